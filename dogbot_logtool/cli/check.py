"""`check` on the command line."""

from typing import NoReturn

import click

from dogbot_logtool.cli.call import Call, write
from dogbot_logtool.commands.check import check, exit_code, read_limits
from dogbot_logtool.comparison.judge import Judgement
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.output import output_file
from dogbot_logtool.io.printable import printable
from dogbot_logtool.options.check import Check
from dogbot_logtool.report.check_report import check_json, check_junit, print_check
from dogbot_logtool.report.documents import damage_json
from dogbot_logtool.report.text.console import results


def run(options: Check) -> NoReturn:
    """Judge each log; or print limits that all of them pass."""
    if (options.limits is None) != options.suggest:
        raise CallError("check needs one of --limits FILE.toml and --suggest")
    call = Call(options)
    if options.limits is None:
        _suggest(call, options)
    limits = read_limits(options.limits, options.baseline)
    logs, options = call.joined_logs(options)
    junit = output_file(options.junit, logs.paths, overwrite=options.overwrite)
    checked: dict[str, list[Judgement]] = {}
    for done in call.measured(logs, options):
        name = done.json["log"]["path"]
        judgements = checked[name] = check(done.json, limits)
        document = {**check_json(name, judgements), "damage": damage_json(done.damage)}
        call.add(document, exit_code(judgements))
        if not options.json:
            print_check(results(), name, judgements, verbose=options.verbose)
    if junit is not None:
        write(check_junit(checked, dict(call.failures)), junit, overwrite=options.overwrite)
    call.finish(as_json=options.json)


def _suggest(call: Call, options: Check) -> NoReturn:
    """Print limits that all logs pass."""
    from dogbot_logtool.comparison.suggestion import doubts, suggest_limits  # noqa: PLC0415

    if options.baseline or options.junit or options.json:
        raise CallError("--suggest prints a limits file; it goes with none of the other outputs")
    logs, options = call.joined_logs(options)
    documents = {}
    for done in call.measured(logs, options):
        documents[done.json["log"]["path"]] = done.json
        call.add(done.json)
    names, runs = [printable(name) for name in documents], list(documents.values())
    if runs:
        click.echo(suggest_limits(runs, names), nl=False)
        for doubt in doubts(runs, names):
            click.echo(f"warning: {doubt}", err=True)
    call.finish()
