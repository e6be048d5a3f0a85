"""The records of metrics, and what is made of them."""

from dataclasses import replace

import pytest
from jsonschema import Draft202012Validator

from dogbot_logtool.core.arrays import Aggregate
from dogbot_logtool.core.metrics import (
    NEEDS,
    Foot,
    Gait,
    GaitOfLog,
    Phase,
    Planned,
    Segment,
    WalkMetrics,
)
from dogbot_logtool.core.records import (
    Curve,
    Field,
    fields_of,
    metric_paths,
    to_json,
    unknown,
    void,
)
from dogbot_logtool.report.documents import schema

SUFFIXES = {
    "_s": "s",
    "_m": "m",
    "_n": "N",
    "_ns": "N s",
    "_bw": "BW",
    "_kg": "kg",
    "_j": "J",
    "_hz": "Hz",
    "_mps": "m/s",
    "_mps2": "m/s^2",
    "_radps": "rad/s",
    "_rad": "rad",
    "_nps": "N/s",
    "_ppm": "1e-6",
    "_percent": "%",
    "_bytes": "B",
    "_n_per_min": "N/min",
}
PATHS = list(metric_paths(WalkMetrics))
SPREAD = Aggregate(2, 1.5, 0.5, 1.5, 1.0, 2.0)
CURVE = Curve((0.0, 100.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0))


def walk() -> WalkMetrics:
    """A walk of two feet and one segment, with some of its metrics."""
    foot = replace(
        unknown(Foot),
        contact_fraction=0.5,
        stance_s=SPREAD,
        slip_m=SPREAD,
        height_over_stride_m=CURVE,
        touchdown_s=(0.0, 1.0),
        planned=replace(unknown(Planned), missed=1),
    )
    feet = {"left": foot, "right": foot}
    gait = replace(unknown(Gait), name="run", phase={"left": Phase(0.0, 1.0, None)})
    segment = replace(unknown(Segment), start_s=0.0, end_s=2.0, gait=gait, feet=feet)
    own = {field.name: getattr(gait, field.name) for field in fields_of(Gait)}
    whole = GaitOfLog(**own, transition_strides=0, segments=(segment,))
    return replace(
        unknown(WalkMetrics),
        gait=whole,
        feet=feet,
        null_because={"gait.sequence": "does not apply"},
    )


@pytest.mark.parametrize(("path", "field", "words"), PATHS)
def test_a_metric_tells_its_definition_its_unit_and_what_it_needs(
    path: str, field: Field, words: str
) -> None:
    key = path.removesuffix(".*").rsplit(".", 1)[-1]
    suffix = max((each for each in SUFFIXES if key.endswith(each)), key=len, default="")
    assert words
    assert set(field.of.needs) <= NEEDS.keys()
    assert not suffix or field.of.unit in {SUFFIXES[suffix], "%"}


def test_every_need_is_one_of_some_metric() -> None:
    assert {need for _, field, _ in PATHS for need in field.of.needs} == NEEDS.keys()


def test_the_whole_log_and_a_segment_have_the_same_metrics() -> None:
    paths = {path for path, _, _ in PATHS}
    in_segments = {each.removeprefix("gait.segments[].") for each in paths if "segments[]" in each}
    assert in_segments - {"start_s", "end_s"} <= paths


def test_detail_is_curves_and_lists_of_times() -> None:
    foot = to_json(walk(), detail=False)["feet"]["left"]

    assert set(to_json(walk())["feet"]["left"]) - set(foot) == {
        "height_over_stride_m",
        "vertical_over_stride_n",
        "forward_over_stride_n",
        "touchdown_s",
        "lift_off_s",
    }


def test_json_follows_the_schema() -> None:
    contract = schema(WalkMetrics)
    Draft202012Validator.check_schema(contract)
    validator = Draft202012Validator(contract)
    for detail in (True, False):
        validator.validate(to_json(walk(), detail=detail))
    wrong = {**to_json(walk()), "spin": 1}
    assert not validator.is_valid(wrong)


def test_what_matches_a_pattern_becomes_null_in_the_log_and_in_its_segments() -> None:
    voided = void(walk(), ("feet.left.*", "gait.name"))

    for part in (voided, voided.gait.segments[0]):
        assert part.gait.name is None
        assert part.feet["left"] == unknown(Foot)
        assert part.feet["right"] == walk().feet["right"]


def test_a_group_leaves_the_other_groups_of_a_segment_alone() -> None:
    voided = void(walk(), ("gait.*",))
    segment = voided.gait.segments[0]

    assert (segment.start_s, segment.end_s) == (0.0, 2.0)
    assert segment.feet == walk().feet
    assert segment.gait.phase == {"left": Phase(None, None, None)}
    assert voided.gait.support_sets is None
