"""`robots` on the command line."""

import re
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import click

from dogbot_logtool.cli.call import Call, write
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.io.printable import shell_joined
from dogbot_logtool.option import part_of
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.robots import Robots
from dogbot_logtool.robot.robot import known_robots, load_robot, robot_toml


def run(options: Robots) -> None:
    """List the known robots, print the file of one, or draft one from a log."""
    name, *logs = options.words or ("",)
    if name == "new" and not logs:
        raise CallError("robots new: name the log, as in 'dogbot-logtool robots new walk.mcap'")
    if name == "new":
        if len(logs) > 1 and not options.join:
            raise CallError("robots new: name one log; with --join, several files of one recording")
        _new(options, *map(Path, logs))
    if logs or options.output is not None or options.join:
        raise CallError("robots: a log, -o and --join go with 'new' only")
    if name:
        click.echo(robot_toml(name), nl=False)
        return
    known = {robot: load_robot(robot).description for robot in known_robots()}
    if options.json:
        click.echo(to_json(known, indent=2))
        return
    width = max(map(len, known)) + 2
    for each, description in known.items():
        click.echo(f"{each:<{width}}{description}")


def _new(options: Robots, log: Path, *others: Path) -> NoReturn:
    """Draft the file of a log's robot; exit."""
    from dogbot_logtool.commands.new_robot import new_robot  # noqa: PLC0415
    from dogbot_logtool.io.output import output_file  # noqa: PLC0415

    call = Call(options)
    target = output_file(options.output, (log, *others), overwrite=options.overwrite)
    stem = (target or log).stem
    name = re.sub(r"[^A-Za-z0-9]+", "_", stem).strip("_") or "robot"
    measuring = replace(part_of(options, MeasureOptions), joined=others)
    found = new_robot(log, name, measuring)
    call.add_damage(found.damage)
    write(found.text.encode(), target, overwrite=options.overwrite)
    if not options.quiet:
        for other in found.runners_up[:3]:
            click.echo(f"not chosen: {other.told}", err=True)
        files = [str(log), *map(str, others), *(["--join"] if others else [])]
        words = ["dogbot-logtool", "stats", *files, "--robot", str(target or "robot.toml")]
        click.echo(f"  {shell_joined(words)}", err=True)
    call.finish()
