"""The command `vssea`."""

from typing import Annotated

import typer

app = typer.Typer(no_args_is_help=True, help="Tune the robust position control of a variable stiffness actuator.")


@app.callback()
def command() -> None:
    """Keep `serve` a subcommand while it is the only one."""


@app.command()
def serve(
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Port to listen on.")] = 8000,
) -> None:
    """Start the dashboard."""
