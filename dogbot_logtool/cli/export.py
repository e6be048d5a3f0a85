"""`export` on the command line."""

import sys
from collections import Counter
from typing import NoReturn

import numpy as np

from dogbot_logtool.api.walk import Walk
from dogbot_logtool.cli.call import Call, refuse_given
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.output import output_at, output_file, whole_file
from dogbot_logtool.io.storage import Location, name_of
from dogbot_logtool.options.export import Export
from dogbot_logtool.report.tables import TableFile
from dogbot_logtool.results import Measurement
from dogbot_logtool.run.inputs import LogSet
from dogbot_logtool.run.runner import OnProgress


def run(options: Export) -> NoReturn:
    """Write a table of all logs, or keep their tables in a dataset."""
    if options.dataset is None:
        refuse_given(options, ("label", "prune", "scheduler"), "goes with --dataset")
    else:
        refuse_given(options, ("table", "output", "overwrite"), "goes without --dataset")
    call = Call(options)
    logs, options = call.joined_logs(options)
    if options.dataset is not None:
        _dataset(call, logs, options, options.dataset)
    output = None if options.output == "-" else options.output
    target = output_file(output, logs.paths, overwrite=options.overwrite)
    if target is None:
        if options.overwrite:
            raise CallError("--overwrite goes with -o FILE")
        _write(call, logs, options, TableFile("stdout.csv", sys.stdout.buffer))
        call.finish()
    with whole_file(target, overwrite=options.overwrite) as file:
        table = TableFile(target.name, file)
        _write(call, logs, options, table)
        if not call.has_results:
            call.finish()  # which leaves the block, and no file
        table.finish()
    call.finish()


def _write(call: Call, logs: LogSet, options: Export, file: TableFile) -> None:
    """Export all logs, one after the other."""
    table = options.table or "strides"

    def export(log: Location, options: Export, progress: OnProgress) -> Measurement:
        measured = measure(log, options, progress)
        walk = Walk(log, measured, options)
        for each in walk.all_samples() if table == "samples" else [getattr(walk, table)]:
            file.add({"log": np.full(len(each), name_of(log), np.object_), **each.columns})
        return measured

    for _ in call.each(export, options, logs.paths, logs.names):
        call.add({})


def _dataset(call: Call, logs: LogSet, options: Export, name: str) -> NoReturn:
    """Measure the logs that are not in a dataset, or not as they are now; exit."""
    from dogbot_logtool.commands.tasks import measure_entry  # noqa: PLC0415
    from dogbot_logtool.report.dataset import dataset_at, parse_labels  # noqa: PLC0415 - loads pyarrow
    from dogbot_logtool.report.text.console import diagnostics  # noqa: PLC0415
    from dogbot_logtool.report.text.written_text import print_dataset  # noqa: PLC0415

    root = output_at(name, "", several=True).path.absolute()
    dataset = dataset_at(root, options, parse_labels(options.label))
    pending = dataset.begin(logs, prune=options.prune)
    call.add_unchanged(pending.unchanged)
    counts = Counter(unchanged=len(pending.unchanged))
    counts["damaged"] = sum(bool(code) for _, code in pending.unchanged)
    names = pending.log_set.names
    for done in call.each(measure_entry, options, pending.entries, names, "stats"):
        damaged = bool(done.damage.losses)
        dataset.write(done.entry, done.tables, damaged=damaged)
        counts.update(measured=1, damaged=damaged)
        call.add({})
    failures = dict(call.failures)
    for entry, log in zip(pending.entries, names, strict=True):
        if log in failures:
            dataset.write_failed(entry, failures[log])
    if not options.quiet:
        counts["failed"] = len(call.failures)
        print_dataset(diagnostics(), name_of(dataset.root), counts, pending.pruned)
    call.finish()
