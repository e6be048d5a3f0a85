"""Logs whose feet are fields of messages of types that nobody knows."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from tests.oracles import walks
from tests.oracles.definitions import CELLS

RATE_HZ: Final = 100
DURATION_S: Final = 12.0
PERIOD_S: Final = 1.0
DUTY: Final = 0.6
START_NS: Final = 1_700_000_000_000_000_000
WEIGHT_N: Final = 30.0


def is_down(time_s: float, foot: int) -> bool:
    """Tell whether a foot of a tripod gait is down: feet 0, 2, 4 against 1, 3, 5."""
    return (time_s / PERIOD_S - foot % 2 * 0.5) % 1.0 < DUTY


def load_n(time_s: float, foot: int) -> float:
    """Return the load of a foot of six: all that are down share the weight."""
    down = sum(is_down(time_s, each) for each in range(6))
    return WEIGHT_N / down if is_down(time_s, foot) else 0.0


Samples = Callable[[float], Iterable[tuple[str, str, Mapping[str, Any]]]]
"""Topics, types and fields of the messages at a time, s."""
_TOPIC: Final = "/crawler/strut_{}/tip_load"
_READING: Final = "odd_msgs/msg/Reading"


def write(path: Path, samples: Samples) -> Path:
    """Write what is sent at each time."""
    walk, entries = walks.Walk(2), []
    for sample in range(round(DURATION_S * RATE_HZ)):
        time = START_NS + round(sample * 1e9 / RATE_HZ)
        for topic, kind, fields in samples(sample / RATE_HZ):
            data = walk.bytes_of(kind, walk.make(kind, **fields))
            entries.append(walks.Entry(topic, kind, time, data))
    return walks.write_mcap(path, walk, entries)


def six_feet(
    path: Path, kind: str = _READING, topic: str = _TOPIC, feet: Sequence[int] = range(6)
) -> Path:
    """Write six feet on unusual topics, with temperatures of the same type beside them."""

    def samples(time_s: float) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        for foot in feet:
            value: dict[str, float] = {"value": load_n(time_s, foot)}
            if kind.endswith("Touch"):
                value = {"is_down": is_down(time_s, foot)}
            elif kind.endswith("Counts"):
                value = {"value": round(load_n(time_s, foot))}
            yield topic.format(foot + 1), kind, value
            warm = {"value": 40.0 + foot + time_s * RATE_HZ * 1e-3}
            yield f"/crawler/strut_{foot + 1}/motor_temp", _READING, warm

    return write(path, samples)


def six_feet_in_two(folder: Path) -> tuple[Path, Path]:
    """Write the same recording as two files: three feet in each."""
    front = six_feet(folder / "front.mcap", feet=range(3))
    return front, six_feet(folder / "back.mcap", feet=range(3, 6))


def four_cells_a_foot(path: Path) -> Path:
    """Write two feet of a biped, each the sum of four pressure cells."""

    def samples(time_s: float) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        loads = {side: load_n(time_s, foot) / 4.0 for foot, side in enumerate("lr")}
        yield "/fsr", "odd_msgs/msg/Soles", {cell: loads[cell[0]] for cell in CELLS}

    return write(path, samples)


def wrenches(path: Path, topic: str) -> None:
    """Write four limbs that walk in turns, called by strings beside the array of wrenches."""

    def samples(time_s: float) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        forces = [[(0, 0, load_n(time_s, foot))] for foot in range(4)]
        yield topic, "odd_msgs/msg/Tips", {"name": list("abcd"), "wrench": forces}

    write(path, samples)


def switches(path: Path, legs: int) -> None:
    """Write contact switches of numbered legs."""

    def samples(time_s: float) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        for leg in range(legs):
            down = {"data": is_down(time_s, leg)}
            yield f"/leg_{leg + 1}/foot_contact", "std_msgs/msg/Bool", down

    write(path, samples)


def load_cell(path: Path, rows: int) -> Path:
    """Write one six-axis force sensor below a walking robot: rows of Fx, Fy, Fz, Tx, Ty, Tz."""
    random = np.random.default_rng(3)

    def samples(time_s: float) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        swing = np.sin(2.0 * np.pi * time_s + np.arange(6))
        data = (swing * [3, 3, 10, 0.5, 0.5, 0.5] + random.normal(0, 0.1, (rows, 6))).ravel()
        fields = {"rows": rows, "cols": 6, "data": data.astype(np.float32)}
        yield "/load_cell", "odd_msgs/msg/LoadCell", fields

    return write(path, samples)
