"""Everything that is kept of a robot's legs while its log streams past."""

from collections.abc import Mapping, Sequence

from dogbot_logtool.core.frames.transform_buffer import TransformBuffer
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.legs.foot_path import FootPath, PathRecorder, path_by_joints
from dogbot_logtool.core.legs.joint_track import (
    MOST_JOINTS,
    JointHistory,
    JointLimits,
    JointRecorder,
    JointTable,
)
from dogbot_logtool.core.legs.settings import LegSettings
from dogbot_logtool.core.quality.clocks import OffsetRecorder, OffsetTrack
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class LegHistory:
    """What was kept of the legs."""

    settings: LegSettings
    joints: tuple[JointHistory, ...]
    """Each once, by name."""
    paths: tuple[FootPath | None, ...]
    """Of each foot in the base's frame; None: nothing tells."""
    offsets: Mapping[str, OffsetTrack]
    """How far the stamps of joint states lie behind log time, by topic."""


class LegRecorder:
    """Makes a `LegHistory` of what batches tell."""

    def __init__(self, settings: LegSettings, clock: TimeSource) -> None:
        self._settings, self._clock = settings, clock
        chains = [None if each is None or each.joints else each for each in settings.chains]
        self._paths = PathRecorder(chains, settings.statics)
        self._joints: dict[tuple[str, str], JointRecorder] = {}
        self._offsets: dict[str, OffsetRecorder] = {}

    def add(self, joints: Sequence[JointTable], frames: TransformBuffer, end: int | None) -> None:
        """Take in the next batch: joint states, frames that move, and its latest log time, ns."""
        for table in joints:
            stamped = table.stamp != table.log_time
            offsets = self._offsets.setdefault(table.topic, OffsetRecorder())
            offsets.add(table.log_time[stamped], table.stamp[stamped])
            for column, name in enumerate(table.names):
                key = table.topic, name
                if key not in self._joints:
                    if len(self._joints) >= MOST_JOINTS:
                        continue
                    limits = self._settings.limits.get(name, JointLimits())
                    self._joints[key] = JointRecorder(name, table.topic, self._clock, limits)
                self._joints[key].add(table.joint(column))
        self._paths.add(frames, end)

    def finish(self) -> LegHistory:
        """End the log."""
        order = {topic: rank for rank, topic in enumerate(self._settings.joint_topics)}
        found: dict[str, JointHistory] = {}
        for topic, name in sorted(self._joints, key=lambda key: (key[1], order[key[0]])):
            history = self._joints[topic, name].finish() if name not in found else None
            if history is not None:
                found[name] = history
        paths = list(self._paths.finish())
        tracks = {name: each.track if each.moves else each.lowest for name, each in found.items()}
        for foot, chain in enumerate(self._settings.chains):
            if chain is not None and chain.joints:
                paths[foot] = path_by_joints(chain, tracks)
        offsets = {topic: each.finish() for topic, each in self._offsets.items()}
        return LegHistory(self._settings, tuple(found.values()), tuple(paths), offsets)
