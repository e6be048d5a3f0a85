"""Damage to a log, for scripts."""

from typing import Any

from dogbot_logtool.reader.containers.loss import Damage


def damage_json(damage: Damage) -> dict[str, Any]:
    """Return damage as plain values.

    `messages` is null when their number cannot be known, `text` where the log is sound, and
    `start_s` and `end_s`, which count from the log's first message, where they are not known.
    """
    return {
        "text": damage.text or None,
        "messages": damage.messages,
        "bytes": damage.bytes,
        "places": [
            {
                "offset": loss.offset,
                "text": loss.what,
                "messages": loss.messages,
                "bytes": loss.bytes,
                "start_s": damage.seconds(loss.start_time),
                "end_s": damage.seconds(loss.end_time),
            }
            for loss in damage.losses
        ],
    }
