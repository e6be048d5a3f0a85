"""Sensor messages of one robot as columns, and the truth about it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import wraps
from typing import Any, Concatenate, Final, Literal, ParamSpec, Self

import numpy as np

from tests.truth.geometry import Flags, Floats, Ints
from tests.truth.robots import Robot

START_NS = 1_700_000_000_000_000_000
"""Header stamp of time 0."""
LOGGED_AFTER_NS = 700_000
"""A message's log time is its stamp and this."""


@dataclass(frozen=True, slots=True)
class Truth:
    """What is true of a recording, whatever disturbs its sensors."""

    gait_class: str | None
    """None: no gait may be claimed."""
    touchdown_s: tuple[tuple[float, ...], ...]
    """Of each foot, within the recording; also `lift_off_s`."""
    lift_off_s: tuple[tuple[float, ...], ...]
    metrics: Mapping[str, Any]
    """By name, as `judging.FIGURES` has them: of the log, or of each foot; None: not known."""
    sequence: str | None = None
    segments: tuple[str, ...] = ()
    """Classes one after another, where there are several."""
    falls_s: tuple[float, ...] = ()
    seams_s: tuple[float, ...] = ()
    """Where feet stand elsewhere at once, as recordings were joined."""

    def but(self, **metrics: Any) -> Self:
        """Return the same with other metrics."""
        return replace(self, metrics={**self.metrics, **metrics})

    @property
    def stride_s(self) -> Any:
        """Duration of all strides; None: the feet make none."""
        return self.metrics.get("stride_period_s")

    def of_feet(self, rows: Sequence[int]) -> Self:
        """Return what is true of some feet only."""

        def kept(values: Any) -> Any:
            is_of_feet = isinstance(values, tuple) and len(values) == len(self.touchdown_s)
            return tuple(values[row] for row in rows) if is_of_feet else values

        steps = {name: kept(getattr(self, name)) for name in ("touchdown_s", "lift_off_s")}
        found = {name: kept(values) for name, values in self.metrics.items()}
        return replace(self, metrics=found, **steps)


@dataclass(frozen=True)
class Messages:
    """n messages of a topic."""

    time: Floats
    """(n,) s, true time."""
    stamp: Ints
    """(n,) ns."""
    log_time: Ints
    """(n,) ns."""

    @classmethod
    def sent(cls, time: Floats, *columns: Any) -> Self:
        """Stamp messages with one perfect clock."""
        stamp = nanoseconds(time)
        return cls(time, stamp, stamp + LOGGED_AFTER_NS, *columns)

    def pick(self, rows: Flags | Ints) -> Self:
        """Keep the chosen messages."""
        return replace(self, **{each.name: getattr(self, each.name)[rows] for each in fields(self)})


@dataclass(frozen=True)
class FootRecording(Messages):
    """n messages of one foot's sensor."""

    touching: Flags
    """(n,) whether the foot is on the ground."""
    force: Floats
    """(n, 3) N, as the sensor reports it: in the world, or in its link."""
    point: Floats
    """(n, 3) m, the foot's sole in the world; the contact point where it touches."""
    normal: Floats
    """(n, 3) of the ground."""
    link: Floats
    """(n, 4) x, y, z, w: the sensor's link in the base."""


@dataclass(frozen=True)
class BaseRecording(Messages):
    """n messages of the base's odometry."""

    position: Floats
    """(n, 3) m."""
    orientation: Floats
    """(n, 4) x, y, z, w."""
    velocity: Floats
    """(n, 3) m/s, in the world."""


@dataclass(frozen=True)
class VectorRecording(Messages):
    """n messages of a topic that holds one vector: a velocity command, an accelerometer."""

    topic: str
    kind: Literal["twist", "twist_stamped", "imu"]
    vector: Floats
    """(n, 3) linear x and y and angular z, or a linear acceleration; (n, 6) with a turn rate."""
    frame: str = "base_link"


SensorKind = Literal["contacts", "gz_contacts", "wrench", "spot", "flags"]
"""Contact states with points and normals of Gazebo classic or of the new Gazebo, which speaks in
contact only; a force sensor that reports no contact; or in one message of all feet flags and places
in the base's axes, or flags alone."""


@dataclass(frozen=True, slots=True)
class Sensor:
    """One of several sensors of a foot."""

    topic: str
    frame: str
    columns: FootRecording


@dataclass(frozen=True, slots=True)
class Recording:
    """All sensors of one robot."""

    robot: Robot
    feet: tuple[FootRecording, ...]
    base: BaseRecording
    truth: Truth
    seconds: float
    kind: SensorKind = "contacts"
    sensors: tuple[tuple[Sensor, ...], ...] = ()
    """Those of each foot, where it has several."""
    has_tf: bool = False
    """Whether the log holds the transforms of the links."""
    touches_itself: bool = False
    """Whether bumpers report in swing 30 N of contact with the robot's own body."""
    beside: tuple[VectorRecording, ...] = ()
    """Topics beside feet and base."""
    places: tuple[Floats, ...] = ()
    """(n, 3) m, of each foot in the base's axes, at the times of its messages."""
    odometry: str = ""
    """Topic of the odometry; empty: the robot's."""
    child_frame: str = "base_link"
    """What the odometry says that its poses are of."""
    statics: tuple[tuple[str, tuple[float, ...]], ...] = ()
    """Frames that sit on the base: name, translation and quaternion, as one static transform."""
    given: dict[str, Any] = field(default_factory=dict)
    """Options that the user gives; without ``mass`` the truth."""

    def sensors_of(self, foot: int) -> tuple[Sensor, ...]:
        """Return a foot's sensors."""
        if self.sensors:
            return self.sensors[foot]
        frame = f"{self.robot.feet[foot]}_link"
        return (Sensor(self.robot.topic(foot), frame, self.feet[foot]),)

    def each_foot(
        self, change: Callable[[int, FootRecording], FootRecording], *only: str
    ) -> "Recording":
        """Change the recordings of all feet, or of those named."""
        feet = tuple(
            change(row, foot) if not only or self.robot.feet[row] in only else foot
            for row, foot in enumerate(self.feet)
        )
        return replace(self, feet=feet)


Disturbance = Callable[[Recording], Recording]
P = ParamSpec("P")


def of_feet(
    change: Callable[Concatenate[int, FootRecording, P], FootRecording],
) -> Callable[P, Disturbance]:
    """Make a fault of all feet out of a change of one, given its number and its messages."""

    @wraps(change)
    def fault(*words: P.args, **named: P.kwargs) -> Disturbance:
        return lambda recording: recording.each_foot(
            lambda row, foot: change(row, foot, *words, **named)
        )

    return fault


def of_base(
    change: Callable[Concatenate[BaseRecording, P], BaseRecording],
) -> Callable[P, Disturbance]:
    """Make a fault of the odometry out of a change of its messages."""

    @wraps(change)
    def fault(*words: P.args, **named: P.kwargs) -> Disturbance:
        return lambda recording: replace(recording, base=change(recording.base, *words, **named))

    return fault


def of_all(change: Callable[Concatenate[Any, P], Any]) -> Callable[P, Disturbance]:
    """Make a fault of feet and base out of a change of a topic's messages."""

    @wraps(change)
    def fault(*words: P.args, **named: P.kwargs) -> Disturbance:
        def of_both(recording: Recording) -> Recording:
            base = change(recording.base, *words, **named)
            moved = replace(recording, base=base)
            return moved.each_foot(lambda _, foot: change(foot, *words, **named))

        return of_both

    return fault


def on(fault: Disturbance, *feet: str) -> Disturbance:
    """Let a fault be of some feet only."""

    def change(recording: Recording) -> Recording:
        faulty = fault(recording).feet
        return recording.each_foot(lambda row, _: faulty[row], *feet)

    return change


def changed(**fields: Any) -> Disturbance:
    """Change how a log is recorded."""
    return lambda recording: replace(recording, **fields)


FORCE: Final = changed(kind="wrench")
"""Sensors report a force all the time, and no contact."""
FLAGS: Final = changed(kind="flags")
"""One topic tells contact of all feet, and nothing else."""
IN_CONTACT: Final = changed(kind="gz_contacts")
"""Sensors speak in contact only."""


def true(**metrics: Any) -> Disturbance:
    """Let other metrics be true, or None be known of them."""
    return lambda recording: replace(recording, truth=recording.truth.but(**metrics))


def together(*disturbances: Disturbance) -> Disturbance:
    """Make one disturbance of several."""
    return lambda recording: disturbed(recording, *disturbances)


def disturbed(recording: Recording, *disturbances: Disturbance) -> Recording:
    """Apply disturbances one after another; the truth stays."""
    for disturb in disturbances:
        recording = disturb(recording)
    return recording


def nanoseconds(time: Floats) -> Ints:
    """(n,) ns of header stamps at true times."""
    return np.asarray(START_NS + np.round(time * 1e9), dtype=np.int64)


def sample_times(seconds: float, rate_hz: float) -> Floats:
    """(n,) s, at a steady rate."""
    return np.arange(int(seconds * rate_hz + 1e-9) + 1) / rate_hz


def at_times(time: Floats, base: BaseRecording, vectors: Floats) -> Floats:
    """(n, ...) vectors of the base's poses at other times."""
    return np.stack([np.interp(time, base.time, column) for column in vectors.T], axis=1)
