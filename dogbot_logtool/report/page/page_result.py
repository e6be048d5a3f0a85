"""Results of `report`, for people and for scripts."""

from typing import Any

from rich.console import Console

from dogbot_logtool import __version__
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import shown
from dogbot_logtool.report.documents import damage_json
from dogbot_logtool.report.text.console import human_size, print_losses, print_sentence
from dogbot_logtool.report.verdict import headline, quality_of
from dogbot_logtool.results import Page


def page_json(done: Page) -> dict[str, Any]:
    """Return what was written as plain values."""
    measured = done.measured
    return {
        "tool": {"name": "dogbot-logtool", "version": __version__},
        "input": shown(done.source),
        "output": shown(done.target),
        "bytes": done.size,
        "verdict": headline(measured.metrics),
        "quality": quality_of(measured).word,
        "damage": damage_json(measured.damage),
    }


def print_page(console: Console, done: Page, *, verbose: bool) -> None:
    """Print what was written."""
    measured = done.measured
    name = printable(shown(done.target)), "bold"
    words = f": {headline(measured.metrics)}. {quality_of(measured).line} ({human_size(done.size)})"
    print_sentence(console, name, printable(words))
    if verbose:
        for each in measured.findings:
            print_sentence(console, f"{each.severity.word:>7}  {printable(each.text)}", indent=9)
    print_losses(console, done.damage)
