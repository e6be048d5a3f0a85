"""What is drawn of a walk in any span of log time: looked up, so that spans need no order."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.conversion.scene import Scene
from dogbot_logtool.core.arrays import AnyColumns, Ints, picked
from dogbot_logtool.core.events import STEPS, to_log_time, with_steps
from dogbot_logtool.core.gait.segments import gait_changes
from dogbot_logtool.core.scene.arrows import Arrows, sample_arrows
from dogbot_logtool.core.scene.feet import DrawnFoot, foot_labels, foot_loads
from dogbot_logtool.core.scene.support_scene import leg_lines, support_scene
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.writer import described, topics
from dogbot_logtool.writer.annotations import Annotations, Drawn
from dogbot_logtool.writer.chunks import FinishedChunk, MessageRecords, finish_chunks, of_payloads

SPAN_ROWS = 40_000
"""Samples of feet in a span: enough to make the cost of a numpy call small, and few enough to be
annotated in some 60 MB."""
_TIMES: Final = np.iinfo(np.int64)
TimeSpan = tuple[int, int]
"""ns, log times from which on and before which is annotated."""


def time_spans(scene: Scene) -> list[TimeSpan]:
    """Cut log time into spans with about as many rows of what is drawn."""
    columns = [scene.poses.log_time, *(foot.samples.log_time for foot in scene.feet)]
    times = max(columns, key=len)
    spans = sum(map(len, columns)) // SPAN_ROWS + 1
    cuts = sorted({*times[np.arange(1, spans) * len(times) // spans].tolist()})
    return list(zip([_TIMES.min, *cuts], [*cuts, _TIMES.max], strict=True))


def annotate_span(
    scene: Scene, annotations: Annotations, _log: Log, span: TimeSpan | None
) -> tuple[list[FinishedChunk], Counter[str]]:
    """Return the chunks of a span, and how many annotations lack something.

    Args:
        scene: what is drawn.
        annotations: as which messages.
        span: ns; None: the robot, and events and gaits of the whole log.
    """
    counts = Counter[str]()
    if span is None:
        parts: Iterable[MessageRecords] = _records_of_the_whole(annotations, scene)
    else:
        columns, counts = _annotations_between(scene, *span)
        parts = annotations.messages(columns)
    compression = scene.options.compression or "zstd"
    return [chunk for part in parts for chunk in finish_chunks(part, compression)], counts


def _annotations_between(scene: Scene, start: int, end: int) -> tuple[list[Drawn], Counter[str]]:
    """Return what is drawn from a log time on and before another, ns.

    Returns:
        annotations, and how many lack something: arrows as in `core/scene/arrows.py`,
        ``support_unknown`` without a polygon, since contact or contact point of some foot is
        unknown, ``support_unweighed`` with a polygon, but a vertical force unknown.
    """

    def rows(log_time: Ints) -> slice:
        return slice(*np.searchsorted(log_time, [start, end]).tolist())

    def within(columns: AnyColumns, log_time: Ints) -> AnyColumns:
        return picked(columns, rows(log_time))

    counts = Counter[str]()
    feet = [(foot, rows(foot.samples.log_time)) for foot in scene.feet]
    forced = [each for each in feet if each[0].has_force]
    drawn: list[Drawn] = [within(each, each.log_time) for each in scene.others]
    for foot, own in () if scene.style.needs_contact_states else forced:
        arrows, skipped = _arrows(scene, foot, own)
        drawn.append(arrows)
        counts += skipped
    drawn += [foot_loads(*each, scene.walk.settings.body_weight_n) for each in feet]
    drawn += [foot_labels(*each) for each in forced]
    poses = within(scene.poses, scene.poses.log_time)
    if scene.wanted.has_support:
        com_offset_m = scene.selection.robot.com_offset_m or (0, 0, 0)
        support = support_scene(poses, scene.feet, com_offset_m)
        counts += Counter(support_unknown=support.unknown, support_unweighed=support.unweighed)
        drawn.append(support)
    if scene.description.hips is not None:
        drawn.append(leg_lines(poses, scene.feet, scene.description.hips))
    return drawn, counts


def _arrows(scene: Scene, foot: DrawnFoot, rows: slice) -> tuple[Arrows, Counter[str]]:
    """Return the arrows of samples that touch, and the removals of all others."""
    samples = picked(foot.samples, rows)
    samples = replace(
        samples,
        in_contact=samples.in_contact & foot.touching[rows],
        force=samples.force.astype(np.float64),
        normal=samples.normal.astype(np.float64),
    )
    return sample_arrows(samples, scene.arrow_scale, along_force=scene.style.along_force)


def _records_of_the_whole(annotations: Annotations, scene: Scene) -> Iterator[MessageRecords]:
    """Yield the messages of `/robot_description`, `/gait`, `/events` and `/events/spans`."""
    if scene.description.urdf is not None and scene.opening is not None:
        yield annotations.robot_description(scene.description.urdf, scene.opening)
    made, channels, walk = annotations.encoding.message, annotations.channels, scene.walk
    tracks = [foot.record.track for foot in walk.feet]

    def log_time(times: Sequence[int]) -> Ints:
        return to_log_time(tracks, np.array(times, np.int64), scene.opening or 0, scene.end)

    gaits = gait_changes(walk.segments, walk.feet)
    states = (made(described.gait(*each)) for each in gaits)
    yield of_payloads(channels[topics.GAIT], states, log_time([time for time, _ in gaits]))
    found = with_steps(walk.metrics)
    events = [(walk.origin + round(each.onset_s * 1e9), each) for each in found]
    event_time = log_time([time for time, _ in events])
    logged = (made(described.event(*each)) for each in events)
    yield of_payloads(channels[topics.EVENTS], logged, event_time)
    if topics.SPANS in channels:
        # A viewer's timeline shows what calls for a look; steps are in the log panel.
        odd = [row for row, (_, event) in enumerate(events) if event.type not in STEPS]
        spans = (made(described.span(*events[row])) for row in odd)
        yield of_payloads(channels[topics.SPANS], spans, event_time[odd])
