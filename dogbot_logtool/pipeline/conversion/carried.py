"""What passes from one batch to the next.

Batches are worked on in parallel. What a batch must know of all earlier ones is small, follows from
what was read of them alone, and is handed on before the heavy work begins.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_tracker import Footing, FootMemory, follow_feet, nothing_heard
from dogbot_logtool.core.contact.silent_swing import LastHeard, last_heard
from dogbot_logtool.core.frames.transform_buffer import TransformBuffer
from dogbot_logtool.pipeline.conversion.reading import ReadBatch
from dogbot_logtool.pipeline.plan import Plan


@dataclass(frozen=True, slots=True)
class Carried:
    """What a batch must know of all earlier ones."""

    odometry: int | None = None
    """ns, time of the last usable odometry message."""
    contacts: LastHeard = field(default_factory=dict)
    """When the feet that are silent in swing were last heard."""
    transforms: TransformBuffer = field(default_factory=TransformBuffer)
    """What was last recorded of the frames that are needed."""
    feet: tuple[FootMemory, ...] = ()
    """Where each foot stands; empty where nobody asks."""

    @classmethod
    def nothing(cls, plan: Plan) -> "Carried":
        """Return what is known before the first message."""
        return cls(feet=(nothing_heard(),) * len(plan.hearings))

    def footings(self, samples: Sequence[Samples], plan: Plan) -> tuple[Footing, ...]:
        """Return each foot's way through a batch after all earlier ones, if anybody asks.

        Args:
            samples: of the batch, placed in the world as far as frames tell.
            plan: what is to be done.
        """
        return follow_feet(samples, self.feet, plan.hearings, force_in_world=plan.force_in_world)

    def past(self, read: ReadBatch, footings: Sequence[Footing]) -> "Carried":
        """Return what the batch after this one must know.

        Args:
            read: what was read of this one.
            footings: of each foot in this one, if anybody asks.
        """
        heard = self.contacts
        for contacts in read.columns.contacts:
            if contacts.source.silent_in_swing:
                heard = last_heard(contacts.felt.samples, heard)
        frames = read.columns.frames
        transforms = frames.handed_on(self.transforms) if frames else self.transforms
        feet = tuple(footing.memory() for footing in footings)
        odometry = self.odometry if read.last_pose is None else read.last_pose
        return Carried(odometry, heard, transforms, feet)
