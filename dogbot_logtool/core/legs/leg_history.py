"""Everything that is kept of a robot's legs while its log streams past."""

from collections.abc import Mapping, Sequence

from dogbot_logtool.core.frames.transform_buffer import TransformBuffer
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.legs.foot_path import FootPath, PathRecorder, path_by_joints
from dogbot_logtool.core.legs.joint_track import MOST_JOINTS, JointHistory, JointTable
from dogbot_logtool.core.legs.settings import LegSettings
from dogbot_logtool.core.legs.topic_recorder import TopicRecorder
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
        self._topics: dict[str, TopicRecorder] = {}
        self._offsets: dict[str, OffsetRecorder] = {}

    def add(self, joints: Sequence[JointTable], frames: TransformBuffer, end: int | None) -> None:
        """Take in the next batch: joint states, frames that move, and its latest log time, ns."""
        for table in joints:
            log_time, stamp = table.samples.log_time, table.samples.stamp
            stamped = stamp != log_time
            offsets = self._offsets.setdefault(table.topic, OffsetRecorder())
            offsets.add(log_time[stamped], stamp[stamped])
            if table.topic not in self._topics:
                limits = self._settings.limits
                self._topics[table.topic] = TopicRecorder(table.topic, self._clock, limits)
            topic = self._topics[table.topic]
            others = sum(each.joints for each in self._topics.values()) - topic.joints
            topic.add(table.names, table.samples, MOST_JOINTS - others)
        self._paths.add(frames, end)

    def finish(self) -> LegHistory:
        """End the log."""
        order = {topic: rank for rank, topic in enumerate(self._settings.joint_topics)}
        found: dict[str, JointHistory] = {}
        for topic in sorted(self._topics, key=order.__getitem__):
            for name, history in self._topics[topic].finish().items():
                found.setdefault(name, history)
        joints = tuple(found[name] for name in sorted(found))
        paths = list(self._paths.finish())
        for foot, chain in enumerate(self._settings.chains):
            if chain is not None and chain.joints:
                named = {joint.measured for joint in chain.joints}
                own = {name: each for name, each in found.items() if name in named}
                paths[foot] = path_by_joints(
                    chain, {n: each.track if each.moves else each.lowest for n, each in own.items()}
                )
        offsets = {topic: each.finish() for topic, each in self._offsets.items()}
        return LegHistory(self._settings, joints, tuple(paths), offsets)
