"""The repository's own sample logs against the truth that is written beside them."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from tests.paths import SAMPLE_LOGS
from tests.truth.events import matched
from tests.truth.outcome import Outcome, measured_log

REACH_S: Final = 0.1
_LOG: Final = (
    ("duty factor", "gait.duty_factor", "gait.duty_factor"),
    ("stride frequency, Hz", "gait.stride_frequency_hz", "gait.stride_frequency_hz"),
    ("forward speed, m/s", "base.forward_speed_mps", "base.forward_speed_mps"),
    ("path length, m", "base.path_length_m", "base.path_length_m"),
    (
        "vertical impulse over weight",
        "forces.vertical_impulse_over_weight",
        "forces.vertical_impulse_over_weight",
    ),
)
"""Name, key in the truth, key in the JSON."""
_FEET: Final = (
    ("contact fraction", "contact_fraction", "contact_fraction"),
    ("peak vertical force, N", "peak_vertical_force_n", "peak_vertical_force_n.max"),
)


def sample_rows() -> Iterator[tuple[str, ...]]:
    """Yield log, figure, truth, result and error."""
    for file in sorted(SAMPLE_LOGS.glob("*.truth.json")):
        name = file.name.removesuffix(".truth.json")
        log = next(path for path in SAMPLE_LOGS.glob(f"{name}.*") if path.suffix != ".json")
        yield from _rows(log, json.loads(file.read_text(encoding="utf-8")))


def _rows(log: Path, truth: dict[str, Any]) -> Iterator[tuple[str, ...]]:
    found = measured_log(log)
    true, result = truth["gait"]["class"], found.figure("gait.name")
    yield log.name, "gait", true, str(result), "" if true == result else "differs"
    for name, key, figure in _LOG:
        group, _, last = key.partition(".")
        yield log.name, name, *_compared(truth[group][last], found.figure(figure))
    for name, key, figure in _FEET:
        for foot, figures in truth["feet"].items():
            result = found.figure(f"feet.{foot}.{figure}")
            yield log.name, f"{name}, {foot}", *_compared(figures[key], result)
    for name, key in (("touchdowns", "touchdown_s"), ("lift-offs", "lift_off_s")):
        yield log.name, name, *_events(truth, found, key)


def _compared(true: float | None, result: float | None) -> tuple[str, str, str]:
    if true is None or result is None:
        return f"{true}", "null" if result is None else f"{result:.4f}", ""
    error = f"{(result - true) / true * 100.0:+.2f} %" if true else f"{result:+.4f}"
    return f"{true:.4f}", f"{result:.4f}", error


def _events(truth: dict[str, Any], found: Outcome, key: str) -> tuple[str, str, str]:
    """Compare events; truth's seconds count from the log's beginning, as the figures' do."""
    errors: list[float] = []
    count = 0
    for foot, figures in truth["feet"].items():
        result = np.array(found.figure(f"feet.{foot}.{key}") or [], np.float64)
        true = np.array(figures[key.replace("lift_off", "liftoff")])
        errors += matched(true, result, REACH_S)
        count += len(true)
    spread = f"{np.mean(errors) * 1e3:+.1f} ± {np.std(errors) * 1e3:.1f} ms" if errors else ""
    return str(count), f"{len(errors)} of them", spread
