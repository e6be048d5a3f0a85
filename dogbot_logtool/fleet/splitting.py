"""An engine that has huge logs done in parts, by the workers of another."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import groupby
from typing import Any, Final, Protocol, runtime_checkable

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.fleet.engine import (
    AHEAD,
    Engine,
    Failure,
    Item,
    Result,
    Tell,
    Watch,
    Work,
    attempt,
)
from dogbot_logtool.fleet.parts import PART_SIZE, Parts

SPLIT_ABOVE: Final = 1 << 30
"""Bytes of a log above which it is split: some 20 s of one worker's time."""
_ASKED_AT_ONCE: Final = 16


@runtime_checkable
class Divisible(Protocol):
    """Work on logs that can be done in parts."""

    def size(self, item: Any) -> int:  # noqa: ANN401 - each kind of work has its own items
        """Return the size of an item's log, bytes."""

    def __call__(self, item: Any, tell: Tell | None, parts: Parts | None = None) -> Any:  # noqa: ANN401
        """Work on an item, by parts if they are given."""


class Splitting(Engine[Result]):
    """Hands logs to another engine: most of them whole, huge ones in parts, one after the other."""

    def __init__(
        self, engine: Engine[Any], above: int = SPLIT_ABOVE, part_size: int = PART_SIZE
    ) -> None:
        """Set up.

        Args:
            engine: whose workers see logs under the same names; is closed with this one.
            above: bytes of a log above which it is split.
            part_size: see `Parts`.
        """
        self._engine = engine
        self._above = above
        self._part_size = part_size
        self.jobs = engine.jobs
        self.may_repeat = engine.may_repeat

    def run(
        self, work: Work[Result], items: Sequence[Item], watch: Watch, ahead: int = AHEAD
    ) -> Iterator[Result | Failure]:
        """See `Engine.run`."""
        if not isinstance(work, Divisible):
            yield from self._engine.run(work, items, watch, ahead)
            return
        huge = self._huge(work, items)
        for is_huge, group in groupby(range(len(items)), key=huge.__getitem__):
            numbers = list(group)
            if not is_huge:
                some = items[numbers[0] : numbers[-1] + 1]
                yield from self._engine.run(work, some, _Shifted(watch, numbers[0]), ahead)
                continue
            for number in numbers:
                in_parts = partial(work, parts=Parts(self._engine, watch, self._part_size))
                yield attempt(in_parts, items[number], partial(watch.told, number))
                watch.finished(number)

    def _huge(self, work: Divisible, items: Sequence[Item]) -> list[bool]:
        """Tell which logs are to be split."""
        with ThreadPoolExecutor(_ASKED_AT_ONCE) as pool:
            return list(pool.map(lambda item: self._is_huge(work, item), items))

    def _is_huge(self, work: Divisible, item: Item) -> bool:
        try:
            return work.size(item) > self._above
        except (LogtoolError, OSError):
            # Whoever opens it will say what is the matter.
            return False

    def close(self) -> None:
        """See `Engine.close`."""
        self._engine.close()


class _Shifted:
    """Hears of some items of many, and passes on their numbers among all."""

    def __init__(self, watch: Watch, first: int) -> None:
        self._watch = watch
        self._first = first

    def told(self, number: int, done: int, total: int) -> None:
        """See `Watch`."""
        self._watch.told(self._first + number, done, total)

    def finished(self, number: int) -> None:
        """See `Watch`."""
        self._watch.finished(self._first + number)

    def say(self, sentence: str) -> None:
        """See `Watch`."""
        self._watch.say(sentence)
