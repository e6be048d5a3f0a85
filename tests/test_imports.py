"""Which room may import which, and that paths of metrics lead to one."""

import ast
import re
import sys
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Final

import pytest

import dogbot_logtool
from dogbot_logtool.core.metrics import Stride, WalkMetrics
from dogbot_logtool.core.records import fields_of, metric_paths

PACKAGE: Final = "dogbot_logtool"
ROOT: Final = Path(dogbot_logtool.__file__).parent
MODULES: Final = sorted(ROOT.rglob("*.py"))
FLOORS: Final = (
    ("__main__",),
    ("cli",),
    ("api",),
    ("commands",),
    ("report",),
    ("comparison",),
    ("results",),
    ("conversion",),
    ("robot",),
    ("options",),
    ("run",),
    ("reader",),
    ("writer", "io"),
    ("core",),
    ("option",),
    ("errors", "finding", "mcap_layout", "signals"),
    ("extras",),
)
"""Rooms, the highest first. A room imports only rooms on floors below its own."""
ALONE: Final = {"core": {"finding"}}
"""What else rooms may import that are to stand on their own."""
SIDEWAYS: Final = {("writer", "io")}
"""Rooms of one floor of which the first may import the second."""


def name_of(file: Path) -> str:
    """The dotted name of a module, ``__init__`` left out."""
    parts = file.relative_to(ROOT.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def imports_of(file: Path) -> frozenset[str]:
    """Every module that a file imports: at its top, in functions, and for types only."""
    imported: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            imported |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            # Linting refuses relative ones; what is imported may be a module itself:
            # `from dogbot_logtool import cli`.
            imported |= {f"{node.module}.{alias.name}" for alias in node.names}
            imported.add(str(node.module))
    return frozenset(imported)


def is_module(name: str) -> bool:
    path = ROOT.parent.joinpath(*name.split("."))
    return path.is_dir() or path.with_suffix(".py").is_file()


def own_imports(file: Path) -> Iterator[str]:
    """The modules of the package that a file imports, without the package's own name."""
    for name in imports_of(file):
        if name.startswith(f"{PACKAGE}.") and is_module(name):
            yield name.removeprefix(f"{PACKAGE}.")


def floor_of(room: str) -> int:
    return next(number for number, rooms in enumerate(FLOORS) if room in rooms)


def room_of(file: Path) -> str:
    return file.relative_to(ROOT).with_suffix("").parts[0]


FILES: Final = [file for file in MODULES if file != ROOT / "__init__.py"]


def test_there_is_something_to_look_at() -> None:
    rooms = {room_of(file) for file in FILES}
    assert rooms == {room for floor in FLOORS for room in floor}
    assert set(own_imports(ROOT / "core" / "scene" / "feet.py")) >= {
        "core.contact.contacts",
        "core.arrays",
    }


def test_rooms_import_rooms_below_them() -> None:
    assert [
        f"{name_of(file)} imports {name}"
        for file in FILES
        for name in own_imports(file)
        if (other := name.split(".")[0]) != (room := room_of(file))
        and (room, other) not in SIDEWAYS
        and (floor_of(other) <= floor_of(room) or other not in ALONE.get(room, {other}))
    ] == []


def test_libraries_stay_in_their_rooms() -> None:
    """The core knows numpy and the standard library only, and only the command line knows click."""
    of_core = {PACKAGE, "numpy", *sys.stdlib_module_names}
    assert [
        f"{name_of(file)} imports {name}"
        for file in FILES
        for name in imports_of(file)
        if (
            (library := name.split(".")[0]) and (room_of(file) == "core" and library not in of_core)
        )
        or (room_of(file) not in {"cli", "__main__"} and library == "click")
    ] == []


@pytest.mark.parametrize("room", ["core", "reader"])
def test_no_part_of_a_room_imports_itself_through_another(room: str) -> None:
    graph: dict[str, set[str]] = defaultdict(set)
    for file in (ROOT / room).rglob("*.py"):
        part = _part(name_of(file).removeprefix(f"{PACKAGE}."))
        names = (name for name in own_imports(file) if name.startswith(f"{room}."))
        graph[part] |= {_part(name) for name in names} - {part, room}
    TopologicalSorter(graph).prepare()  # raises an error that names a circle


def _part(name: str) -> str:
    return ".".join(name.split(".")[:2])


# --- Paths of metrics -----------------------------------------------------------------------------


PATHS: Final = {path.replace("[]", "") for path, _, _ in metric_paths(WalkMetrics)} | {
    field.name for field in fields_of(Stride)
}


def attributes() -> Iterator[ast.Attribute]:
    for file in MODULES:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Attribute):
                yield node


def test_every_path_that_is_written_leads_to_a_metric() -> None:
    """``METRICS.gait.name`` in a report is one; of feet and the like any name may follow."""
    found = list(attributes())
    inner = {id(node.value) for node in found}
    whole = (ast.unparse(node) for node in found if id(node) not in inner)
    written = [each for each in whole if each.startswith("METRICS.")]
    assert len(written) > 10
    for path in (re.sub(r"\[.*?\]", ".*", each).removeprefix("METRICS.") for each in written):
        member = re.sub(r"\.(median|min|max|value_in)\b", "", path)
        ends = {known for known in PATHS if known.startswith(member)}
        ends |= {known for known in PATHS if known.endswith(f"*.{member}")}
        assert ends, path
