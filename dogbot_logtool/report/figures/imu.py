"""Figures of the base's accelerometer against the feet's forces and the base's poses."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.figures.figure import Figure, Kind, Member, Scope

# Loaded for logs with an accelerometer.
if TYPE_CHECKING:
    from dogbot_logtool.core.geometry.delay import Delay
    from dogbot_logtool.core.imu.comparison import ImuComparison
    from dogbot_logtool.core.imu.forces import ForceComparison, Turn


@dataclass(frozen=True, slots=True)
class ImuSource:
    """The source of the accelerometer's figures."""

    stats: Stats
    imu: "ImuComparison"


def imu_source(stats: Stats) -> ImuSource | None:
    """Return what the figures are taken from; None in a log without an accelerometer."""
    return None if stats.imu is None else ImuSource(stats, stats.imu)


@dataclass(frozen=True, slots=True)
class _ForceSource:
    stats: Stats
    forces: "ForceComparison"

    @property
    def scales(self) -> Mapping[str, float] | None:
        """Factor by foot; None unless all are known."""
        found = self.forces.scales
        if found is None:
            return None
        names = (foot.name for foot in self.stats.feet)
        told = {name: each for name, each in zip(names, found.feet, strict=True) if each}
        return told if len(told) == len(found.feet) else None


def _forces(source: ImuSource) -> _ForceSource | None:
    forces = source.imu.forces
    return None if forces is None else _ForceSource(source.stats, forces)


_STILL: Final = "the base hardly accelerates horizontally (root mean square below 0.15 m/s^2)"
_TURN: "Final[Sequence[Figure[Turn]]]" = (
    Figure(
        "turn_rad",
        Kind.NUMBER,
        lambda turn: turn.angle_rad,
        "argument of the sum of a conj(b), with horizontal means over a stride as complex numbers: "
        "b of the poses; to the left",
    ),
    Figure(
        "coherence",
        Kind.FRACTION,
        lambda turn: min(turn.coherence, 1.0),
        "|sum a conj(b)| / sqrt(sum |a|^2 sum |b|^2): 1 where one is the other, turned and scaled",
    ),
)
_CURVE: "Final[Sequence[Figure[Delay]]]" = (
    Figure(
        "correlation",
        Kind.NUMBER,
        lambda delay: delay.correlation,
        "largest correlation of both, over delays of up to an eighth of a stride either way, 0.2 s "
        "at most",
    ),
    Figure(
        "delay_s",
        Kind.NUMBER,
        lambda delay: delay.delay_s,
        "delay of the forces behind the accelerometer at that correlation",
    ),
)
_FORCES: Final[Sequence[Member]] = (
    Figure[_ForceSource](
        "known_s",
        Kind.AMOUNT,
        lambda source: source.forces.known_s,
        "time that it is over: windows inside of whole strides in which all feet, accelerometer "
        "and poses are known",
    ),
    Figure[_ForceSource](
        "over_mass_mps2",
        Kind.NUMBER,
        lambda source: source.forces.vertical_mps2,
        "mean sum of the feet's vertical forces over the mass",
    ),
    Figure[_ForceSource](
        "over_accelerometer",
        Kind.NUMBER,
        lambda source: source.forces.ratio,
        "the same over the vertical specific force, levelled and in m/s^2: 1 in a sound recording",
    ),
    Figure[_ForceSource](
        "foot_factors",
        Kind.NUMBERS_BY_NAME,
        lambda source: source.scales,
        "what each foot's force must be multiplied with so that their sum is mass times vertical "
        "specific force, 25 times a second (least squares)",
        null="the load does not shift between the feet, feet always press together, or a factor is "
        "not known to 0.1, with what the factors leave unexplained in every stride alike",
    ),
    Scope(
        "direction",
        _TURN,
        lambda source: source.forces.turn,
        "horizontal forces over the mass against the base's acceleration from poses",
        null=f"{_STILL}; directions of forces are not known",
    ),
    Scope(
        "curve",
        _CURVE,
        lambda source: source.forces.curve,
        "how vertical forces over the mass swing about their mean over a stride, against the "
        "accelerometer",
        null="one of both swings by less than 0.02 g; fewer than four strides",
    ),
)
IMU: Final[Sequence[Member]] = (
    Figure[ImuSource](
        "topic", Kind.TEXT, lambda source: source.imu.sensed.topic, "topic of the accelerometer"
    ),
    Figure[ImuSource](
        "frames",
        Kind.TEXTS,
        lambda source: list(source.imu.sensed.frames),
        "frames of its messages' headers",
    ),
    Figure[ImuSource](
        "mounting",
        Kind.TEXT,
        lambda source: "recorded" if source.imu.mounting_recorded else "assumed",
        "whether how it sits on the base was recorded as a static transform, or its frame is taken "
        "to be the base's",
        choices=("recorded", "assumed"),
    ),
    Figure[ImuSource](
        "known_s",
        Kind.AMOUNT,
        lambda source: source.imu.known_s,
        "time with accelerometer and poses: all means are over a stride (0.5 s without strides) "
        "about 25 instants a second in it",
    ),
    Figure[ImuSource](
        "reads",
        Kind.TEXT,
        lambda source: source.imu.mounting.reading and source.imu.mounting.reading.value,
        "what it reads, by its mean specific force: m/s^2 within 5 % of what is expected, g within "
        "5 % of 1, without gravity below 4 % of g",
        null="means over strides leave what a mounting explains by more than 0.1 g (root mean "
        "square)",
        choices=("m/s^2", "g", "without gravity", "nothing", "another scale"),
    ),
    Figure[ImuSource](
        "accelerometer_mps2",
        Kind.AMOUNT,
        lambda source: source.imu.imu_mps2,
        "length of its mean specific force in the base's frame, as recorded: g, whatever the robot "
        "weighs",
    ),
    Figure[ImuSource](
        "poses_mps2",
        Kind.NUMBER,
        lambda source: source.imu.base_mps2,
        "9.81 and the base's mean vertical acceleration, from the change of its speed over strides",
    ),
    Figure[ImuSource](
        "tilt_rad",
        Kind.AMOUNT,
        lambda source: source.imu.mounting.tilt_rad,
        "angle of its mean specific force against what attitude, gravity and poses expect",
        null="it reads no gravity, or `reads` is null",
    ),
    Scope(
        "direction",
        _TURN,
        lambda source: source.imu.turn,
        "its horizontal acceleration, levelled, against the base's from poses",
        null=f"{_STILL}; what it reads is not known, or of another scale",
    ),
    Scope(
        "forces",
        _FORCES,
        _forces,
        "the feet's forces against it",
        null="no strides (a robot may rest on its body), no mass, vertical forces are not known, "
        "what it reads is not known or of another "
        "scale, or less than 2 s in common",
    ),
)
"""Figures of a `ImuSource`."""
