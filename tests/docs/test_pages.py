"""The pages that are made of the program's tables are up to date, and the tables complete."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from dogbot_logtool.report.figures.document import DOCUMENT, STRIDE_ROWS
from dogbot_logtool.report.figures.figure import all_figures
from pages import PAGES

import dogbot_logtool as dl
from dogbot_logtool.finding import finding_kinds
from tests.commands.test_planned import GRF, Plan, figures, write
from tests.paths import ROOT, SAMPLE_LOGS
from tests.truth.commanded import ALL_KINDS, Commanded, commanded_walk
from tests.truth.gaits import WALK
from tests.truth.log_file import write_log
from tests.truth.sensed import pushed, with_imu
from tests.truth.walking import Walk

_CODE = re.compile(r'\bFinding\(\s*"([A-Z_]+)"')
_CAPITALS = re.compile(r'"([A-Z]{2,}(?:_[A-Z]+)+)"')


def codes_in_the_code() -> set[str]:
    texts = [file.read_text(encoding="utf-8") for file in (ROOT / "dogbot_logtool").rglob("*.py")]
    return {code for text in texts for code in _CODE.findall(text)}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_page_is_up_to_date(page: Path) -> None:
    assert page.read_text(encoding="utf-8") == PAGES[page](), "run: make docs"


def leaves(value: Any, path: str = "") -> Iterator[str]:
    """Paths of everything in a document that is neither an object nor a list of objects."""
    if isinstance(value, dict) and set(value) != {"n", "mean", "std", "median", "min", "max"}:
        for key, each in value.items():
            yield from leaves(each, f"{path}/{key}")
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for each in value:
            yield from leaves(each, f"{path}[]")
    else:
        yield path.removeprefix("/")


def pattern(path: str) -> re.Pattern[str]:
    """What matches the paths of a figure; names may hold dots and slashes."""
    return re.compile(re.escape(path).replace(r"\*", ".+").replace(r"\.", "/"))


def null_objects(path: str) -> Iterator[str]:
    """The objects and lists in which a figure is: where they are null or empty, it is missing."""
    while "." in path:
        path = path.rpartition(".")[0]
        yield path.removesuffix("[]")


def test_the_table_holds_every_key_of_real_documents_and_no_other(tmp_path: Path) -> None:
    found = set(leaves(figures(write(tmp_path, GRF, Plan(2)))))
    robot = Commanded(ALL_KINDS, seconds=18.0)
    log = write_log(commanded_walk(robot, robot.commands()), tmp_path / "commanded.mcap")
    found |= set(leaves(figures(log)))
    walk = Walk(gait=WALK, seconds=12.0).recorded(200.0, 100.0)
    sensed = with_imu(pushed(walk, (0.6, 0.3, 0.0), 5.0))
    log = write_log(sensed, tmp_path / "sensed.mcap")
    found |= set(leaves(dl.measure(log, mass=20.0, wrench_frame="world").stats))
    for golden in SAMPLE_LOGS.glob("golden/*.stats.json"):
        found |= set(leaves(json.loads(golden.read_text(encoding="utf-8"))))
    paths = [path for path, _ in all_figures(DOCUMENT)]
    known = [pattern(each) for path in paths for each in (path, *null_objects(path))]
    assert {each for each in found if not any(one.fullmatch(each) for one in known)} == set()
    missing = {path for path in paths if not any(map(pattern(path).fullmatch, found))}
    assert missing == set()


def test_every_figure_says_what_it_is() -> None:
    figures = [*all_figures(DOCUMENT), *all_figures(STRIDE_ROWS)]
    assert len(figures) > 150
    for path, figure in figures:
        assert figure.definition, path
        assert not figure.definition.endswith("."), path


def capitals_in_the_code() -> set[str]:
    texts = [file.read_text(encoding="utf-8") for file in (ROOT / "dogbot_logtool").rglob("*.py")]
    return {word for text in texts for word in _CAPITALS.findall(text)}


def test_every_word_in_capitals_is_a_declared_code() -> None:
    """Codes are also taken from tables."""
    names = finding_kinds().keys()
    assert capitals_in_the_code() - names == {"BATCH_SIZE", "OPENBLAS_NUM_THREADS", "SEEK_DATA"}


def test_every_code_is_declared() -> None:
    codes = codes_in_the_code()
    assert len(codes) > 60
    assert codes - finding_kinds().keys() == set()


def test_every_finding_says_what_to_do() -> None:
    """A remedy is something that a person can do, in a sentence."""
    idle = [
        code
        for code, kind in finding_kinds().items()
        if not kind.remedy.endswith(".") or kind.remedy.startswith("Nothing")
    ]
    assert idle == []


def test_every_declared_code_is_used() -> None:
    names = finding_kinds().keys()
    texts = [file.read_text(encoding="utf-8") for file in (ROOT / "dogbot_logtool").rglob("*.py")]
    unused = {name for name in names if not any(name in text for text in texts)}
    assert unused == set()
