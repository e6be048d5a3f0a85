"""`layout` on the command line."""

from pathlib import Path
from typing import NoReturn

import click

from dogbot_logtool.cli.call import Call
from dogbot_logtool.commands.layout import view_of
from dogbot_logtool.io.output import refuse_bad_target, whole_file
from dogbot_logtool.io.targets import output_file
from dogbot_logtool.options import Layout
from dogbot_logtool.report.layouts import VIEWERS


def run(options: Layout) -> NoReturn:
    """Print a viewer's layout."""
    call = Call(options)
    viewer = VIEWERS[options.viewer]
    log = None if options.log is None else Path(options.log)
    target = output_file(options.output, viewer.suffix)
    if target is not None:
        refuse_bad_target(target, log, overwrite=options.overwrite)
    view = view_of(log, options)
    call.add_damage(view.damage)
    content = viewer.layout(view)
    if target is None:
        click.echo(content.decode(), nl=False)
    else:
        with whole_file(target, overwrite=options.overwrite) as file:
            file.write(content)
    call.finish()
