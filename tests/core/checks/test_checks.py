"""What was checked of a walk; what each finding voids is in `test_voids.py`."""

from dogbot_logtool.core.checks.engine import findings_of, questions_of
from dogbot_logtool.core.metrics import Check
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Severity, finding_kinds
from tests.core.checks.measured_walk import WALK, feet, late, measure
from tests.truth import core_columns, scenes, walking
from tests.truth.sequences import then


def checks(stats: Walk) -> tuple[Check, ...]:
    return questions_of(stats, findings_of(stats))


def test_a_sound_walk_passes_every_check() -> None:
    found = {check.name: check.outcome for check in checks(measure(feet(), WALK.odometry()))}
    for name in ("the legs move as the feet step", "nothing contradicts the accelerometer"):
        assert found.pop(name) == "does not apply"
    assert set(found.values()) == {"passed"}


def test_a_failed_check_names_its_finding() -> None:
    stats = measure([late(each, 0.2) for each in feet()], WALK.odometry())
    (failed,) = [check for check in checks(stats) if check.outcome == "failed"]
    assert failed.name == "all topics have one clock"
    assert "/odom" in (failed.reason or "")


def test_too_short_a_log_leaves_clocks_unchecked() -> None:
    short = [each.pick(each.stamp < each.stamp[0] + 400_000_000) for each in feet()]
    made = {check.name: check.outcome for check in checks(measure(short, WALK.odometry()))}
    assert made["all topics have one clock"] == "not made"


def test_every_warning_about_metrics_says_which_checks_fail_and_every_check_can_fail() -> None:
    of_pictures = {"Frames and transforms", "Arrows and support"}
    failing = set()
    for code, kind in finding_kinds().items():
        is_about_metrics = kind.severity is Severity.WARNING and kind.subject not in of_pictures
        assert (kind.fails is not None) or not is_about_metrics, code
        failing |= {*(kind.fails or ())}
        failing |= {name for case in kind.cases.values() for name in case.fails or ()}
    assert failing == {check.name for check in checks(measure(feet(), WALK.odometry()))}


def test_the_weight_that_the_belly_of_a_robot_takes_is_no_load_taken_off() -> None:
    walk, sits = walking.Walk(seconds=12.0).recorded(250.0), scenes.sitting_down().recorded(250.0)
    found = findings_of(core_columns.measure(then(walk, sits)))
    assert "PAYLOAD" not in {each.code for each in found}
