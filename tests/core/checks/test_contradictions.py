"""Walks whose topics contradict one another: named, and null where that matters."""

from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding, Severity
from tests.analysed import feet_of
from tests.core.checks.measured_walk import WALK, S, feet, late, measure
from tests.core.checks.voided import metrics


def found(stats: Stats, code: str) -> list[Finding]:
    return [each for each in findings_of(stats) if each.code == code]


def test_a_walk_without_contradictions_has_no_such_finding() -> None:
    stats = measure(feet(), WALK.odometry())
    codes = {each.code for each in findings_of(stats)}
    assert codes.isdisjoint({"CLOCK_OFFSET", "WORLDS_DIFFER", "CLOCK_SET"})
    assert stats.stability is not None
    assert feet_of(stats)[0].stride_length_m is not None


@pytest.mark.parametrize("seconds", [0.1, 0.2, 0.3, -0.2])
def test_an_odometry_on_another_clock_makes_what_rests_on_both_null(seconds: float) -> None:
    stats = measure([late(each, seconds) for each in feet()], WALK.odometry())
    (finding,) = found(stats, "CLOCK_OFFSET")
    where = "behind" if seconds > 0 else "ahead of"
    assert finding.text.startswith("/odom: its clock is ")
    assert where in finding.text
    # The feet's messages are logged 0.7 ms after their stamps, the odometry's at once.
    assert stats.clocks[-1].behind_s == pytest.approx(seconds - 0.0007, abs=1e-6)
    assert stats.stability is None
    walk = metrics(stats)
    assert [foot.stride_length_m for foot in walk.feet.values()] == [None] * 4
    assert walk.null_because["feet.front_left.stride_length_m"] == "CLOCK_OFFSET"
    assert {"stability.*", "feet.*.stride_length_*"} <= set(finding.voids)
    assert stats.main is not None
    assert stats.main.gait.name == "trot"
    assert findings_of(stats)[0].code == "CLOCK_OFFSET"


def test_a_delay_of_little_consequence_is_only_noted() -> None:
    stats = measure([late(each, 0.03) for each in feet()], WALK.odometry())
    (finding,) = found(stats, "CLOCK_OFFSET")
    assert finding.severity is Severity.NOTE
    assert finding.voids == ()
    assert stats.stability is not None


def test_a_foot_on_another_clock_makes_the_gait_null() -> None:
    samples = feet()
    samples[2] = late(samples[2], 0.2)
    stats = measure(samples, WALK.odometry())
    (finding,) = found(stats, "CLOCK_OFFSET")
    assert finding.where == "/back_left"
    assert stats.main is None
    assert stats.support is None
    assert "clocks" in found(stats, "CLASS_UNKNOWN")[0].text
    assert feet_of(stats)[2].stride_frequency_hz == pytest.approx(1.25, rel=2e-3)


def test_wall_and_simulation_time_mixed_are_named_and_log_time_is_used() -> None:
    samples = [late(each, 12.0 - 1.7e9) for each in feet()]
    stats = measure(samples, WALK.odometry())
    assert stats.settings.clock is TimeSource.LOG
    reason = stats.settings.time_source_reason
    assert "wall time and simulation time are mixed" in reason
    assert "/odom" in reason
    assert stats.main is not None
    assert stats.main.gait.name == "trot"
    assert stats.stability is not None
    offsets = found(stats, "CLOCK_OFFSET")
    assert [each.severity for each in offsets] == [Severity.NOTE] * 4


@pytest.mark.parametrize("drift", [(0.0, 0.0), (0.0, 0.5)])
def test_contacts_in_another_world_make_stability_null(drift: tuple[float, float]) -> None:
    odometry = WALK.odometry()
    position = odometry.position.copy()
    share = np.linspace(0.0, 1.0, len(position))[:, None]
    position[:, :2] += share * np.array(drift) if any(drift) else np.array([3.0, 4.0])
    stats = measure(feet(), replace(odometry, position=position))
    (finding,) = found(stats, "WORLDS_DIFFER")
    assert finding.where == "stability"
    assert stats.stability is None
    assert "not in one world" in finding.text
    assert "stability.*" in finding.voids


def test_all_feet_silent_at_once_is_named() -> None:
    start = int(WALK.odometry().stamp[0])
    silent = [
        each.pick((each.stamp < start + 5 * S) | (each.stamp >= start + 7 * S)) for each in feet()
    ]
    stats = measure(silent, WALK.odometry())
    (finding,) = found(stats, "ALL_FEET_SILENT")
    assert "1 time, first at 5.00 s, 2.00 s in all" in finding.text
    assert stats.support is not None
    assert stats.support.flight_fraction == pytest.approx(0.0, abs=0.01)
    one = [*silent[:1], *feet()[1:]]
    assert not found(measure(one, WALK.odometry()), "ALL_FEET_SILENT")
    recorder = WALK.odometry()
    paused = (recorder.stamp < start + 5 * S) | (recorder.stamp >= start + 7 * S)
    assert not found(measure(silent, recorder.pick(paused)), "ALL_FEET_SILENT")
