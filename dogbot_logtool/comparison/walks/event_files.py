"""Files of labelled events: EUROBENCH's YAML of gait events, BIDS' events.tsv, our own CSV."""

import csv
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

from dogbot_logtool.core.events.gait_labels import LABELS, SIDES
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.storage import content

SUFFIXES: Final = frozenset({".yaml", ".yml", ".tsv", ".csv"})
_LARGEST: Final = 64 << 20
_NONE: Final = frozenset({"", "n/a"})


class LabelledEvent(NamedTuple):
    """An event, and when it happened."""

    onset_s: float
    """Since the log's start."""
    type: str
    foot: str
    """Its name, or its side; empty: of the whole robot."""


def is_event_file(path: Path) -> bool:
    """Tell by its name whether a file holds labelled events."""
    return path.suffix.lower() in SUFFIXES


def read_event_file(path: Path) -> list[LabelledEvent]:
    """Read a file of labelled events.

    Raises:
        CallError: it cannot be read, or holds none.
    """
    try:
        data = content(path, _LARGEST)
        text = "" if data is None else data.decode("utf-8-sig")
    except OSError as error:
        raise CallError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise CallError(f"{path}: is no text") from error
    is_yaml = path.suffix.lower() in {".yaml", ".yml"}
    events = list(_of_yaml(text, path) if is_yaml else _of_table(text, path))
    if not events:
        raise CallError(f"{path}: there are no events in it")
    return sorted(events)


def _of_yaml(text: str, path: Path) -> Iterator[LabelledEvent]:
    """Yield the events of EUROBENCH's lists of seconds."""
    from ruamel.yaml import YAML  # noqa: PLC0415 - only here
    from ruamel.yaml.error import YAMLError  # noqa: PLC0415

    try:
        document = YAML(typ="safe", pure=True).load(text)
    except (YAMLError, ValueError, RecursionError) as error:
        raise CallError(f"{path}: is not YAML that can be read") from error
    if not isinstance(document, dict):
        raise CallError(f"{path}: has no lists by name, such as l_heel_strike: [1.2, 2.3]")
    for key, times in document.items():
        short, _, label = str(key).partition("_")
        if short not in SIDES or label not in LABELS or times is None:
            continue
        if not isinstance(times, list):
            raise CallError(f"{path}: {key} is no list of seconds")
        for each in times:
            yield LabelledEvent(_seconds(each, f"{path}: {key}"), LABELS[label], SIDES[short])


def _of_table(text: str, path: Path) -> Iterator[LabelledEvent]:
    """Yield the rows of BIDS' table, or of ours: both have an onset, a type, and perhaps a foot."""
    dialect = "excel-tab" if path.suffix.lower() == ".tsv" else "excel"
    try:
        rows = list(csv.reader(text.splitlines(), dialect=dialect))
    except csv.Error as error:
        raise CallError(f"{path}: is no table that can be read: {error}") from error
    header = rows[0] if rows else []
    columns = [_column(header, *names) for names in (("onset", "onset_s"), ("trial_type", "type"))]
    foot_column = _column(header, "foot")
    if None in columns:
        wanted = "onset and trial_type" if dialect == "excel-tab" else "onset_s and type"
        raise CallError(f"{path}: its first line does not name the columns {wanted}")
    onset, kind = (each or 0 for each in columns)
    for number, row in enumerate(rows[1:], 2):
        if row:
            cells = [*row, *[""] * (len(header) - len(row))]
            foot = "" if foot_column is None else cells[foot_column]
            time = _seconds(cells[onset], f"{path}, line {number}")
            yield LabelledEvent(time, cells[kind], "" if foot in _NONE else foot)


def _column(header: list[str], *names: str) -> int | None:
    return next((header.index(name) for name in names if name in header), None)


def _seconds(value: object, where: str) -> float:
    try:
        time = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        time = math.nan
    if not math.isfinite(time):
        raise CallError(f"{where}: {str(value)[:40]!r} is no time in seconds")
    return time
