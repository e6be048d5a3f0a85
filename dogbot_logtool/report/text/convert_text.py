"""The summary of `convert` for people."""

from rich.console import Console

from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import shown
from dogbot_logtool.report.text.console import print_findings, print_losses, print_sentence
from dogbot_logtool.results import Conversion


def print_conversion(console: Console, done: Conversion, *, verbose: bool) -> None:
    """Print what was done."""
    added = sum(done.annotations.values())
    name = printable(shown(done.target))
    line = f": {done.copied:,} recorded messages and {added:,} annotations"
    print_sentence(console, (name, "bold"), line)
    if verbose:
        for topic, count in done.annotations.items():
            print_sentence(console, f"         {count:>9,}  {printable(topic)}")
    print_findings(console, done.findings)
    print_losses(console, done.damage)
