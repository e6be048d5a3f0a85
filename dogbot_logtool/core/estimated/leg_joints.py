"""The joints of all legs, from whatever topics tell them, at the same times."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, all_finite, median_of
from dogbot_logtool.core.corrections.clock import (
    TimeSource,
    advancing,
    check_stamps,
    first_at_each_tick,
)
from dogbot_logtool.core.legs.joints import JointTable

RATE_HZ: Final = 200.0
"""At which legs are looked at, at most."""
SLOWEST_S: Final = 0.04
"""s between two joint states, beyond which they tell no contact."""
FEWEST: Final = 20
"""Joint states at least."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LegJoints:
    """The k joints of all legs at n times."""

    names: tuple[str, ...]
    topic: str
    """The topic that tells of most of them."""
    clock: TimeSource
    log_time: Ints
    """(n,) ns; also `stamp`."""
    stamp: Ints
    time: Ints
    """(n,) ns on `clock`, strictly increasing."""
    position: Floats
    """(n, k) rad or m."""
    effort: Floats
    """(n, k) N m or N; NaN: not told."""

    @property
    def seconds(self) -> Floats:
        """(n,) s since the first."""
        return np.asarray((self.time - self.time[0]) / 1e9)

    def columns(self, names: Sequence[str]) -> list[int]:
        """Return the columns of some joints."""
        return [self.names.index(name) for name in names]


def joints_of_legs(tables: Sequence[JointTable], names: Sequence[str]) -> LegJoints:
    """Return joints at the times of the topic that tells of most of them.

    Args:
        tables: joint states, the best topic first.
        names: of the joints.

    Raises:
        ValueError: a sentence: not all of them are told, or too rarely.
    """
    table_of = {name: table for table in reversed(tables) for name in table.names}
    if lacking := [name for name in names if name not in table_of]:
        text = f"joint states do not tell of {', '.join(lacking)}"
        raise ValueError(f"{text}, which the robot description has")
    of = [table_of[name] for name in names]
    main = max(of, key=of.count)
    checks = {t.topic: check_stamps(t.topic, t.samples.stamp, t.samples.log_time) for t in of}
    stamped = all(check.mostly_usable for check in checks.values())
    clock = TimeSource.HEADER if stamped else TimeSource.LOG
    own = [main.names.index(name) for name in names if table_of[name] is main]
    usable = all_finite(main.samples.position[:, own])
    if stamped:
        usable &= checks[main.topic].usable
    rows, all_times = np.flatnonzero(usable), clock.of(main.samples)
    rows = rows[advancing(all_times[rows])]
    rows = rows[first_at_each_tick(all_times[rows], RATE_HZ)]
    time = all_times[rows]
    position, effort = np.full((2, len(rows), len(names)), np.nan)
    for column, (name, table) in enumerate(zip(names, of, strict=True)):
        samples, there = table.samples, table.names.index(name)
        for found, recorded in ((position, samples.position), (effort, samples.effort)):
            values = recorded[:, there]
            same = table is main
            found[:, column] = (
                values[rows] if same else _interpolated(time, clock.of(samples), values)
            )
    if len(rows) < FEWEST or not np.isfinite(position).all():
        raise ValueError("too few joint states tell the positions of all joints of the legs")
    interval_s = float(median_of(np.diff(time))) / 1e9
    if interval_s > SLOWEST_S:
        raise ValueError(f"joint states come {1.0 / interval_s:.3g} times a second, too rarely")
    times = main.samples.log_time[rows], main.samples.stamp[rows], time
    return LegJoints(tuple(names), main.topic, clock, *times, position, effort)


def _interpolated(at: Ints, time: Ints, values: Floats) -> Floats:
    """(n,) values of another topic; NaN where all are."""
    rows = np.flatnonzero(np.isfinite(values))
    rows = rows[advancing(time[rows])]
    if not len(rows):
        return np.full(len(at), np.nan)
    first = time[rows[0]]
    return np.asarray(np.interp(at - first, time[rows] - first, values[rows]))
