"""The state that one batch hands to the next.

Batches are converted in parallel. A batch needs little of all earlier ones: it follows from their
decoded messages alone, and is sent on before the expensive work begins.
"""

from collections.abc import Mapping, Sequence
from dataclasses import field

import numpy as np

from dogbot_logtool.core.base.odometry import Odometry
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_tracker import FootMemory, FootTracker, initial_memory
from dogbot_logtool.core.contact.silent_swing import LastMessages, SilentFeet, last_messages
from dogbot_logtool.core.frames.kinematics import LinkTransforms
from dogbot_logtool.core.frames.transform_buffer import TransformBuffer
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.core.load.silences import LastContact
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.pipeline.batches import BatchColumns
from dogbot_logtool.pipeline.conversion.plan import ConversionPlan


@dataclass(frozen=True, slots=True)
class BatchState:
    """The state that all earlier batches leave."""

    last_pose_time: int | None = None
    """ns, time of the last usable odometry message."""
    last_link_time: int | None = None
    """ns, time of the last joint state that moved the robot's links."""
    last_messages: LastMessages = field(default_factory=dict)
    """The last message of each foot that is silent in swing."""
    feet_down: frozenset[int] = frozenset()
    """Feet whose last contact message told of contact."""
    transforms: TransformBuffer = field(default_factory=TransformBuffer)
    """The newest transforms of the frames that are needed."""
    feet: tuple[FootMemory, ...] = ()
    """Contact and touchdowns of each foot."""
    contacts: tuple[LastContact, ...] | None = None
    """The last contact message of each foot; None: no batch came before."""

    def feet_without_messages(self, feet: int) -> frozenset[int]:
        """Return which of the robot's feet have not sent a message yet."""
        if self.contacts is None:
            return frozenset(range(feet))
        return frozenset(foot for foot, last in enumerate(self.contacts) if not last.is_message)

    @property
    def last_contact_times(self) -> Mapping[int, int]:
        """ns, log time of the last contact message of each foot."""
        return {foot: last.log_time for foot, last in enumerate(self.contacts or ())}

    @classmethod
    def initial(cls, plan: ConversionPlan) -> "BatchState":
        """Return the state before the first message."""
        return cls(feet=(initial_memory(),) * len(plan.sensors))

    def after(
        self,
        columns: BatchColumns,
        poses: Odometry,
        trackers: Sequence[FootTracker],
        contacts: tuple[LastContact, ...],
        silent: SilentFeet,
        links: Sequence[LinkTransforms] = (),
    ) -> "BatchState":
        """Return the state after a batch.

        Args:
            columns: of the batch.
            poses: its usable ones.
            trackers: of each foot in it.
            contacts: the last contact message of each foot.
            silent: the feet that are silent in swing.
            links: moved by joint states in it.
        """
        newest = self.last_messages
        for decoded in columns.contacts:
            if decoded.source.silent_in_swing:
                newest = last_messages(decoded.reduced.samples, newest, silent)
        frames = columns.frames
        return BatchState(
            last_pose_time=int(poses.time[-1]) if len(poses.time) else self.last_pose_time,
            last_link_time=next(
                (int(each.stamp[-1]) for each in reversed(links) if len(each.stamp)),
                self.last_link_time,
            ),
            last_messages=newest,
            feet_down=_feet_down(columns.samples, self.feet_down),
            transforms=frames.handed_on(self.transforms) if frames else self.transforms,
            feet=tuple(tracker.memory() for tracker in trackers),
            contacts=contacts,
        )


def _feet_down(samples: Sequence[Samples], before: frozenset[int]) -> frozenset[int]:
    """Return the feet whose last sample is in contact; those without one are as before."""
    down = set(before)
    for each in samples:
        for foot in distinct(each.foot).tolist():
            last = np.flatnonzero(each.foot == foot)[-1]
            (down.add if each.in_contact[last] else down.discard)(foot)
    return frozenset(down)
