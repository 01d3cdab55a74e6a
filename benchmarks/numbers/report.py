"""Print every number of the theory that can be checked, the expected one beside what this code gives."""

from rich.console import Console
from rich.table import Table

from benchmarks.numbers import encoders, law, observer

CONDITIONS = (
    "RMS and chatter over t >= 4 s unless said; chatter = RMS of the torque's change from one sample to the next; "
    "no fade-in; torque limit only (no speed and no thermal limit); T = 1 ms. "
    "Left out: the baselines of Fig. 2 without observer, and super-twisting, which the product does not offer."
)


def main() -> None:
    """Compute all sections and print one table each."""
    console = Console(width=200, soft_wrap=False)
    console.print(CONDITIONS)
    for title, module in (("Section 2", law), ("Section 3", observer), ("Section 5", encoders)):
        table = Table("what", "expected", "measured", "how", title=title, title_justify="left", show_lines=False)
        for section in module.SECTIONS:
            for line in section():
                table.add_row(*line)
        console.print(table)
