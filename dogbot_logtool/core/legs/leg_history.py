"""Everything that is kept of a robot's legs."""

from collections.abc import Mapping, Sequence

import numpy as np

from dogbot_logtool.core.corrections.clock import OffsetTrack, TimeSource, offset_track
from dogbot_logtool.core.frames.transforms import TransformBuffer
from dogbot_logtool.core.legs.foot_path import (
    FootPath,
    LegChain,
    path_by_joints,
    path_by_transforms,
)
from dogbot_logtool.core.legs.joint_history import joint_histories
from dogbot_logtool.core.legs.joint_track import (
    MOST_JOINTS,
    JointHistory,
    JointSamples,
    JointTable,
)
from dogbot_logtool.core.legs.settings import LegSettings
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class LegHistory:
    """Everything kept of the legs."""

    settings: LegSettings
    joints: tuple[JointHistory, ...]
    """Each once, by name."""
    paths: tuple[FootPath | None, ...]
    """Path of each foot in the base's frame; None: not known."""
    offsets: Mapping[str, OffsetTrack]
    """How far the stamps of joint states lie behind log time, by topic."""


def leg_history(
    tables: Sequence[JointTable],
    frames: TransformBuffer,
    settings: LegSettings,
    clock: TimeSource,
) -> LegHistory:
    """Return the joints of a log, and the paths of its feet.

    Args:
        tables: joint states, one table a topic, the best first: its states of a joint are used.
        frames: of the legs that transforms move, on that clock.
        settings: sources of the legs.
        clock: which time counts.
    """
    found: dict[str, JointHistory] = {}
    for table in tables:
        columns = np.arange(min(len(table.names), MOST_JOINTS - len(found)))
        samples = table.samples.only(columns)
        histories = joint_histories(table.names, table.topic, samples, clock, settings.limits)
        found = {**histories, **found}
    return LegHistory(
        settings=settings,
        joints=tuple(found[name] for name in sorted(found)),
        paths=tuple(_path(chain, found, frames, settings.statics) for chain in settings.chains),
        offsets={table.topic: _offsets(table.samples) for table in tables},
    )


def _offsets(samples: JointSamples) -> OffsetTrack:
    """Return how far the stamps of states lie behind log time; without a stamp they equal it."""
    stamped = samples.stamp != samples.log_time
    return offset_track(samples.log_time[stamped], samples.stamp[stamped])


def _path(
    chain: LegChain | None,
    joints: Mapping[str, JointHistory],
    frames: TransformBuffer,
    statics: TransformBuffer,
) -> FootPath | None:
    """Return the path of a foot; None: not known."""
    if chain is None:
        return None
    if not chain.joints:
        return path_by_transforms(chain, frames, statics)
    named = {joint.measured for joint in chain.joints}
    own = {name: each for name, each in joints.items() if name in named}
    path = path_by_joints(
        chain, {name: each.track if each.moves else each.lowest for name, each in own.items()}
    )
    return path if path is not None and len(path.time) else None
