"""What was checked, on walks with and without what the checks need."""

from dataclasses import replace

from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.checks.questions import KINDS, Outcome, checks_of
from dogbot_logtool.core.contact.contact_rule import FootSensor, contact_rule
from dogbot_logtool.core.corrections.sensor import SensorLevel
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Severity, finding_kinds
from tests.core.checks.measured_walk import WALK, feet, late, measure
from tests.oracles.straight_walk import SETTINGS


def outcomes(stats: Stats) -> dict[str, Outcome]:
    return {check.name: check.outcome for check in checks_of(stats, findings_of(stats))}


def test_a_sound_walk_passes_every_check() -> None:
    stats = measure(feet(), WALK.odometry())
    found = outcomes(stats)
    for name in ("the legs move as the feet step", "nothing contradicts the accelerometer"):
        assert found.pop(name) is Outcome.DOES_NOT_APPLY
    assert set(found.values()) == {Outcome.PASSED}


def test_a_failed_check_names_its_finding() -> None:
    stats = measure([late(each, 0.2) for each in feet()], WALK.odometry())
    failed = [
        check for check in checks_of(stats, findings_of(stats)) if check.outcome is Outcome.FAILED
    ]
    assert [check.name for check in failed] == ["all topics have one clock"]
    assert "/odom" in failed[0].reason


def test_without_a_mass_the_weight_is_not_checked() -> None:
    stats = measure(feet(), WALK.odometry())
    massless = replace(
        stats,
        settings=replace(SETTINGS, mass_kg=None),
        loads=replace(stats.loads, body_weight_n=None),
    )
    assert outcomes(massless)["the feet carry the weight"] is Outcome.NOT_MADE


def test_without_contact_points_worlds_are_no_matter() -> None:
    samples = feet()
    for each in samples:
        each.position[:] = float("nan")
    stats = measure(samples, WALK.odometry())
    assert outcomes(stats)["contacts are where the base is"] is Outcome.DOES_NOT_APPLY


def test_too_short_a_log_leaves_clocks_unchecked() -> None:
    short = [each.pick(each.stamp < each.stamp[0] + 400_000_000) for each in feet()]
    stats = measure(short, WALK.odometry())
    assert outcomes(stats)["all topics have one clock"] is Outcome.NOT_MADE


def test_log_times_that_are_the_stamps_tell_nothing_of_clocks() -> None:
    samples = [replace(each, log_time=each.stamp) for each in feet()]
    stats = measure(samples, WALK.odometry())
    assert outcomes(stats)["all topics have one clock"] is Outcome.DOES_NOT_APPLY


def test_every_warning_about_figures_says_which_checks_fail() -> None:
    of_pictures = {"Frames and transforms", "Arrows and support"}
    for code, kind in finding_kinds().items():
        is_about_figures = kind.severity is Severity.WARNING and kind.subject not in of_pictures
        assert (kind.fails is not None) or not is_about_figures, code


def test_every_check_can_fail() -> None:
    kinds = finding_kinds().values()
    failing = {name for kind in kinds for name in kind.fails or ()}
    failing |= {name for kind in kinds for case in kind.cases.values() for name in case.fails or ()}
    assert failing == {kind.name for kind in KINDS}


def test_an_unloaded_level_that_is_not_seen_is_no_check_passed() -> None:
    stats = measure(feet(), WALK.odometry())
    level = replace(
        SensorLevel(zero_in_swing=True), reason="the foot is seen unloaded fewer than twice"
    )
    sensor = FootSensor(level, contact_rule(level, stats.settings.body_weight_n))
    settings = replace(
        stats.settings, feet=tuple(replace(foot, sensor=sensor) for foot in stats.settings.feet)
    )
    made = outcomes(replace(stats, settings=settings))
    assert made["what sensors read without load is known"] is Outcome.NOT_MADE
