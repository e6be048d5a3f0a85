"""Comparing two decoded messages, or two JSON documents, field by field.

Decoded means: structs as mappings, arrays as lists or one-dimensional numpy arrays, and as leaves
numbers, truth values, texts, bytes and None. JSON's rules on types hold for all: 1 and 1.0 are both
numbers, true is none.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags
from dogbot_logtool.comparison.tolerances import FieldRules, Tolerance

Tree = Any
"""A decoded value; see above."""
_QUATERNION: Final = frozenset("xyzw")
_TEXT_LIMIT: Final = 100
_NOTHING: Final = "nothing"


@dataclass(frozen=True, slots=True)
class FieldDifference:
    """One place at which two values differ."""

    path: str
    """``entities[0].arrows[0].pose.position.z``."""
    expected: str
    actual: str
    deviation: float | None = None
    """|expected - actual| where both are finite numbers."""


@dataclass(slots=True)
class Findings:
    """What comparing two values found."""

    limit: int
    """Differences to keep."""
    differences: list[FieldDifference] = field(default_factory=list)
    compared: int = 0
    """Leaves that both have."""
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

    @property
    def differing(self) -> int:
        """Number of differences, kept or not."""
        return self.different + self.missing + self.extra

    def add(self, difference: FieldDifference) -> None:
        """Keep a difference, if there is room."""
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
    expected: Tree,
    actual: Tree,
    rules: FieldRules,
    *,
    limit: int,
    path: str = "",
    field_path: str | None = None,
) -> Findings:
    """Compare two decoded values.

    Args:
        expected: the one.
        actual: the other.
        rules: tolerances and ignored fields.
        limit: the number of differences to keep; all are counted.
        path: what leads to the values.
        field_path: the same without positions, if it differs.
    """
    findings = Findings(limit)
    _Comparer(rules, findings).compare(
        expected, actual, path, path if field_path is None else field_path
    )
    return findings


class _Comparer:
    """Walks down both values at once; `path` has positions, `name` has not."""

    def __init__(self, rules: FieldRules, findings: Findings) -> None:
        self._rules = rules
        self._findings = findings

    def compare(self, expected: Tree, actual: Tree, path: str, name: str) -> None:
        if self._rules.ignored(name):
            return
        if isinstance(expected, Mapping) and isinstance(actual, Mapping):
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
        if _is_quaternion(expected) and _is_quaternion(actual):
            self._quaternions(expected, actual, path, name)
            return
        # Joined only where there is something above: this is the innermost loop.
        path_to, name_to = (f"{path}." if path else ""), (f"{name}." if name else "")
        for key, value in expected.items():
            if key in actual:
                self.compare(value, actual[key], path_to + key, name_to + key)
            elif not self._rules.ignored(name_to + key):
                self._findings.missing += count_leaves(value)
                self._findings.add(FieldDifference(path_to + key, text_of(value), _NOTHING))
        for key, value in actual.items():
            if key not in expected and not self._rules.ignored(name_to + key):
                self._findings.extra += count_leaves(value)
                self._findings.add(FieldDifference(path_to + key, _NOTHING, text_of(value)))

    def _quaternions(
        self, expected: Mapping[str, float], actual: Mapping[str, float], path: str, name: str
    ) -> None:
        """q and -q are the same rotation: the sign that fits better is taken."""
        turned = {key: -value for key, value in actual.items()}
        nearer = min((actual, turned), key=lambda one: _distance(expected, one))
        if nearer is actual:
            for key, value in expected.items():
                self._leaves(value, actual[key], f"{path}.{key}", f"{name}.{key}")
            return
        self._findings.compared += 4
        agree = True
        worst = 0.0
        for key, value in expected.items():
            tolerance = self._rules.tolerance(f"{name}.{key}")
            deviation = abs(value - nearer[key])
            self._findings.deviate(f"{path}.{key}", deviation)
            agree &= value == nearer[key] or _within(deviation, value, tolerance)
            worst = max(worst, deviation)
        if agree:
            self._findings.loose += 4
        else:
            # As a whole: single components of q against -q would puzzle.
            self._findings.differ(path, text_of(expected), text_of(actual), worst)

    def _lists(self, expected: list[Tree], actual: list[Tree], path: str, name: str) -> None:
        for index, (one, other) in enumerate(zip(expected, actual, strict=False)):
            self.compare(one, other, f"{path}[{index}]", name)
        self._lengths(expected, actual, path)

    def _lengths(self, expected: Sequence[Tree], actual: Sequence[Tree], path: str) -> None:
        size, other = len(expected), len(actual)
        if size != other:
            self._findings.missing += sum(count_leaves(value) for value in expected[other:])
            self._findings.extra += sum(count_leaves(value) for value in actual[size:])
            self._findings.add(FieldDifference(path, f"{size} elements", f"{other} elements"))

    def _arrays(
        self, expected: NDArray[Any], actual: NDArray[Any], path: str, name: str
    ) -> None:
        self._lengths(expected, actual, path)
        size = min(len(expected), len(actual))
        one, other = expected[:size], actual[:size]
        self._findings.compared += size
        if "f" in one.dtype.kind + other.dtype.kind:
            equal, agree, deviation = _compare_floats(one, other, self._rules.tolerance(name))
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

    def _leaves(self, expected: Tree, actual: Tree, path: str, name: str) -> None:
        self._findings.compared += 1
        if _is_number(expected) and _is_number(actual):
            if expected == actual or (expected != expected and actual != actual):  # noqa: PLR0124
                return
            if isinstance(expected, float) or isinstance(actual, float):
                self._floats(float(expected), float(actual), path, name)
                return
        elif type(expected) is type(actual) and _same(expected, actual):
            return
        self._findings.differ(path, text_of(expected), text_of(actual))

    def _floats(self, expected: float, actual: float, path: str, name: str) -> None:
        deviation = abs(expected - actual)
        self._findings.deviate(path, deviation)
        if _within(deviation, expected, self._rules.tolerance(name)):
            self._findings.loose += 1
            return
        apart = deviation if math.isfinite(deviation) else None
        self._findings.differ(path, text_of(expected), text_of(actual), apart)


def _is_number(value: Tree) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_quaternion(value: Mapping[str, Tree]) -> bool:
    return value.keys() == _QUATERNION and all(
        isinstance(component, float) for component in value.values()
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


def _same(expected: Tree, actual: Tree) -> bool:
    """Compare leaves of one type that are no numbers."""
    return bool(expected == actual)


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
        text = f"{len(value)} bytes {value[: _TEXT_LIMIT // 2].hex()}"
    elif isinstance(value, np.ndarray):
        text = f"[{', '.join(str(one) for one in value[:_TEXT_LIMIT])}]"
    else:
        text = json.dumps(value, default=text_of)
    return text if len(text) <= _TEXT_LIMIT else f"{text[: _TEXT_LIMIT - 1]}…"
