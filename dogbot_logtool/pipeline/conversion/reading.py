"""What `convert` reads of a batch: columns of what the robot did and felt."""

from dataclasses import dataclass

from dogbot_logtool.core.base.odometry import Odometry, usable_poses
from dogbot_logtool.core.frames.transform_buffer import TransformBuffer
from dogbot_logtool.pipeline.batches import BatchColumns
from dogbot_logtool.pipeline.plan import Plan
from dogbot_logtool.pipeline.world_frames import Placed
from dogbot_logtool.reader.containers.log import Log, Span


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
    def last_pose(self) -> int | None:
        """Time of the last usable odometry message, ns; None: there is none."""
        return int(self.poses.time[-1]) if len(self.poses.time) else None

    def placed(self, before: TransformBuffer, plan: Plan) -> Placed:
        """Place the contacts, where that is wanted and the log's own frames tell.

        Args:
            before: the frames of all earlier batches.
            plan: what is to be done.
        """
        samples, frames = self.columns.samples, self.columns.frames
        if plan.frames is None or frames is None:
            return Placed(samples)
        return plan.frames.place(samples, frames.around(before))


def read_batch(log: Log, plan: Plan, span: Span) -> ReadBatch:
    """Read and decode one batch."""
    columns = plan.reader.read(log, span)
    return ReadBatch(columns, columns.odometry.pick(usable_poses(columns.odometry)))
