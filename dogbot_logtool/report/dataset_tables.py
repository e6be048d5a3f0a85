"""The tables of a dataset, a row a record: their columns are the fields of the metrics' records."""

from collections.abc import Iterator, Mapping
from typing import Any, Final

from dogbot_logtool.core.events import with_steps
from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.core.records import Field, fields_of, is_record, to_json
from dogbot_logtool.errors import ExtraMissingError
from dogbot_logtool.report.tables import arrow_table
from dogbot_logtool.results import StrideTable

try:
    import pyarrow as pa
except ImportError as error:
    raise ExtraMissingError("--dataset", "fleet") from error

TABLES: Final = ("strides", "feet", "events", "findings", "logs")
"""In the order in which they are written: a log that is in `logs` is in all of them."""
_TYPES: Final[Mapping[Any, Any]] = {
    float: pa.float64(),
    int: pa.int64(),
    str: pa.string(),
    bool: pa.bool_(),
}
Labels = Mapping[str, str]
Tables = Mapping[str, Any]
"""`pyarrow.Table` of each of `TABLES`."""


def log_tables(metrics: WalkMetrics, strides: StrideTable) -> Tables:
    """Return the rows of a log that was measured."""
    tables = {"strides": arrow_table(strides.columns).add_column(0, "foot", [strides.foot])}
    for field in fields_of(WalkMetrics):
        if field.name in TABLES:
            is_events = field.name == "events"
            items = with_steps(metrics) if is_events else getattr(metrics, field.name)
            tables[field.name] = _rows(field, items)
    return {**tables, **log_row(to_json(metrics), None)}


def log_row(row: Mapping[str, Any], sentence: str | None) -> Tables:
    """Return the row of a log, and why it could not be measured; None: it could."""
    schema = pa.schema([pa.field("error", pa.string()), *_columns(WalkMetrics)])
    return {"logs": pa.Table.from_pylist([{"error": sentence, **row}], schema)}


def _rows(field: Field, items: Any) -> Any:  # noqa: ANN401 - records, by name or in a list
    """Return a row a record."""
    columns = list(_columns(field.inner))
    if field.kind != "map":
        return pa.Table.from_pylist([to_json(each) for each in items], pa.schema(columns))
    rows = [{"foot": name, **to_json(each)} for name, each in items.items()]
    return pa.Table.from_pylist(rows, pa.schema([pa.field("foot", pa.string()), *columns]))


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


def with_labels(rows: Any, labels: Labels) -> Any:  # noqa: ANN401 - pyarrow has no types
    """Return the row of a log with these labels, in the place of those that it has."""
    column = pa.array([list(labels.items())] * len(rows), pa.map_(pa.string(), pa.string()))
    if "labels" in rows.column_names:
        rows = rows.drop_columns("labels")
    return rows.append_column("labels", column)
