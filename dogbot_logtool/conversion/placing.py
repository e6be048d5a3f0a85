"""Contacts of a batch placed in the world by the log's own frames."""

from dataclasses import dataclass, field

from dogbot_logtool.conversion.reading import Extract
from dogbot_logtool.core.contacts import Samples
from dogbot_logtool.core.link_frames import FrameCounts
from dogbot_logtool.core.transform_buffer import TransformBuffer
from dogbot_logtool.plan import Plan


@dataclass(frozen=True, slots=True)
class Placed:
    """Contacts with forces turned and sensors placed, as far as that is wanted and frames tell."""

    samples: tuple[Samples, ...]
    """One each of `Extract.samples`."""
    counts: FrameCounts = field(default_factory=FrameCounts)


def place(read: Extract, before: TransformBuffer, plan: Plan) -> Placed:
    """Place the contacts of a batch.

    Args:
        read: what was read of the batch.
        before: what all earlier batches hand on of the frames.
        plan: what is to be done.
    """
    if plan.frames is None or read.frames is None:
        return Placed(read.samples)
    around = read.frames.around(before)
    placed = [plan.frames.place(samples, around) for samples in read.samples]
    counts = sum((told for _, told in placed), FrameCounts())
    return Placed(tuple(samples for samples, _ in placed), counts)
