"""The commands `vssea rig ...`: look at a rig without moving it, and write an example of a rig's file."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from backend.refusal import refuse

if TYPE_CHECKING:
    from backend.rigs.rig_file import RigFile

rig = typer.Typer(no_args_is_help=True, help="Describe and check a rig.")


@rig.command()
def check(
    which: Annotated[str, typer.Argument(metavar="FILE|NAME", help="A rig's file, or the name of a known rig.")],
    gear_ratio: Annotated[
        float | None, typer.Option(help="Gear ratio of the rig's actuator; the default actuator's if unset.")
    ] = None,
) -> None:
    """Open a rig's bus and compare who answers with its file; nothing is written and nothing moves.

    Exit status 1 if something is not as it should be.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from backend.rigs.check import check_rig

    file = _rig_file(which)
    table = Table(box=box.SIMPLE, title=f"Rig {file.name}", title_justify="left")
    for heading in ("", "what", "found", "expected"):
        table.add_column(heading, overflow="fold")
    lines = check_rig(file, gear_ratio)
    for line in lines:
        table.add_row("ok" if line["ok"] else "NOT OK", line["what"], line["found"], line["expected"])
    Console().print(table)
    wrong = [line for line in lines if not line["ok"]]
    for line in wrong:
        typer.echo(line["sentence"])
    if wrong:
        raise typer.Exit(1)
    typer.echo("The rig is as its file says.")


@rig.command()
def example() -> None:
    """Print a commented rig file: two EPOS4 and an encoder on a CAN card."""
    from backend.rigs.library import example_text

    typer.echo(example_text(), nl=False)


def _rig_file(which: str) -> "RigFile":
    from backend.problem import Problem
    from backend.rigs.library import FOLDER, RigLibrary, rig_file_of
    from backend.settings import Settings

    path = Path(which)
    try:
        if path.suffix == ".toml" or path.is_file():
            return rig_file_of(path.read_text("utf-8"))
        return RigLibrary(Settings().data_dir / FOLDER).file(which)
    except (OSError, UnicodeDecodeError) as error:
        refuse(f"{which} cannot be read: {error}; expected a rig's TOML file or a name")
    except Problem as problem:
        refuse(problem.detail)
    except ValueError as error:  # of the settings
        refuse(str(error))
