"""Everything that is kept of a robot's legs while its log streams past."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.transform_buffer import TransformBuffer
from dogbot_logtool.core.geometry.arrays import Flags, Floats
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.legs.foot_path import FootPath, PathRecorder, path_by_joints
from dogbot_logtool.core.legs.joint_recorder import JointRecorder, told_alike
from dogbot_logtool.core.legs.joint_track import (
    MOST_JOINTS,
    JointHistory,
    JointLimits,
    JointSamples,
    JointTable,
)
from dogbot_logtool.core.legs.settings import LegSettings
from dogbot_logtool.core.quality.clocks import OffsetRecorder, OffsetTrack
from dogbot_logtool.dataclass import dataclass

_IMPLAUSIBLE: Final = 1e9
"""rad, rad/s and N m: no joint reaches it."""


class TopicRecorder:
    """Makes a `JointHistory` of each joint of a topic; the same however its messages are split.

    Joints that all messages tell together are followed together.
    """

    def __init__(self, topic: str, clock: TimeSource, limits: Mapping[str, JointLimits]) -> None:
        self._topic, self._clock, self._limits = topic, clock, limits
        self._recorders: list[JointRecorder] = []

    @property
    def joints(self) -> int:
        """How many are followed."""
        return sum(len(each.names) for each in self._recorders)

    def add(self, names: Sequence[str], samples: JointSamples, most: int) -> None:
        """Take in states of joints, in the order of the log.

        Args:
            names: of the joints.
            samples: their states; those without a position are left out.
            most: joints to follow at most.
        """
        told = np.abs(samples.position) <= _IMPLAUSIBLE
        messages = dict(zip(names, _told_of(told), strict=True))
        self._recorders = [part for each in self._recorders for part in each.apart(messages)]
        self._follow(messages, most)
        samples = replace(
            samples, velocity=_plausible(samples.velocity), effort=_plausible(samples.effort)
        )
        column = {name: number for number, name in enumerate(names)}
        for recorder in self._recorders:
            if messages.get(recorder.names[0]):
                columns = np.array([column[name] for name in recorder.names])
                rows = told[:, columns[0]]
                own = samples.only(columns)
                recorder.add(own if rows.all() else own.pick(rows))

    def finish(self) -> dict[str, JointHistory]:
        """End the log; return the joints by name of which any state could be used."""
        return {each.name: each for recorder in self._recorders for each in recorder.finish()}

    def _follow(self, messages: Mapping[str, bytes], most: int) -> None:
        """Begin to follow joints that are new."""
        known = {name for each in self._recorders for name in each.names}
        new = [name for name, told in messages.items() if told and name not in known]
        for joints in told_alike(new[: most - len(known)], messages):
            names = [new[joint] for joint in joints]
            limits = [self._limits.get(name, JointLimits()) for name in names]
            self._recorders.append(JointRecorder(names, self._topic, self._clock, limits))


def _told_of(told: Flags) -> list[bytes]:
    """Return which messages tell of each joint; equal for joints that are told together.

    Args:
        told: (n, k).

    Returns:
        (k,), empty for a joint that none tells of.
    """
    if told.all():
        return [b"all"] * told.shape[1]
    return [column.tobytes() if column.any() else b"" for column in told.T]


def _plausible(values: Floats) -> Floats:
    """Return values with NaN for those that no joint reaches."""
    plausible = np.abs(values) <= _IMPLAUSIBLE
    return values if plausible.all() else np.where(plausible, values, np.nan)


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
