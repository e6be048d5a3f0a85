"""Comparing two decoded messages, or two JSON documents, field by field.

Decoded means: structs as dicts, arrays as lists or one-dimensional numpy arrays, and as leaves
numbers, truth values, texts, bytes and None. JSON's rules on types hold for all: 1 and 1.0 are both
numbers, true is none.
"""

import json
import math
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.comparison.outcome import Difference, Findings
from dogbot_logtool.comparison.tolerances import FieldRules, Tolerance
from dogbot_logtool.core.arrays import Flags, Floats

Tree = Any
"""A decoded value; see above."""
_QUATERNION: Final = frozenset("xyzw")
_TEXT_LIMIT: Final = 100
_NOTHING: Final = "nothing"


def compare_fields(
    expected: Tree, actual: Tree, rules: FieldRules, findings: Findings, path: str = ""
) -> Findings:
    """Compare two decoded values.

    Args:
        expected: the one.
        actual: the other.
        rules: tolerances and ignored fields.
        findings: where to note what is found; it is returned.
        path: what leads to the values; without positions.
    """
    _Comparer(rules, findings).compare(expected, actual, path, path)
    return findings


class _Comparer:
    """Walks down both values at once; `path` has positions, `name` has not."""

    def __init__(self, rules: FieldRules, findings: Findings) -> None:
        self._rules = rules
        self._findings = findings

    def compare(self, expected: Tree, actual: Tree, path: str, name: str) -> None:
        if self._rules.ignored(name):
            return
        if isinstance(expected, dict) and isinstance(actual, dict):
            if _is_quaternion(expected) and _is_quaternion(actual):
                self._quaternions(expected, actual, path, name)
            else:
                self.structs(expected, actual, path, name)
        elif isinstance(expected, np.ndarray) and isinstance(actual, np.ndarray):
            self._arrays(expected, actual, path, name)
        elif isinstance(expected, list) and isinstance(actual, list):
            for index, (one, other) in enumerate(zip(expected, actual, strict=False)):
                self.compare(one, other, f"{path}[{index}]", name)
            self._lengths(expected, actual, path)
        else:
            self._leaves(expected, actual, path, name)

    def structs(
        self, expected: Mapping[str, Tree], actual: Mapping[str, Tree], path: str, name: str
    ) -> None:
        found = self._findings
        found.empty += not (expected or actual)
        for key in dict.fromkeys((*expected, *actual)):
            below, inner = join(path, key), join(name, key)
            if key in expected and key in actual:
                self.compare(expected[key], actual[key], below, inner)
            elif not self._rules.ignored(inner) and key in expected:
                found.missing += count_leaves(expected[key])
                found.add(Difference(below, text_of(expected[key]), _NOTHING))
            elif not self._rules.ignored(inner):
                found.extra += count_leaves(actual[key])
                found.add(Difference(below, _NOTHING, text_of(actual[key])))

    def _quaternions(
        self, expected: Mapping[str, float], actual: Mapping[str, float], path: str, name: str
    ) -> None:
        """Q and -q are the same rotation: the sign that fits better is taken."""
        counting = [key for key in expected if not self._rules.ignored(join(name, key))]
        expected, actual = ({key: each[key] for key in counting} for each in (expected, actual))
        turned = {key: -value for key, value in actual.items()}
        if _distance(expected, actual) <= _distance(expected, turned):
            self.structs(expected, actual, path, name)
            return
        found = Findings(0)
        _Comparer(self._rules, found).structs(expected, turned, path, name)
        self._findings.compared += found.compared
        self._deviate(found.deviation_path, found.deviation)
        if found.count:
            # As a whole: single components of q against -q would puzzle.
            self._differ(path, text_of(expected), text_of(actual), found.deviation)
        else:
            self._findings.loose += found.compared

    def _lengths(
        self, expected: list[Tree] | NDArray[Any], actual: list[Tree] | NDArray[Any], path: str
    ) -> None:
        size, other = len(expected), len(actual)
        self._findings.empty += not (size or other)
        if size != other:
            self._findings.missing += sum(map(count_leaves, expected[other:]))
            self._findings.extra += sum(map(count_leaves, actual[size:]))
            self._findings.add(Difference(path, f"{size} elements", f"{other} elements"))

    def _arrays(self, expected: NDArray[Any], actual: NDArray[Any], path: str, name: str) -> None:
        self._lengths(expected, actual, path)
        size = min(len(expected), len(actual))
        one, other, found = expected[:size], actual[:size], self._findings
        found.compared += size
        if one.dtype == other.dtype and one.tobytes() == other.tobytes():
            return
        is_float = "f" in one.dtype.kind + other.dtype.kind
        tolerance = self._rules.tolerance(name) if is_float else self._rules.claimed(name)
        equal, agree, apart = _compare_arrays(one, other, tolerance)
        if size:
            worst = int(apart.argmax())
            self._deviate(f"{path}[{worst}]", float(apart[worst]))
        found.loose += int((agree & ~equal).sum())
        differing = np.flatnonzero(~agree)
        for row in differing[: found.limit].tolist():
            deviation = float(apart[row]) if apart[row] >= 0.0 else None
            found.add(Difference(f"{path}[{row}]", str(one[row]), str(other[row]), deviation))
        found.different += len(differing)
        found.count += max(len(differing) - found.limit, 0)

    def _leaves(self, expected: Tree, actual: Tree, path: str, name: str) -> None:
        self._findings.compared += 1
        if type(expected) is type(actual) and expected == actual:
            return
        if _is_number(expected) and _is_number(actual):
            self._numbers(expected, actual, path, name)
        elif isinstance(expected, bytes) and isinstance(actual, bytes):
            self._bytes(expected, actual, path)
        else:
            self._differ(path, text_of(expected), text_of(actual))

    def _numbers(self, expected: float, actual: float, path: str, name: str) -> None:
        if expected == actual or (expected != expected and actual != actual):  # noqa: PLR0124
            return
        texts = text_of(expected), text_of(actual)
        tolerance = self._rules.claimed(name)
        if isinstance(expected, float) or isinstance(actual, float):
            expected, actual = _as_float(expected), _as_float(actual)
            tolerance = self._rules.tolerance(name)
        if tolerance is None:
            self._differ(path, *texts)
            return
        apart = abs(expected - actual)
        allowed = tolerance.atol
        if tolerance.rtol:
            allowed += tolerance.rtol * _as_float(abs(expected))
        self._deviate(path, _as_float(apart))
        # An infinite expected value would allow everything.
        if apart <= allowed and apart < math.inf:
            self._findings.loose += 1
        else:
            self._differ(path, *texts, _as_float(apart))

    def _bytes(self, expected: bytes, actual: bytes, path: str) -> None:
        if len(expected) != len(actual):
            self._differ(path, f"{len(expected)} bytes", f"{len(actual)} bytes")
            return
        pairs = enumerate(zip(expected, actual, strict=True))
        index, (one, other) = next(pair for pair in pairs if pair[1][0] != pair[1][1])
        self._differ(f"{path}[{index}]", f"0x{one:02x}", f"0x{other:02x}")

    def _differ(self, path: str, one: str, other: str, deviation: float = math.nan) -> None:
        """Note that a leaf differs."""
        self._findings.different += 1
        apart = deviation if math.isfinite(deviation) else None
        self._findings.add(Difference(path, one, other, apart))

    def _deviate(self, path: str, deviation: float) -> None:
        """Note how far apart two numbers are."""
        if self._findings.deviation < deviation < math.inf:
            self._findings.deviation, self._findings.deviation_path = deviation, path


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
    return value.keys() == _QUATERNION and all(isinstance(each, float) for each in value.values())


def _distance(one: Mapping[str, float], other: Mapping[str, float]) -> float:
    """Return the largest deviation of a component; NaN and infinity count as none."""
    deviations = [abs(value - other[key]) for key, value in one.items()]
    return max((d for d in deviations if math.isfinite(d)), default=0.0)


def _compare_arrays(
    expected: NDArray[Any], actual: NDArray[Any], tolerance: Tolerance | None
) -> tuple[Flags, Flags, Floats]:
    """Compare arrays of one length.

    Returns:
        (n,) which are equal, which agree, and how far they are apart: below 0 where that is no
        finite number, and without a tolerance everywhere.
    """
    kinds = {expected.dtype.kind, actual.dtype.kind}
    if tolerance is None or "b" in kinds:
        equal = expected == actual
        return equal, equal, np.full(len(equal), -1.0)
    # Differences of integers are exact.
    one, other = (
        each.astype(np.float64 if "f" in kinds else object) for each in (expected, actual)
    )
    with np.errstate(invalid="ignore", over="ignore"):
        apart = np.abs(one - other)
        agree = (apart <= tolerance.atol + tolerance.rtol * np.abs(one)).astype(np.bool_)
    equal = (one == other) | ((one != one) & (other != other))  # noqa: PLR0124 - NaN
    apart = np.where(np.isfinite(apart.astype(np.float64)), apart, -1.0).astype(np.float64)
    return equal, equal | (agree & (apart >= 0.0)), apart


def count_leaves(value: Tree) -> int:
    """Return the number of leaves; an empty struct or array counts as one."""
    if isinstance(value, np.ndarray):
        return max(len(value), 1)
    if isinstance(value, Mapping | list):
        inner = value.values() if isinstance(value, Mapping) else value
        return max(sum(map(count_leaves, inner)), 1)
    return 1


def text_of(value: Tree) -> str:
    """Return a value in one line that fits a report, without control characters."""
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, bytes):
        text = f"{len(value)} bytes {value[:_TEXT_LIMIT].hex()}"
    elif isinstance(value, np.ndarray):
        text = f"[{', '.join(map(str, value[:_TEXT_LIMIT]))}]"
    else:
        text = json.dumps(value[:_TEXT_LIMIT] if isinstance(value, str) else value, default=text_of)
    return text if len(text) <= _TEXT_LIMIT else f"{text[: _TEXT_LIMIT - 3]}..."
