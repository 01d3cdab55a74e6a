"""How a command of the command line refuses: one sentence, exit status 2."""

from typing import NoReturn

import typer


def refuse(sentence: str) -> NoReturn:
    """End the command with a sentence on standard error and exit status 2."""
    typer.echo(f"vssea: {sentence}", err=True)
    raise typer.Exit(2)
