"""The command `vssea`."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from pydantic import ValidationError

from backend.emulator.commands import emulator
from backend.refusal import refuse
from backend.rigs.commands import rig

if TYPE_CHECKING:
    from backend.settings import Settings

app = typer.Typer(no_args_is_help=True, help="Tune the robust position control of a variable stiffness actuator.")
app.add_typer(emulator, name="emulator")
app.add_typer(rig, name="rig")


def _settings(**given: Any) -> "Settings":
    from pydantic_settings import SettingsError

    from backend.settings import Settings

    try:
        return Settings(**{name: value for name, value in given.items() if value is not None})
    except ValidationError as error:
        first = error.errors()[0]
        refuse(f"{'.'.join(map(str, first['loc']))} {first['msg'].removeprefix('Value error, ')}".strip())
    except SettingsError as error:
        refuse(f'{error}; expected JSON, such as ["my-host"]')


@app.command()
def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on (127.0.0.1; others need VSSEA_TOKEN).")] = None,
    port: Annotated[int | None, typer.Option(help="Port to listen on (8000).")] = None,
    scenario: Annotated[str | None, typer.Option(help="Scenario of the first start (nominal).")] = None,
) -> None:
    """Start the dashboard."""
    import uvicorn

    from backend.app import create_app
    from backend.batch.start import EngineRefused

    settings = _settings(host=host, port=port, scenario=scenario)
    try:
        application = create_app(settings)
    except OSError as error:
        refuse(f"{settings.data_dir} cannot be the data folder: {error}; set VSSEA_DATA_DIR to a folder of your own")
    except EngineRefused as refusal:
        refuse(f"batches cannot be computed at {settings.batch_engine}: {refusal}")
    shown = f"[{settings.host}]" if ":" in settings.host else settings.host
    typer.echo(f"VSSEA on http://{shown}:{settings.port}/  (Ctrl+C ends it)")
    uvicorn.run(
        application, host=settings.host, port=settings.port, log_level="warning", access_log=False,
        ws_per_message_deflate=False, ws_ping_interval=5.0, ws_ping_timeout=20.0, timeout_graceful_shutdown=2,
    )  # fmt: skip


@app.command()
def simulate(
    file: Annotated[
        str, typer.Argument(help="Scenario as JSON: a file, - for standard input, or a ready scenario's name.")
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Write the trajectory: .csv, .json or .bin.")
    ] = None,
    every: Annotated[int, typer.Option(min=1, help="Keep every n-th sample of the trajectory.")] = 1,
    allow_unstable: Annotated[bool, typer.Option(help="Simulate even if the tuning's own loop is unstable.")] = False,
) -> None:
    """Simulate a scenario and print its metrics as JSON."""
    from backend.compute.jobs import simulate_scenario
    from backend.problem import from_validation
    from vssea_core.scenario import Scenario
    from vssea_core.scenarios import SCENARIOS

    forms = {".csv": "csv", ".json": "json", ".bin": "binary"}
    form = forms.get(output.suffix, "") if output else "none"
    if not form:
        refuse(f"{output} cannot be written: expected a name ending in {', '.join(forms)}")
    try:
        scenario = SCENARIOS[file] if file in SCENARIOS else Scenario.model_validate_json(_read(file))
        _, content = simulate_scenario(scenario, form, every, allow_unstable)
        figures = content if form == "none" else simulate_scenario(scenario, "none", 1, True)[1]
    except ValidationError as error:
        refuse(from_validation(error, Scenario).detail)
    except ValueError as refusal:
        refuse(str(refusal))
    if output:
        _write(output, content)
    typer.echo(json.dumps(json.loads(figures), indent=2, ensure_ascii=False))


@app.command()
def export(
    file: Annotated[
        str, typer.Argument(help="Scenario as JSON: a file, - for standard input, or a ready scenario's name.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder to write to; it is made if it is not there.")],
) -> None:
    """Export a scenario's controller: numbers as JSON and for MATLAB, C source with test vectors."""
    from backend.compute.jobs import export_all
    from backend.problem import from_validation
    from vssea_core.scenario import Scenario
    from vssea_core.scenarios import SCENARIOS

    try:
        files = export_all(SCENARIOS[file] if file in SCENARIOS else Scenario.model_validate_json(_read(file)))
    except ValidationError as error:
        refuse(from_validation(error, Scenario).detail)
    except ValueError as refusal:
        refuse(str(refusal))
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        refuse(f"{output} cannot be made: {error}")
    for name, content in files.items():
        _write(output / name, content)
        typer.echo(output / name)


@app.command()
def paper(
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for the report; made if it is missing.")
    ] = Path("paper-report"),
) -> None:
    """Check the paper: draw Figs. 2 to 4 from simulations and test each sentence of its results.

    Exit status 1 if a claim fails.
    """
    from rich.console import Console

    from backend.reports.paper import paper_report
    from backend.reports.terminal import claims_shown, with_progress

    try:
        report = with_progress(lambda tell: paper_report(str(output), tell))
    except OSError as error:
        refuse(f"{output} cannot be written: {error}; expected a folder of your own")
    Console().print(claims_shown(report))
    typer.echo(f"{report['statement']}\n{output / 'index.html'}")
    if not report["passed"]:
        raise typer.Exit(1)


@app.command()
def report(
    recording: Annotated[str, typer.Argument(help="An MCAP file, or the id of a recording in the recordings folder.")],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="File to write; <id>-report.html if unset.")
    ] = None,
) -> None:
    """Write the report of a recording: one HTML page that needs no other file."""
    from backend.recordings.reader import Recording
    from backend.recordings.report import report_page

    path = Path(recording)
    if path.suffix != ".mcap":
        path = _settings().recordings_folder / f"{recording}.mcap"
    try:
        page = report_page(Recording(path))
    except OSError as error:
        refuse(f"{path} cannot be read: {error.strerror}; expected an .mcap file or a recording's id")
    except ValueError as refusal:
        refuse(str(refusal))
    target = output or Path(f"{path.stem}-report.html")
    _write(target, page.encode())
    typer.echo(target)


def _read(file: str) -> str:
    try:
        return sys.stdin.read() if file == "-" else Path(file).read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        refuse(f"{file} cannot be read: {error}; expected a scenario's file or name (nominal, realistic, paper_fig2)")


def _write(file: Path, content: bytes) -> None:
    try:
        file.write_bytes(content)
    except OSError as error:
        refuse(f"{file} cannot be written: {error}")


if __name__ == "__main__":
    app()
