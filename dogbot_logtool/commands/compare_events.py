"""The story of `compare LABELS LOG`: are labelled events found, and when?"""

from pathlib import Path

from dogbot_logtool.commands.tasks import Measure
from dogbot_logtool.comparison.walks.event_files import (
    LabelledEvent,
    is_event_file,
    read_event_file,
)
from dogbot_logtool.comparison.walks.labelled_events import EventMatch, match_labels
from dogbot_logtool.core.events.gait_labels import SIDES, feet_by_side
from dogbot_logtool.errors import CallError
from dogbot_logtool.pipeline.options import StatsOptions
from dogbot_logtool.report.figures.figure import Json


def compare_events(
    labels: Path, actual: Path, within_s: float, options: StatsOptions
) -> list[EventMatch]:
    """Match labelled events with those of a log, or of another file.

    Args:
        labels: the file of labelled events.
        actual: a log, or a file of events.
        within_s: s that an event may be early or late.
        options: of measuring the log.

    Raises:
        CallError: a file cannot be read, or names feet that the log does not have.
        LogError: the log cannot be used.
    """
    labelled = read_event_file(labels)
    if is_event_file(actual):
        return match_labels(labelled, read_event_file(actual), within_s)
    document = Measure(options)(actual, None).json
    found = [
        LabelledEvent(each["onset_s"], each["type"], each["foot"] or "")
        for each in document["events"]
    ]
    return match_labels(_with_names(labelled, document, labels), found, within_s)


def _with_names(labelled: list[LabelledEvent], document: Json, labels: Path) -> list[LabelledEvent]:
    """Give the log's feet to labels that tell sides only."""
    feet = {name: foot["place"] for name, foot in document["feet"].items()}
    named = {each.foot for each in labelled} - {"", *feet}
    sides = feet_by_side(feet) or {}
    if strange := sorted(named - set(sides)):
        have = ", ".join(feet) or "none"
        what = "a side" if strange[0] in SIDES.values() else "a foot"
        raise CallError(
            f"{labels}: {strange[0]} is {what} that the log does not have; it has {have}"
        )
    return [each._replace(foot=sides.get(each.foot, each.foot)) if each.foot in named else each
            for each in labelled]  # fmt: skip
