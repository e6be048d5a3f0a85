"""`stats` on the command line."""

from functools import partial
from pathlib import Path
from typing import NoReturn

from dogbot_logtool.cli.call import Call
from dogbot_logtool.commands.tasks import figures
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.output import output_file
from dogbot_logtool.io.printable import printable
from dogbot_logtool.options.stats import Stats
from dogbot_logtool.results import Figures, Measurement


def run(options: Stats) -> NoReturn:
    """Measure logs, and print what they come to."""
    call = Call(options)
    logs, options = call.joined_logs(options)
    target = output_file(options.figure, logs.paths, overwrite=options.overwrite)
    if target is not None:
        from dogbot_logtool.commands.plot import refuse_bad_figure  # noqa: PLC0415

        refuse_bad_figure(target, logs.paths, overwrite=options.overwrite)
    elif options.overwrite:
        raise CallError("--overwrite goes with --figure")
    is_one = len(logs.paths) == 1
    work = partial(figures, whole=is_one, as_json=options.json, detail=options.verbose)
    measured: list[Figures] = []
    for done in call.each(work, options, logs.paths, logs.names, "stats"):
        call.add(done.json)
        if done.whole is not None and target is not None:
            _draw(done.whole, target, options)
        measured.append(done)
    if not options.json and measured:
        _print(measured, verbose=options.verbose)
    call.finish(as_json=options.json)


def _draw(measured: Measurement, target: Path, options: Stats) -> None:
    """Draw the figure, and print which time it shows."""
    from dogbot_logtool.commands.plot import draw_figure  # noqa: PLC0415
    from dogbot_logtool.report.text.console import diagnostics, print_sentence  # noqa: PLC0415

    start, end = draw_figure(measured, target, overwrite=options.overwrite)
    if not options.quiet:
        print_sentence(diagnostics(), printable(f"{target}: {start:.2f} to {end:.2f} s"))


def _print(measured: list[Figures], *, verbose: bool) -> None:
    """Print the report of one log, or a summary of several."""
    from dogbot_logtool.report.text.console import results  # noqa: PLC0415 - rich costs 40 ms
    from dogbot_logtool.report.text.stats_text import print_report, print_summary  # noqa: PLC0415

    one = measured[0].whole
    if one is not None:
        print_report(results(), one, verbose=verbose)
    else:
        rows, damage = zip(*((done.summary, done.damage) for done in measured), strict=True)
        print_summary(results(), rows, damage)
