"""Several sensors of one foot, such as toe and heel: their forces add, any contact is contact.

Which sensors are of one foot is told by the names of their topics, or by the frame or link that
they share.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, concatenated, norms
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import usual_interval_s
from dogbot_logtool.core.recording import Recording, has_own_stamps
from dogbot_logtool.finding import Finding
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.leg_names import foot_name, leg_position
from dogbot_logtool.robot.score import word_of
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.words import SIDES, words_of

NEAR: Final = 1.5
"""Intervals between the messages of two sensors of one foot that tell of one time."""
LEAST_N: Final = 1e-9
"""N: weight of a contact without a force."""


def with_joined_sensors(
    recording: Recording, selection: Selection
) -> tuple[Recording, Selection, tuple[Finding, ...]]:
    """Make one foot of all sensors that a foot has.

    Returns:
        the recording and the selection with whole feet, and what was joined.
    """
    feet = selection.robot.feet
    named = [foot.sensor_of for foot in feet]
    frames = [_only(recording.links.get(row, frozenset())) for row in range(len(feet))]
    groups, how = _groups(named), "names"
    if not groups and all(_is_of_leg(*each) for each in zip(feet, frames, strict=True)):
        groups, how = _groups(frames), "frames"
    if not groups:
        return recording, selection, ()
    names = groups if any(named) else [foot_name(name) for name in groups]
    joined = tuple(
        replace(feet[rows[0]], name=name, sensor_of="", leg_position=leg_position(name))
        for name, rows in zip(names, groups.values(), strict=True)
    )
    row_of = {row: number for number, rows in enumerate(groups.values()) for row in rows}
    of = {
        channel: tuple(dict.fromkeys(row_of[row] for row in rows))
        for channel, rows in selection.feet_of.items()
    }
    silent = any(source.row.silent_in_swing for source in selection.sources)
    samples, links = [], {}
    for number, rows in enumerate(groups.values()):
        samples.append(_joined([recording.feet[row] for row in rows], number, silent=silent))
        links[number] = frozenset(each for row in rows for each in recording.links.get(row, ()))
    # A sensor that is silent while another one of its foot speaks has no gap.
    silenced = {foot.topic for foot in feet if silent} - {foot.topic for foot in joined}
    topics = {t: times for t, times in recording.topics.items() if t not in silenced}
    text = "; ".join(
        f"{name} = {' + '.join(word_of(feet[row]) for row in rows)}"
        for name, rows in zip(names, groups.values(), strict=True)
    )
    finding = Finding("TOPICS_CHOSEN", f"several sensors of one foot, by their {how}: {text}")
    return (
        replace(recording, feet=tuple(samples), links=links, topics=topics),
        replace(selection, robot=replace(selection.robot, feet=joined), feet_of=of),
        (finding,),
    )


def _only(names: frozenset[str]) -> str:
    return next(iter(names)) if len(names) == 1 else ""


def _groups(owners: Sequence[str]) -> dict[str, list[int]]:
    """Return the sensors of each owner; none unless all owners have as many, and several."""
    groups: dict[str, list[int]] = {}
    for row, owner in enumerate(owners):
        groups.setdefault(owner, []).append(row)
    sizes = {len(rows) for rows in groups.values()}
    is_grid = len(groups) > 1 and len(sizes) == 1 and sizes != {1} and "" not in groups
    return groups if is_grid else {}


def _is_of_leg(foot: Foot, frame: str) -> bool:
    """Tell whether a frame's name is that of a leg on the side that the sensor's name says."""
    sides = [
        {SIDES[word.text] for word in words_of(name) if word.text in SIDES}
        for name in (frame, foot.topic)
    ]
    return len(sides[0]) == 1 and sides[1] <= sides[0]


def _joined(sensors: Sequence[Samples], foot: int, *, silent: bool) -> Samples:
    """Add up the sensors of a foot.

    Args:
        sensors: samples of each, at least two.
        foot: number of the foot.
        silent: whether sensors send no messages without contact.
    """
    stamped = all(has_own_stamps(each) for each in sensors if len(each.log_time))
    most = max(sensors, key=lambda each: len(each.log_time))
    interval_ns = (usual_interval_s(most.log_time) or 0.0) * 1e9
    times = [each.stamp if stamped else each.log_time for each in sensors]
    if silent:
        time = np.sort(np.concatenate(times), kind="stable")
        order = np.argsort(np.concatenate(times), kind="stable")
        apart = np.diff(time, prepend=time[:1] - round(interval_ns)) > interval_ns / 2.0
        most = concatenated(sensors).pick(order[apart])
    at = most.stamp if stamped else most.log_time
    rows = [_nearest(time, at) for time in times]
    parts = [each.pick(row) for each, row in zip(sensors, rows, strict=True)]
    pairs = zip(times, rows, strict=True)
    near = np.stack([np.abs(time[row] - at) <= NEAR * interval_ns for time, row in pairs])
    touching = near & np.stack([part.in_contact for part in parts])
    force = np.stack([part.force for part in parts])
    force[~near] = 0.0 if silent else np.nan
    in_world = np.stack([part.in_world for part in parts])
    weight = np.where(touching, np.maximum(np.linalg.norm(force, axis=2), LEAST_N), 0.0)
    normal = _mean([part.normal for part in parts], weight)
    return replace(
        most,
        foot=np.broadcast_to(np.int64(foot), len(at)),
        in_contact=np.asarray(touching.any(axis=0)),
        force=force.sum(axis=0),
        in_world=np.asarray((in_world | ~touching).all(axis=0) & touching.any(axis=0)),
        points=np.where(touching, [part.points for part in parts], 0).sum(axis=0),
        position=_mean([part.position for part in parts], weight),
        normal=normal / norms(normal)[:, None],
    )


def _nearest(time: Ints, at: Ints) -> Ints:
    """(n,) the row of the message that is nearest to each time; time: (m,) ns, hardly unsorted."""
    return np.searchsorted((time[1:] + time[:-1]) // 2, at)


def _mean(vectors: Sequence[Floats], weight: Floats) -> Floats:
    """(n, 3) mean of sensors' vectors, those without a weight or a vector left out; NaN of none."""
    known = np.where(np.isfinite([each[:, 0] for each in vectors]), weight, 0.0)[:, :, None]
    with np.errstate(invalid="ignore"):
        mean: Floats = (np.nan_to_num(vectors) * known).sum(axis=0) / known.sum(axis=0)
    return mean
