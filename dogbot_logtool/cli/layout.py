"""`layout` on the command line."""

from pathlib import Path
from typing import NoReturn

from dogbot_logtool.cli.call import Call, write
from dogbot_logtool.commands.layout import view_of
from dogbot_logtool.io.output import output_file
from dogbot_logtool.options.layout import Layout
from dogbot_logtool.report.layouts import layout_file


def run(options: Layout) -> NoReturn:
    """Print a viewer's layout."""
    call = Call(options)
    log = None if options.log is None else Path(options.log)
    inputs = [log] if log else []
    target = output_file(options.output, inputs, overwrite=options.overwrite)
    view = view_of(log, options)
    call.add_damage(view.damage)
    write(layout_file(options.viewer, view), target, overwrite=options.overwrite)
    call.finish()
