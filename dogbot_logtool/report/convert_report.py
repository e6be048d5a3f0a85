"""The summary of `convert` for people and for scripts."""

from dataclasses import asdict
from typing import Any

from rich.console import Console
from rich.text import Text

from dogbot_logtool import __version__
from dogbot_logtool.convert import Conversion
from dogbot_logtool.printable import printable
from dogbot_logtool.report.console import print_findings
from dogbot_logtool.report.damage import damage_json, print_damage
from dogbot_logtool.storage import shown


def conversion_json(done: Conversion) -> dict[str, Any]:
    """Return what was done as plain values."""
    plan = done.plan
    robot = plan.selection.robot
    return {
        "tool": {"name": "dogbot-logtool", "version": __version__},
        "input": shown(done.source),
        "output": shown(done.target),
        "container": done.container,
        "robot": robot.name,
        "style": plan.options.style,
        "encoding": plan.options.encoding,
        "topics": {
            "odometry": sorted({channel.topic for channel in plan.selection.odometry}),
            "feet": {foot.name: foot.topic for foot in robot.feet},
        },
        "frames": {"world": plan.world_frame, "base": plan.base_frame},
        "messages": {"read": done.counts.messages, "copied": done.copied},
        "annotations": dict(done.annotations),
        "skipped": {**asdict(done.counts.arrows), "bad_poses": done.counts.bad_poses},
        "findings": [
            {"code": f.code, "text": f.text, "where": f.where or None} for f in done.findings
        ],
        "damage": damage_json(done.losses),
    }


def print_conversion(console: Console, done: Conversion, *, verbose: bool) -> None:
    """Print what was done."""
    added = sum(done.annotations.values())
    name = printable(shown(done.target))
    line = f": {done.copied:,} recorded messages and {added:,} annotations"
    console.print(Text.assemble(Text(name, style="bold"), line), soft_wrap=True)
    if verbose:
        for topic, count in done.annotations.items():
            console.print(f"         {count:>9,}  {printable(topic)}", soft_wrap=True)
    print_findings(console, done.findings)
    print_damage(console, done.losses)
