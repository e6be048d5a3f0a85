"""The rows of one log as Arrow tables: columns are the fields of the records of metrics."""

from collections.abc import Iterator, Mapping
from typing import Any, Final

import pyarrow as pa

from dogbot_logtool.core import metrics
from dogbot_logtool.core.records import Field, fields_of, is_record, to_json
from dogbot_logtool.report.files.table_file import arrow_table
from dogbot_logtool.results import StrideTable

TABLES: Final = ("strides", "feet", "events", "findings", "logs")
"""In the order in which they are written: a log that is in `logs` is in all of them."""
_TYPES: Final[Mapping[Any, Any]] = {
    float: pa.float64(),
    int: pa.int64(),
    str: pa.string(),
    bool: pa.bool_(),
}

Tables = Mapping[str, Any]
"""`pyarrow.Table` of each of `TABLES`."""


def log_tables(walk: metrics.WalkMetrics, strides: StrideTable) -> Tables:
    """Return the rows of a log that was measured."""
    row = {"error": None, **to_json(walk)}
    foot = pa.array(strides.foot, pa.string())
    tables = {
        "strides": arrow_table(strides.columns).add_column(0, "foot", foot),
        "logs": pa.Table.from_pylist([row], _log_schema()),
    }
    for field in fields_of(metrics.WalkMetrics):
        if field.name in TABLES:
            tables[field.name] = _rows(field, getattr(walk, field.name))
    return tables


def failed_tables(sentence: str) -> Tables:
    """Return the row of a log that could not be measured."""
    return {"logs": pa.Table.from_pylist([{"error": sentence}], _log_schema())}


def with_hash(rows: Any, log_hash: str) -> Any:  # noqa: ANN401 - pyarrow has no types
    """Return rows behind a column that joins the tables."""
    return rows.add_column(0, "log_hash", pa.array([log_hash] * len(rows), pa.string()))


def with_labels(rows: Any, labels: Mapping[str, str]) -> Any:  # noqa: ANN401
    """Return the row of a log with these labels."""
    column = pa.array([list(labels.items())] * len(rows), pa.map_(pa.string(), pa.string()))
    names = rows.column_names
    if "labels" in names:
        return rows.set_column(names.index("labels"), "labels", column)
    return rows.append_column("labels", column)


def labels_of(rows: Any) -> dict[str, str]:  # noqa: ANN401
    """Return the labels of the row of a log."""
    return dict(rows["labels"][0].as_py())


def _rows(field: Field, items: Any) -> Any:  # noqa: ANN401 - records, by name or in a list
    """Return a row a record."""
    columns = list(_columns(field.inner))
    if field.kind != "map":
        return pa.Table.from_pylist([to_json(each) for each in items], pa.schema(columns))
    rows = [{"foot": name, **to_json(each)} for name, each in items.items()]
    return pa.Table.from_pylist(rows, pa.schema([pa.field("foot", pa.string()), *columns]))


def _log_schema() -> Any:  # noqa: ANN401 - pyarrow has no types
    return pa.schema([pa.field("error", pa.string()), *_columns(metrics.WalkMetrics)])


def _columns(record: Any) -> Iterator[Any]:  # noqa: ANN401 - a class of records
    """Yield the columns of the fields of a record; lists of records are tables of their own."""
    for field in fields_of(record):
        kind = _type(field)
        if kind is not None:
            yield pa.field(field.name, kind, metadata={"unit": field.of.unit})


def _type(field: Field) -> Any:  # noqa: ANN401 - pyarrow has no types
    if field.kind in {"record", "aggregate", "curve"}:
        return pa.struct(list(_columns(field.inner)))
    if field.kind in {"map", "records"}:
        return None if is_record(field.inner) else pa.map_(pa.string(), _TYPES[field.inner])
    one = _TYPES.get(field.inner, pa.string())
    return pa.list_(one) if field.kind == "list" else one
