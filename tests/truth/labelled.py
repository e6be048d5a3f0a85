"""Real logs whose events people have labelled."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from tests.truth.events import matched
from tests.truth.outcome import Outcome, measured_log
from tests.truth.recording import Floats

REACH_S: Final = 0.15
_SUFFIX: Final = ".events.json"
_KINDS: Final = (("heel_strike_s", "touchdown_s"), ("toe_off_s", "lift_off_s"))
"""Key of the labels, key in the JSON."""


def labelled_rows(folder: Path) -> Iterator[tuple[str, ...]]:
    """Yield log, foot, contact fraction, touchdowns and lift-offs.

    Args:
        folder: NAME.mcap or NAME.bag beside NAME.events.json, which holds for each foot
            ``heel_strike_s`` and ``toe_off_s``: seconds since the log's start.
    """
    for file in sorted(folder.rglob(f"*{_SUFFIX}")):
        stem = file.name.removesuffix(_SUFFIX)
        log = next(path for path in file.parent.glob(f"{stem}.*") if path != file)
        labels = json.loads(file.read_text(encoding="utf-8"))
        found = measured_log(log)
        duration_s = found.json["log"]["duration_s"]
        for foot, events in labels.items():
            fraction = found.figure(f"feet.{foot}.contact_fraction")
            result = "null" if fraction is None else f"{fraction:.3f}"
            true = f"{contact_fraction(events, duration_s):.3f}"
            kinds = (_compared(events, found, foot, *kind) for kind in _KINDS)
            yield log.name, foot, f"{true} → {result}", *kinds


def contact_fraction(events: dict[str, Any], duration_s: float) -> float:
    """Return the part of the log between a heel strike and the toe-off after it."""
    strikes, offs = (np.array(events[label]) for label, _ in _KINDS)
    row = np.searchsorted(offs, strikes)
    ends = np.append(offs, duration_s)[row]
    return float((ends - strikes).sum() / duration_s)


def _compared(events: dict[str, Any], found: Outcome, foot: str, label: str, key: str) -> str:
    true: Floats = np.array(events[label])[1:-1]
    result = np.array(found.figure(f"feet.{foot}.{key}") or [], np.float64)
    errors = np.array(matched(true, result, REACH_S)) * 1e3
    if not len(errors):
        return f"0 of {len(true)}"
    spread = f"{errors.mean():+.0f} ± {errors.std():.0f} ms, at most {np.abs(errors).max():.0f} ms"
    return f"{len(errors)} of {len(true)}, {spread}"
