"""What a log lacks of what metrics need, by the names of `NEEDS`."""

from collections.abc import Mapping

import numpy as np

from dogbot_logtool.core.gait.foot_steps import FootSteps
from dogbot_logtool.core.load.load_figures import vertical_is_known
from dogbot_logtool.core.records import KeyPath
from dogbot_logtool.core.statistics import Stats

Lacks = frozenset[str]
"""Names of what is missing."""


class Lacking:
    """What a log lacks, as a whole, a foot, a joint and a topic."""

    def __init__(self, stats: Stats) -> None:
        """Look at what a log has."""
        legs = stats.legs
        self._log = _log(stats)
        self._feet = {
            foot.name: self._log | _foot(stats, row) for row, foot in enumerate(stats.feet)
        }
        self._joints = (
            {
                name: {
                    **self._log,
                    "efforts": not legs.joints[name].has_effort,
                    "limits": not legs.joints[name].has_limits,
                    "strides": joint.position_over_stride is None,
                }
                for name, joint in legs.metrics.joints.items()
            }
            if legs
            else {}
        )
        self._topics = {each.topic: {"stamps": each.zero_stamps is None} for each in stats.topics}

    def at(self, path: KeyPath) -> Lacks:
        """Return what is missing for the metric at a path."""
        missing: Mapping[str, bool] = self._log
        match path:
            case ("feet", name, *_) | ("quality", "feet", name, *_):
                missing = self._feet[name]
            case ("legs", "joints", name, *_):
                missing = self._joints[name]
            case ("quality", "topics", name, *_):
                missing = self._topics[name]
        return frozenset(need for need, is_missing in missing.items() if is_missing)


def _log(stats: Stats) -> dict[str, bool]:
    feet, legs, stability = stats.feet, stats.legs, stats.stability
    touching = [foot.record for foot in feet if len(foot.record.in_contact)]
    undefined = None if stability is None else stability.undefined_fraction
    joints = [] if legs is None else [legs.joints[name] for name in legs.metrics.joints]
    return {
        "feet": not feet,
        "two feet": len(feet) != 2,
        "four feet": len(feet) != 4,
        "three feet": len(feet) < 3 or undefined == 1.0,
        "leg positions": any(foot.leg_position is None for foot in feet),
        "all feet": stats.support is None,
        "strides": stats.main is None or not stats.main.strides,
        "phases": stats.main is not None and None in stats.main.phases,
        "base": stats.base is None,
        "points": not any(_has_points(foot) for foot in feet),
        "foot frame": legs is None or not any(leg.frame for leg in legs.feet),
        "force": not all(foot.record.has_force for foot in feet),
        "vertical force": not all(map(vertical_is_known, touching)),
        "weight": stats.settings.mass_kg is None,
        "joints": not joints,
        "efforts": not any(each.has_effort for each in joints),
        "limits": not any(each.has_limits for each in joints),
        "commands": stats.command_track is None and stats.base is not None,
        "imu": not stats.settings.imu_topic,
    }


def _foot(stats: Stats, row: int) -> dict[str, bool]:
    foot, legs = stats.feet[row], stats.legs
    rolls_unknown = stats.settings.foot_rolling_m is None and foot.slip_from != "foot_frame"
    return {
        "contact": foot.record.contact_fraction() is None,
        "strides": not len(foot.strides.stance),
        "points": not _has_points(foot),
        "foot frame": legs is None or not legs.feet[row].frame,
        "leg rate": legs is not None and legs.feet[row].is_slow,
        "rolling": rolls_unknown,
        "force": not foot.record.has_force,
        "vertical force": not vertical_is_known(foot.record),
        "weight": stats.loads.weight_n is None,
        "normals": not np.isfinite(foot.stances.figures.friction_use).any(),
        "plan": not stats.planned or stats.planned[row] is None,
    }


def _has_points(foot: FootSteps) -> bool:
    return bool(np.isfinite(foot.record.track.point).any())
