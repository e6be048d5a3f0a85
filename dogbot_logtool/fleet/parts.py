"""One huge log on many workers: its batches in parts, whose outcomes are joined in order.

What is decided of a log is decided once, here, and sent; a worker opens the log itself and reads
its part. Batches are those of one core and are joined as on one core, so figures and bytes are the
same. What a batch must know of all earlier ones follows from what was read of them, so `convert`
has its log read twice: first for that, which is folded here, then to be converted.
"""

import hashlib
import threading
import uuid
import weakref
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, Protocol

from dogbot_logtool.annotated import open_recorded
from dogbot_logtool.errors import CallError, LogError, LogtoolError
from dogbot_logtool.fleet.engine import Engine, Failure, Tell, Watch
from dogbot_logtool.reader.log import Chunk, Log, Span
from dogbot_logtool.storage import Location, shown

if TYPE_CHECKING:
    from dogbot_logtool.conversion.batch import ConvertedBatch
    from dogbot_logtool.conversion.carried import Carried
    from dogbot_logtool.conversion.reading import Extract
    from dogbot_logtool.measuring import BatchMeasurer, MeasuredBatch
    from dogbot_logtool.plan import Plan
    from dogbot_logtool.writer.annotations import Annotations

PART_SIZE: Final = 16 << 20
"""Bytes of the file from which a part is full: some 0.3 s of work, against 4 ms of a scheduler."""
PARTS_AHEAD: Final = 32
"""Parts under way or waiting to be joined: they bound the memory here, and keep busy more workers
than one process can take results from."""

_OPEN_FOR_S: Final = 60.0


class PartWork(Protocol):
    """What is done to a part of a log; can be pickled."""

    def __call__(self, log: Log, spans: Sequence[Span], given: Any) -> Sequence[Any]:  # noqa: ANN401 - each kind of work has its own
        """Return something for each batch, in order; it can be pickled, too."""


@dataclass(frozen=True, slots=True)
class Part:
    """Some neighbouring batches of a log."""

    batches: tuple[tuple[int, ...], ...]
    """Offsets of the chunks of each."""
    given: object = None
    """What the work must know beside its batches."""


def index_of(log: Log) -> str:
    """Return a digest of all that opening a log tells, where its bytes lie above all."""
    told = (log.container, log.source.size, log.channels, log.chunks, log.start_time, log.end_time)
    return hashlib.sha256(repr(told).encode("utf-8", "surrogatepass")).hexdigest()


class _Opened:
    """A log that is open until nobody refers to this."""

    def __init__(self, place: Location) -> None:
        self.log = open_recorded(place)
        weakref.finalize(self, self.log.close)
        self.index = index_of(self.log)
        self._chunks: Mapping[int, Chunk] = {chunk.offset: chunk for chunk in self.log.chunks}

    def spans(self, part: Part) -> list[Span]:
        """Return the batches of a part."""
        return [tuple(self._chunks[offset] for offset in batch) for batch in part.batches]


class _LastOpened:
    """Keeps the log of the last part open for a while: the next one is likely to be of the same."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._opener: _Opener | None = None
        self._opened: _Opened | None = None
        self._timer: threading.Timer | None = None

    def by(self, opener: "_Opener") -> _Opened:
        with self._lock:
            if self._opened is None or self._opener != opener:
                self._opened = None
                self._opened, self._opener = _Opened(opener.place), opener
            if self._timer is not None:
                self._timer.cancel()
            self._timer = threading.Timer(_OPEN_FOR_S, self._forget)
            self._timer.daemon = True
            self._timer.start()
            return self._opened

    def _forget(self) -> None:
        with self._lock:
            self._opened = None


_OPENED: Final = _LastOpened()


@dataclass(frozen=True, slots=True)
class _Opener:
    """Opens on a worker the log that is open here."""

    place: Location
    index: str
    """See `index_of`."""
    run: str
    """Differs between calls: the file may do, too."""

    def __call__(self) -> _Opened:
        opened = _OPENED.by(self)
        if opened.index != self.index:
            raise LogError(
                f"{shown(self.place)}: is another log to a worker than to who sent it there; "
                "workers must see the same files, and nobody may write to them"
            )
        return opened


@dataclass(frozen=True, slots=True)
class OnPart:
    """Some work on any part of a log; runs on a worker."""

    opener: _Opener
    work: PartWork

    def __call__(self, part: Part, tell: Tell | None) -> Sequence[Any]:
        """Work on a part.

        Raises:
            LogError: it is not the log that the coordinator has.
        """
        del tell
        opened = self.opener()
        return self.work(opened.log, opened.spans(part), part.given)


class Parts:
    """Works on the parts of one log, by an engine."""

    def __init__(self, engine: Engine[Any], watch: Watch, size: int = PART_SIZE) -> None:
        """Set up.

        Args:
            engine: whose workers see the log under the same name.
            watch: hears what a user should know.
            size: bytes of the file from which a part is full.
        """
        self._engine = engine
        self._watch = _OnlyWords(watch)
        self._size = size
        self._run = uuid.uuid4().hex

    def converted(
        self, place: Location, log: Log, plan: "Plan", annotations: "Annotations"
    ) -> Generator["ConvertedBatch", None, None]:
        """Convert the log at a place; see `dogbot_logtool.convert.BatchSource`."""
        del annotations  # They follow from log and plan, and cannot be pickled.
        from dogbot_logtool.conversion.carried import Carried  # noqa: PLC0415

        parts = list(self._cut(log.spans(*plan.limits)))
        opener = _Opener(place, index_of(log), self._run)
        carried = Carried.nothing(plan)
        known: list[Part] = []
        read = self._done(OnPart(opener, _Extracting(plan)), parts)
        for part, extracts in zip(parts, read, strict=True):
            known.append(replace(part, given=carried))
            for extract in extracts:
                carried = carried.over(extract, plan)
        for batches in self._done(OnPart(opener, _Converting(plan)), known):
            yield from batches

    def measured(
        self, place: Location, log: Log, measurer: "BatchMeasurer", spans: Iterable[Span]
    ) -> Generator["MeasuredBatch", None, None]:
        """Measure batches of the log at a place; see `dogbot_logtool.stats.BatchSource`."""
        work = OnPart(_Opener(place, index_of(log), self._run), _Measuring(measurer))
        for batches in self._done(work, list(self._cut(spans))):
            yield from batches

    def _cut(self, spans: Iterable[Span]) -> Iterator[Part]:
        batches: list[tuple[int, ...]] = []
        size = 0
        for span in spans:
            batches.append(tuple(chunk.offset for chunk in span))
            size += sum(chunk.data_size for chunk in span)
            if size >= self._size:
                yield Part(tuple(batches))
                batches, size = [], 0
        if batches:
            yield Part(tuple(batches))

    def _done(self, work: "OnPart", parts: Sequence[Part]) -> Iterator[Sequence[Any]]:
        """Yield what became of each part.

        Raises:
            LogtoolError: one could not be done.
        """
        for outcome in self._engine.run(work, parts, self._watch, PARTS_AHEAD):
            if isinstance(outcome, Failure):
                raise (CallError if outcome.exit_code == CallError.exit_code else LogtoolError)(
                    outcome.sentence
                )
            yield outcome


@dataclass(frozen=True, slots=True)
class _Extracting:
    """Reads what later batches must know of each."""

    plan: "Plan"

    def __call__(self, log: Log, spans: Sequence[Span], given: None) -> list["Extract"]:
        from dogbot_logtool.conversion.reading import read_batch  # noqa: PLC0415

        del given
        return [read_batch(log, self.plan, span).extract for span in spans]


@dataclass(frozen=True, slots=True)
class _Converting:
    """Converts batches, knowing what is carried to the first of them."""

    plan: "Plan"

    def __call__(self, log: Log, spans: Sequence[Span], given: "Carried") -> list["ConvertedBatch"]:
        from dogbot_logtool.conversion.batch import BatchConverter  # noqa: PLC0415
        from dogbot_logtool.conversion.channels import annotations_of  # noqa: PLC0415
        from dogbot_logtool.parallel.relay import one_by_one  # noqa: PLC0415

        annotations, _ = annotations_of(log, self.plan)
        convert = BatchConverter(log, self.plan, annotations)
        return list(one_by_one(convert, spans, given))


@dataclass(frozen=True, slots=True)
class _Measuring:
    """Reads the columns that figures are worked out of."""

    measurer: "BatchMeasurer"

    def __call__(self, log: Log, spans: Sequence[Span], given: None) -> list["MeasuredBatch"]:
        del given
        return [self.measurer(log, span) for span in spans]


class _OnlyWords:
    """Hears nothing of how far a part has come: the log's progress is told where it is joined."""

    def __init__(self, watch: Watch) -> None:
        self._watch = watch

    def told(self, number: int, done: int, total: int) -> None:
        """See `Watch`."""

    def finished(self, number: int) -> None:
        """See `Watch`."""

    def say(self, sentence: str) -> None:
        """See `Watch`."""
        self._watch.say(sentence)
