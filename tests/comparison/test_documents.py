"""JSON documents compared: a table of pairs, options, and the lines that name what differs."""

import json
from pathlib import Path
from typing import Any

import pytest

import dogbot_logtool as dl
from tests.comparison.recordings import compared, lines

Q = '{"x": 0.1, "y": 0.2, "z": -0.3, "w": 0.9}'
"""A quaternion, and the same rotation."""
TURNED = '{"x": -0.1, "y": -0.2, "z": 0.3, "w": -0.9}'
STATS = json.dumps(
    {
        "tool": {"name": "dogbot-logtool", "version": "1"},
        "log": {"path": "/one/walk.bag", "messages": 100},
        "feet": {"left": {"duty": {"median": 0.7, "n": 12}}, "right": {"slip_m": None}},
        "strides": [{"foot": "left", "duty": 0.7}, {"foot": "right", "period_s": 1.1}],
    }
)
NO_VALUE = "leaves no value to compare"


def other(old: str, new: str) -> str:
    assert old in STATS
    return STATS.replace(old, new)


SAME: list[tuple[str, str, dict[str, Any]]] = [
    *((text, text, {}) for text in ("[1, 1.5, NaN, Infinity, true, null, {}, []]", Q, STATS)),
    (f'{{"q": {Q}}}', f'{{"q": {TURNED}}}', {}),
    (f'{{"q": {Q}}}', f'{{"q": {TURNED.replace("0.2", "9.0")}}}', {"ignore": ["q.y"]}),
    ('{"h": {"s": 1}, "v": 1}', '{"h": {"s": 2}, "v": 1}', {"ignore": ["h.s"]}),
    ("[1.0]", "[1.5]", {"atol": 0.5}),
    ("[2.0]", "[1.0]", {"rtol": 0.5}),
    # What says where metrics come from is never compared.
    (STATS, other("/one/walk.bag", "/other/run.bag").replace('"1"', '"2"'), {}),
    (f"[{STATS}]", f"[{other('/one/walk.bag', '/other/run.bag')}]", {}),
    *(
        (STATS, other("0.7, ", "0.9, "), {"ignore": [glob]})
        for glob in ("*duty*", "feet.*.duty.median", "feet.left.duty")
    ),
    (STATS, other('"n": 12', '"n": 13'), {"topics": ["strides", "l*"]}),
]


DIFFERENT: list[tuple[str, str, dict[str, Any], list[str]]] = [
    ('{"a": 1}', '{"a": 1.5}', {}, ["a: expected 1, got 1.5 (|d| 0.5)"]),
    ('{"a": 1}', '{"a": 2}', {"atol": 9.0, "rtol": 1.0}, ["a: expected 1, got 2"]),
    ('{"a": true}', '{"a": 1}', {"atol": 9.0}, ["a: expected true, got 1"]),
    ('{"a": 1}', '{"a": "1"}', {}, ['a: expected 1, got "1"']),
    ('{"a": Infinity}', '{"a": 1e308}', {"rtol": 1.0}, ["a: expected inf, got 1e+308"]),
    (f'{{"a": {2**53}}}', f'{{"a": {2**53 + 1}}}', {}, [f"a: expected {2**53}, got {2**53 + 1}"]),
    ("[1.0]", "[2.0]", {"rtol": 0.5}, ["[0]: expected 1.0, got 2.0 (|d| 1)"]),
    ('{"a": [1, {"b": null}], "d": 1}', '{"e": 1, "a": [1.0, {"b": false}]}', {}, [
        "a[1].b: expected null, got false",
        "d: expected 1, got nothing",
        "e: expected nothing, got 1",
    ]),
    ('{"a": {"b": {"c": 1, "d": [1, 2]}}}', '{"a": {}}', {}, [
        'a.b: expected {"c": 1, "d": [1, 2]}, got nothing'
    ]),
    # As a whole: single components of q against -q would puzzle.
    (f'{{"q": {Q}}}', f'{{"q": {TURNED.replace("-0.1", "-0.6")}}}', {}, [
        f'q: expected {Q}, got {TURNED.replace("-0.1", "-0.6")} (|d| 0.5)'
    ]),
    # Nor are four others, or more than four, a quaternion.
    ('{"x": 1.0, "y": 0.0, "z": 0.0}', '{"x": -1.0, "y": 0.0, "z": 0.0}', {}, [
        "x: expected 1.0, got -1.0 (|d| 2)"
    ]),
    ('{"x": 1, "y": 0, "z": 0, "w": 0}', '{"x": -1, "y": 0, "z": 0, "w": 0}', {}, [
        "x: expected 1, got -1"
    ]),
    (f'{{"q": {Q}}}', f'{{"q": {Q.replace("0.9", "NaN")}}}', {}, ["q.w: expected 0.9, got nan"]),
    ('{"a": "\\u001b[31m"}', '{"a": "b"}', {}, ['a: expected "\\u001b[31m", got "b"']),
    (STATS, other("0.7, ", "0.9, "), {"topics": ["f*"]}, [
        "feet.left.duty.median: expected 0.7, got 0.9 (|d| 0.2)"
    ]),
    (STATS, other("100", "9"), {}, ["log.messages: expected 100, got 9"]),
]  # fmt: skip


ROWS = [*((*row, []) for row in SAME), *DIFFERENT]


@pytest.mark.parametrize(("one", "two", "options", "told"), ROWS, ids=lambda e: str(e)[:30])
def test_what_differs(
    tmp_path: Path, one: str, two: str, options: dict[str, Any], told: list[str]
) -> None:
    result = compared(tmp_path, one, two, **options)
    assert (lines(result), result.same, result.exit_code) == (told, not told, int(bool(told)))


REFUSED: list[tuple[str, dict[str, Any], str]] = [
    (STATS, {"topics": "nothing"}, f"--topics {NO_VALUE}: nothing"),
    (STATS, {"ignore": ["feet", "tool", "log", "strides*"]}, f"--ignore {NO_VALUE}"),
    (STATS, {"topics": "feet.left"}, f"--topics {NO_VALUE}: feet.left"),
    ('{"log": {"path": "1"}, "a": 1}', {"topics": "log"}, f"--topics {NO_VALUE}"),
    (STATS, {"atol": -1.0}, "atol=-1.0: must be a number from 0"),
    ('{"a": ', {}, "is not JSON"),
    (f"{'[' * 990}1{']' * 990}", {"ignore": "x"}, "is nested too deeply"),
]


@pytest.mark.parametrize(("text", "options", "sentence"), REFUSED, ids=lambda e: str(e)[:30])
def test_what_cannot_be_compared(
    tmp_path: Path, text: str, options: dict[str, Any], sentence: str
) -> None:
    with pytest.raises(dl.LogtoolError, match="(?s)" + sentence.replace("*", r"\*")):
        compared(tmp_path, text, text.replace("1", "2"), **options)


TOLERANCES = """
[default]
rtol = 1e-9
[metres]
atol = 0.01
fields = ["*position*"]
[newtons]
rtol = 0.1
fields = ["/topic:force.*", "*_n", "*.count"]
[never]
atol = 1e9
fields = ["position.angle", "/other:*"]
"""


@pytest.mark.parametrize(
    ("field", "one", "two", "is_same"),
    [
        ("position.x", "1.0", "1.005", True),
        ("position.x", "1.0", "1.02", False),
        ("position.angle", "1.0", "2.0", False),  # the first quantity that fits counts
        ("force_n", "100.0", "109.0", True),
        ("force_n", "100.0", "111.0", False),
        ("a.count", "100", "109", True),  # integers are exact unless a quantity names them
        ("a.count", "100", "111", False),
        ("a.count", "true", "false", False),
        ("speed", "1.0", "1.0000000001", True),
        ("speed", "1.0", "1.00001", False),
    ],
)
def test_each_quantity_has_its_tolerance(
    tmp_path: Path, field: str, one: str, two: str, *, is_same: bool
) -> None:
    (tmp_path / "tolerances.toml").write_text(TOLERANCES)
    keys = field.split(".")
    sides = [
        "".join(f'{{"{key}": ' for key in keys) + value + "}" * len(keys) for value in (one, two)
    ]
    result = compared(tmp_path, *sides, tolerances=tmp_path / "tolerances.toml")
    assert result.same == is_same
    assert compared(tmp_path, *sides, tolerances=tmp_path / "tolerances.toml", atol=1e9).same == (
        is_same or field == "speed"
    )


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a = 1", r"a must be a table: \[a\]"),
        ("[metres]\natol = 1", "metres.fields must be a list of globs"),
        ("[metres]\nfields = ['x']\nato = 1", "metres.ato: not known"),
        ("[default]\nfields = ['x']", "default.fields: not known"),
        ("[metres]\nfields = ['x']\natol = -1", "metres.atol is -1"),
        ("[metres]\nfields = ['x']\nrtol = 'a'", "metres.rtol is 'a'; it must be a number from 0"),
        ("[metres", "not valid TOML"),
    ],
)
def test_a_bad_tolerance_file_is_told_with_its_key(
    tmp_path: Path, text: str, sentence: str
) -> None:
    file = tmp_path / "tolerances.toml"
    file.write_text(text)
    with pytest.raises(dl.CallError, match=rf"tolerances.toml.*{sentence}"):
        compared(tmp_path, STATS, STATS, tolerances=file)
    with pytest.raises(dl.CallError, match="no such file"):
        compared(tmp_path, STATS, STATS, tolerances=tmp_path / "none.toml")


def test_values_are_counted_by_part(tmp_path: Path) -> None:
    one = '{"gait": {"name": "trot", "duty": 0.714, "n": 12}, "feet": [{"n": 201.25, "a": null}]}'
    two = '{"gait": {"name": "walk", "duty": 0.714, "n": 12.0}, "feet": [{"n": 201.5, "b": 1}]}'
    gait, feet = compared(tmp_path, one, two).tallies
    assert (gait.expected, gait.equal, gait.different) == (3, 2, 1)
    assert (feet.expected, feet.actual, feet.missing, feet.extra) == (2, 2, 1, 1)
    assert (feet.deviation, feet.deviation_path) == (0.25, "feet[0].n")
    (array,) = compared(tmp_path, '{"a": [1, 2]}', '{"a": [1]}').tallies
    assert (array.equal, array.missing, array.extra) == (1, 1, 0)
    assert "neither file has any values" in compared(tmp_path, "{}", "{}").warnings[0]
