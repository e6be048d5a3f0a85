"""A log flows one way, reader -> core -> writer: who may import whom."""

import ast
import sys
from pathlib import Path
from typing import Final

import pytest

import dogbot_logtool

PACKAGE: Final = "dogbot_logtool"
ROOT: Final = Path(dogbot_logtool.__file__).parent
MODULES: Final = sorted(ROOT.rglob("*.py"))

COMMANDS: Final = (
    "cli",
    "compare",
    "convert",
    "frames",
    "info",
    "layout",
    "plot",
    "stats",
    "__main__",
)
LAYERS: Final = ("core", "reader", "writer")


def name_of(file: Path) -> str:
    """The dotted name of a module, ``__init__`` left out."""
    parts = file.relative_to(ROOT.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports_of(file: Path) -> set[str]:
    """Every module that a file imports: at its top, in functions, and for types only."""
    imported = set()
    package = file.parent.relative_to(ROOT.parent).parts
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            imported |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            module = ".".join([*above, *filter(None, [node.module])])
            # What is imported may be a module itself: `from dogbot_logtool import cli`.
            imported |= {module} | {f"{module}.{alias.name}" for alias in node.names}
    return imported


def files_of(layer: str) -> list[Path]:
    return sorted((ROOT / layer).rglob("*.py"))


def is_within(module: str, *packages: str) -> bool:
    return any(f"{module}.".startswith(f"{package}.") for package in packages)


def test_there_is_something_to_look_at() -> None:
    for layer in LAYERS:
        assert len(files_of(layer)) > 3
    assert imports_of(ROOT / "core" / "loads.py") >= {
        "dataclasses",
        "numpy",
        "dogbot_logtool.core.contact.contacts",
        "dogbot_logtool.core.contact.contacts.Samples",
    }


def test_relative_imports_are_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / PACKAGE / "core" / "odd.py"
    file.parent.mkdir(parents=True)
    file.write_text(
        "from . import arrays\nfrom ..reader import log\ndef f():\n    import rosbags.typesys\n"
    )
    monkeypatch.setattr(sys.modules[__name__], "ROOT", tmp_path / PACKAGE)

    assert name_of(file) == "dogbot_logtool.core.odd"
    assert imports_of(file) == {
        "dogbot_logtool.core",
        "dogbot_logtool.core.geometry.arrays",
        "dogbot_logtool.reader",
        "dogbot_logtool.reader.containers.log",
        "rosbags.typesys",
    }


@pytest.mark.parametrize("file", files_of("core"), ids=name_of)
def test_core_imports_numpy_the_standard_library_and_core_only(file: Path) -> None:
    allowed = {"numpy", *sys.stdlib_module_names}

    strangers = {
        module
        for module in imports_of(file)
        if module.split(".")[0] not in allowed and not is_within(module, f"{PACKAGE}.core")
    }

    assert strangers == set()


@pytest.mark.parametrize("file", files_of("reader"), ids=name_of)
def test_the_reader_does_not_import_the_writer(file: Path) -> None:
    assert not [module for module in imports_of(file) if is_within(module, f"{PACKAGE}.writer")]


@pytest.mark.parametrize("file", files_of("writer"), ids=name_of)
def test_the_writer_does_not_import_the_reader(file: Path) -> None:
    assert not [module for module in imports_of(file) if is_within(module, f"{PACKAGE}.reader")]


@pytest.mark.parametrize("layer", LAYERS)
def test_no_layer_imports_a_command_or_a_report(layer: str) -> None:
    forbidden = [f"{PACKAGE}.{name}" for name in (*COMMANDS, "report")]

    found = {
        f"{name_of(file)} imports {module}"
        for file in files_of(layer)
        for module in imports_of(file)
        if is_within(module, *forbidden)
    }

    assert found == set()


@pytest.mark.parametrize(
    "file",
    [
        file
        for file in MODULES
        if not is_within(name_of(file), f"{PACKAGE}.cli", f"{PACKAGE}.__main__")
    ],
    ids=name_of,
)
def test_only_the_command_line_knows_click_and_itself(file: Path) -> None:
    assert not [
        module for module in imports_of(file) if is_within(module, "click", f"{PACKAGE}.cli")
    ]
