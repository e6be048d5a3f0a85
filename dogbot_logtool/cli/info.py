"""`info` on the command line."""

from dataclasses import replace
from functools import partial
from typing import NoReturn

from dogbot_logtool.cli.call import Call
from dogbot_logtool.commands.info import describe
from dogbot_logtool.options import Info
from dogbot_logtool.report.info_report import info_json, print_info
from dogbot_logtool.report.text.console import results


def run(options: Info) -> NoReturn:
    """Print what is in each log."""
    call = Call(options)
    logs, options = call.joined_logs(options)
    runner = call.runner("info", len(logs.paths))
    work = partial(describe, options=replace(options, jobs=runner.jobs))
    for found in call.each(work, logs.paths, logs.names, runner):
        call.add(info_json(found))
        if not options.json:
            print_info(results(), found)
    call.finish(as_json=options.json)
