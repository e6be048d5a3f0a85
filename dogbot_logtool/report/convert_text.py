"""The summary of `convert` for people."""

from rich.console import Console
from rich.text import Text

from dogbot_logtool.convert import Conversion
from dogbot_logtool.printable import printable
from dogbot_logtool.report.console import print_damage, print_findings
from dogbot_logtool.storage import shown


def print_conversion(console: Console, done: Conversion, *, verbose: bool) -> None:
    """Print what was done."""
    added = sum(done.annotations.values())
    name = printable(shown(done.target))
    line = f": {done.copied:,} recorded messages and {added:,} annotations"
    console.print(Text.assemble(Text(name, style="bold"), line), soft_wrap=True)
    if verbose:
        for topic, count in done.annotations.items():
            console.print(f"         {count:>9,}  {printable(topic)}", soft_wrap=True)
    print_findings(console, done.findings)
    print_damage(console, done.losses)
