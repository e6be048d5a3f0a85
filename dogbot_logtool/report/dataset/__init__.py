"""The figures of many logs as Parquet, for any SQL engine: what `export --dataset` keeps.

    logs/robot=dogbot/month=2026-11/part-0000.parquet      a row a log
    feet/robot=dogbot/month=2026-11/part-0000.parquet      a row a foot of a log
    strides/robot=dogbot/month=2026-11/part-0000.parquet   a row a stride of a foot
    events/robot=dogbot/month=2026-11/part-0000.parquet    a row an event

The rows of a log lie in the part of one number in each table, together with those of other logs. A
part is replaced as a whole, `logs` last, so that a reader sees no half file, and what a later run
finds in `logs` is in the other tables, too.
"""
