"""Choose what works on the logs of a call."""

from typing import Any, Literal

from dogbot_logtool.run.runner import Runner, SerialRunner

Command = Literal["convert", "info", "stats"]
"""A module of `dogbot_logtool.commands`."""


def runner_for(command: Command, logs: int, jobs: int, scheduler: str | None) -> Runner[Any]:
    """Choose a runner.

    One log is done in this process, several batches at once; several logs by as many processes; and
    all of them by a cluster if there is a scheduler.

    Args:
        command: what is done to each.
        logs: how many.
        jobs: how much is done at once on this machine.
        scheduler: address of one of dask.distributed.

    Raises:
        CallError: that is no address.
        LogtoolError: no scheduler answers, or the extra `fleet` is not installed.
    """
    if scheduler is not None:
        from dogbot_logtool.run.cluster import ClusterRunner  # noqa: PLC0415 - needs the extra

        return ClusterRunner(scheduler)
    if min(logs, jobs) <= 1:
        return SerialRunner(jobs)
    from dogbot_logtool.run.processes import ProcessRunner  # noqa: PLC0415 - slow to import

    load = f"dogbot_logtool.commands.{command}"
    return ProcessRunner(min(logs, jobs), max(jobs // logs, 1), load=load)
