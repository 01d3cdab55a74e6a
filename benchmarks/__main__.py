"""Run a benchmark by name; each is a module with a `main()` whose docstring says what it measures."""

import argparse
import importlib

BENCHMARKS = {
    "numbers": ("benchmarks.numbers.report", "every number of the theory, recomputed by this code"),
    "kernel": ("benchmarks.kernel", "time of a simulated run, beside scipy and python-control"),
    "maps": (
        "benchmarks.maps",
        "time of stability and margin maps and of the report on one tuning, beside python-control",
    ),
    "stability": ("benchmarks.stability", "linear predictions against nonlinear simulations at 400 random points"),
    "batch": (
        "benchmarks.batch",
        "runs a second of batches, their memory, growth; rows against single runs, bit by bit",
    ),
    "cluster": ("benchmarks.batch_cluster", "a batch on this machine's engine and on a local Dask cluster"),
    "beside": ("benchmarks.batch_beside", "lateness of the live loop with and without a batch beside it"),
    "export": ("benchmarks.export", "one tick of the exported C controller, beside the compiled tick"),
    "store": ("benchmarks.store", "1,000 edits of one preset by two programs, and a list of 1,000 presets"),
    "start": ("benchmarks.start", "from starting the server to something moving on the page"),
    "latency": ("benchmarks.latency", "slider to changed torque, STOP to zero torque"),
    "kills": ("benchmarks.kills", "SIGKILLs of the recording process: unreadable files, tail lost"),
    "recorder": ("benchmarks.recorder", "lateness of the loop with the recorder on and off"),
    "hour": ("benchmarks.hour", "one hour of recording: size, memory, samples lost, time"),
    "recordings": (
        "benchmarks.recordings",
        "an hour's recording: written, opened, drawn, exported, beside the public mcap reader",
    ),
    "emulator": (
        "benchmarks.emulator",
        "the emulated rig: SYNC to the last answer at 500 Hz and 1 kHz, processor time",
    ),
    "faults": (
        "benchmarks.rigs.campaign",
        "every fault in every activity on an emulated rig: time to safe torque, peaks",
    ),
    "rig": ("benchmarks.rigs.cycle", "the loop on an emulated CAN bus, 500 Hz and 1 kHz, for a minute each"),
    "stop": ("benchmarks.rigs.stop_click", "STOP clicked in Chromium to zero torque at an emulated motor"),
    "stiffness": (
        "benchmarks.rigs.stiffness",
        "stiffness 50, 800, 50 N m/rad while tracking, with and without its terms",
    ),
    "agreement": ("benchmarks.rigs.agreement", "the same scenario on the emulated rig and in simulation"),
    "loop": ("benchmarks.loop", "the 1 kHz loop for two minutes: lateness, overruns, lost samples, processor time"),
}


def main() -> None:
    """Parse the command line and run the benchmark it names."""
    listing = "\n".join(f"  {name:10} {words}" for name, (_, words) in BENCHMARKS.items())
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=f"benchmarks:\n{listing}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("name", nargs="*", choices=[[], *BENCHMARKS], metavar="NAME", help="default: all, one by one")
    for name in parser.parse_args().name or BENCHMARKS:
        importlib.import_module(BENCHMARKS[name][0]).main()


if __name__ == "__main__":
    main()
