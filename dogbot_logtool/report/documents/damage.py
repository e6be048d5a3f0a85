"""Damage to a log, for scripts."""

from collections.abc import Sequence
from typing import Any

from dogbot_logtool.reader.containers.log import Loss, lost_messages


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
