"""The metrics of many logs as Parquet, for any SQL engine: what `export --dataset` keeps.

    logs/3f2a....parquet       a row: a log, with groups of metrics as structs (base, gait ...)
    feet/3f2a....parquet       a row a foot of that log; likewise strides, events, findings

A file is named by the hash of its log's path. Writing is replacing that file; those of other logs
are never opened. Two calls that write one log write the same bytes, so nothing is locked.
"""

from dogbot_logtool.errors import ExtraMissingError

try:
    import pyarrow  # noqa: F401, ICN001
except ImportError as error:
    raise ExtraMissingError("--dataset", "fleet") from error
