"""Two runs, or two groups of runs: can they be compared, which metrics differ, and by how much?

A metric of strides differs where a bootstrap interval of the difference of its medians leaves zero
out, and the difference is more than what the recording resolves. Intervals of times are as wide as
the sampling leaves them in doubt. Strides follow one another and are not independent, so whole
blocks of strides are drawn (moving blocks, Künsch 1989). There are many metrics, so that each
interval is as wide as the number of them asks for (Bonferroni).
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from statistics import median
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, median_of
from dogbot_logtool.core.records import METRICS, MetricPath
from dogbot_logtool.errors import LogError
from dogbot_logtool.reader.containers.loss import Damage

if TYPE_CHECKING:
    from dogbot_logtool.results import Figures

CONFIDENCE: Final = 0.95
"""That no interval misses its difference, over all metrics."""
DRAWS: Final = 20_000
BLOCK: Final = 3
"""Strides that are drawn together."""
FEWEST_STRIDES: Final = 5
"""Strides of a foot on either side; fewer give no interval."""
LEAST_SHARE: Final = 0.01
"""Differences below this share of the metric are of no interest, however certain."""
MOST_SPEED_SHARE: Final = 0.2
"""Share by which speeds may differ: stance and stride follow the speed."""
MOST_SPEED_MPS: Final = 0.05
"""m/s, by which they may differ however slow the robot is."""
MOST_MASS_SHARE: Final = 0.01
_SEED: Final = 20_261_122
_STANCE, _SWING, _START = map(str, (METRICS.stance_s, METRICS.swing_s, METRICS.start_s))
_PERIOD: Final = "period_s"


Json = Mapping[str, Any]


class MetricDifference(NamedTuple):
    """How a metric of one foot differs between two sides."""

    foot: str
    metric: str
    strides: tuple[int, int]
    """Strides on either side."""
    medians: tuple[float, float]
    difference: float
    """The second median minus the first."""
    interval: tuple[float, float]
    """Interval of the difference, at the confidence that the number of metrics asks for."""
    effect: float
    """Difference over the spread of single strides (median absolute deviation, scaled)."""
    differs: bool


class GaitComparison(NamedTuple):
    """How two sides walk."""

    sides: tuple[tuple[str, ...], tuple[str, ...]]
    """Names of the logs of either side."""
    reasons: tuple[str, ...]
    """Why they cannot be compared; empty: they can."""
    doubts: tuple[str, ...]
    """Recordings that are not to be relied on."""
    differences: tuple[MetricDifference, ...]
    """A difference for every metric that both have; empty where they cannot be compared."""
    damage: tuple[Damage, ...] = ()
    """What was lost of which log; sound logs are left out."""

    @property
    def differing(self) -> tuple[MetricDifference, ...]:
        """The metrics that differ."""
        return tuple(each for each in self.differences if each.differs)

    @property
    def exit_code(self) -> int:
        """0: nothing differs; 1: something does, or they cannot be compared."""
        return 1 if self.reasons or self.differing else 0


def compare_walks(first: Sequence["Figures"], second: Sequence["Figures"]) -> GaitComparison:
    """Compare how two sides walk.

    Args:
        first: what `stats` of each log of one side comes to.
        second: of the other.

    Raises:
        LogError: nothing of a side could be measured.
    """
    if not first or not second:
        raise LogError("nothing is left to compare: no log of one side could be measured")
    documents = [[run.json for run in side] for side in (first, second)]
    reasons = tuple(why_not_comparable(*documents))
    one, other = (tuple(each["log"]["path"] for each in side) for side in documents)
    return GaitComparison(
        sides=(one, other),
        damage=tuple(run.damage for run in (*first, *second) if run.damage.losses),
        reasons=reasons,
        doubts=tuple(doubts([*documents[0], *documents[1]])),
        differences=() if reasons else tuple(metric_differences(first, second)),
    )


def metric_differences(
    first: Sequence["Figures"], second: Sequence["Figures"]
) -> list[MetricDifference]:
    """Compare all metrics of strides, foot by foot; those of the largest effect come first.

    Args:
        first: the runs of one side.
        second: those of the other.
    """
    interval_s = max((run.interval_s for run in (*first, *second)), default=0.0)
    one, other = _values(first), _values(second)
    both = [key for key in one if key in other]
    known = [key for key in both if min(len(one[key]), len(other[key])) >= FEWEST_STRIDES]
    found = []
    for foot, metric in sorted(known):
        resolution = _resolution(metric, interval_s, one.get((foot, _PERIOD)))
        values = one[foot, metric], other[foot, metric]
        found.append(_difference(foot, metric, *values, resolution, metrics=len(known)))
    return sorted(found, key=lambda each: (not each.differs, -abs(each.effect)))


def _values(runs: Sequence["Figures"]) -> Mapping[tuple[str, str], Floats]:
    """Return the known values of each metric of each foot, run after run."""
    parts = defaultdict[tuple[str, str], list[Floats]](list)
    for run in runs:
        columns = dict(run.strides.columns)
        columns.pop(_START, None)
        if {_STANCE, _SWING} <= columns.keys():
            columns[_PERIOD] = columns[_STANCE] + columns[_SWING]
        feet = np.array(run.strides.foot)
        for foot, (metric, values) in product(dict.fromkeys(run.strides.foot), columns.items()):
            parts[foot, metric].append(values[(feet == foot) & np.isfinite(values)])
    return {key: np.concatenate(values) for key, values in parts.items()}


def _difference(
    foot: str, metric: str, one: Floats, other: Floats, resolution: float, *, metrics: int
) -> MetricDifference:
    """Compare the values of a metric.

    Args:
        foot: whose it is.
        metric: its name.
        one: (n,) of the first side. Also `other`, (m,) of the second.
        other: see `one`.
        resolution: what the recording resolves, in the metric's unit.
        metrics: how many are compared in all.
    """
    medians = float(median_of(one)), float(median_of(other))
    difference = medians[1] - medians[0]
    random = np.random.default_rng(_SEED)
    drawn = _drawn_medians(other, random) - _drawn_medians(one, random)
    # Sampled times are off by up to half an interval, and those of one side often all alike.
    drawn += random.triangular(-resolution, 0.0, resolution, DRAWS) if resolution else 0.0
    tail = (1.0 - CONFIDENCE) / max(metrics, 1) / 2.0
    low, high = np.quantile(drawn, [tail, 1.0 - tail])
    least = max(LEAST_SHARE * abs(medians[0]), resolution)
    spread = np.hypot(_spread(one), _spread(other)) / np.sqrt(2.0)
    return MetricDifference(
        foot=foot,
        metric=metric,
        strides=(len(one), len(other)),
        medians=medians,
        difference=difference,
        interval=(float(low), float(high)),
        effect=difference / float(max(spread, least, np.finfo(np.float64).tiny)),
        differs=bool((low > 0.0 or high < 0.0) and abs(difference) > least),
    )


def _drawn_medians(values: Floats, random: np.random.Generator) -> Floats:
    """(DRAWS,) medians of as many values, drawn in blocks of neighbours."""
    count = len(values)
    block = min(BLOCK, count)
    blocks = -(-count // block)
    starts: Ints = random.integers(0, count - block + 1, (DRAWS, blocks))
    rows = (starts[:, :, None] + np.arange(block)).reshape(DRAWS, -1)[:, :count]
    medians: Floats = median_of(values[rows], axis=1)
    return medians


def _resolution(metric: str, interval_s: float, period: Floats | None) -> float:
    """Return the difference that the recording resolves, in the metric's unit."""
    if metric == str(METRICS.duty_factor) and period is not None:
        return interval_s / float(median_of(period))
    return interval_s if metric in {_STANCE, _SWING, _PERIOD} else 0.0


def _spread(values: Floats) -> float:
    """Return the standard deviation that normal values of this median deviation have."""
    return 1.4826 * float(median_of(np.abs(values - median_of(values))))


def why_not_comparable(first: Sequence[Json], second: Sequence[Json]) -> list[str]:
    """Say what keeps two sides from being compared, a sentence each; empty if nothing does.

    Args:
        first: ``stats --json`` of the runs of one side.
        second: of the other.
    """
    checks = (_feet, _gait, _speed, _mass)
    return [reason for check in checks for reason in check(first, second)]


def doubts(documents: Sequence[Json]) -> Iterator[str]:
    """Yield which recordings are not to be relied on."""
    for document in documents:
        checks = document["quality"]["checks"]
        failed = [each["name"] for each in checks if each["outcome"] == "failed"]
        if failed:
            yield f"{document['log']['path']}: it does not hold that {' and '.join(failed)}"


def _feet(first: Sequence[Json], second: Sequence[Json]) -> Iterator[str]:
    if len({frozenset(document["feet"]) for document in (*first, *second)}) > 1:
        yield "the robots have different feet"
    for number, side in enumerate((first, second), 1):
        counts = [foot["strides"] or 0 for document in side for foot in document["feet"].values()]
        feet = len(set().union(*(document["feet"] for document in side)))
        if sum(counts) < FEWEST_STRIDES * max(feet, 1):
            yield f"side {number} has {sum(counts)} strides of {feet} feet: too few"


def _gait(first: Sequence[Json], second: Sequence[Json]) -> Iterator[str]:
    one, other = ({each["gait"]["name"] or "not known" for each in s} for s in (first, second))
    if len(one | other) > 1:
        yield f"the gaits differ: {', '.join(sorted(one))} against {', '.join(sorted(other))}"


def _speed(first: Sequence[Json], second: Sequence[Json]) -> Iterator[str]:
    one, other = (_known(METRICS.base.forward_speed_mps, side) for side in (first, second))
    if one and other:
        speeds = median(one), median(other)
        most = max(MOST_SPEED_MPS, MOST_SPEED_SHARE * max(map(abs, speeds)))
        if abs(speeds[0] - speeds[1]) > most:
            yield f"the speeds differ: {speeds[0]:.2f} m/s against {speeds[1]:.2f} m/s"


def _mass(first: Sequence[Json], second: Sequence[Json]) -> Iterator[str]:
    known = _known(METRICS.settings.mass_kg, (*first, *second))
    apart = known and max(known) - min(known) > MOST_MASS_SHARE * max(known)
    if apart or 0 < len(known) < len(first) + len(second):
        yield f"the masses differ: {', '.join(f'{mass:g} kg' for mass in sorted({*known}))}"


def _known(metric: MetricPath, side: Sequence[Json]) -> list[float]:
    return [value for each in side if (value := metric.value_in(each)) is not None]
