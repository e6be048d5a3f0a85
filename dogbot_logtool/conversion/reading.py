"""What `convert` reads of a batch: columns of what the robot did and felt."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from dogbot_logtool.core.contacts import Samples
from dogbot_logtool.core.odometry import Odometry, usable_poses
from dogbot_logtool.core.transform_buffer import TransformBuffer
from dogbot_logtool.plan import Plan
from dogbot_logtool.reader.contact_sources.registry import ContactsRead, read_contacts
from dogbot_logtool.reader.log import Batch, Log, Span
from dogbot_logtool.reader.messages import DecodedMessages, malformed_in
from dogbot_logtool.reader.odometry import decode_odometry, joined_odometry
from dogbot_logtool.reader.transforms import decode_transforms
from dogbot_logtool.world_frames import BatchFrames, Placed, look_around


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

    batch: Batch
    poses: Odometry
    """The usable ones, in the order of the log."""
    bad_poses: int
    """Odometry messages with a zero quaternion or a number that is not finite."""
    contacts: tuple[ContactsRead, ...]
    transforms: tuple[DecodedMessages, ...]
    """The log's own transforms, where they matter."""
    frames: BatchFrames | None
    """What places feet in the world; None where that is not needed."""
    malformed: Mapping[int, int]
    """Messages that could not be decoded, by channel id."""
    stored_size: int
    """Bytes of the file that it was read from."""

    @property
    def extract(self) -> Extract:
        """What other batches may need to know of it."""
        return Extract(
            int(self.poses.time[-1]) if len(self.poses.time) else None,
            tuple(contacts.felt.samples for contacts in self.contacts),
            tuple(contacts.source.silent_in_swing for contacts in self.contacts),
            self.frames,
        )


def read_batch(log: Log, plan: Plan, span: Span) -> ReadBatch:
    """Read and decode one batch."""
    batch = log.read(span).cropped(plan.start_time, plan.end_time)
    selection = plan.selection
    decoded = decode_odometry(batch, selection.odometry)
    odometry = joined_odometry(decoded)
    poses = odometry.pick(usable_poses(odometry))
    # Only arrows along the force may have to stand along a normal instead.
    feet = replace(selection.foot_channels(), normals=plan.options.style == "force")
    contacts = read_contacts(batch, selection.contacts, feet)
    samples = [read.felt.samples for read in contacts]
    transforms = (
        decode_transforms(batch, selection.transforms)
        if plan.frames is not None or plan.base_may_have_parent
        else []
    )
    frames = None
    if plan.frames is not None:
        own = plan.frames.tracks(transforms, poses)
        frames = look_around(log, selection, plan.frames, span, batch, own, samples, plan.limits)
    return ReadBatch(
        batch=batch,
        poses=poses,
        bad_poses=len(odometry.log_time) - len(poses.log_time),
        contacts=tuple(contacts),
        transforms=tuple(transforms),
        frames=frames,
        malformed=malformed_in([*decoded, *(read.messages for read in contacts), *transforms]),
        stored_size=sum(chunk.data_size for chunk in span),
    )
