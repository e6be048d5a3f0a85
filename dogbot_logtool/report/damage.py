"""Damage to a log, told."""

from collections.abc import Sequence
from typing import Any, Final

from rich.console import Console
from rich.text import Text

from dogbot_logtool.printable import printable
from dogbot_logtool.reader.log import Loss, lost_messages

_TOLD: Final = 10
"""Places of damage that are listed one by one."""


def damage_json(losses: Sequence[Loss]) -> dict[str, Any]:
    """Return damage as plain values; `messages` is null when their number cannot be known."""
    return {
        "messages": lost_messages(losses),
        "bytes": sum(loss.bytes for loss in losses),
        "places": [
            {
                "offset": loss.offset,
                "text": loss.what,
                "messages": loss.messages,
                "bytes": loss.bytes,
            }
            for loss in losses
        ],
    }


def print_damage(console: Console, losses: Sequence[Loss]) -> None:
    """Print what was lost, and where."""
    for loss in losses[:_TOLD]:
        line = Text.assemble(Text(" damage  ", style="red"), printable(loss.what))
        console.print(line, soft_wrap=True)
    if len(losses) > _TOLD:
        console.print(f" damage  and {len(losses) - _TOLD} more places")
    if losses:
        messages = lost_messages(losses)
        count = "an unknown number of" if messages is None else f"{messages:,}"
        size = sum(loss.bytes for loss in losses)
        console.print(f"   lost  {count} messages, {size:,} bytes", soft_wrap=True)
