import math

import numpy as np
import pytest

from dogbot_logtool.comparison.fields import Tree, compare_fields, text_of
from dogbot_logtool.comparison.outcome import Findings
from dogbot_logtool.comparison.tolerances import FieldRules, Quantity, Rules, Tolerance

EXACT = Rules()
NEXT = math.nextafter(0.1, 1.0)


def compared(expected: Tree, actual: Tree, rules: Rules = EXACT, limit: int = 100) -> Findings:
    findings = Findings(limit)
    compare_fields(expected, actual, FieldRules(rules, "/topic"), findings)
    return findings


def lines(expected: Tree, actual: Tree, rules: Rules = EXACT) -> list[str]:
    found = compared(expected, actual, rules).differences
    return [f"{one.path}: {one.expected} | {one.actual}" for one in found]


@pytest.mark.parametrize(
    "value",
    [
        0,
        -1,
        10**400,
        1.5,
        math.nan,
        math.inf,
        -math.inf,
        True,
        None,
        "",
        "text",
        b"",
        b"\0\1",
        {},
        [],
        {"a": [{"b": 1.5}, {"b": None}]},
        np.array([1.0, math.nan, math.inf]),
        np.array([], np.uint8),
        {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
    ],
)
def test_everything_equals_itself(value: Tree) -> None:
    found = compared(value, value)
    assert not found.differences
    assert (found.count, found.loose, found.different, found.missing, found.extra) == (0,) * 5


@pytest.mark.parametrize(
    ("expected", "actual"),
    [
        (1, 2),
        (1, True),
        (0, False),
        (0, None),
        (1, "1"),
        ("a", "b"),
        ("a", b"a"),
        (b"a", b"b"),
        (None, {}),
        ([], {}),
        ([], np.array([])),
        (1.0, math.nan),
        (math.nan, 1.0),
        (math.inf, -math.inf),
        (math.inf, 1e308),
        (1e308, math.inf),
        (10**400, 1.0),
        (0.1, NEXT),
        (2**53, 2.0**53 + 2),
    ],
)
def test_values_that_differ(expected: Tree, actual: Tree) -> None:
    generous = Rules(Tolerance(atol=0.0, rtol=0.0))
    assert compared({"a": expected}, {"a": actual}, generous).different == 1


def test_a_number_is_a_number_however_json_spells_it() -> None:
    assert not lines({"a": 1}, {"a": 1.0})
    assert lines({"a": 1}, {"a": 1.5}) == ["a: 1 | 1.5"]


def test_infinities_are_never_within_tolerance() -> None:
    generous = Rules(Tolerance(atol=1e300, rtol=1.0))
    for expected, actual in ((math.inf, 1.0), (1.0, math.inf), (math.inf, -math.inf)):
        assert compared(expected, actual, generous).different == 1
        assert compared(np.array([expected]), np.array([actual]), generous).different == 1


def test_integers_are_exact_whatever_the_tolerance() -> None:
    generous = Rules(Tolerance(atol=10.0, rtol=1.0))
    assert compared({"a": 1}, {"a": 2}, generous).different == 1
    assert compared(np.array([1]), np.array([2]), generous).different == 1


def test_nan_of_any_kind_equals_nan_only() -> None:
    other_nan = np.array([0x7FF8000000000001], np.uint64).view(np.float64)
    assert not lines(np.array([math.nan]), other_nan)
    assert lines(np.array([math.nan, 1.0]), np.array([1.0, math.nan])) == [
        "[0]: nan | 1.0",
        "[1]: 1.0 | nan",
    ]


def test_the_last_bit_is_seen_and_tolerated_on_request() -> None:
    expected, actual = {"a": {"b": [0.1]}}, {"a": {"b": [NEXT]}}
    found = compared(expected, actual)
    assert found.differences[0].path == "a.b[0]"
    assert found.differences[0].deviation == NEXT - 0.1
    assert (found.deviation, found.deviation_path) == (NEXT - 0.1, "a.b[0]")
    found = compared(expected, actual, Rules(Tolerance(atol=1e-15)))
    assert (found.count, found.loose, found.compared) == (0, 1, 1)
    assert found.deviation == NEXT - 0.1


def test_relative_tolerance_is_of_the_expected_value() -> None:
    rules = Rules(Tolerance(rtol=0.5))
    assert not compared(2.0, 1.0, rules).count
    assert compared(1.0, 2.0, rules).count == 1
    assert not compared(np.array([2.0]), np.array([1.0]), rules).count
    assert compared(np.array([1.0]), np.array([2.0]), rules).count == 1


def test_each_quantity_has_its_tolerance() -> None:
    rules = Rules(
        Tolerance(),
        (
            Quantity(("*position*",), Tolerance(atol=0.01)),
            Quantity(("/topic:force.*",), Tolerance(rtol=0.1)),
            Quantity(("/other:*",), Tolerance(atol=1e9)),
        ),
    )
    expected = {"pose": {"position": {"x": 1.0}}, "force": {"x": 100.0}, "speed": 1.0}
    near = {"pose": {"position": {"x": 1.005}}, "force": {"x": 105.0}, "speed": 1.0}
    assert compared(expected, near, rules).loose == 2
    assert not lines(expected, near, rules)
    far = {"pose": {"position": {"x": 1.02}}, "force": {"x": 120.0}, "speed": 1.005}
    assert [line.partition(":")[0] for line in lines(expected, far, rules)] == [
        "pose.position.x",
        "force.x",
        "speed",
    ]


def test_ignored_fields_take_what_is_below_them_along() -> None:
    expected = {"header": {"stamp": {"sec": 1}, "id": "a"}, "v": [{"x": 1.0, "y": 1.0}]}
    actual = {"header": {"stamp": {"sec": 2}}, "v": [{"x": 2.0, "y": 1.0, "z": 1.0}]}
    assert lines(expected, actual, Rules(ignore=("header.stamp", "/topic:header.id"))) == [
        "v[0].x: 1.0 | 2.0",
        "v[0].z: nothing | 1.0",
    ]
    assert not lines(expected, actual, Rules(ignore=("header", "v.*")))


def test_fields_that_only_one_has() -> None:
    found = compared({"a": 1, "b": {"c": 1, "d": [1, 2]}}, {"a": 1, "e": None})
    assert [(d.path, d.expected, d.actual) for d in found.differences] == [
        ("b", '{"c": 1, "d": [1, 2]}', "nothing"),
        ("e", "nothing", "null"),
    ]
    assert (found.compared, found.missing, found.extra) == (1, 3, 1)


def test_arrays_of_other_lengths() -> None:
    for kind in (list, np.array):
        found = compared(kind([1.0, 2.0, 3.0]), kind([1.0, 2.5]))
        assert sorted((d.path, d.expected, d.actual) for d in found.differences) == [
            ("", "3 elements", "2 elements"),
            ("[1]", "2.0", "2.5"),
        ]
        assert (found.compared, found.different, found.missing, found.extra) == (2, 1, 1, 0)


def test_an_array_is_counted_whole_and_listed_up_to_the_limit() -> None:
    found = compared(np.zeros(1000), np.ones(1000), limit=3)
    assert [one.path for one in found.differences] == ["[0]", "[1]", "[2]"]
    assert (found.count, found.different) == (1000, 1000)


def test_the_largest_deviation_of_an_array_is_placed() -> None:
    found = compared({"a": np.array([0.0, 0.0, math.nan])}, {"a": np.array([1.0, 3.0, 9.0])})
    assert (found.deviation, found.deviation_path) == (3.0, "a[1]")


def test_bytes_name_the_first_that_differs() -> None:
    assert lines({"a": b"\0\1\2"}, {"a": b"\0\1\3"}) == ["a[2]: 0x02 | 0x03"]
    assert lines({"a": b"\0\1\2"}, {"a": b"\0"}) == ["a: 3 bytes | 1 bytes"]


def quaternion(*components: float) -> dict[str, float]:
    return dict(zip("xyzw", components, strict=True))


def test_quaternions_are_equal_up_to_sign() -> None:
    found = compared(quaternion(0.1, 0.2, -0.3, 0.9), quaternion(-0.1, -0.2, 0.3, -0.9))
    assert (found.count, found.loose, found.deviation) == (0, 4, 0.0)


def test_quaternions_that_differ_are_told_by_component_or_as_a_whole() -> None:
    assert lines({"q": quaternion(0.0, 0.0, 0.0, 1.0)}, {"q": quaternion(0.5, 0.0, 0.0, 1.0)}) == [
        "q.x: 0.0 | 0.5"
    ]
    found = compared({"q": quaternion(0.0, 0.0, 0.0, 1.0)}, {"q": quaternion(0.5, 0.0, 0.0, -1.0)})
    assert [(d.path, d.deviation) for d in found.differences] == [("q", 0.5)]
    tolerant = Rules(quantities=(Quantity(("q.*",), Tolerance(atol=0.5)),))
    expected, actual = quaternion(0.0, 0.0, 0.0, 1.0), quaternion(0.5, 0.0, 0.0, -1.0)
    assert not lines({"q": expected}, {"q": actual}, tolerant)


def test_only_structs_of_exactly_x_y_z_w_are_quaternions() -> None:
    vector = {"x": 1.0, "y": 0.0, "z": 0.0}
    assert lines(vector, {**vector, "x": -1.0}) == ["x: 1.0 | -1.0"]
    more = {**quaternion(1.0, 0.0, 0.0, 1.0), "v": 1.0}
    assert len(lines(more, {key: -value for key, value in more.items()})) == 3
    whole = {"x": 1, "y": 0, "z": 0, "w": 1}
    assert len(lines(whole, {key: -value for key, value in whole.items()})) == 2


def test_a_quaternion_with_nan_differs_from_a_sound_one() -> None:
    assert compared(quaternion(math.nan, 0.0, 0.0, 1.0), quaternion(0.0, 0.0, 0.0, 1.0)).count == 1
    broken = quaternion(math.nan, math.nan, math.nan, math.nan)
    assert not compared(broken, dict(broken)).count


def test_texts_are_short_and_harmless() -> None:
    assert text_of("\x1b[31m\n") == '"\\u001b[31m\\n"'
    assert len(text_of("x" * 10_000)) == 100
    assert len(text_of(b"x" * 10_000)) == 100
    assert len(text_of(list(range(10_000)))) == 100
    assert text_of(np.array([1, 2], np.uint8)) == "[1, 2]"
    assert text_of({"a": np.array([1.5]), "b": b"\1"}) == '{"a": "[1.5]", "b": "1 bytes 01"}'
