"""The metadata record that tells how a file was made: no dates, no paths."""

from collections.abc import Mapping, Sequence
from typing import Final

from mcap import records

from dogbot_logtool import __version__
from dogbot_logtool.conversion.plan import ConversionPlan
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import file_name
from dogbot_logtool.provenance import PROVENANCE
from dogbot_logtool.reader.containers.log import Log, Loss, lost_messages
from dogbot_logtool.writer.mcap_writer import metadata_record

_LONGEST_NUMBER: Final = 18


def provenance_record(
    log: Log, plan: ConversionPlan, losses: Sequence[Loss], *, force_in_world: bool
) -> records.Metadata:
    """Return the record of a conversion."""
    options, robot = plan.options, plan.selection.robot
    values: dict[str, object] = {
        "version": __version__,
        "style": options.style,
        "encoding": options.encoding,
        "copy": options.copy,
        "wrench_frame": robot.wrench_frame,
        "force_in_world": force_in_world,
        "tf": options.tf,
        "tf_rate_hz": options.tf_rate,
        "robot": robot.name,
        "mass_kg": robot.mass_kg,
        "world_frame": plan.wanted.world_frame,
        "base_frame": plan.wanted.base_frame,
        **_copied(plan),
        **_origin(log, plan),
        **_loss(log, losses),
    }
    texts = {key: "" if value is None else str(value) for key, value in values.items()}
    return metadata_record(PROVENANCE, texts)


def _copied(plan: ConversionPlan) -> dict[str, object]:
    """Return which topics were copied, where that was not all."""
    globs = {"topics": plan.options.copied_topics, "without": plan.options.topics_left_out}
    return {key: " ".join(map(printable, value)) for key, value in globs.items() if value}


def _origin(log: Log, plan: ConversionPlan) -> dict[str, object]:
    """Return where the recorded messages come from.

    For a log that was annotated before, that is the log which it was made from, as long as a part
    of its time is not cut out anew.
    """
    start_s, end_s = plan.options.start, plan.options.end
    earlier = _earlier(log)
    if earlier and not any(
        (start_s, end_s, *(each.get(key) for each in earlier[1:] for key in ("start_s", "end_s")))
    ):
        return {key: earlier[0].get(key) for key in ("input", "container", "start_s", "end_s")}
    return {
        "input": printable(file_name(log.source.path)),
        "container": log.container,
        "start_s": start_s,
        "end_s": end_s,
    }


def _loss(log: Log, losses: Sequence[Loss]) -> dict[str, object]:
    """Return what was lost on the way, also when the log was annotated before."""
    earlier = _earlier(log)
    messages = [lost_messages(losses), *(_number(each.get("lost_messages")) for each in earlier)]
    texts = [*(each.get("damage", "") for each in earlier), *(loss.what for loss in losses)]
    known = [count for count in messages if count is not None]
    return {
        "lost_messages": sum(known) if len(known) == len(messages) else None,
        "lost_bytes": sum(loss.bytes for loss in losses)
        + sum(_number(each.get("lost_bytes")) or 0 for each in earlier),
        "damage": "; ".join(text for text in texts if text),
    }


def _earlier(log: Log) -> Sequence[Mapping[str, str]]:
    annotations = log.annotations
    return annotations.records if annotations else ()


def _number(text: str | None) -> int | None:
    """Return a count that a record tells; None if it tells none."""
    sound = text and text.isascii() and text.isdigit() and len(text) <= _LONGEST_NUMBER
    return int(text) if text and sound else None
