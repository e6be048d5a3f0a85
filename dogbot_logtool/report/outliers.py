"""Values that are unlike the others."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, median_of

MOST_DEVIATIONS: Final = 3.5
"""Modified z-score beyond which a value is an outlier (Iglewicz and Hoaglin 1993)."""
LEAST_SHARE: Final = 0.1
"""An outlier also misses the median by more than this share of it: in a walk so even that
neighbouring strides differ by one sample, one more sample is no event."""
FEWEST: Final = 5
"""Values from which a median says what is usual."""


@dataclass(frozen=True, slots=True)
class Outliers:
    """Values of one figure that are far from the usual."""

    high: Flags
    """(n,) far above the median."""
    low: Flags
    """(n,) far below it."""
    median: float
    """NaN where too few values are known."""


def outliers(values: Floats, least: float = 0.0) -> Outliers:
    """Mark values far from the median.

    The modified z-score is 0.6745 (x - median) / MAD, with MAD the median of |x - median|; where
    that is 0, because more than half of the values are equal, it is (x - median) / 1.2533 MeanAD,
    with MeanAD the mean of |x - median|.
    Source: Iglewicz and Hoaglin, How to Detect and Handle Outliers, 1993.

    Args:
        values: (n,) any unit; NaN is not known, and no outlier.
        least: distance from the median, in that unit, up to which no value is one.
    """
    known = values[np.isfinite(values)]
    none = np.zeros(len(values), np.bool_)
    if len(known) < FEWEST:
        return Outliers(none, none, float("nan"))
    median = float(median_of(known))
    deviations = np.abs(known - median)
    usual = float(median_of(deviations)) / 0.6745 or float(np.mean(deviations)) * 1.253314
    away = values - median
    with np.errstate(invalid="ignore"):
        far = np.abs(away) > MOST_DEVIATIONS * usual
        far &= np.abs(away) > max(LEAST_SHARE * abs(median), least)
        return Outliers(far & (away > 0.0), far & (away < 0.0), median)
