"""`export --dataset`: measure logs into a dataset."""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, NoReturn

from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.commands.tasks import MeasuredEntry, MeasureForDataset
from dogbot_logtool.io.storage import from_root, location, shown
from dogbot_logtool.report.dataset import Dataset, Pending, dataset_at, parse_labels
from dogbot_logtool.report.text.conversion_text import DatasetRun
from dogbot_logtool.run.choice import runner_for
from dogbot_logtool.run.inputs import find_logs

if TYPE_CHECKING:
    from dogbot_logtool.robot.options import StatsOptions


def export_dataset(
    words: tuple[str, ...],
    name: str,
    options: "StatsOptions",
    labels: tuple[str, ...],
    scheduler: str | None,
    *,
    prune: bool,
    quiet: bool,
) -> NoReturn:
    """Measure the logs that are not in a dataset, or not as they are now; exit.

    Args:
        words: of the logs.
        name: of the dataset, a directory or URL.
        options: of measuring; `jobs` is for all logs.
        labels: ``NAME=VALUE``, labels for the logs of this call.
        scheduler: address of one of dask.distributed.
        prune: remove logs that are gone.
        quiet: no progress, and no notes.

    Raises:
        CallError: no dataset can be there, or a label is none.
        LogtoolError: the dataset cannot be read or written.
    """
    log_set = find_logs(words, for_workers=scheduler is not None)
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(log_set)
    dataset = dataset_at(from_root(location(name)), options, parse_labels(labels))
    pending = dataset.begin(log_set, prune=prune)
    outcomes.add_unchanged(pending.unchanged)
    run = DatasetRun(pending.unchanged, pending.pruned)
    runner = runner_for("stats", len(pending.entries), options.jobs, scheduler)
    take = _taker(pending, dataset, run)
    work = MeasureForDataset(replace(options, jobs=runner.jobs))
    for _ in outcomes.of(runner, work, pending.entries, pending.log_set.names, take):
        outcomes.add({})
    if not quiet:
        from dogbot_logtool.report.text.console import diagnostics  # noqa: PLC0415 - rich costs 40 ms
        from dogbot_logtool.report.text.conversion_text import print_dataset  # noqa: PLC0415

        run.failed = len(outcomes.failures)
        print_dataset(diagnostics(), shown(dataset.files.root), run)
    outcomes.finish(as_json=False)


def _taker(
    pending: Pending, dataset: Dataset, run: DatasetRun
) -> Callable[[int, MeasuredEntry | None, str], None]:
    """Return what takes the outcome of each log."""

    def take(number: int, done: MeasuredEntry | None, sentence: str) -> None:
        entry = pending.entries[number]
        if done is None:
            dataset.write_failed(entry, sentence)
            return
        damaged = bool(done.damage.losses)
        dataset.write(entry, done.tables, damaged=damaged)
        run.measured += 1
        run.damaged += damaged

    return take
