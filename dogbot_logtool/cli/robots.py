"""The words of `robots`."""

import click

from dogbot_logtool.cli.options import json_option
from dogbot_logtool.io.plain_json import to_json


@click.command()
@click.argument("name", required=False)
@json_option
def robots(name: str | None, *, as_json: bool) -> None:
    """List the known robots, or print one's file to copy and edit."""
    from dogbot_logtool.robot import known_robots, load_robot, robot_toml  # noqa: PLC0415

    if name is not None:
        click.echo(robot_toml(name), nl=False)
        return
    known = {robot: load_robot(robot).description for robot in known_robots()}
    if as_json:
        click.echo(to_json(known, indent=2))
        return
    for robot, description in known.items():
        click.echo(f"{robot:<12}{description}")
