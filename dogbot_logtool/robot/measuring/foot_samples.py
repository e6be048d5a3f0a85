"""The samples of feet by what a whole log tells: their contacts, and the sensors that are one foot.

Flags are compared with the forces beside them. Raw counts have two clear modes in a walk, in the
air and on the ground: from which count on a foot touches then lies between them, although nothing
says what a count is in newtons. The forces of several sensors of one foot, such as toe and heel,
add, and any contact is contact: which are of one foot is told by the names of their topics, or by
the frame or link that they share.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import (
    Floats,
    concatenated,
    mean_of_known,
    nearest_rows,
    norms,
    percentiles_of,
)
from dogbot_logtool.core.clock import usual_interval_s
from dogbot_logtool.core.contact.contacts import Samples, without_contact
from dogbot_logtool.core.contact.foot_history import Thresholds
from dogbot_logtool.core.contact.sensor import estimate_level
from dogbot_logtool.core.recording import Recording, has_own_stamps
from dogbot_logtool.core.sensors import MOST_OF_LOAD, contact_rule
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import listed
from dogbot_logtool.robot.names import foot_name, leg_of, leg_position
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.topics import not_calibrated

_LOAD_SHARE: Final = 0.2
"""Share of all feet's load from which a foot cannot be in the air."""
_CONTRADICTED: Final = 0.2
"""Share of contradicted flags from which constant flags are taken for not filled in."""
_INVERTED: Final = 0.1
"""Share of a foot's mean load without contact flags below which that with flags is, if they are
inverted; an offset of the sensor seldom takes off as much."""
_DOUBTFUL: Final = 0.05
"""Share of contradicted flags from which it is said."""
_BLUR: Final = 0.02
"""Share of a sensor's range by which its counts are blurred; a walk's loads vary by far more."""
_UNLOADED: Final = 1.0 / 3.0
"""Share of the distance between two levels up to which the lower is that of a foot in the air;
weight that is shifted in a stand leaves more on each foot."""
NEAR: Final = 1.5
"""Intervals between the messages of two sensors of one foot that tell of one time."""
LEAST_N: Final = 1e-9
"""N: weight of a contact without a force."""


def decide_contacts(
    feet: Sequence[Samples], selection: Selection
) -> tuple[tuple[Samples, ...], Selection]:
    """Decide when feet touch whose messages have flags beside forces, or raw counts.

    Args:
        feet: samples of each foot, as recorded.
        selection: how they are read.

    Returns:
        the samples, and the selection with the thresholds that were found and what is said.
    """
    sources = [selection.sources_of(row) for row in range(len(feet))]
    flagged = [
        row for row, of in enumerate(sources) if any(s.has_flags and s.has_force for s in of)
    ]
    raw = [row for row, of in enumerate(sources) if any(s.row.unit == "counts" for s in of)]
    raw = [row for row in raw if selection.robot.feet[row].newtons_per_count is None]
    decided = list(feet)
    if flagged:
        selection = _compare_flags([feet[row] for row in flagged], selection, flagged)
    for row in flagged:
        each = feet[row]
        if row in selection.ignored_flags:
            each = replace(each, in_contact=np.asarray((each.force != 0.0).any(axis=1)))
        decided[row] = without_contact(each, ~each.in_contact)
    if raw:
        selection, thresholds = _with_levels(feet, selection, raw)
        for row in raw:
            decided[row] = _counted(feet[row], *thresholds[row])
    return tuple(decided), selection


def _compare_flags(feet: Sequence[Samples], selection: Selection, rows: Sequence[int]) -> Selection:
    """Compare contact flags of some feet with the forces beside them.

    Flags that never change although forces do are not filled in, and those of a foot that bears
    its load without them are inverted: these are ignored.
    """
    times = np.unique(np.concatenate([each.log_time for each in feet]))
    load, flag = np.full((2, len(feet), len(times)), np.nan)
    for foot, each in enumerate(feet):
        at = np.searchsorted(times, each.log_time)
        load[foot, at], flag[foot, at] = norms(each.force), each.in_contact
    total = np.nansum(load, axis=0)
    wrong = np.where(flag > 0.0, load == 0.0, load > _LOAD_SHARE * total)
    # Without any load, as before a simulation begins, forces tell nothing.
    wrong &= np.isfinite(load) & (total > 0.0)
    share = wrong.sum(axis=1) / np.maximum(np.isfinite(load).sum(axis=1), 1)
    touches = mean_of_known(flag)
    with_flag, without = (mean_of_known(np.where(flag == up, load, np.nan)) for up in (1.0, 0.0))
    inverted = with_flag < _INVERTED * without
    ignored = inverted | (np.isin(touches, (0.0, 1.0)) & (share > _CONTRADICTED))
    findings, numbers = [], np.array(rows)
    for say, some, least in (("ignored", ignored, 0.0), ("plain", ~ignored, _DOUBTFUL)):
        mean = float(share[some].sum() / max(some.sum(), 1))
        if mean > least:
            names = listed([selection.robot.feet[row].name for row in numbers[some].tolist()])
            findings.append(found("FLAGS_CONTRADICTED", say=say, share=mean, names=names))
    return selection._replace(
        ignored_flags=frozenset(numbers[ignored].tolist()),
        findings=(*selection.findings, *findings),
    )


def _with_levels(
    feet: Sequence[Samples], selection: Selection, raw: Sequence[int]
) -> tuple[Selection, Mapping[int, tuple[float, float | None]]]:
    """Find what raw sensors read without load, and the threshold of contact, where none is given.

    All feet must have two clear modes: a gait of some says nothing of the others.

    Returns:
        the selection; and by raw foot the counts to take off, and from which on it touches then.
    """
    robot = selection.robot
    thresholds = dict.fromkeys(raw, (0.0, robot.contact_on_counts))
    say, told = "unknown", ""
    if robot.contact_on_counts is None:
        levels = {row: _contact_level(feet[row]) for row in raw}
        wrong = [f"{robot.feet[row].name}: {why}" for row, (_, _, why) in levels.items() if why]
        if wrong:
            told = f" (it cannot be estimated from the log; {wrong[0]})"
        else:
            # The sensors of two feet may count differently.
            thresholds = {row: (offset, on) for row, (offset, on, _) in levels.items()}
            say, told = "estimated", listed([f"{on:.3g}" for _, on, _ in levels.values()])
            shifted = (
                replace(foot, offset=foot.offset + thresholds.get(row, (0.0, None))[0])
                for row, foot in enumerate(robot.feet)
            )
            robot = replace(robot, feet=tuple(shifted))
    findings = [each for each in selection.findings if "counts" not in each.cases]
    own = (each for each in selection.contacts if not {*raw}.isdisjoint(selection.feet_of[each]))
    unscaled = [robot.feet[row] for row in raw]
    types = dict.fromkeys(channel.type_name for channel in own)
    findings += (not_calibrated(robot, unscaled, name, say, told) for name in types)
    return selection._replace(robot=robot, findings=tuple(findings)), thresholds


def _contact_level(samples: Samples) -> tuple[float, float, str]:
    """Return what a raw sensor reads without load, and from which counts above it a foot touches.

    Returns:
        both, and why these say nothing; empty: they do.
    """
    force = samples.force.astype(float)
    if len(force):
        # A mode that is a count or two narrower than the other must not pass for the unloaded one.
        low, high = percentiles_of(force[:, 2], [5.0, 95.0])
        force[:, 2] += np.random.default_rng(0).normal(0.0, _BLUR * (high - low), len(force))
    level = estimate_level(samples.log_time, force, _UNLOADED)
    on, offset = contact_rule(level, None, Thresholds(), None).on_n, float(level.offset_n[2])
    alike = on > MOST_OF_LOAD * (level.loaded_n or 0.0)
    return offset, on, level.reason or ("its counts do not change as in steps" if alike else "")


def _counted(samples: Samples, offset: float, on_counts: float | None) -> Samples:
    """Return samples with contact from a count on, and without the force, which is not known."""
    if on_counts is None:
        return samples.pick(np.empty(0, np.int64))
    touches = np.asarray(samples.force[:, 2] - offset >= on_counts)
    force = np.zeros_like(samples.force)
    force[touches, 2] = np.nan
    return replace(samples, in_contact=touches, force=force)


# --- several sensors of one foot -----------------------------------------------------------------


def with_joined_sensors(
    recording: Recording, selection: Selection
) -> tuple[Recording, Selection, tuple[Finding, ...]]:
    """Make one foot of all sensors that a foot has.

    Returns:
        the recording and the selection with whole feet, and what was joined.
    """
    feet = selection.robot.feet
    named = [foot.sensor_of for foot in feet]
    links_of = [sorted(recording.links.get(row, ())) for row in range(len(feet))]
    frames = [links[0] if len(links) == 1 else "" for links in links_of]
    groups, how = _groups(named), "names"
    if not groups and all(leg_of(frame)[1] for frame in frames):
        groups, how = {foot_name(name): rows for name, rows in _groups(frames).items()}, "frames"
    if not groups:
        return recording, selection, ()
    joined = tuple(
        replace(feet[rows[0]], name=name, sensor_of="", leg_position=leg_position(name))
        for name, rows in groups.items()
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
        links[number] = frozenset(each for row in rows for each in links_of[row])
    # A sensor that is silent while another one of its foot speaks has no gap.
    silenced = {foot.topic for foot in feet if silent} - {foot.topic for foot in joined}
    topics = {t: times for t, times in recording.topics.items() if t not in silenced}
    told = (f"{n} = {' + '.join(feet[row].word for row in rows)}" for n, rows in groups.items())
    text = "; ".join(told)
    finding = Finding("TOPICS_CHOSEN", f"several sensors of one foot, by their {how}: {text}")
    return (
        replace(recording, feet=tuple(samples), links=links, topics=topics),
        selection._replace(robot=replace(selection.robot, feet=joined), feet_of=of),
        (finding,),
    )


def _groups(owners: Sequence[str]) -> dict[str, list[int]]:
    """Return the sensors of each owner; none unless all owners have as many, and several."""
    groups: dict[str, list[int]] = {}
    for row, owner in enumerate(owners):
        groups.setdefault(owner, []).append(row)
    sizes = {len(rows) for rows in groups.values()}
    is_grid = len(groups) > 1 and len(sizes) == 1 and sizes != {1} and "" not in groups
    return groups if is_grid else {}


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
    rows = [nearest_rows(time, at) for time in times]
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


def _mean(vectors: Sequence[Floats], weight: Floats) -> Floats:
    """(n, 3) mean of sensors' vectors, those without a weight or a vector left out; NaN of none."""
    known = np.where(np.isfinite([each[:, 0] for each in vectors]), weight, 0.0)[:, :, None]
    with np.errstate(invalid="ignore"):
        mean: Floats = (np.nan_to_num(vectors) * known).sum(axis=0) / known.sum(axis=0)
    return mean
