"""What `stats --parquet` has done, for people."""

from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.text import Text

from dogbot_logtool.io.printable import printable


def print_dataset(
    console: Console,
    dataset: str,
    written: Sequence[dict[str, Any]],
    unchanged: Sequence[tuple[str, int]],
    failed: int,
) -> None:
    """Print how many logs a dataset has received, and name the damaged ones.

    Args:
        console: where to print.
        dataset: name of the dataset, as it may be shown.
        written: figures of the logs that were written, as in `--json`.
        unchanged: names and exit codes of the logs that were there already.
        failed: how many logs could not be measured or written.
    """
    damaged = [(each["log"]["path"], _lost(each["quality"])) for each in written]
    damaged = [(name, lost) for name, lost in damaged if lost]
    damaged += [
        (name, "unchanged, damaged when it was measured") for name, code in unchanged if code
    ]
    counts = ((len(written), "written"), (len(unchanged), "unchanged"), (failed, "failed"))
    words = [f"{count:,} {what}" for count, what in counts if count or what == "written"]
    text = f": {', '.join(words)}; {len(damaged):,} damaged"
    console.print(Text.assemble(Text(printable(dataset), style="bold"), text), soft_wrap=True)
    for name, lost in damaged:
        line = Text.assemble(Text(" damage  ", style="red"), f"{printable(name)}: {lost}")
        console.print(line, soft_wrap=True)


def _lost(quality: dict[str, Any]) -> str:
    """Say how much of a log was lost; nothing if it is sound."""
    if not quality["losses"]:
        return ""
    messages = quality["lost_messages"]
    count = "an unknown number of" if messages is None else f"{messages:,}"
    return f"{count} messages, {quality['lost_bytes']:,} bytes lost"
