"""Conversions of logs, made once for each set of options."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, get_args

from mcap import records
from mcap.stream_reader import StreamReader

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.results import Conversion
from dogbot_logtool.writer.chunks import Compression
from tests.oracles.annotated_file import Written, read_written
from tests.oracles.recorded import read_log

COMPRESSIONS: tuple[Compression, ...] = get_args(Compression)


@dataclass(frozen=True)
class Done:
    conversion: Conversion
    path: Path

    @cached_property
    def written(self) -> Written:
        return read_written(self.path)


_DONE: dict[tuple[Path, str], Done] = {}
_FOLDER = TemporaryDirectory(prefix="converted")


def converted(log: Path, **options: Any) -> Done:
    """Convert a log, once for the same options."""
    key = (log, repr(sorted(options.items())))
    if key not in _DONE:
        target = Path(_FOLDER.name) / f"{len(_DONE)}.mcap"
        conversion = convert(log, target, ConvertOptions(**options))
        _DONE[key] = Done(conversion, target)
    return _DONE[key]


def opening_of(log: Path) -> int:
    """The first log time, ns."""
    return min(message.log_time for message in read_log(log))


def codes(conversion: Conversion) -> set[str]:
    return {finding.code for finding in conversion.findings}


def chunks_of(path: Path) -> list[records.Chunk]:
    with path.open("rb") as stream:
        return [
            record
            for record in StreamReader(stream, emit_chunks=True).records
            if isinstance(record, records.Chunk)
        ]
