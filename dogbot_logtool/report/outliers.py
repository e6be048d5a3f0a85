"""Values that are unlike the others."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, median_of

MOST_DEVIATIONS: Final = 3.5
"""Modified z-score beyond which a value is an outlier (Iglewicz and Hoaglin 1993)."""
LEAST_SHARE: Final = 0.1
"""An outlier also misses the median by more than this share of it: in a walk so even that
neighbouring strides differ by one sample, one more sample is no event."""
FEWEST: Final = 5
"""Values from which a median says what is usual."""


def outliers(values: Floats, least: float = 0.0) -> tuple[Ints, float]:
    """Mark values far from the median.

    The modified z-score is 0.6745 (x - median) / MAD, with MAD the median of |x - median|; where
    that is 0, because more than half of the values are equal, it is (x - median) / 1.2533 MeanAD,
    with MeanAD the mean of |x - median|.
    Source: Iglewicz and Hoaglin, How to Detect and Handle Outliers, 1993.

    Args:
        values: (n,) any unit; NaN is not known, and no outlier.
        least: distance from the median, in that unit, up to which no value is one.

    Returns:
        (n,) 1 far above the median, -1 far below it, else 0; and the median, NaN where too few
        values are known.
    """
    known = values[np.isfinite(values)]
    if len(known) < FEWEST:
        return np.zeros(len(values), np.int64), float("nan")
    median = float(median_of(known))
    deviations = np.abs(known - median)
    usual = float(median_of(deviations)) / 0.6745 or float(np.mean(deviations)) * 1.253314
    away = np.nan_to_num(values - median)
    far = np.abs(away) > max(MOST_DEVIATIONS * usual, LEAST_SHARE * abs(median), least)
    return (np.sign(away) * far).astype(np.int64), median
