"""Times that sentences tell, since the log's start."""

from dataclasses import replace

from dogbot_logtool.core.base.falls import Tipping
from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.statistics import Stats
from tests.oracles.straight_walk import Walk
from tests.truth import scenes
from tests.truth.core_columns import measure
from tests.truth.sequences import then
from tests.truth.walking import Walk as TrueWalk


def text_of(stats: Stats, code: str) -> str:
    (found,) = (each.text for each in findings_of(stats) if each.code == code)
    return found


def test_when_a_robot_is_first_carried() -> None:
    recording = then(TrueWalk(seconds=6.0).recorded(200.0), scenes.carried().recorded(200.0))
    (begin, _), *_ = recording.truth.carried_s
    told = text_of(measure(recording), "LIFTED")
    assert abs(float(told.split("first at ")[1].split(" s:")[0]) - begin) < 0.3


def test_when_a_robot_begins_to_tip() -> None:
    stats = Walk(seconds=4.0).measure()
    tipping = Tipping(stats.origin + 3_250_000_000, "roll", 0.4)
    assert "at 3.25 s and is 0.40 rad" in text_of(replace(stats, tipping=tipping), "FALL")
