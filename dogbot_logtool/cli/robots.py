"""The words of `robots`."""

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from dogbot_logtool.cli.options import (
    join_option,
    json_option,
    output_file,
    overwrite_option,
    quiet_option,
    topic_options,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.io.printable import shell_joined

if TYPE_CHECKING:
    from dogbot_logtool.robot.options import TopicOptions


@click.command()
@click.argument("name", required=False)
@click.argument("logs", nargs=-1, metavar="[LOG...]", type=click.Path(path_type=Path))
@join_option
@click.option(
    "-o", "--output", type=output_file, metavar="FILE.toml", help="Of new; default: stdout."
)
@overwrite_option
@topic_options
@json_option
@quiet_option
def robots(
    name: str | None,
    logs: tuple[Path, ...],
    output: Path | None,
    topics: "TopicOptions",
    *,
    join: bool,
    overwrite: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """List the known robots, or print one's file to copy and edit.

    `robots new LOG` writes a robot's file from a log, with the evidence as comments. Feet are
    looked for in messages of any type.
    """
    from dogbot_logtool.robot.robot import known_robots, load_robot, robot_toml  # noqa: PLC0415

    if name == "new" and logs:
        log, *others = logs
        if others and not join:
            raise CallError("robots new: name one log; with --join, several files of one recording")
        joined = replace(topics, joined=tuple(others))
        _new(log, output, joined, overwrite=overwrite, quiet=quiet)
        return
    if name == "new":
        raise CallError("robots new: name the log, as in 'dogbot-logtool robots new walk.mcap'")
    if logs or output is not None or join:
        raise CallError("robots: a log, -o and --join go with 'new' only")
    if name is not None:
        click.echo(robot_toml(name), nl=False)
        return
    known = {robot: load_robot(robot).description for robot in known_robots()}
    if as_json:
        click.echo(to_json(known, indent=2))
        return
    width = max(map(len, known)) + 2
    for each, description in known.items():
        click.echo(f"{each:<{width}}{description}")


def _new(
    log: Path, output: Path | None, options: "TopicOptions", *, overwrite: bool, quiet: bool
) -> None:
    from dogbot_logtool.commands.new_robot import new_robot  # noqa: PLC0415
    from dogbot_logtool.io.output import refuse_bad_target, whole_file  # noqa: PLC0415
    from dogbot_logtool.io.targets import refuse_other_format  # noqa: PLC0415

    if output is not None:
        refuse_other_format(output, ".toml")
        for source in (log, *options.joined):
            refuse_bad_target(output, source, overwrite=overwrite)
    stem = (output or log).stem
    outcomes = Outcomes(quiet=quiet)
    found = new_robot(log, re.sub(r"[^A-Za-z0-9]+", "_", stem).strip("_") or "robot", options)
    outcomes.add_damage(found.damage)
    if output is None:
        click.echo(found.text, nl=False)
    else:
        with whole_file(output, overwrite=overwrite) as file:
            file.write(found.text.encode())
    if quiet:
        outcomes.finish()
    for other in found.runners_up[:3]:
        click.echo(f"not chosen: {other.fields} ({other.reasons})", err=True)
    file_name = str(output or "robot.toml")
    files = [str(log), *map(str, options.joined), *(["--join"] if options.joined else [])]
    command = shell_joined(["dogbot-logtool", "stats", *files, "--robot", file_name])
    click.echo(f"  {command}", err=True)
    outcomes.finish()
