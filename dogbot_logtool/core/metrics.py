"""The metrics of a walk: a field of a record is a metric, declared here and nowhere else.

Its name is the key in JSON, the string below it its definition, its annotation type, unit and
needs. ``None`` is "not measured"; `WalkMetrics.null_because` names the cause. Spans: `Base`,
`Gait`, `Foot`, `Forces` and `Stability` are measured for the whole log and, with the same names,
for each segment.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Final

from dogbot_logtool.core.records import Count, Number, Numbers, Of, Record, Shape, Spread, Text

SCHEMA_VERSION: Final = 3
"""Grows with every change of meaning."""
NEEDS: Final[Mapping[str, str]] = {
    "feet": "no topic of feet",
    "two feet": "for two feet only",
    "four feet": "for four feet only",
    "contact": "no contacts of this foot",
    "all feet": "contact of some foot not known",
    "strides": "no whole stride",
    "phases": "no touchdowns of some foot in whole strides",
    "leg positions": "leg positions not known",
    "base": "no poses of the base",
    "points": "no contact points",
    "places": "no places of this foot, and no poses of the base",
    "straight": "no places of this foot, and the base turns in its strides",
    "foot frame": "no transforms or joints of the legs",
    "leg rate": "legs or contacts sampled below 100 Hz",
    "rolling": "foot_rolling_m not known: --set foot_rolling_m=M",
    "three feet": "never three feet down",
    "force": "no forces, contact only",
    "vertical force": "frame of the forces not known",
    "weight": "mass not known: --mass KG",
    "normals": "no contact normals",
    "joints": "no joint states",
    "efforts": "no joint efforts",
    "limits": "no joint limits (URDF)",
    "commands": "no velocity commands",
    "imu": "no accelerometer",
    "plan": "no planned contacts",
    "stamps": "no header stamps that are read",
}
"""What a log may lack, and the sentence that says so; of several the first is told."""


_PHASED: Final = ("feet", "strides", "phases", "leg positions")
_FOUR: Final = ("feet", "four feet", "strides", "phases", "leg positions")
_VERTICAL: Final = ("contact", "force", "vertical force")
_PRESSED: Final = ("feet", "base", "points", "force", "vertical force", "all feet")
_SWUNG: Final = ("strides", "base", "foot frame")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Log(Record):
    """What was read."""

    path: str
    """Name of the log as given."""
    container: str
    """ROS 1 bag, MCAP, ROS 2 SQLite bag."""
    profile: str
    """ros1, ros2 or empty."""
    start_s: Annotated[Number, Of("s")]
    """Log time of the first message, Unix time or simulation time; null: no messages."""
    duration_s: Annotated[Number, Of("s")]
    """Last less first log time; null: no messages."""
    messages: int
    """Messages in the log."""
    lost_messages: Count
    """Messages that could not be read; null where their number is not known."""
    lost_bytes: Annotated[Count, Of("B")]
    """Bytes that could not be read."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FootSettings(Record):
    """How the contact of one foot was detected."""

    topic: Text
    """Topic of its contacts."""
    leg_position: tuple[str, ...] | None
    """Front, middle or back, then left, right or centre."""
    contact_on_n: Annotated[Number, Of("N")]
    """|F| above the unloaded level from which the foot is in contact."""
    contact_off_n: Annotated[Number, Of("N")]
    """|F| above the unloaded level below which contact ends."""
    debounce_s: Annotated[Number, Of("s")]
    """Shorter swings are filled, then shorter stances dropped. If not set, max(20 ms, 1.5 sampling
    intervals); then swings below 1/16 of the foot's usual one are filled, too."""
    offset_from: Text
    """Source of the unloaded level: option, robot, estimated or default."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Settings(Record):
    """What decided the metrics."""

    robot: str
    """Name of the robot's file."""
    robot_guessed: bool
    """True where the robot was guessed from the topics."""
    clock: str
    """header or log: the clock that everything is measured on."""
    mass_kg: Annotated[Number, Of("kg")]
    """Mass of the robot, from an option or the robot's file; null: not known."""
    body_weight_n: Annotated[Number, Of("N")]
    """Weight that forces in body weights are divided by; null: neither mass nor forces tell."""
    weight_source: Text
    """mass (option or robot's file) or estimated (the feet's mean vertical sum over whole
    strides)."""
    forward_axis: str
    """Axis of the base that points forward."""
    wrench_frame: str
    """world, link or unknown: frame of the recorded forces."""
    reference_foot: Text
    """Foot that phases are measured against."""
    com_offset_m: Annotated[Numbers, Of("m")]
    """Centre of mass from the base's origin, in its axes; null: taken to be there."""
    base_from: Text
    """pose, legs (leg odometry) or null."""
    contact_from: Text
    """sensor, joint_torques, kinematics (both estimated), plan (not measured at all) or null."""
    feet: dict[str, FootSettings]
    """Settings of each foot."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Base(Record):
    """Motion of the base over a span. Poses are integrated, never twists."""

    duration_s: Annotated[Number, Of("s", "base")]
    """First to last pose, gaps left out."""
    path_length_m: Annotated[Number, Of("m", "base")]
    """Length of the horizontal path above the noise of the poses; gaps, jumps and stands are left
    out."""
    net_displacement_m: Annotated[Number, Of("m", "base")]
    """Horizontal distance of the last pose from the first."""
    forward_speed_mps: Annotated[Number, Of("m/s", "base")]
    """Mean speed along the robot's forward axis, turned by yaw only."""
    lateral_speed_mps: Annotated[Number, Of("m/s", "base")]
    """Mean speed to the robot's left, likewise."""
    yaw_change_rad: Annotated[Number, Of("rad", "base")]
    """Total turn, counter-clockwise positive, unwrapped; jumps are left out."""
    yaw_rate_radps: Annotated[Number, Of("rad/s", "base")]
    """yaw_change_rad over duration_s."""
    height_m: Annotated[Spread, Of("m", "base", "points")]
    """Height of the base's origin over the latest contact points of the feet."""
    climb_m: Annotated[Number, Of("m", "base")]
    """Rise of the path, last less first pose."""
    slope_rad: Annotated[Number, Of("rad", "points")]
    """Angle between the plane through the contact points and the horizontal."""
    roll_rad: Annotated[Spread, Of("rad", "base")]
    """Rotation about the robot's own forward axis."""
    pitch_rad: Annotated[Spread, Of("rad", "base")]
    """Rotation about the robot's own left axis; nose down is positive."""
    froude: Annotated[Number, Of("", "base", "points")]
    """v^2 / (g h) with the mean forward speed and the mean height (Alexander 1984)."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Phase(Record):
    """When a foot touches down in the stride of another, as a share of that stride."""

    mean: Annotated[Number, Of("cycles", "strides")]
    """Touchdown after that of the reference foot over the stride period of the reference foot
    (Hildebrand 1965), mean on the circle (Batschelet 1981), in [0, 1)."""
    consistency: Annotated[Number, Of("", "strides")]
    """Length R of the mean on the circle: 1 is the same phase in every stride, near 0 any."""
    left_hind: Annotated[Number, Of("cycles", "strides", "leg positions")]
    """The same mean against the left hind foot, as many papers have it."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LimbPhase(Record):
    """Hind against fore feet, a side."""

    left: Annotated[Number, Of("cycles", *_FOUR)]
    """Share of the stride by which the left hind footfall precedes the left fore one."""
    right: Annotated[Number, Of("cycles", *_FOUR)]
    """The same on the right."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SupportSet(Record):
    """Feet that stand together."""

    feet: tuple[str, ...]
    """Names of the feet that are down."""
    fraction: Annotated[float, Of()]
    """Share of the time known to all feet."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Gait(Record):
    """Coordination of the feet over a span."""

    name: Annotated[Text, Of("", *_PHASED)]
    """Class of the gait by its phases (walk, amble, trot, pace, gallop, canter, half-bound, bound,
    pronk; run and hop of two feet; tripod, tetrapod and wave of six): the nearest one, if the
    phases deviate by at most 0.1 cycles and every R exceeds 0.8; else irregular. stand: all feet
    are down for longer than 1 s and than a stride."""
    confidence: Annotated[Number, Of("", *_PHASED)]
    """(1 - class_distance / 0.2) x lowest R of the phases x min(1, strides / 3), 0 to 1; 1 for a
    stand. High from 0.8, fair from 0.5, low below."""
    sequence: Annotated[Text, Of("", *_PHASED)]
    """Order of the feet, where the class leaves it open: lateral or diagonal in a walk, rotary or
    transverse in a gallop."""
    nearest_name: Annotated[Text, Of("", *_PHASED)]
    """Class whose phases are nearest, whether it fits or not."""
    class_distance: Annotated[Number, Of("cycles", *_PHASED)]
    """Largest deviation of the phases from what defines the nearest class."""
    diagonality: Annotated[Number, Of("cycles", *_FOUR)]
    """Share of the stride by which a hind footfall precedes the fore one of its side, mean of both
    sides on the circle (Cartmill, Lemelin and Schmitt 2002)."""
    limb_phase: LimbPhase
    """Hind against fore feet."""
    duty_factor: Annotated[Number, Of("", "feet", "strides")]
    """Mean of the feet's mean duty factors (Hildebrand 1965)."""
    stride_frequency_hz: Annotated[Number, Of("Hz", "feet", "strides")]
    """Stride frequency of the reference foot."""
    strides: Annotated[Count, Of("", "feet")]
    """Whole strides of the reference foot."""
    flight_fraction: Annotated[Number, Of("", "feet", "all feet")]
    """Share of the time known to all feet without a foot on the ground."""
    double_support_fraction: Annotated[Number, Of("", "feet", "two feet", "all feet")]
    """Share of the time known to all feet with both feet of a biped on the ground."""
    support: Annotated[dict[str, float] | None, Of("", "feet", "all feet")]
    """Share of the time known to all feet with 0, 1, 2 ... feet on the ground."""
    support_sets: Annotated[tuple[SupportSet, ...] | None, Of("", "feet", "all feet")]
    """The most frequent sets of standing feet."""
    phase: dict[str, Phase]
    """Phase of each foot against the reference foot."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Planned(Record):
    """A foot's contacts against those planned."""

    delay_s: Annotated[Spread, Of("s", "plan")]
    """Touchdown after the planned one, of those that are nearest to each other and nearer than half
    the way to the next planned ones; positive: late."""
    missed: Annotated[Count, Of("", "plan")]
    """Planned touchdowns without one."""
    unplanned: Annotated[Count, Of("", "plan")]
    """Touchdowns without a planned one."""
    agreement: Annotated[Number, Of("", "plan")]
    """Share of the time in which planned and measured contact agree."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Foot(Record):
    """One foot over a span."""

    contact_fraction: Annotated[Number, Of("", "contact")]
    """Time in contact over time known."""
    strides: Annotated[Count, Of("", "contact")]
    """Whole strides: touchdown to the next touchdown, both seen, cut by no gap."""
    stance_s: Annotated[Spread, Of("s", "contact", "strides")]
    """Touchdown to lift-off of whole stances."""
    swing_s: Annotated[Spread, Of("s", "contact", "strides")]
    """Lift-off to touchdown of whole strides."""
    stride_period_s: Annotated[Spread, Of("s", "contact", "strides")]
    """Touchdown to the next touchdown."""
    duty_factor: Annotated[Spread, Of("", "contact", "strides")]
    """Stance over stride period (Hildebrand 1965; Alexander 1984)."""
    stride_frequency_hz: Annotated[Number, Of("Hz", "contact", "strides")]
    """Whole strides over the sum of their periods."""
    stride_length_m: Annotated[Spread, Of("m", "strides", "places", "straight")]
    """Horizontal distance from each place where the foot stands to its next one."""
    stride_length_from: Annotated[Text, Of("", "strides", "places", "straight")]
    """What it is measured by: points, foot_frame or base (the base's way, equal where the robot
    goes straight)."""
    step_length_m: Annotated[Spread, Of("m", *_SWUNG, "leg positions")]
    """Distance ahead of the opposite foot's footfall, along the foot's swing."""
    step_width_m: Annotated[Spread, Of("m", *_SWUNG, "leg positions")]
    """The same across it."""
    clearance_m: Annotated[Spread, Of("m", *_SWUNG)]
    """Highest point of a swing above the straight line between the foot's places in the middle of
    the stances before and after."""
    swing_length_m: Annotated[Spread, Of("m", *_SWUNG)]
    """Horizontal distance of the foot's places in the stances before and after a swing."""
    touchdown_down_mps: Annotated[Spread, Of("m/s", *_SWUNG, "leg rate")]
    """Downward velocity of the foot one contact sample before touchdown: slope there of the
    parabola that fits its places of the 30 ms before."""
    touchdown_along_mps: Annotated[Spread, Of("m/s", *_SWUNG, "leg rate")]
    """Horizontal speed of the foot, likewise."""
    height_over_stride_m: Annotated[Shape, Of("m", *_SWUNG)]
    """Height of the foot above the line of its clearance over the gait cycle."""
    contact_travel_m: Annotated[Spread, Of("m", "contact", "points", "strides")]
    """Horizontal distance of the contact points at 10 % and 90 % of a stance, rolling included."""
    slip_m: Annotated[Spread, Of("m", "contact", "points", "rolling", "strides")]
    """Horizontal distance of the foot on the ground between 20 % and 80 % of a stance, by its
    frame; else what contact_travel_m exceeds foot_rolling_m by."""
    slip_largest_m: Annotated[Spread, Of("m", "contact", "points", "rolling", "strides")]
    """The same of the largest distance in a stance."""
    slip_from: Annotated[Text, Of("", "contact", "points", "rolling", "strides")]
    """What slips are measured by: foot_frame or points."""
    touchdown_s: Annotated[Numbers, Of("s", "contact")]
    """Times of the touchdowns that were seen, from the log's start."""
    lift_off_s: Annotated[Numbers, Of("s", "contact")]
    """Times of the lift-offs that were seen."""
    planned: Annotated[Planned | None, Of("", "plan")]
    """Against the plan, where the log has one."""
    peak_force_n: Annotated[Spread, Of("N", "contact", "force", "strides")]
    """Largest |F| of a stance; lone spikes are left out."""
    peak_force_bw: Annotated[Spread, Of("BW", "contact", "force", "weight", "strides")]
    """peak_force_n over the body weight."""
    mean_force_n: Annotated[Spread, Of("N", "contact", "force", "strides")]
    """Mean |F| of a stance; lone spikes are left out."""
    peak_vertical_force_n: Annotated[Spread, Of("N", *_VERTICAL, "strides")]
    """Largest vertical force of a stance, upwards in the world; lone spikes are left out."""
    peak_vertical_force_bw: Annotated[Spread, Of("BW", *_VERTICAL, "weight", "strides")]
    """peak_vertical_force_n over the body weight."""
    mean_vertical_force_n: Annotated[Spread, Of("N", *_VERTICAL, "strides")]
    """Mean vertical force of a stance; lone spikes are left out."""
    vertical_impulse_ns: Annotated[Number, Of("N s", *_VERTICAL)]
    """Integral of the vertical force over all time known."""
    braking_impulse_ns: Annotated[Spread, Of("N s", *_VERTICAL, "base", "strides")]
    """Size of a stance's impulse against the base's forward axis at mid-stance."""
    propulsive_impulse_ns: Annotated[Spread, Of("N s", *_VERTICAL, "base", "strides")]
    """Impulse of a stance along the base's forward axis at mid-stance."""
    loading_rate_nps: Annotated[Spread, Of("N/s", "contact", "force", "strides")]
    """Slope of |F| from 20 % to 80 % of the rise to the first peak of a stance."""
    impact_ratio: Annotated[Spread, Of("", "contact", "force", "strides")]
    """Highest |F| in the first 50 ms of a stance over the median |F| of the stance."""
    friction_use: Annotated[Spread, Of("", *_VERTICAL, "normals", "strides")]
    """Tangential over normal force, 95th percentile of a stance."""
    vertical_over_stride_n: Annotated[Shape, Of("N", *_VERTICAL, "strides")]
    """Vertical force over the gait cycle, interpolated between samples."""
    forward_over_stride_n: Annotated[Shape, Of("N", *_VERTICAL, "base", "strides")]
    """Force along the base's forward axis at mid-stance, likewise."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LoadShare(Record):
    """Shares of the feet's vertical impulse over whole strides.

    Of the integral of |F| where the direction of the forces is not known.
    """

    feet: Annotated[dict[str, float] | None, Of("", "feet", "all feet", "force", "strides")]
    """Share of each foot; they add up to 1."""
    fore: Annotated[Number, Of("", "feet", "all feet", "force", "strides", "leg positions")]
    """Share of the fore feet."""
    left: Annotated[Number, Of("", "feet", "all feet", "force", "strides", "leg positions")]
    """Share of the left feet."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Symmetry(Record):
    """Right against left of a pair of feet: 200 (R - L) / (R + L) (Robinson, Herzog, Nigg 1987)."""

    stance_s: Annotated[Number, Of("%", "strides", "leg positions")]
    """Of the mean stance durations."""
    duty_factor: Annotated[Number, Of("%", "strides", "leg positions")]
    """Of the mean duty factors."""
    peak_force_n: Annotated[Number, Of("%", "force", "strides", "leg positions")]
    """Of the mean peak forces."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Forces(Record):
    """Loads of the whole robot over a span."""

    vertical_impulse_over_weight: Annotated[
        Number, Of("", "feet", "force", "vertical force", "weight", "all feet")
    ]
    """Vertical impulse of all feet over weight times time, over whole strides in which all feet are
    known; 1: the feet carry the robot."""
    load_share: LoadShare
    """Who carries how much."""
    symmetry_index_percent: dict[str, Symmetry]
    """Symmetry of the fore and the hind pair of a quadruped."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Stability(Record):
    """Static stability over a span, at up to 100 Hz.

    The base's origin stands for the centre of mass unless com_offset_m is given.
    """

    static_margin_m: Annotated[Spread, Of("m", "feet", "base", "points", "all feet", "three feet")]
    """Distance of the base's projection from the support polygon's edge; negative outside (McGhee
    and Frank 1968)."""
    energy_margin_m: Annotated[Spread, Of("m", "feet", "base", "points", "all feet", "three feet")]
    """Height that the base must rise to tip over an edge: the energy stability margin over the
    weight (Messuri and Klein 1985)."""
    unstable_fraction: Annotated[Number, Of("", "feet", "base", "points", "all feet")]
    """Share of all time with a support polygon outside of which the base's projection lies."""
    undefined_fraction: Annotated[Number, Of("", "feet", "base", "points", "all feet")]
    """Share of all time in which all is known and fewer than three feet are down."""
    unknown_fraction: Annotated[Number, Of("", "feet", "base", "points", "all feet")]
    """Share of all time in which the base, or whether and where a foot stands, is not known. The
    rest of the time is stable."""
    centre_of_pressure_forward_m: Annotated[Spread, Of("m", *_PRESSED)]
    """Centre of pressure ahead of the base's origin: mean of the contact points, weighted by
    vertical force."""
    centre_of_pressure_left_m: Annotated[Spread, Of("m", *_PRESSED)]
    """The same to the left of the base's origin."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Segment(Record):
    """Time in which the gait does not change."""

    start_s: Annotated[float, Of("s")]
    """From the log's start."""
    end_s: Annotated[float, Of("s")]
    """From the log's start."""
    base: Base
    gait: Gait
    feet: dict[str, Foot]
    forces: Forces
    stability: Stability


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class GaitOfLog(Gait):
    """Coordination of the feet: that of the longest segment, and all segments."""

    transition_strides: Count
    """Strides of the reference foot between segments."""
    segments: tuple[Segment, ...]
    """Cut where class or stride period changes for at least two strides, and where the robot
    stands."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Joint(Record):
    """One joint. rad, N m and W, or m and N where it slides."""

    foot: Text
    """Foot that it moves, by the robot description or by names."""
    range_of_motion: Annotated[Number, Of("rad or m", "joints")]
    """Highest less lowest position."""
    peak_speed: Annotated[Number, Of("rad/s or m/s", "joints")]
    """Largest speed, recorded or, where none is, by differences of positions."""
    peak_effort: Annotated[Number, Of("N m or N", "joints", "efforts")]
    """Largest magnitude of the effort, as recorded."""
    rms_effort: Annotated[Number, Of("N m or N", "joints", "efforts")]
    """Root mean square of the effort."""
    absolute_work_j: Annotated[Number, Of("J", "joints", "efforts")]
    """Integral of |effort x speed| over the log; silences above 0.1 s are left out."""
    near_limit_fraction: Annotated[Number, Of("", "joints", "limits")]
    """Share of the time within 2 % of the range from an end, or above 95 % of the effort or speed
    that the robot description allows."""
    position_over_stride: Annotated[Shape, Of("rad or m", "joints", "strides")]
    """Position over the gait cycle of its foot."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Legs(Record):
    """Joints and their work."""

    absolute_work_j: Annotated[Spread, Of("J", "joints", "efforts", "strides")]
    """Absolute work of all joints with efforts in a stride of the reference foot."""
    positive_work_j: Annotated[Spread, Of("J", "joints", "efforts", "strides")]
    """Positive work of them in the same."""
    mechanical_cost_of_transport: Annotated[Number, Of("", "joints", "efforts", "weight", "base")]
    """Absolute mechanical work of the joints over m g d, summed over strides; d: their length. No
    losses of motors and electronics."""
    joints: dict[str, Joint]
    """Each joint."""
    asymmetry_percent: Annotated[dict[str, float], Of("%")]
    """Right against left of the median range of motion in a stride, a pair of joints; 0: equal."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Tracking(Record):
    """A commanded velocity against that of the base."""

    commanded_mps: Annotated[Number, Of("m/s", "commands")]
    """Mean command, each held until the next, over the same time as the measured velocity."""
    measured_mps: Annotated[Number, Of("m/s", "commands", "base")]
    """Mean velocity of the base in its own axes, turned by yaw only, while a command holds."""
    mean_error_mps: Annotated[Number, Of("m/s", "commands", "base")]
    """Mean of measured less commanded."""
    rms_error_mps: Annotated[Number, Of("m/s", "commands", "base")]
    """Root mean square of measured less commanded, both means over a stride."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Turning(Record):
    """A commanded turn rate against that of the base."""

    commanded_radps: Annotated[Number, Of("rad/s", "commands")]
    """Mean command, each held until the next, over the same time as the measured velocity."""
    measured_radps: Annotated[Number, Of("rad/s", "commands", "base")]
    """Mean turn rate while a command holds."""
    mean_error_radps: Annotated[Number, Of("rad/s", "commands", "base")]
    """Mean of measured less commanded."""
    rms_error_radps: Annotated[Number, Of("rad/s", "commands", "base")]
    """Root mean square of measured less commanded, both means over a stride."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Commands(Record):
    """How well the robot follows its velocity commands."""

    topic: Annotated[Text, Of("", "commands")]
    """Topic of the commands."""
    commanded_s: Annotated[Number, Of("s", "commands")]
    """Time in which a command holds."""
    forward: Tracking
    lateral: Tracking
    yaw: Turning


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Imu(Record):
    """The base's accelerometer as a witness of forces and poses."""

    topic: Annotated[Text, Of("", "imu")]
    """Topic of the accelerometer."""
    known_s: Annotated[Number, Of("s", "imu", "base")]
    """Time with accelerometer and poses."""
    accelerometer_mps2: Annotated[Number, Of("m/s^2", "imu", "base")]
    """Length of the mean reading in the base's frame: g, whatever the robot weighs."""
    tilt_rad: Annotated[Number, Of("rad", "imu", "base")]
    """Angle of the mean reading from what attitude, gravity and poses expect."""
    forces_over_accelerometer: Annotated[
        Number, Of("", "imu", "base", "force", "vertical force", "weight", "strides")
    ]
    """Mean of the feet's summed vertical force over the mass and the vertical acceleration that is
    read, over whole strides; 1: they agree."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Event(Record):
    """Something that happened at a time."""

    onset_s: Annotated[float, Of("s")]
    """From the log's start."""
    duration_s: Annotated[float, Of("s")]
    """0 for an instant."""
    type: str
    """fall, tipping, carried, stumble, slip, early_contact, margin_below_zero, gait_change,
    pose_jump, sensor_fault, gap, touchdown or lift_off."""
    foot: Text
    """Foot, where it is one's."""
    value: Number
    """Its size, in the unit beside it."""
    unit: Text
    """Unit of the value; `swing` is the share of a swing."""
    code: Text
    """Finding that it belongs to; of a change of the gait both classes, `trot>walk`."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Finding(Record):
    """Something to know before relying on the metrics."""

    code: str
    """Name of the finding, as `check` rules use it."""
    severity: str
    """error, warning or note."""
    text: str
    """What was found."""
    remedy: str
    """What to do; empty: nothing."""
    where: Text
    """Topic, foot or path."""
    voids: tuple[str, ...]
    """Patterns of the metrics that it sets to null."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class TopicQuality(Record):
    """Timing of a topic."""

    messages: int
    """Messages of the topic."""
    rate_hz: Annotated[Number, Of("Hz")]
    """(messages - 1) / (latest - earliest time); null: fewer than 10 messages, or within 50 ms."""
    interval_p95_s: Annotated[Number, Of("s")]
    """95th percentile of the intervals between messages."""
    interval_max_s: Annotated[Number, Of("s")]
    """Longest interval."""
    gaps: Count
    """Silences longer than max(5 usual intervals, 50 ms); none are counted where messages come on
    events or are fewer than 11, or where a sensor is silent in swing."""
    gaps_total_s: Annotated[Number, Of("s")]
    """Sum of the gaps."""
    bad_stamps: Annotated[Count, Of("", "stamps")]
    """Header stamps that are zero, repeated, step back, or lie ahead of those that follow."""
    clock_offset_s: Annotated[Number, Of("s", "stamps")]
    """Log time less header stamp, median."""
    clock_drift_ppm: Annotated[Number, Of("1e-6", "stamps")]
    """Millionths by which log time runs faster than the stamps."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FootQuality(Record):
    """Samples of one foot's sensor."""

    not_finite: int
    """Messages with a number that is not finite; left out."""
    filled_swings: int
    """Swings shorter than the debouncing time, counted as contact."""
    dropped_stances: int
    """Contacts shorter than the debouncing time, counted as swing."""
    discarded_strides: dict[str, int]
    """Stances that begin no whole stride, by reason: log_start, log_end, gap, standing, fall."""
    spikes: Annotated[Count, Of("", "force")]
    """Lone spikes of the force in whole stances; kept out of the peaks."""
    force_offset_n: Annotated[Numbers, Of("N", "force")]
    """What the unloaded sensor reads, x, y and z; taken off all forces."""
    force_noise_n: Annotated[Number, Of("N", "force")]
    """Standard deviation of the unloaded sensor's noisiest component."""
    force_drift_n_per_min: Annotated[Number, Of("N/min", "force")]
    """Drift of the unloaded level along the direction of the load."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Check(Record):
    """A question that was asked of the recording."""

    name: str
    """What holds if it passes."""
    outcome: str
    """passed, failed, not made or does not apply."""
    reason: Text
    """Why it failed or was not made."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Quality(Record):
    """Can the recording be trusted?"""

    topics: dict[str, TopicQuality]
    """Timing of each topic in use."""
    feet: dict[str, FootQuality]
    """Samples of each foot."""
    overlap_s: Annotated[float, Of("s")]
    """Time known to all feet that have messages, and to the base."""
    base_to_feet_m: Annotated[Number, Of("m", "points", "base")]
    """Median horizontal distance of the base from the centroid of the feet's usual positions."""
    feet_spread_m: Annotated[Number, Of("m", "points")]
    """Distance of the outermost foot's usual position from that centroid."""
    checks: tuple[Check, ...]
    """Each check and its outcome."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class WalkMetrics(Record):
    """All that is known of a walk: `stats --json`."""

    schema_version: int
    """Grows with every change of meaning."""
    log: Log
    settings: Settings
    base: Base
    gait: GaitOfLog
    feet: dict[str, Foot]
    forces: Forces
    stability: Stability
    legs: Legs
    commands: Commands
    imu: Imu
    quality: Quality
    events: tuple[Event, ...]
    findings: tuple[Finding, ...]
    null_because: dict[str, str]
    """Path of a null: code of the finding that voids it, what the log lacks, or `does not apply`.
    Segments have only those that the whole log does not have."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Stride(Record):
    """A whole stride of a foot: a row of `export --table strides`."""

    start_s: Annotated[float, Of("s")]
    """Touchdown, from the log's start."""
    stance_s: Annotated[float, Of("s")]
    """Touchdown to lift-off."""
    swing_s: Annotated[float, Of("s")]
    """Lift-off to the next touchdown."""
    duty_factor: Annotated[float, Of()]
    """Stance over stride period."""
    length_m: Annotated[Number, Of("m", "base")]
    """Horizontal distance of the base between touchdown and next touchdown."""
    peak_force_n: Annotated[Number, Of("N", "force")]
    """Highest |F| of the stance."""
    vertical_impulse_ns: Annotated[Number, Of("N s", "force", "vertical force")]
    """Integral of the vertical force over the stance."""
    slip_m: Annotated[Number, Of("m", "points", "rolling")]
    """Slip of the stance, as in the metrics of a foot."""
    clearance_m: Annotated[Number, Of("m", "base", "foot frame")]
    """Likewise of its swing, as all below."""
    swing_length_m: Annotated[Number, Of("m", "base", "foot frame")]
    """Horizontal distance of the swing."""
    step_length_m: Annotated[Number, Of("m", "base", "foot frame", "leg positions")]
    """Distance ahead of the opposite foot's footfall."""
    step_width_m: Annotated[Number, Of("m", "base", "foot frame", "leg positions")]
    """The same across the swing."""
    touchdown_down_mps: Annotated[Number, Of("m/s", "base", "foot frame", "leg rate")]
    """Downward velocity before the touchdown that ends the stride."""
    touchdown_along_mps: Annotated[Number, Of("m/s", "base", "foot frame", "leg rate")]
    """Horizontal speed there."""
    positive_work_j: Annotated[Number, Of("J", "joints", "efforts")]
    """Positive work of the leg's joints in the stride."""
    absolute_work_j: Annotated[Number, Of("J", "joints", "efforts")]
    """Absolute work of them."""
