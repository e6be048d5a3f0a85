"""Who works on the logs of a call."""

from typing import Any

from dogbot_logtool.fleet.engine import Engine, Here


def engine_for(logs: int, jobs: int, scheduler: str | None) -> Engine[Any]:
    """Choose an engine.

    One log is done here, several batches at once; several logs by as many processes; and whatever a
    scheduler's workers can do, they do, huge logs in parts.

    Args:
        logs: how many.
        jobs: how much is done at once on this machine.
        scheduler: address of one of dask.distributed, or ``local:N``.

    Raises:
        CallError: the extra `fleet` is not installed, or that is no address.
        LogtoolError: no scheduler answers.
    """
    if scheduler is not None:
        from dogbot_logtool.fleet.cluster import Cluster  # noqa: PLC0415 - needs the extra
        from dogbot_logtool.fleet.splitting import Splitting  # noqa: PLC0415

        return Splitting(Cluster(scheduler))
    if min(logs, jobs) <= 1:
        return Here(jobs)
    from dogbot_logtool.fleet.processes import Processes  # noqa: PLC0415 - slow to import

    return Processes(min(logs, jobs), max(jobs // logs, 1))
