"""What patterns and tolerances name is what they act on, and nothing passes by mistake."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.comparison.fields import Tree, compare_fields
from dogbot_logtool.comparison.outcome import Comparison, Findings
from dogbot_logtool.comparison.tolerances import FieldRules, Quantity, Rules, Tolerance
from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.options import CompareOptions
from tests import forked_cli
from tests.comparison.recordings import JSON, Recording, odometry, recording, ros_kind
from tests.forked_cli import Ended

FIGURES: dict[str, Any] = {
    "tool": {"name": "dogbot-logtool", "version": "1"},
    "log": {"path": "/one/walk.bag", "messages": 100},
    "feet": {
        "front_left": {"duty_factor": {"median": 0.7, "n": 12}, "slip_m": 0.01},
        "front_right": {"duty_factor": {"median": 0.6, "n": 11}, "slip_m": 0.02},
    },
    "gait": {"name": "trot", "duty_factor": 0.65},
    "strides": [{"foot": "front_left", "duty": 0.7}, {"foot": "front_right", "period_s": 1.1}],
}


def changed(*path: str | int, to: object) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(json.dumps(FIGURES))
    inner: Any = document
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = to
    return document


def compare_documents(folder: Path, expected: object, actual: object, **options: Any) -> Comparison:
    files = folder / "expected.json", folder / "actual.json"
    for path, document in zip(files, (expected, actual), strict=True):
        path.write_text(json.dumps(document), encoding="utf-8")
    return compare(*files, CompareOptions(**options))


def toml(folder: Path, text: str) -> Path:
    path = folder / "tolerances.toml"
    path.write_text(text, encoding="utf-8")
    return path


def compared(expected: Tree, actual: Tree, rules: Rules) -> Findings:
    findings = Findings(100)
    compare_fields(expected, actual, FieldRules(rules, "/topic"), findings)
    return findings


def quaternion(*components: float) -> dict[str, float]:
    return dict(zip("xyzw", components, strict=True))


@pytest.mark.parametrize("ignored", ["q.x", "*.x", "/topic:q.x", "*x"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_ignored_component_counts_for_neither_sign(ignored: str, sign: float) -> None:
    expected = {"q": quaternion(0.1, 0.2, -0.3, 0.9)}
    actual = {"q": quaternion(-5.0, 0.2 * sign, -0.3 * sign, 0.9 * sign)}
    found = compared(expected, actual, Rules(ignore=(ignored,)))
    assert (found.count, found.compared) == (0, 3)
    other = {"q": quaternion(-5.0, 0.2 * sign, -0.3 * sign, 0.5 * sign)}
    assert compared(expected, other, Rules(ignore=(ignored,))).count == 1


def test_an_ignored_quaternion_is_ignored() -> None:
    expected, actual = quaternion(0.1, 0.2, -0.3, 0.9), quaternion(-0.1, -0.2, 0.4, -0.9)
    for ignored in ("q", "q.*", "*"):
        found = compared({"q": expected}, {"q": actual}, Rules(ignore=(ignored,)))
        assert (found.count, found.compared) == (0, 0)


@pytest.mark.parametrize(
    ("expected", "actual", "near"),
    [
        (100, 101, True),
        (100, 103, False),
        (-100, -102, True),
        (2**70, 2**70 + 2, True),
        (2**70, 2**70 + 3, False),
        (10**400, 10**400 + 1, True),
        (10**400, 10**400 + 3, False),
    ],
)
def test_integers_get_the_tolerance_that_names_them(
    expected: int, actual: int, *, near: bool
) -> None:
    rules = Rules(quantities=(Quantity(("*.count",), Tolerance(atol=2.0)),))
    one, other = ({"a": {"count": value}} for value in (expected, actual))
    found = compared(one, other, rules)
    assert (found.different, found.loose) == ((0, 1) if near else (1, 0))
    one, other = ({"a": {"number": value}} for value in (expected, actual))
    assert compared(one, other, rules).different == 1


@pytest.mark.parametrize("kind", [np.uint8, np.int64, np.uint64])
def test_arrays_of_integers_get_the_tolerance_that_names_them(kind: type) -> None:
    expected: NDArray[Any] = np.array([1, 2, 200], kind)
    actual: NDArray[Any] = np.array([2, 1, 205], kind)
    rules = Rules(quantities=(Quantity(("counts",), Tolerance(atol=1.0)),))
    found = compared({"counts": expected}, {"counts": actual}, rules)
    assert (found.loose, found.different, found.deviation) == (2, 1, 5.0)
    assert [d.path for d in found.differences] == ["counts[2]"]


def test_truth_values_have_no_tolerance() -> None:
    rules = Rules(quantities=(Quantity(("*",), Tolerance(atol=9.0)),))
    assert compared({"a": True}, {"a": False}, rules).different == 1
    assert compared({"a": np.array([True])}, {"a": np.array([False])}, rules).different == 1


def test_statistics_of_one_log_in_two_folders_are_the_same(tmp_path: Path) -> None:
    moved = changed("log", "path", to="/other/folder/walk.bag")
    assert compare_documents(tmp_path, FIGURES, moved).exit_code == 0
    assert compare_documents(tmp_path, [FIGURES], [moved]).exit_code == 0
    assert compare_documents(tmp_path, FIGURES, changed("log", "messages", to=9)).exit_code == 1


@pytest.mark.parametrize(
    "pattern", ["*duty*", "feet.*.duty_factor.median", "feet.front_left.duty_factor", "*.median"]
)
def test_a_pattern_names_a_figure_wherever_it_stands(tmp_path: Path, pattern: str) -> None:
    path = ("feet", "front_left", "duty_factor", "median")
    other = changed(*path, to=0.9)
    assert compare_documents(tmp_path, FIGURES, other).exit_code == 1
    assert compare_documents(tmp_path, FIGURES, other, ignore=(pattern,)).exit_code == 0
    result = compare_documents(tmp_path, FIGURES, other, topics=(pattern,))
    assert [difference.path for difference in result.differences] == [".".join(path)]
    elsewhere = changed("feet", "front_left", "slip_m", to=9.0)
    assert compare_documents(tmp_path, FIGURES, elsewhere, topics=(pattern,)).exit_code == 0


def test_a_tolerance_names_a_figure_inside(tmp_path: Path) -> None:
    other = changed("feet", "front_left", "duty_factor", "median", to=0.71)
    rules = toml(tmp_path, '[duty]\natol = 0.02\nfields = ["feet.*.duty_factor.median"]')
    result = compare_documents(tmp_path, FIGURES, other, tolerances=rules)
    assert (result.exit_code, result.warnings) == (0, ())
    other = changed("feet", "front_left", "duty_factor", "n", to=13)
    assert compare_documents(tmp_path, FIGURES, other, tolerances=rules).exit_code == 1
    rules = toml(tmp_path, '[strides]\natol = 1\nfields = ["*.n"]')
    assert compare_documents(tmp_path, FIGURES, other, tolerances=rules).exit_code == 0


def test_elements_that_are_picked_keep_their_positions(tmp_path: Path) -> None:
    other = changed("strides", 1, "period_s", to=1.2)
    result = compare_documents(tmp_path, FIGURES, other, topics=("*period*",))
    assert [difference.path for difference in result.differences] == ["strides[1].period_s"]


@pytest.mark.parametrize(
    "ignore", [("*",), ("feet", "gait", "tool", "log", "strides*"), ("*.*", "*")]
)
def test_patterns_that_leave_nothing_are_a_wrong_call(
    tmp_path: Path, ignore: tuple[str, ...]
) -> None:
    with pytest.raises(CallError, match="--ignore leaves no value to compare") as error:
        compare_documents(tmp_path, FIGURES, FIGURES, ignore=ignore)
    assert error.value.exit_code == 2
    with pytest.raises(CallError, match="leaves no value"):
        compare_documents(tmp_path, [FIGURES], [FIGURES], ignore=("*",))
    with pytest.raises(CallError, match="leaves no value"):
        compare_documents(tmp_path, FIGURES, FIGURES, topics=("gait",), ignore=("gait",))


def test_documents_without_a_value_are_said(tmp_path: Path) -> None:
    documents: tuple[object, ...] = ({}, [])
    for document in documents:
        result = compare_documents(tmp_path, document, document)
        assert result.exit_code == 0
        assert result.warnings == ("neither file has any values to compare",)


def test_empty_lists_are_compared_too(tmp_path: Path) -> None:
    sound = {"losses": [], "gait": "trot"}
    assert compare_documents(tmp_path, sound, sound, topics=("losses",)).exit_code == 0
    assert compare_documents(tmp_path, sound, sound, ignore=("gait",)).exit_code == 0
    lossy = sound | {"losses": ["one"]}
    assert compare_documents(tmp_path, sound, lossy, topics=("losses",)).exit_code == 1


@pytest.mark.parametrize("topics", [("log.path",), ("tool.version", "*.path")])
def test_what_is_never_compared_cannot_be_all_that_is(
    tmp_path: Path, topics: tuple[str, ...]
) -> None:
    with pytest.raises(CallError, match="--topics leaves no value to compare"):
        compare_documents(tmp_path, FIGURES, FIGURES, topics=topics)


def logs(folder: Path, expected: Recording, actual: Recording) -> tuple[Path, Path]:
    return expected.write(folder / "one.mcap"), actual.write(folder / "other.mcap")


def with_metadata(values: Mapping[str, dict[str, str]]) -> Recording:
    kinds = {"/a": JSON, "/odom": ros_kind(1)}
    messages = [("/a", 0, b'{"x": 1}'), ("/odom", 0, odometry(1))]
    plain = recording(kinds, *messages)
    return Recording(plain.kinds, plain.messages, values)


OURS = {"dogbot_logtool": {"version": "1", "style": "pressure"}}


@pytest.mark.parametrize(
    "pattern",
    ["metadata:dogbot_logtool", "metadata:*", "metadata:dogbot_logtool.*", "(records)"],
)
def test_our_own_metadata_can_be_ignored_by_its_name(tmp_path: Path, pattern: str) -> None:
    files = logs(tmp_path, with_metadata({}), with_metadata(OURS))
    result = compare(*files, CompareOptions())
    assert result.exit_code == 1
    assert result.differences[0].line.startswith("(records) metadata:dogbot_logtool: expected not")
    if pattern != "metadata:dogbot_logtool.*":
        assert compare(*files, CompareOptions(ignore=(pattern,))).exit_code == 0
    other = {"dogbot_logtool": {"version": "1", "style": "force"}}
    files = logs(tmp_path, with_metadata(OURS), with_metadata(other))
    result = compare(*files, CompareOptions(ignore=(pattern,)))
    assert (result.exit_code, result.warnings) == (0, ())


@pytest.mark.parametrize("ignore", [("*",), ("/*",), ("/a", "/odom"), ("*", "profile")])
def test_a_log_of_which_all_is_ignored_is_a_wrong_call(
    tmp_path: Path, ignore: tuple[str, ...]
) -> None:
    files = logs(tmp_path, with_metadata({}), with_metadata({}))
    with pytest.raises(CallError, match="--ignore leaves no topic to compare"):
        compare(*files, CompareOptions(ignore=ignore))


@pytest.mark.parametrize(
    "text", ['{"a": 1, "a": 1}', '{"b": [{"a": 1, "c": 2, "a": 3}]}', '[{"a": 0, "a": 0}]']
)
def test_a_key_that_stands_twice_is_no_json(tmp_path: Path, text: str) -> None:
    path = tmp_path / "twice.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(LogError, match='an object has the key "a" twice'):
        compare(path, path, CompareOptions())


def run(*words: object, timeout: float = 120.0) -> Ended:
    return forked_cli.run("compare", *words, timeout=timeout)


def test_a_report_replaces_nothing_unasked(tmp_path: Path) -> None:
    files = [tmp_path / name for name in ("one.json", "other.json")]
    for path in files:
        path.write_text(json.dumps(FIGURES), encoding="utf-8")
    report = tmp_path / "report.xml"
    assert run(*files, "--junit", report).returncode == 0
    assert report.read_bytes().startswith(b"<?xml")
    report.write_text("mine", encoding="utf-8")
    done = run(*files, "--junit", report)
    assert (done.returncode, done.stdout, report.read_text("utf-8")) == (2, "", "mine")
    assert "exists already; --overwrite replaces it" in done.stderr
    assert run(*files, "--junit", report, "--overwrite").returncode == 0
    assert report.read_bytes().startswith(b"<?xml")
    for path in files:
        assert run(*files, "--junit", path, "--overwrite").returncode == 2
        assert json.loads(path.read_bytes()) == FIGURES


def test_a_table_of_very_many_parts_has_those_that_differ(tmp_path: Path) -> None:
    many = {f"k{number}": 0 for number in range(50_000)}
    files = [tmp_path / name for name in ("one.json", "other.json")]
    for path, document in zip(files, (many, many | {"k7": 1, "k30000": 1}), strict=True):
        path.write_text(json.dumps(document), encoding="utf-8")
    done = run(*files, timeout=60)
    assert done.returncode == 1
    lines = done.stdout.splitlines()
    assert [line.split()[0] for line in lines[1:4]] == ["part", "k7", "k30000"]
    assert lines[4] == "... and 49998 more, 0 of them different"


def test_very_many_topics_take_no_longer_than_their_number(tmp_path: Path) -> None:
    kinds = {f"/t{number}": JSON for number in range(16_000)}
    files = logs(
        tmp_path,
        recording(kinds, *((topic, 0, b"1") for topic in kinds)),
        recording(kinds, *((topic, 0, b"1") for topic in kinds if topic != "/t77")),
    )
    done = run(*files, "--ignore", "/nothing", timeout=60)
    assert done.returncode == 1
    assert "/t77[0] t=0.000 s: missing" in done.stdout


def test_warnings_go_to_stderr_and_change_no_exit_code(tmp_path: Path) -> None:
    path, link = tmp_path / "one.json", tmp_path / "link.json"
    path.write_text(json.dumps(FIGURES), encoding="utf-8")
    link.symlink_to(path)
    done = run(path, link)
    assert done.returncode == 0
    assert done.stdout.startswith("same: ")
    assert done.stderr.splitlines() == [
        f"warning: {path} and {link} are the same file, so nothing can differ",
    ]
    assert json.loads(run(path, link, "--json").stdout)["warnings"]
