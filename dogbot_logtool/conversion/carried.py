"""What passes from one batch to the next.

Batches are worked on in parallel. What a batch must know of all earlier ones is small, follows from
what was read of them alone, and is handed on before the heavy work begins.
"""

from collections.abc import Iterable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass, field

from dogbot_logtool.conversion.reading import ReadBatch
from dogbot_logtool.core.silent_swing import LastHeard, last_heard
from dogbot_logtool.core.transform_buffer import TransformBuffer
from dogbot_logtool.reader.log import Span


@dataclass(frozen=True, slots=True)
class Carried:
    """What a batch must know of all earlier ones."""

    odometry: int | None = None
    """ns, time of the last usable odometry message."""
    contacts: LastHeard = field(default_factory=dict)
    """When the feet that are silent in swing were last heard."""
    transforms: TransformBuffer = field(default_factory=TransformBuffer)
    """What was last recorded of the frames that are needed."""

    def past(self, read: ReadBatch) -> "Carried":
        """Return what the batch after this one must know."""
        time = read.poses.time
        heard = self.contacts
        for contacts in read.contacts:
            if contacts.source.silent_in_swing:
                heard = last_heard(contacts.felt.samples, heard)
        transforms = read.frames.handed_on(self.transforms) if read.frames else self.transforms
        return Carried(int(time[-1]) if len(time) else self.odometry, heard, transforms)


@dataclass(frozen=True, slots=True)
class Work:
    """A batch to be converted, tied to the one before it and the one after it."""

    span: Span
    before: Future[Carried]
    after: Future[Carried]

    def hand_on(self, read: ReadBatch) -> Carried:
        """Tell the next batch what it must know; return what the one before told."""
        carried = self.before.result()
        self.after.set_result(carried.past(read))
        return carried

    def give_up(self) -> None:
        """Let nobody wait for what will not come; does nothing where it has come."""
        self.after.cancel()


def chained(spans: Iterable[Span]) -> Iterator[Work]:
    """Tie every batch to the one before it."""
    before: Future[Carried] = Future()
    before.set_result(Carried())
    for span in spans:
        after: Future[Carried] = Future()
        yield Work(span, before, after)
        before = after
