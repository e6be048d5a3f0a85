"""Forces over the gait cycle: braking and propulsion, and the usual curve of a stride."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, percentiles_of, rows_of_runs, trapezoids
from dogbot_logtool.core.base.motion import FORWARD_ANGLES
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stance_samples import PARTS
from dogbot_logtool.core.contact.stances import Stances
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.records import Curve, Shape
from dogbot_logtool.core.rotations import along_heading
from dogbot_logtool.dataclass import dataclass

CYCLE_POINTS: Final = 51
"""Points of a curve over a stride: 0, 2, ... 100 %."""
QUARTILES: Final = (25.0, 50.0, 75.0)


@dataclass(frozen=True, slots=True)
class CycleCurve:
    """A force over the gait cycle, (n,) each."""

    percent: Floats
    """% of the stride."""
    lower: Floats
    """N, lower quartile over strides; also `median` and `upper`."""
    median: Floats
    upper: Floats
    number: int
    """Strides."""


@dataclass(frozen=True, slots=True)
class ForeAftImpulses:
    """Fore-aft impulses of a foot's stances, along the base's forward axis at mid-stance."""

    braking: Floats
    """(n,) N s, at least 0: what slows the robot; NaN where direction or heading is not known."""
    propulsive: Floats
    """(n,) N s, at least 0: what drives it forward."""


def forward_forces(foot: FootHistory, heading: Floats) -> Floats:
    """(stances, PARTS) N, mean force along a heading, (stances,) rad, in each part of a stance."""
    x, y = foot.stance_forces[:, 0], foot.stance_forces[:, 1]
    forward: Floats = x * np.cos(heading)[:, None] + y * np.sin(heading)[:, None]
    return forward


def stance_headings(stances: Stances, base: BaseHistory, forward_axis: str) -> Floats:
    """(stances,) rad, where the base's forward axis points in the middle of each stance."""
    middle = stances.touchdown + (stances.liftoff - stances.touchdown) // 2
    heading: Floats = base.angles_at(middle)[:, 2] + FORWARD_ANGLES[forward_axis]
    return heading


def fore_aft_impulses(foot: FootHistory, heading: Floats) -> ForeAftImpulses:
    """Integrate the braking and the propulsive part of the force over each stance.

    Each sample counts by its own sign.

    Args:
        foot: its history.
        heading: (stances,) rad; see `stance_headings`.
    """
    track, stances = foot.track, foot.stances
    braking, propulsive = np.full((2, len(heading)), np.nan)
    known = np.isfinite(heading) & np.isfinite(foot.stance_forces).all(axis=(1, 2))
    if not known.any():
        return ForeAftImpulses(braking, propulsive)
    before = np.maximum(np.searchsorted(track.time, stances.touchdown[known]) - 1, 0)
    # A foot that stopped to speak in a stance has no sample at its end.
    behind = np.minimum(np.searchsorted(track.time, stances.liftoff[known]) + 1, len(track.time))
    rows, stance, first = rows_of_runs(before, behind)
    force = track.horizontal_force[rows].astype(np.float64)
    along, _ = along_heading(force, heading[known][stance])
    time = (track.time[rows] - track.time[0]) / 1e9
    braking[known] = -trapezoids(np.minimum(along, 0.0), time, first)
    propulsive[known] = trapezoids(np.maximum(along, 0.0), time, first)
    return ForeAftImpulses(braking, propulsive)


def stride_curve(force: Floats, strides: Strides) -> CycleCurve | None:
    """Return the usual force over a stride, 0 in its swing; None where none is known.

    Args:
        force: (n, PARTS) N, mean force in each part of each of the foot's stances.
        strides: of the same foot.
    """
    of_strides = force[strides.stance]
    rows = np.flatnonzero(np.isfinite(of_strides).all(axis=1))
    phase: Floats = np.arange(CYCLE_POINTS) / float(CYCLE_POINTS - 1)
    stance_phase = phase[None, :] / strides.duty_factor[rows][:, None]
    part = np.minimum((stance_phase * PARTS).astype(np.int64), PARTS - 1)
    known = np.where(stance_phase < 1.0, np.take_along_axis(of_strides[rows], part, axis=1), 0.0)
    return cycle_curve(phase * 100.0, known)


def cycle_curve(percent: Floats, values: Floats) -> CycleCurve | None:
    """Return the quartiles of curves, (n, points)."""
    if len(values) == 0:
        return None
    lower, median, upper = percentiles_of(values, QUARTILES, axis=0)
    return CycleCurve(percent, lower, median, upper, len(values))


def curve_of(curve: CycleCurve | None) -> Shape:
    """Return a curve as a metric."""
    if curve is None:
        return None
    parts = (curve.percent, curve.lower, curve.median, curve.upper)
    return Curve(*(tuple(each.tolist()) for each in parts))
