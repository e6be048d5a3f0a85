"""The words of `info`."""

from pathlib import Path

import click

from dogbot_logtool.cli.options import json_option, logs_argument, parse_topics, topic_options
from dogbot_logtool.cli.outcomes import Outcomes


@click.command()
@logs_argument
@topic_options
@json_option
def info(
    logs: tuple[Path, ...],
    robot: str | None,
    odom_topic: str | None,
    feet: tuple[str, ...],
    mass_kg: float | None,
    *,
    as_json: bool,
) -> None:
    """Show what is in a log, what will be used for what, and what is wrong with it."""
    from dogbot_logtool.info import describe  # noqa: PLC0415
    from dogbot_logtool.report.console import results  # noqa: PLC0415
    from dogbot_logtool.report.info_report import info_json, print_info  # noqa: PLC0415

    options = parse_topics(robot, odom_topic, feet, mass_kg)
    outcomes = Outcomes()
    for source in logs:
        with outcomes.of(source):
            found = describe(source, options)
            outcomes.add(info_json(found), found.exit_code)
            if not as_json:
                print_info(results(), found)
    outcomes.finish(as_json=as_json)
