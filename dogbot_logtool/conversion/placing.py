"""Contacts of a batch placed in the world by the log's own frames."""

from dataclasses import dataclass, field

from dogbot_logtool.conversion.carried import Carried
from dogbot_logtool.conversion.reading import ReadBatch
from dogbot_logtool.core.contacts import Samples
from dogbot_logtool.core.link_frames import FrameCounts
from dogbot_logtool.plan import Plan


@dataclass(frozen=True, slots=True)
class Placed:
    """Contacts with forces turned and sensors placed, as far as that is wanted and frames tell."""

    samples: tuple[Samples, ...]
    """One each of `ReadBatch.contacts`."""
    counts: FrameCounts = field(default_factory=FrameCounts)


def place(read: ReadBatch, carried: Carried, plan: Plan) -> Placed:
    """Place the contacts of a batch.

    Args:
        read: the batch.
        carried: what all earlier batches hand on.
        plan: what is to be done.
    """
    recorded = tuple(contacts.felt.samples for contacts in read.contacts)
    if plan.frames is None or read.frames is None:
        return Placed(recorded)
    around = read.frames.around(carried.transforms)
    placed = [plan.frames.place(samples, around) for samples in recorded]
    counts = sum((told for _, told in placed), FrameCounts())
    return Placed(tuple(samples for samples, _ in placed), counts)
