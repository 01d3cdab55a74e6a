"""The commands `vssea emulator ...`: run an emulated rig, and set or look at what goes wrong with it."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from backend.emulator.control_port import PORT, ask
from backend.refusal import refuse

emulator = typer.Typer(invoke_without_command=True, help="Run a whole emulated rig on a CAN bus of its own.")


@emulator.callback()
def run(
    context: typer.Context,
    port: Annotated[int, typer.Option(min=1, max=65534, help="Port of the bus; the control port is the next.")] = PORT,
    interface: Annotated[str, typer.Option(help="socketcand (a server of its own), or socketcan.")] = "socketcand",
    channel: Annotated[str, typer.Option(help="Name of the CAN channel, such as vcan0 with socketcan.")] = "can0",
    actuator: Annotated[
        Path | None, typer.Option(help="Actuator as JSON; the default one with dry friction if unset.")
    ] = None,
    stiffness: Annotated[float, typer.Option(help="N·m/rad at which it is switched on.")] = 200.0,
    stiffness_offset: Annotated[
        float, typer.Option(help="rad that the stiffness encoder shows at switch-on; 0 = it has to be homed.")
    ] = 0.0,
) -> None:
    """Run an emulated rig until Ctrl+C: two CiA 402 drives and a CiA 406 encoder behind socketcand on 127.0.0.1."""
    context.obj = port
    if context.invoked_subcommand is not None:
        return
    from backend.emulator.process import Options, run_emulator

    plant = _actuator(actuator)
    options = Options(port, interface, channel, plant, _stiffness(stiffness, plant), stiffness_offset)
    where = f"127.0.0.1:{port}" if interface == "socketcand" else channel
    try:
        run_emulator(options, started=lambda _: typer.echo(f"Emulated rig on {interface} {where}  (Ctrl+C ends it)"))
    except OSError as error:
        hint = (
            "is an emulator running there already" if interface == "socketcand" else "does `ip link` list the channel"
        )
        refuse(f"{interface} {where} cannot be opened: {error}; {hint}?")


@emulator.command()
def fault(
    context: typer.Context,
    name: Annotated[str, typer.Argument(help="Such as drive_fault; `vssea emulator faults` lists them.")],
    node: Annotated[int | None, typer.Option(help="1 motor drive, 2 stiffness drive, 3 link encoder.")] = None,
    value: Annotated[str | None, typer.Option(help="Size of the fault, such as 0.05 or 0x2310.")] = None,
) -> None:
    """Let something go wrong with the running emulator."""
    _show(context, {"do": "fault", "name": name, "node": node, "value": value})


@emulator.command()
def clear(context: typer.Context) -> None:
    """Take all faults back; a drive's fault still waits for its reset."""
    _show(context, {"do": "clear"})


@emulator.command()
def load(
    context: typer.Context, torque: Annotated[float, typer.Argument(help="N·m; positive opposes positive motion.")]
) -> None:
    """Load the link with a torque that stays; 0 takes it off."""
    _show(context, {"do": "load", "value": torque})


@emulator.command()
def state(context: typer.Context) -> None:
    """Print the emulated rig as it truly is."""
    _show(context, {"do": "state"})


@emulator.command()
def watch(context: typer.Context) -> None:
    """Begin peaks anew."""
    _show(context, {"do": "watch"})


@emulator.command()
def peaks(context: typer.Context) -> None:
    """Print what was largest since `watch`, and when the motor was without torque."""
    _show(context, {"do": "peaks"})


@emulator.command()
def faults() -> None:
    """List what can go wrong."""
    from backend.emulator.faults import FAULTS

    for name, meaning in FAULTS.items():
        typer.echo(f"{name:18}{meaning}")


def _show(context: typer.Context, request: dict[str, Any]) -> None:
    try:
        reply = ask(context.obj + 1, {key: value for key, value in request.items() if value is not None})
    except (OSError, ValueError) as error:
        refuse(f"no emulator answers on 127.0.0.1:{context.obj}: {error}; start one with: vssea emulator")
    if "error" in reply:
        refuse(reply["error"])
    typer.echo(json.dumps(reply, indent=2, ensure_ascii=False))


def _actuator(file: Path | None) -> Any:
    if file is None:
        return None
    from pydantic import ValidationError

    from vssea_core.actuator.parameters import Actuator

    try:
        return Actuator.model_validate_json(file.read_text("utf-8"))
    except ValidationError as error:
        first = error.errors()[0]
        refuse(f"{file}: {'.'.join(map(str, first['loc']))} {first['msg'].removeprefix('Value error, ')}")
    except (OSError, UnicodeDecodeError) as error:
        refuse(f"{file} cannot be read: {error}; expected an actuator as JSON")


def _stiffness(stiffness: float, actuator: Any) -> float:
    from vssea_core.actuator.parameters import Actuator

    mechanism = (actuator or Actuator()).stiffness
    if not mechanism.softest <= stiffness <= mechanism.stiffest:
        refuse(
            f"stiffness {stiffness:g} N·m/rad is not between its stops; "
            f"expected {mechanism.softest:g} to {mechanism.stiffest:g}"
        )
    return stiffness
