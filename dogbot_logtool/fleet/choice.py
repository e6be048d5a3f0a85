"""Who works on the logs of a call."""

from typing import Any

from dogbot_logtool.fleet.engine import Engine, Here


def engine_for(logs: int, jobs: int, scheduler: str | None) -> Engine[Any]:
    """Choose an engine.

    One log is done here, on all threads; several by processes, since the part of the work that
    holds Python's lock is large for small logs; and whatever a scheduler's workers can do, they do.

    Args:
        logs: how many.
        jobs: threads or processes on this machine.
        scheduler: address of one of dask.distributed, or ``local:N``.

    Raises:
        CallError: the extra `fleet` is not installed, or that is no address.
        LogtoolError: no scheduler answers.
    """
    if scheduler is not None:
        from dogbot_logtool.fleet.cluster import Cluster  # noqa: PLC0415 - needs the extra

        return Cluster(scheduler)
    if min(logs, jobs) <= 1:
        return Here(jobs)
    from dogbot_logtool.fleet.processes import Processes  # noqa: PLC0415 - slow to import

    return Processes(min(logs, jobs), max(jobs // logs, 1))
