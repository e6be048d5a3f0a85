"""Annotations that a log should get, computed in plain Python, a message at a time."""

import math
import re
from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from tests.oracles.frames import Frames, frames_of
from tests.oracles.recorded import BODY_WEIGHT_N, ODOMETRY, Decoded, S, contact_topic, decoded_log
from tests.paths import TROT, TROUBLED, WALK

LOGS = (TROT, WALK, TROUBLED)
TICK_NS = 20_000_000
CLASSIC_TILT = (0.0, math.sin(-0.785), 0.0, math.cos(-0.785))
LONGEST_M = 2.0
"""m, no arrow of the styles `pressure` and `force` is longer."""
STRAIGHT_UP = (0.0, -math.sqrt(0.5), 0.0, math.sqrt(0.5))


def light(wavelength: float) -> tuple[float, float, float]:
    """Return the colour of light, as the live script computed it."""
    gamma = 0.8
    red = green = blue = 0.0
    if 380 <= wavelength <= 440:
        attenuation = 0.3 + 0.7 * (wavelength - 380) / (440 - 380)
        red = ((-(wavelength - 440) / (440 - 380)) * attenuation) ** gamma
        blue = (1.0 * attenuation) ** gamma
    elif 440 <= wavelength <= 490:
        green = ((wavelength - 440) / (490 - 440)) ** gamma
        blue = 1.0
    elif 490 <= wavelength <= 510:
        green = 1.0
        blue = (-(wavelength - 510) / (510 - 490)) ** gamma
    elif 510 <= wavelength <= 580:
        red = ((wavelength - 510) / (580 - 510)) ** gamma
        green = 1.0
    elif 580 <= wavelength <= 645:
        red = 1.0
        green = (-(wavelength - 645) / (645 - 580)) ** gamma
    elif 645 <= wavelength <= 750:
        attenuation = 0.3 + 0.7 * (750 - wavelength) / (750 - 645)
        red = (1.0 * attenuation) ** gamma
    return red, green, blue


def clamped_light(share: float) -> tuple[float, float, float]:
    return light(min(max(380.0 + share * 370.0, 380.0), 750.0))


@dataclass(frozen=True, slots=True)
class Arrow:
    """An arrow that is drawn, or removed where it has no place."""

    log_time: int
    stamp: int
    position: tuple[float, ...] = ()
    orientation: tuple[float, ...] = ()
    length: float = 0.0
    colour: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Load:
    log_time: int
    stamp: int
    in_contact: bool
    force: float
    body_weights: float
    state: str = ""


@dataclass(frozen=True, slots=True)
class Sample:
    """A contact message reduced by hand."""

    in_contact: bool
    force: tuple[float, ...]
    in_world: bool
    position: tuple[float, ...] | None
    normal: tuple[float, ...] | None


def xyz(vector: Any) -> tuple[float, float, float]:
    return float(vector.x), float(vector.y), float(vector.z)


def norm(vector: Iterable[float]) -> float:
    x, y, z = vector
    return math.sqrt(x * x + y * y + z * z)


def stamp_of(decoded: Decoded) -> int:
    stamp = decoded.message.header.stamp
    return int(stamp.sec) * S + int(stamp.nanosec) or decoded.log_time


def step_of(state: Any) -> int:
    match = re.search(r"time:(?: \[)?(\d+)\.(\d+)", state.info)
    assert match is not None
    return int(match[1]) * S + int(match[2])


@np.errstate(all="ignore")
def sample_of(message: Any, foot: str) -> Sample:
    """Take the newest physics step, add its states up, and weigh its points by their forces."""
    newest = [s for s in message.states if step_of(s) == step_of(message.states[-1])]
    signed: list[tuple[float, Any]] = []
    for state in newest:
        names = state.collision1_name, state.collision2_name
        first, second = (f"{foot}_foot" in name for name in names)
        if first != second:
            signed.append((1.0 if first else -1.0, state))
    points, weights = [], []
    for _, state in signed:
        count = len(state.contact_positions)
        paired = count == len(state.wrenches)
        for index, point in enumerate(state.contact_positions):
            force = state.wrenches[index].force if paired else state.total_wrench.force
            points.append(xyz(point))
            weights.append(norm(xyz(force)) / (1 if paired else count))
    if not any(weights):
        weights = [1.0] * len(points)
    total, normal = np.zeros(3), np.zeros(3)
    for sign, state in signed:
        total += sign * np.array(xyz(state.total_wrench.force))
        normal += sum((sign * np.array(xyz(each)) for each in state.contact_normals), np.zeros(3))
    return Sample(
        in_contact=bool(signed),
        force=tuple(total.tolist()),
        in_world=bool(signed) and all(sign < 0 for sign, _ in signed),
        position=tuple(np.average(points, axis=0, weights=weights)) if points else None,
        normal=tuple(normal / norm(normal)) if normal.any() else None,
    )


def turn_x_to(direction: Sequence[float]) -> tuple[float, float, float, float]:
    """Return the rotation about the axis x cross d by the angle between them."""
    x, y, z = direction
    angle = math.atan2(math.hypot(y, z), x)
    across = math.hypot(y, z)
    axis = (0.0, -z / across, y / across) if across else (0.0, 0.0, 1.0)
    half = math.sin(angle / 2)
    return axis[0] * half, axis[1] * half, axis[2] * half, math.cos(angle / 2)


@cache
def frames_in(path: Path) -> Frames:
    """Return the frames of a sample log: those of the other two are not in need."""
    topics = decoded_log(path)
    return frames_of(topics[ODOMETRY], topics["/tf"], log_time=path == TROUBLED)


def expected_arrow(
    decoded: Decoded, foot: str, style: str, *, in_world: bool, frames: Frames | None = None
) -> Arrow | None:
    """Return what a message draws; None: nothing is written."""
    stamp = stamp_of(decoded)
    if style == "classic":
        return classic_arrow(decoded, stamp)
    sample = sample_of(decoded.message, foot)
    removed = Arrow(decoded.log_time, stamp)
    magnitude = norm(sample.force)
    if not sample.in_contact or sample.position is None or not magnitude > 0:
        return removed
    if not all(map(math.isfinite, (magnitude, *sample.position))):
        return removed
    orientation: tuple[float, ...] = STRAIGHT_UP
    share = magnitude / 200.0
    if style == "force":
        known = in_world or sample.in_world
        direction = tuple(np.array(sample.force) / magnitude) if known else sample.normal
        pose = frames.in_world(f"{foot}_lowerleg", stamp, "world") if frames else None
        if pose and not known:
            direction = tuple(pose[1] @ np.array(sample.force) / magnitude)
        if direction is None:
            return removed
        orientation = turn_x_to(direction)
        share = magnitude / (1.5 * BODY_WEIGHT_N)
    colour = (*clamped_light(share), 1.0)
    length = min(magnitude / 100.0, LONGEST_M)
    return Arrow(decoded.log_time, stamp, sample.position, orientation, length, colour)


def classic_arrow(decoded: Decoded, stamp: int) -> Arrow | None:
    """Transcribe `arrows_rviz.py`; where it raised nothing is written."""
    states = decoded.message.states
    if not states or not states[0].contact_positions:
        return None
    force = xyz(states[0].total_wrench.force)
    if any(math.isfinite(part) and math.isinf(part * part) for part in force):
        return None
    p = norm(force) / 100.0
    wavelength = 380 + ((p - 0.0) / (2.0 - 0.0)) * (750 - 380)
    position = xyz(states[0].contact_positions[0])
    return Arrow(decoded.log_time, stamp, position, CLASSIC_TILT, p, (*light(wavelength), 1.0))


def expected_arrows(
    path: Path,
    foot: str,
    style: str,
    *,
    in_world: bool,
    contact: Mapping[int, bool] | None = None,
) -> list[Arrow]:
    """Return what the messages of a foot draw.

    Args:
        path: the log.
        foot: its name.
        style: of the arrows.
        in_world: whether wrenches are in the world frame.
        contact: whether the foot is in contact by log time, as it is measured; None, and where it
            is not measured: as the messages say.
    """
    turned = style == "force" and path in LOGS and not in_world
    frames = frames_in(path) if turned else None
    arrows = (
        expected_arrow(one, foot, style, in_world=in_world, frames=frames)
        for one in decoded_log(path).get(contact_topic(foot), ())
    )
    found = sorted((a for a in arrows if a is not None), key=lambda arrow: arrow.log_time)
    if style == "classic" or contact is None:
        return found
    return [a if contact.get(a.log_time, True) else Arrow(a.log_time, a.stamp) for a in found]


@dataclass(frozen=True, slots=True)
class Pose:
    log_time: int
    stamp: int
    numbers: tuple[float, ...]
    """x, y, z and the quaternion's x, y, z, w."""


def expected_poses(path: Path, *, at_ticks: bool) -> list[Pose]:
    """Return the usable poses; at ticks, the first at or after each 20 ms."""
    poses: list[Pose] = []
    for one in decoded_log(path)[ODOMETRY]:
        pose = one.message.pose.pose
        q = pose.orientation
        rotation = float(q.x), float(q.y), float(q.z), float(q.w)
        numbers = (*xyz(pose.position), *rotation)
        if all(map(math.isfinite, numbers)) and any(rotation):
            poses.append(Pose(one.log_time, stamp_of(one), numbers))
    if not at_ticks:
        return poses
    times = [pose.stamp for pose in poses]
    ticks = range(times[0] // TICK_NS * TICK_NS, times[-1] + 1, TICK_NS)
    return [poses[place] for place in sorted({bisect_left(times, tick) for tick in ticks})]
