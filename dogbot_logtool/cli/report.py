"""`report` on the command line."""

from typing import NoReturn

import click

from dogbot_logtool.cli.call import Call
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.output import may_be_several, output_at
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.options.report import Report
from dogbot_logtool.report.comparison_report import gait_comparison_json
from dogbot_logtool.report.documents import page_json
from dogbot_logtool.report.page import require_libraries
from dogbot_logtool.report.text.console import diagnostics
from dogbot_logtool.report.text.written_text import print_comparison_page, print_page


def run(options: Report) -> NoReturn:
    """Write the page of each log; or one of two sides."""
    require_libraries()
    from dogbot_logtool.commands.report import Reports  # noqa: PLC0415 - needs them

    call = Call(options)
    if options.against:
        _against(call, options)
    logs, options = call.joined_logs(options)
    several = not options.join and may_be_several(options.logs, logs.paths)
    where = output_at(options.output, ".report.html", several=several)
    reports = Reports(logs.paths, where, overwrite=options.overwrite)
    # One after the other, since the index needs them all.
    for done in call.each(reports.write, options, logs.paths, logs.names):
        call.add(page_json(done))
        if not options.quiet:
            print_page(diagnostics(), done, verbose=options.verbose)
    reports.finish(dict(call.failures))
    call.finish(as_json=options.json)


def _against(call: Call, options: Report) -> NoReturn:
    """Write a page that compares two sides; exit."""
    from dogbot_logtool.commands.report_against import (  # noqa: PLC0415 - needs its libraries
        ENDING,
        comparison_target,
        report_against,
    )

    if options.join:
        raise CallError("--join and --against: choose one")
    sides = [call.logs(options.logs), call.logs(options.against)]
    where = output_at(options.output, ENDING, several=False)
    target = comparison_target(where, *(each.paths for each in sides), overwrite=options.overwrite)
    first, second = call.sides(sides, options)
    done = report_against(first, second, target, overwrite=options.overwrite)
    if options.json:
        found = {"output": name_of(done.target), "bytes": done.size}
        click.echo(to_json({**found, **gait_comparison_json(done.found)}, indent=2))
    if not options.quiet:
        print_comparison_page(diagnostics(), name_of(done.target), done.size, done.found)
    call.finish()
