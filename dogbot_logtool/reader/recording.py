"""Read a log whole: every chunk is decoded once, in any process, and joined by log time."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from io import BytesIO
from typing import IO, TYPE_CHECKING, Any, Final, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Ints, Record, concatenated, median_of, picked
from dogbot_logtool.core.base.poses import no_odometry
from dogbot_logtool.core.contact.contacts import Samples, no_samples, without_contact
from dogbot_logtool.core.recording import (
    MOST_JOINTS,
    JointSamples,
    JointTable,
    Recording,
    Times,
    VectorSamples,
    VectorTopic,
)
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.reader.containers.log import Batch, Channel, Chunk, Log, Span
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.messages.gazebo import UNTIMED
from dogbot_logtool.reader.messages.others import is_static
from dogbot_logtool.reader.part import ONLY, Key, Part, Wanted, read_part
from dogbot_logtool.reader.workers import in_order

if TYPE_CHECKING:
    from dogbot_logtool.core.scene.arrows import Arrows

Table = TypeVar("Table")
_NO_NUMBERS: Final = np.empty(0, np.int64)
_REGULAR: Final = 0.75
"""Share of messages that must have the usual lag. Only the last of each stance should not."""
_MOST_CELLS: Final = 1 << 27
"""States of joints that are kept of a topic: half a gigabyte of each kind."""
LARGEST_IN_MEMORY: Final = 128 << 20
"""Bytes from which a column lies in a file that is mapped into memory: those of four feet then
take some 2 GB."""


class _Timed(Record, Protocol):
    """Columns with log times."""

    @property
    def log_time(self) -> Ints:
        """(n,) ns."""


Columns = TypeVar("Columns", bound=_Timed)


class ReadLog(NamedTuple):
    """A log's columns, and what could not be read of it."""

    recording: Recording
    losses: tuple[Loss, ...]
    """Beside those that were found when it was opened, and messages that are malformed."""
    counts: Mapping[int, int]
    """Messages by channel id."""
    malformed: Mapping[int, int]
    """Messages that could not be decoded, by channel id."""
    arrows: "Arrows | None"
    """Of contact states as they are recorded, by log time; None: there are none, or not wanted."""
    without_arrows: Mapping[str, int]
    """Messages with contact states that have none, by why."""


class Alongside(NamedTuple):
    """What is done with messages beside making columns of them, so that they are read once."""

    work: Callable[[Log, Batch], Any]
    """Done in any process to the messages of a span, within the limits."""
    take: Callable[[Any], None]
    """Takes what that returns, in this process and in file order."""


def read_recording(
    log: Log,
    wanted: Wanted,
    jobs: int,
    progress: Callable[[int, int], None] | None = None,
    spans: Iterable[Span] | None = None,
    alongside: Alongside | None = None,
) -> ReadLog:
    """Read a log as columns.

    Args:
        log: the log.
        wanted: what is read of it.
        jobs: processes that decode at once.
        progress: called with bytes done and bytes in all.
        spans: some of its chunks; None: all within the limits.
        alongside: what else is done with the messages.
    """
    chosen = list(log.grouped(_chunks(log, wanted)) if spans is None else spans)
    joined = _Joined(wanted)
    done, total = 0, sum(chunk.data_size for chunk in log.chunks)
    read = partial(_read, wanted, alongside.work if alongside else None)
    for span, (part, beside) in zip(chosen, in_order(read, log, chosen, jobs), strict=True):
        joined.add(part)
        if alongside is not None:
            alongside.take(beside)
        done += sum(chunk.data_size for chunk in span)
        if progress is not None:
            progress(done, total)
    return joined.finish(log)


def _read(
    wanted: Wanted, work: Callable[[Log, Batch], Any] | None, log: Log, span: Span
) -> tuple[Part, Any]:
    """Return the columns of a span, and what else is made of its messages."""
    batch = log.read(span)
    part = read_part(wanted, log, batch)
    return part, None if work is None else work(log, batch.cropped(*wanted.limits))


def _chunks(log: Log, wanted: Wanted) -> Iterator[Chunk]:
    """Yield the chunks within the limits, and those of transforms that hold for ever."""
    static = {channel.id for channel in wanted.transforms if is_static(channel)}
    for chunk in log.chunks:
        holds_static = chunk.counts is not None and not static.isdisjoint(chunk.counts)
        if holds_static or log.overlaps(chunk, *wanted.limits):
            yield chunk


class _Joined:
    """Joins the parts of a log, in file order."""

    def __init__(self, wanted: Wanted) -> None:
        self._wanted = wanted
        self._columns: dict[Key, GrowingColumns] = {}
        self._whole = Part()
        """All but the columns."""
        self._losses: list[Loss] = []

    def add(self, part: Part) -> None:
        """Take the next part."""
        for key, tables in part.columns.items():
            for table in tables:
                if key in self._columns:
                    self._columns[key].add(table)
                else:
                    self._columns[key] = GrowingColumns(table)
        for key, names in part.names.items():
            self._whole.names[key].update(names)
        self._whole.counts.update(part.counts)
        self._losses.extend(part.losses)

    def _take(self, kind: str, which: Any, nothing: Table) -> Table:  # noqa: ANN401
        """Return whole columns, `nothing` if there are none."""
        columns = self._columns.pop((kind, which), None)
        return nothing if columns is None else columns.finish()

    def _which(self, kind: str) -> list[Any]:
        """Return which there are of a kind of columns."""
        return sorted(which for each, which in self._columns if each == kind)

    def finish(self, log: Log) -> ReadLog:
        """Return the columns of the whole log."""
        names, counts = self._whole.names, self._whole.counts
        feet = self._all_feet()
        planned = tuple(
            _of_foot(foot, self._take("planned", foot, no_samples())) for foot in range(len(feet))
        )
        base = in_time_order(self._take("base", ONLY, no_odometry()))
        times = {
            channel: self._take("times", channel, _NO_NUMBERS) for channel in self._which("times")
        }
        recording = Recording(
            feet=feet,
            planned=planned,
            links={foot: frozenset(own) for (kind, foot), own in names.items() if kind == "links"},
            base=base,
            world_frames=tuple(sorted(names["worlds", ONLY])),
            base_frames=tuple(sorted(names["bases", ONLY])),
            transforms={
                edge: in_time_order(self._columns["transforms", edge].finish())
                for edge in self._which("transforms")
            },
            slashed_frames=frozenset(names["slashed", ONLY]),
            joints=tuple(self._joints()),
            commands=self._vectors("commands", self._wanted.commands),
            accelerations=self._vectors("accelerations", self._wanted.accelerations),
            topics=self._topics(log, times),
            implausible=counts["implausible", ONLY],
            untimed_messages=counts["untimed_messages", ONLY],
            foreign_states=counts["foreign_states", ONLY],
            out_of_order=sum(int((np.diff(each) < 0).sum()) for each in times.values()),
        )
        arrows: Arrows | None = self._take("arrows", ONLY, None)
        return ReadLog(
            recording,
            tuple(self._losses),
            {channel: len(own) for channel, own in times.items()},
            {channel: n for (kind, channel), n in counts.items() if kind == "malformed"},
            None if arrows is None else in_time_order(arrows),
            {why: n for (kind, why), n in counts.items() if kind == "without_arrow"},
        )

    def _all_feet(self) -> tuple[Samples, ...]:
        """Join contact samples; a foot whose newest physics step is too old has left the ground."""
        feet = range(len(self._wanted.feet.feet))
        lags = [self._take("lags", foot, _NO_NUMBERS) for foot in feet]
        left_after = left_after_ns(lags, self._take("steps", ONLY, _NO_NUMBERS))
        left = [None if left_after is None else lag > left_after for lag in lags]
        del lags
        return tuple(
            _of_foot(foot, self._take("feet", foot, no_samples()), left[foot]) for foot in feet
        )

    def _joints(self) -> Iterator[JointTable]:
        """Yield the joint states of each topic, the best first."""
        for topic in dict.fromkeys(channel.topic for channel in self._wanted.joints):
            tables = [
                JointTable(topic, which[1], self._columns.pop((kind, which)).finish())
                for kind, which in [*self._columns]
                if kind == "joints" and which[0] == topic
            ]
            if tables:
                yield _one_table(topic, tables)

    def _vectors(self, kind: str, wanted: Sequence[Channel]) -> VectorTopic | None:
        if not wanted:
            return None
        samples = self._take(
            kind, ONLY, VectorSamples(_NO_NUMBERS, _NO_NUMBERS, *np.empty((2, 0, 3)))
        )
        return VectorTopic(in_time_order(samples), tuple(sorted(self._whole.names[kind, ONLY])))

    def _topics(self, log: Log, times: Mapping[int, Ints]) -> dict[str, Times]:
        """Return the times of all topics."""
        own: dict[str, list[Ints]] = {}
        for channel, log_times in times.items():
            own.setdefault(log.channels[channel].topic, []).append(log_times)
        found = {}
        for topic, columns in own.items():
            sent: Times | None = self._take("stamps", topic, None)
            log_time = np.sort(np.concatenate(columns), kind="stable")
            found[topic] = Times(log_time, None) if sent is None else in_time_order(sent)
        return found


def _of_foot(foot: int, samples: Samples, left: Flags | None = None) -> Samples:
    """Return all samples of one foot; its number takes no memory.

    Args:
        foot: its number.
        samples: its samples.
        left: (n,) whether the foot has left the ground; None: as the samples tell.
    """
    samples = replace(samples, foot=np.broadcast_to(np.int64(foot), len(samples.log_time)))
    return in_time_order(samples if left is None else without_contact(samples, left))


def left_after_ns(lags: Sequence[Ints], step: Ints) -> int | None:
    """Return the lag, ns, beyond which a foot has left the ground; None where that is not known.

    While a foot stands, each physics step has a contact. So the newest step of a message lies as
    far from its stamp as in any other, unless the foot left in between. Where lags vary for other
    reasons, as with a simulation that runs ahead of its sensors, a lag tells nothing.

    Args:
        lags: (n,) ns, of each foot's messages; `UNTIMED` of those that tell no step.
        step: (k,) ns, between neighbouring steps of one message; none: messages hold one each.
    """
    if not len(step):
        return None
    lag = np.concatenate([each[each != UNTIMED] for each in lags])
    usual, half_a_step = float(median_of(lag)), float(median_of(step)) / 2.0
    regular = np.abs(lag - usual) < half_a_step
    return round(usual + half_a_step) if regular.mean() >= _REGULAR else None


def _one_table(topic: str, tables: Sequence[JointTable]) -> JointTable:
    """Join tables of one topic, whose joints may differ."""
    rows = sum(len(table.samples.log_time) for table in tables)
    most = min(MOST_JOINTS, max(_MOST_CELLS // rows, 1))
    names = tuple(dict.fromkeys(name for table in tables for name in table.names))[:most]
    column = {name: number for number, name in enumerate(names)}
    samples = []
    for table in tables:
        own = [number for number, name in enumerate(table.names) if name in column]
        into = [column[table.names[number]] for number in own]
        each = table.samples
        wide: list[Any] = []  # float32
        for values in (each.position, each.velocity, each.effort):
            filled = np.full((len(values), len(names)), np.nan, np.float32)
            filled[:, into] = values[:, own]
            wide.append(filled)
        samples.append(JointSamples(each.log_time, each.stamp, *wide))
    return JointTable(topic, names, in_time_order(concatenated(samples)))


def in_time_order(columns: Columns) -> Columns:
    """Sort columns by log time, unless they are."""
    time = columns.log_time
    if (time[1:] >= time[:-1]).all():
        return columns
    return picked(columns, np.argsort(time, kind="stable"))


class GrowingColumns:
    """The columns of a record, or a single one, which grow by those of others of its type."""

    def __init__(self, first: Any) -> None:  # noqa: ANN401
        """Begin with the rows of a record, or with a column."""
        self._type = type(first)
        self._columns = [_Column(each) for each in _columns_of(first)]
        self.add(first)

    def add(self, part: Any) -> None:  # noqa: ANN401
        """Append rows.

        Raises:
            LogtoolError: the file cannot be written.
        """
        for column, each in zip(self._columns, _columns_of(part), strict=True):
            column.add(each)

    def finish(self) -> Any:  # noqa: ANN401
        """Return all rows."""
        found, self._columns = [column.finish() for column in self._columns], []
        return found[0] if self._type is np.ndarray else self._type(*found)


def _columns_of(part: Any) -> list[NDArray[Any]]:  # noqa: ANN401
    if isinstance(part, np.ndarray):
        return [part]
    return [getattr(part, field.name) for field in fields(part)]


class _Column:
    """The bytes of a column."""

    def __init__(self, like: NDArray[Any]) -> None:
        self._shape, self._dtype = (-1, *like.shape[1:]), like.dtype
        self._bytes: IO[bytes] = BytesIO()

    def add(self, values: NDArray[Any]) -> None:
        try:
            if isinstance(self._bytes, BytesIO) and self._bytes.tell() > LARGEST_IN_MEMORY:
                self._bytes = _in_a_file(self._bytes)
            self._bytes.write(np.ascontiguousarray(values).data)
            self._bytes.flush()
        except OSError as error:
            import tempfile  # noqa: PLC0415

            folder = tempfile.gettempdir()
            raise LogtoolError(
                f"the columns of this log are too large for memory, and {folder} cannot hold them: "
                f"{error.strerror}; set TMPDIR to a folder on a larger disk"
            ) from error

    def finish(self) -> NDArray[Any]:
        if isinstance(self._bytes, BytesIO):
            return np.frombuffer(self._bytes.getbuffer(), self._dtype).reshape(self._shape)
        with self._bytes:
            return np.memmap(self._bytes, self._dtype, "r+").reshape(self._shape)


def _in_a_file(memory: BytesIO) -> IO[bytes]:
    """Return a file without a name, of which nothing stays, that holds some bytes."""
    import tempfile  # noqa: PLC0415 - takes long, and few logs are so large

    file = tempfile.TemporaryFile(prefix="dogbot_logtool_")  # noqa: SIM115
    file.write(memory.getbuffer())
    return file
