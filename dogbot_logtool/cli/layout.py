"""The words of `layout`."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from dogbot_logtool.cli.options import output_file, overwrite_option, quiet_option, topic_options
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.report.layouts import DEFAULT_VIEWER, VIEWERS

if TYPE_CHECKING:
    from dogbot_logtool.robot.options import TopicOptions


@click.command()
@click.argument("log", required=False, type=click.Path(path_type=Path))
@click.option("-o", "--output", type=output_file, metavar="FILE", help="Default: stdout.")
@click.option(
    "--viewer",
    type=click.Choice(list(VIEWERS)),
    default=DEFAULT_VIEWER,
    show_default=True,
    help=", ".join(f"{each.name} ({each.summary})" for each in VIEWERS.values()) + ".",
)
@overwrite_option
@topic_options
@quiet_option
def layout(
    log: Path | None,
    output: Path | None,
    viewer: str,
    topics: "TopicOptions",
    *,
    overwrite: bool,
    quiet: bool,
) -> None:
    """Print a viewer's layout: the robot, its loads, its gait diagram.

    The feet are those of the robot (default: dogbot), or those found in LOG.
    """
    from dogbot_logtool.commands.layout import view_of  # noqa: PLC0415
    from dogbot_logtool.io.output import refuse_bad_target, whole_file  # noqa: PLC0415
    from dogbot_logtool.io.targets import refuse_other_format  # noqa: PLC0415

    outcomes = Outcomes(quiet=quiet)
    chosen = VIEWERS[viewer]
    if output is not None:
        refuse_other_format(output, chosen.suffix)
        refuse_bad_target(output, log, overwrite=overwrite)
    view = view_of(log, topics)
    outcomes.add_damage(view.damage)
    content = chosen.layout(view)
    if output is None:
        click.echo(content.decode(), nl=False)
    else:
        with whole_file(output, overwrite=overwrite) as file:
            file.write(content)
    outcomes.finish()
