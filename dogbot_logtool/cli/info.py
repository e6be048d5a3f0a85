"""`info` on the command line."""

from typing import NoReturn

from dogbot_logtool.cli.call import Call
from dogbot_logtool.commands.info import describe
from dogbot_logtool.options.info import Info
from dogbot_logtool.report.info_report import info_json, print_info
from dogbot_logtool.report.text.console import results


def run(options: Info) -> NoReturn:
    """Print what is in each log."""
    call = Call(options)
    logs, options = call.joined_logs(options)
    for found in call.each(describe, options, logs.paths, logs.names, "info"):
        call.add(info_json(found))
        if not options.json:
            print_info(results(), found)
    call.finish(as_json=options.json)
