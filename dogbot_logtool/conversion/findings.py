"""Findings about an annotated log: what is not copied, what cannot be drawn, and how often."""

from collections import Counter
from collections.abc import Iterator
from fnmatch import fnmatchcase
from typing import Final

from dogbot_logtool.core.known_frames import KnownFrames, WorldFrames
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.scene.arrows import ArrowStyle
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import listed
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.robot.selection import Selection

_MOST_FEET: Final = 16
"""Feet for which support is drawn: the work grows with the cube of their number."""


def copy_findings(log: Log, options: ConvertOptions, left_out: frozenset[int]) -> Iterator[Finding]:
    """Say what is left out, and which patterns fit no topic."""
    topics = {channel.topic for channel in log.channels.values()}
    for glob in options.topics:
        if not any(fnmatchcase(topic, glob.removeprefix("!")) for topic in topics):
            yield found("COPY", say="no_topic", glob=glob)
    if left_out:
        names = sorted({log.channels[number].topic for number in left_out})
        messages = sum(log.counts.get(number, 0) for number in left_out)
        yield found("COPY", messages=messages, topics=listed(names))


def second_tf(
    selection: Selection,
    frames: KnownFrames,
    options: ConvertOptions,
    left_out: frozenset[int] = frozenset(),
) -> Finding | None:
    """Say that the transforms that are copied place the base already; None: they do not.

    The same transform twice is harmless; only another parent breaks the tree.
    """
    if not (selection.has_base and options.copy):
        return None
    transforms, odometry = (
        [channel for channel in channels if channel.id not in left_out]
        for channels in (selection.transforms, selection.odometry)
    )
    if odometry and selection.base and selection.base.source.is_transform:
        return found("TF_NOT_WRITTEN", base=frames.base, world=frames.world)
    others = frames.parents.get(frames.base, frozenset()) - {frames.world}
    if transforms and others:
        parents = ", ".join(sorted(others))
        return found("TF_NOT_WRITTEN", "other_parent", base=frames.base, parents=parents)
    return None


def no_support(selection: Selection) -> Finding | None:
    """Say what support lacks; None: nothing."""
    count, why = len(selection.robot.feet), ""
    if not selection.has_base:
        why = "the log has no odometry"
    elif not selection.has_points:
        why = "the log has no contact points"
    elif count > _MOST_FEET:
        why = f"the robot has {count} feet, more than {_MOST_FEET}"
    return found("NO_SUPPORT_DRAWN", why=why) if why else None


def arrow_findings(
    selection: Selection,
    style: ArrowStyle,
    frames: WorldFrames | None,
    settings: WalkSettings,
    weight_n: float | None,
) -> Iterator[Finding]:
    """Say what arrows of a style lack.

    Args:
        selection: topics of the feet.
        style: of the arrows.
        frames: how links and sensors hang in the world.
        settings: of the walk.
        weight_n: N, by which arrows may be coloured; None: not known.
    """
    links, points = (frames.links, frames.points) if frames else ((), ())
    placed = {row for row, point in enumerate(points) if point}
    nowhere = [
        foot.name
        for row, foot in enumerate(settings.feet)
        if foot.has_force
        and row not in placed
        and any(each.in_base or not each.has_points for each in selection.sources_of(row))
    ]
    if nowhere:
        yield found("NOT_DRAWN", "no_points", names=", ".join(nowhere))
    if style.along_force and not settings.force_in_world:
        turned = {row for row, link in enumerate(links) if link}
        lacking = [foot.name for row, foot in enumerate(settings.feet) if row not in turned]
        whose = f" of {', '.join(lacking)}" if turned else ""
        if lacking:
            yield found("NOT_DRAWN", say="magnitude", whose=whose)
    if style.along_force and not weight_n:
        yield found("MASS_UNKNOWN", say="colours")
    for source in selection.sources if style.needs_contact_states else ():
        if source.has_force and not source.has_points:
            yield found("NOT_DRAWN", say="no_states", type=source.row.name, style=style.name)


def count_findings(
    recording: Recording, counts: Counter[str], style: ArrowStyle
) -> Iterator[Finding]:
    """Say how many messages and annotations lack something.

    Args:
        recording: the columns that they are made of.
        counts: annotations that lack something, by what.
        style: of the arrows.
    """
    untimed = 0 if style.needs_contact_states else recording.untimed_messages
    for count, code, say in (
        (counts["bad_poses"], "NOT_FINITE", "no_tf"),
        (untimed, "STATES_IGNORED", "untimed"),
        (recording.foreign_states, "STATES_IGNORED", "plain"),
        (counts["not_finite"], "NOT_FINITE", "not_drawn"),
        (counts["no_position"], "NOT_DRAWN", "no_position"),
        (counts["no_direction"], "NOT_DRAWN", "no_direction"),
        (counts["overflow"], "NOT_FINITE", "overflow"),
        (counts["support_unknown"], "NO_SUPPORT_DRAWN", "no_polygon"),
        (counts["support_unweighed"], "NO_SUPPORT_DRAWN", "no_pressure"),
    ):
        if count:
            cases = ("base",) if say == "no_tf" else ()
            yield found(code, *cases, say=say, count=count)
