"""`convert` on the command line."""

from typing import NoReturn

from dogbot_logtool.cli.call import Call
from dogbot_logtool.commands.tasks import conversion_tasks, convert_task
from dogbot_logtool.io.output import may_be_several, output_at, targets
from dogbot_logtool.options.convert import Convert
from dogbot_logtool.report.documents import conversion_json

_ENDING = ".annotated.mcap"


def run(options: Convert) -> NoReturn:
    """Write the annotated MCAP of each log."""
    call = Call(options)
    logs, options = call.joined_logs(options)
    several = not options.join and may_be_several(options.logs, logs.paths)
    where = output_at(options.output, _ENDING, several=several)
    if options.scheduler is not None:
        where = where._replace(path=where.path.absolute())
    pairs = targets(logs.paths, where, _ENDING, [log.below for log in logs.logs])
    tasks = conversion_tasks(pairs, options)
    for done in call.each(convert_task, options, tasks, logs.names, "convert"):
        call.add(conversion_json(done) if options.json else {})
        if not options.quiet:
            from dogbot_logtool.report.text.console import diagnostics  # noqa: PLC0415 - rich costs 40 ms
            from dogbot_logtool.report.text.written_text import print_conversion  # noqa: PLC0415

            print_conversion(diagnostics(), done, verbose=options.verbose)
    call.finish(as_json=options.json)
