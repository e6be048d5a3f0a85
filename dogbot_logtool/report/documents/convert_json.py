"""The summary of `convert` for scripts."""

from dataclasses import asdict
from typing import Any

from dogbot_logtool import __version__
from dogbot_logtool.io.storage import shown
from dogbot_logtool.report.documents.damage import damage_json
from dogbot_logtool.report.documents.finding_json import finding_json
from dogbot_logtool.results import Conversion


def conversion_json(done: Conversion) -> dict[str, Any]:
    """Return what was done as plain values."""
    return {
        "tool": {"name": "dogbot-logtool", "version": __version__},
        "input": shown(done.source),
        "output": shown(done.target),
        "container": done.container,
        "robot": done.robot.name,
        "style": done.style,
        "encoding": done.encoding,
        "topics": {
            "odometry": list(done.odometry_topics),
            "feet": {foot.name: foot.topic for foot in done.robot.feet},
        },
        "frames": {"world": done.world_frame, "base": done.base_frame},
        "messages": {"read": done.messages, "copied": done.copied},
        "annotations": dict(done.annotations),
        "skipped": {**asdict(done.counts.arrows), "bad_poses": done.counts.bad_poses},
        "findings": [finding_json(each) for each in done.findings],
        "damage": damage_json(done.damage),
    }
