"""What passes from one batch to the next.

Batches are worked on in parallel. What a batch must know of all earlier ones is small, follows from
what was read of them alone, and is handed on before the heavy work begins.
"""

from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field

from dogbot_logtool.conversion.reading import ReadBatch
from dogbot_logtool.core.footing import Footing, FootMemory, follow_feet, nothing_heard
from dogbot_logtool.core.silent_swing import LastHeard, last_heard
from dogbot_logtool.plan import Plan
from dogbot_logtool.reader.log import Span


@dataclass(frozen=True, slots=True)
class Carried:
    """What a batch must know of all earlier ones."""

    odometry: int | None = None
    """ns, time of the last usable odometry message."""
    contacts: LastHeard = field(default_factory=dict)
    """When the feet that are silent in swing were last heard."""
    feet: tuple[FootMemory, ...] = ()
    """Where each foot stands; empty where nobody asks."""

    def past(self, read: ReadBatch, footings: Sequence[Footing]) -> "Carried":
        """Return what the batch after this one must know.

        Args:
            read: what was read of this one.
            footings: of each foot in this one, if anybody asks.
        """
        time = read.poses.time
        heard = self.contacts
        for contacts in read.contacts:
            if contacts.source.silent_in_swing:
                heard = last_heard(contacts.felt.samples, heard)
        feet = tuple(footing.memory() for footing in footings)
        return Carried(int(time[-1]) if len(time) else self.odometry, heard, feet)


@dataclass(frozen=True, slots=True)
class Work:
    """A batch to be converted, tied to the one before it and the one after it."""

    span: Span
    before: Future[Carried]
    after: Future[Carried]

    def hand_on(self, read: ReadBatch, plan: Plan) -> tuple[Carried, Sequence[Footing]]:
        """Tell the next batch what it must know.

        Args:
            read: what was read of this one.
            plan: what is to be done.

        Returns:
            what the batch before told, and each foot's way through this one, if anybody asks.
        """
        carried = self.before.result()
        footings = follow_feet(
            [contacts.felt.samples for contacts in read.contacts],
            carried.feet,
            plan.hearings,
            force_in_world=plan.force_in_world,
        )
        self.after.set_result(carried.past(read, footings))
        return carried, footings

    def give_up(self) -> None:
        """Let nobody wait for what will not come; does nothing where it has come."""
        self.after.cancel()


def chained(spans: Iterable[Span], feet: int) -> Iterator[Work]:
    """Tie every batch to the one before it.

    Args:
        spans: the batches.
        feet: the number of feet of which it is asked where they stand.
    """
    before: Future[Carried] = Future()
    before.set_result(Carried(feet=(nothing_heard(),) * feet))
    for span in spans:
        after: Future[Carried] = Future()
        yield Work(span, before, after)
        before = after
