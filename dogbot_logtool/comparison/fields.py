"""Comparing two decoded messages, or two JSON documents, field by field.

Decoded means: structs as dicts, arrays as lists or one-dimensional numpy arrays, and as leaves
numbers, truth values, texts, bytes and None. JSON's rules on types hold for all: 1 and 1.0 are both
numbers, true is none.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.comparison.tolerances import FieldRules, Tolerance
from dogbot_logtool.core.arrays import Flags

Tree = Any
"""A decoded value; see above."""
_QUATERNION: Final = frozenset("xyzw")
_TEXT_LIMIT: Final = 100
_NOTHING: Final = "nothing"


@dataclass(frozen=True, slots=True)
class FieldDifference:
    """One field in which two values differ."""

    path: str
    """``entities[0].arrows[0].pose.position.z``."""
    expected: str
    actual: str
    deviation: float | None = None
    """|expected - actual| where both are finite numbers."""


@dataclass(slots=True)
class Findings:
    """Differences between two values."""

    limit: int
    """Differences to keep."""
    differences: list[FieldDifference] = field(default_factory=list)
    count: int = 0
    """All differences; whatever is missing or extra at the end of an array is one."""
    compared: int = 0
    """Leaves that both have."""
    empty: int = 0
    """Structs and arrays that are empty in both."""
    loose: int = 0
    """Leaves that are not equal but agree: within tolerance, or quaternions of the other sign."""
    different: int = 0
    missing: int = 0
    """Leaves that only the expected value has."""
    extra: int = 0
    """Leaves that only the actual value has."""
    deviation: float = 0.0
    """The largest between two finite numbers, within tolerance or not."""
    deviation_path: str = ""

    def add(self, difference: FieldDifference) -> None:
        """Count a difference, and keep it if there is room."""
        self.count += 1
        if len(self.differences) < self.limit:
            self.differences.append(difference)

    def differ(self, path: str, expected: str, actual: str, deviation: float | None = None) -> None:
        """Note that a leaf differs."""
        self.different += 1
        self.add(FieldDifference(path, expected, actual, deviation))

    def deviate(self, path: str, deviation: float) -> None:
        """Note how far apart two numbers are."""
        if deviation > self.deviation and math.isfinite(deviation):
            self.deviation, self.deviation_path = deviation, path


def compare_fields(
    expected: Tree, actual: Tree, rules: FieldRules, findings: Findings, path: str = ""
) -> None:
    """Compare two decoded values.

    Args:
        expected: the one.
        actual: the other.
        rules: tolerances and ignored fields.
        findings: where to note what is found.
        path: what leads to the values; without positions.
    """
    _Comparer(rules, findings).compare(expected, actual, path, path)


class _Comparer:
    """Walks down both values at once; `path` has positions, `name` has not."""

    def __init__(self, rules: FieldRules, findings: Findings) -> None:
        self._rules = rules
        self._findings = findings

    def compare(self, expected: Tree, actual: Tree, path: str, name: str) -> None:
        if self._rules.ignored(name):
            return
        if isinstance(expected, dict) and isinstance(actual, dict):
            self._structs(expected, actual, path, name)
        elif isinstance(expected, np.ndarray) and isinstance(actual, np.ndarray):
            self._arrays(expected, actual, path, name)
        elif isinstance(expected, list) and isinstance(actual, list):
            self._lists(expected, actual, path, name)
        else:
            self._leaves(expected, actual, path, name)

    def _structs(
        self, expected: Mapping[str, Tree], actual: Mapping[str, Tree], path: str, name: str
    ) -> None:
        self._findings.empty += not (expected or actual)
        if _is_quaternion(expected) and _is_quaternion(actual):
            self._quaternions(expected, actual, path, name)
            return
        for key, value in expected.items():
            below = join(name, key)
            if key in actual:
                self.compare(value, actual[key], join(path, key), below)
            elif not self._rules.ignored(below):
                self._findings.missing += count_leaves(value)
                self._findings.add(FieldDifference(join(path, key), text_of(value), _NOTHING))
        for key, value in actual.items():
            if key not in expected and not self._rules.ignored(join(name, key)):
                self._findings.extra += count_leaves(value)
                self._findings.add(FieldDifference(join(path, key), _NOTHING, text_of(value)))

    def _quaternions(
        self, expected: Mapping[str, float], actual: Mapping[str, float], path: str, name: str
    ) -> None:
        """Q and -q are the same rotation: the sign that fits better is taken."""
        expected = {k: v for k, v in expected.items() if not self._rules.ignored(join(name, k))}
        turned = {key: -actual[key] for key in expected}
        nearer = min((actual, turned), key=lambda one: _distance(expected, one))
        if nearer is actual:
            for key, value in expected.items():
                self.compare(value, actual[key], join(path, key), join(name, key))
            return
        self._findings.compared += len(expected)
        agree = True
        worst = 0.0
        for key, value in expected.items():
            tolerance = self._rules.tolerance(join(name, key))
            deviation = abs(value - nearer[key])
            self._findings.deviate(join(path, key), deviation)
            agree &= value == nearer[key] or _within(deviation, value, tolerance)
            worst = max(worst, deviation)
        if agree:
            self._findings.loose += len(expected)
        else:
            # As a whole: single components of q against -q would puzzle.
            self._findings.differ(path, text_of(expected), text_of(actual), worst)

    def _lists(self, expected: list[Tree], actual: list[Tree], path: str, name: str) -> None:
        for index, (one, other) in enumerate(zip(expected, actual, strict=False)):
            self.compare(one, other, f"{path}[{index}]", name)
        self._lengths(expected, actual, path)

    def _lengths(
        self, expected: list[Tree] | NDArray[Any], actual: list[Tree] | NDArray[Any], path: str
    ) -> None:
        size, other = len(expected), len(actual)
        self._findings.empty += not (size or other)
        if size != other:
            self._findings.missing += sum(count_leaves(value) for value in expected[other:])
            self._findings.extra += sum(count_leaves(value) for value in actual[size:])
            self._findings.add(FieldDifference(path, f"{size} elements", f"{other} elements"))

    def _arrays(self, expected: NDArray[Any], actual: NDArray[Any], path: str, name: str) -> None:
        self._lengths(expected, actual, path)
        size = min(len(expected), len(actual))
        one, other = expected[:size], actual[:size]
        self._findings.compared += size
        if one.dtype == other.dtype and one.tobytes() == other.tobytes():
            return
        kinds = one.dtype.kind + other.dtype.kind
        claimed = self._rules.claimed(name)
        if "f" in kinds or (claimed is not None and "b" not in kinds):
            compare = _compare_floats if "f" in kinds else _compare_integers
            equal, agree, deviation = compare(one, other, self._rules.tolerance(name))
            if size and np.isfinite(deviation).any():
                worst = int(np.nanargmax(np.where(np.isfinite(deviation), deviation, -1.0)))
                self._findings.deviate(f"{path}[{worst}]", float(deviation[worst]))
        else:
            equal = agree = one == other
            deviation = np.full(size, np.nan)
        self._findings.loose += int((agree & ~equal).sum())
        differing = np.flatnonzero(~agree)
        for index in differing[: self._findings.limit].tolist():
            apart = float(deviation[index]) if np.isfinite(deviation[index]) else None
            self._findings.add(
                FieldDifference(f"{path}[{index}]", str(one[index]), str(other[index]), apart)
            )
        self._findings.different += len(differing)
        self._findings.count += max(len(differing) - self._findings.limit, 0)

    def _leaves(self, expected: Tree, actual: Tree, path: str, name: str) -> None:
        self._findings.compared += 1
        if type(expected) is type(actual) and expected == actual:
            return
        if _is_number(expected) and _is_number(actual):
            if expected == actual or (expected != expected and actual != actual):  # noqa: PLR0124
                return
            if isinstance(expected, float) or isinstance(actual, float):
                self._floats(_as_float(expected), _as_float(actual), path, name)
                return
            if (tolerance := self._rules.claimed(name)) is not None:
                self._integers(expected, actual, path, tolerance)
                return
        elif isinstance(expected, bytes) and isinstance(actual, bytes):
            self._bytes(expected, actual, path)
            return
        self._findings.differ(path, text_of(expected), text_of(actual))

    def _bytes(self, expected: bytes, actual: bytes, path: str) -> None:
        if len(expected) != len(actual):
            self._findings.differ(path, f"{len(expected)} bytes", f"{len(actual)} bytes")
            return
        pairs = enumerate(zip(expected, actual, strict=True))
        index, (one, other) = next(pair for pair in pairs if pair[1][0] != pair[1][1])
        self._findings.differ(f"{path}[{index}]", f"0x{one:02x}", f"0x{other:02x}")

    def _floats(self, expected: float, actual: float, path: str, name: str) -> None:
        deviation = abs(expected - actual)
        self._findings.deviate(path, deviation)
        if _within(deviation, expected, self._rules.tolerance(name)):
            self._findings.loose += 1
            return
        apart = deviation if math.isfinite(deviation) else None
        self._findings.differ(path, text_of(expected), text_of(actual), apart)

    def _integers(self, expected: int, actual: int, path: str, tolerance: Tolerance) -> None:
        apart = abs(expected - actual)
        deviation = _as_float(apart)
        self._findings.deviate(path, deviation)
        allowed = tolerance.atol
        if tolerance.rtol:
            allowed += tolerance.rtol * _as_float(abs(expected))
        if apart <= allowed:
            self._findings.loose += 1
            return
        finite = deviation if math.isfinite(deviation) else None
        self._findings.differ(path, text_of(expected), text_of(actual), finite)


def join(path: str, key: str) -> str:
    """Return the path of a struct's field."""
    return f"{path}.{key}" if path else key


def _as_float(value: float) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _is_number(value: Tree) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_quaternion(value: Mapping[str, Tree]) -> bool:
    return (
        len(value) == 4
        and value.keys() == _QUATERNION
        and all(isinstance(component, float) for component in value.values())
    )


def _distance(one: Mapping[str, float], other: Mapping[str, float]) -> float:
    """Return the largest deviation of a component; NaN and infinity count as none."""
    deviations = [abs(value - other[key]) for key, value in one.items()]
    return max((d for d in deviations if math.isfinite(d)), default=0.0)


def _within(deviation: float, expected: float, tolerance: Tolerance) -> bool:
    # An infinite expected value would allow everything.
    return math.isfinite(deviation) and deviation <= tolerance.atol + tolerance.rtol * abs(expected)


def _compare_floats(
    expected: NDArray[Any], actual: NDArray[Any], tolerance: Tolerance
) -> tuple[Flags, Flags, NDArray[np.float64]]:
    """Return (n,) which are equal, which agree, and how far they are apart."""
    one, other = expected.astype(np.float64), actual.astype(np.float64)
    with np.errstate(invalid="ignore", over="ignore"):
        deviation = np.abs(one - other)
        equal = (one == other) | (np.isnan(one) & np.isnan(other))
        near = deviation <= tolerance.atol + tolerance.rtol * np.abs(one)
    return equal, equal | (near & np.isfinite(deviation)), deviation


def _compare_integers(
    expected: NDArray[Any], actual: NDArray[Any], tolerance: Tolerance
) -> tuple[Flags, Flags, NDArray[np.float64]]:
    """Return the same as `_compare_floats`; differences of integers are exact."""
    apart = np.abs(expected.astype(object) - actual.astype(object))
    allowed = tolerance.atol + tolerance.rtol * np.abs(expected.astype(np.float64))
    return expected == actual, (apart <= allowed).astype(np.bool_), apart.astype(np.float64)


def count_leaves(value: Tree) -> int:
    """Return the number of leaves; an empty struct or array counts as one."""
    if isinstance(value, Mapping):
        return max(sum(count_leaves(inner) for inner in value.values()), 1)
    if isinstance(value, list):
        return max(sum(count_leaves(inner) for inner in value), 1)
    if isinstance(value, np.ndarray):
        return max(len(value), 1)
    return 1


def text_of(value: Tree) -> str:
    """Return a value in one line that fits a report, without control characters."""
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, bytes):
        text = f"{len(value)} bytes {value[:_TEXT_LIMIT].hex()}"
    elif isinstance(value, np.ndarray):
        text = f"[{', '.join(str(one) for one in value[:_TEXT_LIMIT])}]"
    else:
        text = json.dumps(value[:_TEXT_LIMIT] if isinstance(value, str) else value, default=text_of)
    return text if len(text) <= _TEXT_LIMIT else f"{text[: _TEXT_LIMIT - 3]}..."
