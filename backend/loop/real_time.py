"""What real-time loops want of an operating system: kernels compiled before, no garbage collection, priority, locked memory."""

import gc

from backend.processes import ask_for_real_time


def compile_first() -> None:
    """Compile the kernels of a loop, or load them; who comes second finds the machine code ready."""
    from filelock import FileLock

    from vssea_core.compiled import cache_folder

    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    with FileLock(folder / "compiling.lock"):
        from backend.loop.warm import compile_kernels

        compile_kernels()


def settle_down() -> bool:
    """Switch garbage collection off and ask for real time; return whether it was granted."""
    gc.collect()
    gc.freeze()
    gc.disable()
    return ask_for_real_time()
