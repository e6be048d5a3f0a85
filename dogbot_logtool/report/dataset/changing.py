"""Replace the parts of a dataset that change."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from dogbot_logtool.report.dataset.files import Files, schema_of
from dogbot_logtool.report.dataset.labels import Labels
from dogbot_logtool.report.dataset.parts import Change, NewLog, Part, StoredLog, planned_changes
from dogbot_logtool.report.dataset.rows import Columns
from dogbot_logtool.report.dataset.schema import tables

AnyLog = StoredLog | NewLog


def change(
    files: Files,
    new: Sequence[NewLog] = (),
    labels: Mapping[str, Labels] | None = None,
    dropped: Iterable[str] = (),
) -> None:
    """Change what a dataset holds; `files` are locked.

    Args:
        files: of the dataset.
        new: logs that are written, or replace what is there of them.
        labels: all labels of logs whose labels change, by key.
        dropped: keys of logs that go.

    Raises:
        LogtoolError: it cannot be read or written.
    """
    contents = files.contents()
    changes = planned_changes(contents, new, labels, dropped)
    names = set().union(*contents.label_names.values())
    names.update(name for _, part in changes for log in _logs_of(part) for name in log.labels)
    for part, to_be in changes:
        _replace(files, part, to_be, sorted(names), contents.rows.get(part, 0))
    written = {part for part, to_be in changes if to_be.new}
    for table, part in contents.strays:
        if part not in written:
            files.remove(table, part)


def _logs_of(to_be: Change) -> list[AnyLog]:
    """Return the logs of a part in the order of their rows."""
    logs: list[AnyLog] = [*to_be.kept.values(), *to_be.new.values()]
    return sorted(logs, key=lambda log: (log.name, log.key))


def _replace(files: Files, part: Part, to_be: Change, labels: Sequence[str], others: int) -> None:
    """Write the files of a part, that of `logs` last; or remove all, that of `logs` first.

    Args:
        files: of the dataset.
        part: which one.
        to_be: what it is to hold.
        labels: names of the dataset's labels.
        others: rows that the tables beside `logs` have in it.
    """
    logs = _logs_of(to_be)
    if not logs:
        for table in reversed(tuple(tables())):
            files.remove(table, part)
        return
    if to_be.changes_rows:
        others = 0
        for table in tables():
            if table != "logs":
                rows = _rows(files, part, table, to_be, logs)
                others += rows.num_rows
                files.write(table, part, rows)
    rows = _rows(files, part, "logs", to_be, logs)
    files.write("logs", part, _with_labels(rows, logs, labels), others)


def _rows(files: Files, part: Part, table: str, to_be: Change, logs: Sequence[AnyLog]) -> Any:  # noqa: ANN401
    """Return the rows of a table in a part, a `pyarrow.Table`, in the order of the logs."""
    schema = schema_of(table)
    pieces = [_new_rows(table, log, schema) for log in to_be.new.values()]
    if to_be.kept:
        old = files.read(table, part)
        kept = pa.array([log.log_id for log in to_be.kept.values()], pa.string())
        pieces.append(old.filter(pc.is_in(old.column("log_id"), kept)))
    rows = pa.concat_tables(pieces)
    order = pa.array([log.log_id for log in logs], pa.string())
    where = pc.index_in(rows.column("log_id"), order).to_numpy()
    return rows.take(pa.array(np.argsort(where, kind="stable"))).combine_chunks()


def _new_rows(table: str, log: NewLog, schema: Any) -> Any:  # noqa: ANN401 - pyarrow has no types
    if table == "logs":
        return pa.Table.from_pylist([dict(log.row)], schema)
    columns: Columns = log.rows.others.get(table, {})
    count = len(next(iter(columns.values()), ()))
    own = {"log": [log.name] * count, "log_id": [log.log_id] * count}
    arrays = [
        # NaN becomes null.
        pa.array({**columns, **own}.get(field.name, [None] * count), field.type, from_pandas=True)
        for field in schema
    ]
    return pa.Table.from_arrays(arrays, schema=schema)


def _with_labels(rows: Any, logs: Sequence[AnyLog], labels: Sequence[str]) -> Any:  # noqa: ANN401
    for name in labels:
        values = pa.array([log.labels.get(name) for log in logs], pa.string())
        rows = rows.append_column(pa.field(name, pa.string()), values)
    return rows
