"""The pages that are made of the program's tables are up to date, and the tables complete."""

import json
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final

import pytest
from pages import PAGES

import dogbot_logtool as dl
from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.core.records import metric_paths
from dogbot_logtool.finding import finding_kinds
from tests.commands.test_planned import GRF, Plan, figures, write
from tests.paths import ROOT, SAMPLE_LOGS
from tests.truth.commanded import Commanded, commanded_walk
from tests.truth.gaits import WALK
from tests.truth.log_file import write_log
from tests.truth.sensed import pushed, with_imu
from tests.truth.walking import Walk

_CODE = re.compile(r'\b(?:Finding|found)\(\s*"([A-Z_]+)"')
_CAPITALS = re.compile(r'"([A-Z]{2,}(?:_[A-Z]+)+)"')


def program() -> str:
    files = (ROOT / "dogbot_logtool").rglob("*.py")
    return "\n".join(file.read_text(encoding="utf-8") for file in files)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_page_is_up_to_date(page: Path) -> None:
    assert page.read_text(encoding="utf-8") == PAGES[page](), "run: make docs"


def test_every_metric_is_measured_of_some_log(tmp_path: Path) -> None:
    documents = [figures(write(tmp_path, GRF, Plan(2)))]
    robot = Commanded(seconds=18.0)
    log = write_log(commanded_walk(robot, robot.commands()), tmp_path / "commanded.mcap")
    documents.append(figures(log))
    walk = Walk(gait=WALK, seconds=12.0).recorded(200.0, 100.0)
    sensed = with_imu()(pushed((0.6, 0.3, 0.0), 5.0)(walk))
    log = write_log(sensed, tmp_path / "sensed.mcap")
    documents.append(dl.measure(log, mass=20.0, set={"wrench_frame": "world"}).stats)
    goldens = SAMPLE_LOGS.glob("golden/*.stats.json")
    documents += [json.loads(golden.read_text(encoding="utf-8")) for golden in goldens]
    known = {path for document in documents for path in told(document)}
    wanted = [(path, pattern(path)) for path, _, _ in metric_paths(WalkMetrics)]
    unmeasured = {path for path, one in wanted if not any(map(one.fullmatch, known))}
    assert unmeasured == NOT_IN_THESE_LOGS


def told(document: object, path: str = "") -> Iterator[str]:
    """The paths of a document that are not null."""
    items: Iterable[tuple[object, object]] = ()
    if isinstance(document, dict):
        items = document.items()
    elif isinstance(document, list):
        items = enumerate(document)
    for key, value in items:
        if value is not None:
            yield f"{path}{key}"
            yield from told(value, f"{path}{key}.")


NOT_IN_THESE_LOGS: Final = {
    # two feet, joint limits, an offset of the centre of mass, legs at 100 Hz
    "gait.double_support_fraction",
    "gait.segments[].gait.double_support_fraction",
    "legs.joints.*.near_limit_fraction",
    "settings.com_offset_m",
    "feet.*.touchdown_along_mps",
    "feet.*.touchdown_down_mps",
    "gait.segments[].feet.*.touchdown_along_mps",
    "gait.segments[].feet.*.touchdown_down_mps",
    # over the whole log only
    "gait.segments[].feet.*.height_over_stride_m",
    "gait.segments[].feet.*.planned.agreement",
    "gait.segments[].feet.*.planned.delay_s",
    "gait.segments[].feet.*.planned.missed",
    "gait.segments[].feet.*.planned.unplanned",
}
"""Metrics that none of the logs tells."""


def pattern(path: str) -> re.Pattern[str]:
    """What matches the paths of a metric; names may hold dots and slashes."""
    words = re.escape(path).replace(r"\*", ".+").replace(r"\[\]", r"\.\d+")
    return re.compile(words)


def test_codes_are_declared_used_and_say_what_to_do() -> None:
    """Codes are also taken from tables; a remedy is something that a person can do."""
    text, kinds = program(), finding_kinds()
    found = set(_CODE.findall(text))
    assert len(found) > 60
    assert found <= kinds.keys()
    others = {"BATCH_SIZE", "OPENBLAS_NUM_THREADS", "SEEK_DATA"}
    assert set(_CAPITALS.findall(text)) - kinds.keys() <= others
    assert {code for code in kinds if code not in text} == set()
    for code, kind in kinds.items():
        assert kind.remedy.endswith("."), code
        assert not kind.remedy.startswith("Nothing"), code
