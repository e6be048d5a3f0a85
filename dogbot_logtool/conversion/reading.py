"""What `convert` reads of a batch: columns of what the robot did and felt."""

from dataclasses import dataclass

from dogbot_logtool.batch_reader import BatchColumns
from dogbot_logtool.core.contacts import Samples
from dogbot_logtool.core.odometry import Odometry, usable_poses
from dogbot_logtool.core.transform_buffer import TransformBuffer
from dogbot_logtool.plan import Plan
from dogbot_logtool.reader.log import Log, Span
from dogbot_logtool.world_frames import BatchFrames, Placed


@dataclass(frozen=True, slots=True)
class Extract:
    """What placing a batch's contacts and going on after it take; none of its bytes."""

    last_pose: int | None
    """ns, time of the last usable odometry message; None: there is none."""
    samples: tuple[Samples, ...]
    """Of each sort of contact messages."""
    silent_in_swing: tuple[bool, ...]
    """Whether each sort is published only while in contact."""
    frames: BatchFrames | None
    """What places feet in the world; None where that is not needed."""

    def placed(self, before: TransformBuffer, plan: Plan) -> Placed:
        """Place the contacts, where that is wanted and the log's own frames tell.

        Args:
            before: what all earlier batches hand on of the frames.
            plan: what is to be done.
        """
        if plan.frames is None or self.frames is None:
            return Placed(self.samples)
        return plan.frames.place(self.samples, self.frames.around(before))


@dataclass(frozen=True, slots=True)
class ReadBatch:
    """A batch and its columns. It knows nothing of other batches."""

    columns: BatchColumns
    poses: Odometry
    """The usable ones, in the order of the log."""

    @property
    def bad_poses(self) -> int:
        """Odometry messages with a zero quaternion or a number that is not finite."""
        return len(self.columns.odometry.log_time) - len(self.poses.log_time)

    @property
    def extract(self) -> Extract:
        """What other batches may need to know of it."""
        return Extract(
            int(self.poses.time[-1]) if len(self.poses.time) else None,
            self.columns.samples,
            tuple(contacts.source.silent_in_swing for contacts in self.columns.contacts),
            self.columns.frames,
        )


def read_batch(log: Log, plan: Plan, span: Span) -> ReadBatch:
    """Read and decode one batch."""
    columns = plan.reader.read(log, span)
    return ReadBatch(columns, columns.odometry.pick(usable_poses(columns.odometry)))
