"""A metric's key stands in its record: what shows metrics takes them as attributes."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from dogbot_logtool.core.metrics import Stride, WalkMetrics
from dogbot_logtool.core.records import fields_of, metric_paths
from tests.paths import ROOT

PACKAGE: Final = ROOT / "dogbot_logtool"
ROOMS: Final = ("report", "comparison", "commands", "cli", "api")
PATHS: Final = {path.replace("[]", "") for path, _, _ in metric_paths(WalkMetrics)} | {
    field.name for field in fields_of(Stride)
}
FRAME: Final = {"schema_version", "null_because", "start_s", "end_s", "onset_s"}
"""Keys of the document, of its spans and events, which are no metrics."""
KEYS: Final = {key for path in PATHS for key in path.split(".") if "_" in key} - FRAME
OTHER: Final = {"documents.py", "info_report.py", "robot_file.py", "dataset.py", "walk.py"}
"""Files whose strings are keys of other things: of damage, topics, a robot's file, settings, and
of tables of poses and stances."""
MADE: Final = {"tables.py"}
"""The file that makes the table of strides."""


def nodes(kind: type[ast.AST]) -> Iterator[tuple[Path, ast.AST]]:
    for file in (file for room in ROOMS for file in (PACKAGE / room).rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, kind):
                yield file, node


def test_no_string_is_a_metrics_key() -> None:
    found = [
        (str(file.relative_to(PACKAGE)), node.value)
        for file, node in nodes(ast.Constant)
        if isinstance(node, ast.Constant)
        and file.name not in OTHER | MADE
        and isinstance(node.value, str)
        and " " not in node.value
        and set(node.value.split(".")) & KEYS
    ]
    assert found == []


def test_every_path_that_is_written_leads_to_a_metric() -> None:
    """``METRICS.gait.name`` in a report is one; of feet and the like any name may follow."""
    inner = {id(node.value) for _, node in nodes(ast.Attribute) if isinstance(node, ast.Attribute)}
    whole = [node for _, node in nodes(ast.Attribute) if id(node) not in inner]
    written = [ast.unparse(node) for node in whole if ast.unparse(node).startswith("METRICS.")]
    assert len(written) > 10
    for path in (re.sub(r"\[.*?\]", ".*", each).removeprefix("METRICS.") for each in written):
        member = re.sub(r"\.(median|min|max|value_in)\b", "", path)
        ends = {known for known in PATHS if known.startswith(member)}
        ends |= {known for known in PATHS if known.endswith(f"*.{member}")}
        assert ends, path
