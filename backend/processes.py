"""Starting another process by the name of its entry, so that the web process never imports what that process needs."""

import importlib
import multiprocessing
from multiprocessing.process import BaseProcess
from typing import Any

CONTEXT = multiprocessing.get_context("spawn")


def started(name: str, entry: str, *arguments: Any) -> BaseProcess:
    """Start and return a daemon process that runs `entry`, written "package.module:function"."""
    process = CONTEXT.Process(target=_enter, args=(entry, *arguments), name=name, daemon=True)
    process.start()
    return process


def _enter(entry: str, *arguments: Any) -> None:
    module, function = entry.split(":")
    getattr(importlib.import_module(module), function)(*arguments)
