"""A robot, as known before its log is opened: feet, topics, frames, mass, thresholds."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, Final, Literal, get_args

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.toml_table import TomlFile, TomlTable, read_toml
from dogbot_logtool.reader.foot import Foot, FootField

Axis = Literal["+x", "-x", "+y", "-y"]
"""Body axes that can point forward."""
WrenchFrame = Literal["auto", "world", "link"]
Clock = Literal["header", "log"]
Tare = Literal["auto", "none"]
GENERIC: Final = "generic"
MOST_FEET: Final = 64
"""A robot's file or a log that has more is a mistake, and takes the square of the time."""
_KNOWN: Final = Path(__file__).with_name("known")
"""Directory of the robots that come with the program."""
_LEG_POSITIONS: Final = (
    frozenset({"front", "middle", "back"}),
    frozenset({"left", "right", "centre"}),
)
_ALL_KEYS: Final = "'dogbot-logtool robots dogbot' shows all that are."


NEWTONS: Final = {"N": 1.0, "kN": 1e3, "kg": 9.80665, "g": 9.80665e-3, "lbf": 4.4482216152605}
"""Newtons in units of force."""
KINDS: Final = ("force", "contact")
"""Quantity that a field can be read as."""
_AXES_OF_SENSOR: Final = ("x", "y", "z", "-x", "-y", "-z")
_SIGNS: Final = {"+": 1, "-": -1}


@dataclass(frozen=True, slots=True)
class Robot:
    """A robot's file, checked. What is None is taken from the log or stays unknown."""

    name: str
    description: str = ""
    mass_kg: float | None = None
    forward_axis: Axis = "+x"
    wrench_frame: WrenchFrame = "auto"
    """The frame of the recorded wrenches; auto: by evidence."""
    clock: Clock | None = None
    """What times are measured on: header stamps, or log time; None: header stamps, and log time
    where those cannot be used."""
    tare: Tare = "auto"
    """Whether what unloaded sensors read is estimated for feet without `offset_n`, and taken off;
    none: their forces stay as recorded."""
    com_offset_m: tuple[float, float, float] | None = None
    """m: the centre of mass from the base's frame, in its axes; None: taken to be there."""
    foot_rolling_m: float | None = None
    """m: how far a foot's contact point travels in a stance without slipping; None: not known."""
    odometry_topic: str | None = None
    command_topic: str | None = None
    """Topic of the velocity commands; None: found by type and name. Likewise `imu_topic`, of the
    base's inertial unit."""
    imu_topic: str | None = None
    world_frame: str | None = None
    base_frame: str | None = None
    feet: tuple[Foot, ...] = ()
    """The first is the reference for phases."""
    newtons_per_metre: float | None = None
    """N of an arrow of 1 m; None: a body weight is as long as the base is high."""
    shaft_diameter_m: float = 0.04
    contact_on_n: float | None = None
    """N: |F| from which a foot is in contact; None: a share of the weight, above the noise."""
    contact_off_n: float | None = None
    """N: |F| below which contact ends; None: as `contact_on_n`."""
    contact_on_counts: float | None = None
    """Counts above a foot's `offset` from which a raw sensor without a scale is in contact."""
    debounce_s: float | None = None
    """s: shorter swings are filled, then shorter stances dropped; None: 20 ms, or 1.5
    sampling intervals where that is more."""
    given: frozenset[str] = frozenset()
    """Fields that the user set for this call."""

    @property
    def topics(self) -> frozenset[str]:
        """Every topic that the robot's file names."""
        named = {foot.topic for foot in self.feet}
        if self.odometry_topic is not None:
            named.add(self.odometry_topic)
        return frozenset(named)

    def feet_of(self, topic: str) -> tuple[Foot, ...]:
        """Return the feet that a topic's messages are about."""
        return tuple(foot for foot in self.feet if foot.topic == topic)

    def with_mass(self, mass_kg: float | None) -> "Robot":
        """Return this robot with another mass, where one is given."""
        return self if mass_kg is None else replace(self, mass_kg=mass_kg)

    def is_given(self, field: str) -> bool:
        """Tell whether the user set a field for this call: ``mass_kg``, ``tare.front_left``."""
        return field in self.given


@cache
def known_robots() -> tuple[str, ...]:
    """Return the names of the robots that come with the program, sorted."""
    return tuple(sorted(file.stem for file in _KNOWN.glob("*.toml")))


@cache
def robot_toml(name: str) -> str:
    """Return the file of a known robot, to copy and edit.

    Raises:
        CallError: there is no such robot.
    """
    if name not in known_robots():
        raise CallError(
            f"no robot is called {name!r}; known are {', '.join(known_robots())}. "
            "Another one is described in a TOML file: see 'dogbot-logtool robots dogbot'."
        )
    return (_KNOWN / f"{name}.toml").read_text(encoding="utf-8")


def load_robot(name_or_file: str) -> Robot:
    """Load a known robot by name, or any robot from its TOML file.

    Raises:
        CallError: there is no such robot or file, or the file is not a robot's.
    """
    if not name_or_file.endswith(".toml"):
        return _known_robot(name_or_file)
    return parse_robot(read_toml(Path(name_or_file), "a robot's file"), name_or_file)


@cache
def _known_robot(name: str) -> Robot:
    return parse_robot(robot_toml(name), name)


def parse_robot(text: str, source: str) -> Robot:
    """Check and convert a robot's TOML.

    Args:
        text: the TOML.
        source: what to call it in errors.

    Raises:
        CallError: naming the key and the line.
    """
    file = TomlFile(text, source)
    table = TomlTable(file)
    topics = table.section("topics")
    frames = table.section("frames")
    arrows = table.section("arrows")
    contact = table.section("contact")
    feet = table.section("feet")
    if len(feet.names) > MOST_FEET:
        raise feet.fault("", f"there are {len(feet.names)} feet; there may be {MOST_FEET}")
    robot = Robot(
        name=table.text("name") or Path(source).stem,
        description=table.text("description") or "",
        mass_kg=table.positive("mass_kg"),
        forward_axis=_choice(table, "forward_axis", Axis) or "+x",
        wrench_frame=_choice(table, "wrench_frame", WrenchFrame) or "auto",
        clock=_choice(table, "clock", Clock),
        tare=_choice(table, "tare", Tare) or "auto",
        com_offset_m=table.vector("com_offset_m"),
        foot_rolling_m=table.positive("foot_rolling_m"),
        odometry_topic=topics.text("odometry"),
        command_topic=topics.text("command"),
        imu_topic=topics.text("imu"),
        world_frame=frames.frame("world"),
        base_frame=frames.frame("base"),
        feet=tuple(_foot(feet.section(name), name) for name in feet.names),
        newtons_per_metre=arrows.positive("newtons_per_metre"),
        shaft_diameter_m=arrows.positive("shaft_diameter_m") or 0.04,
        contact_on_n=contact.positive("on_n"),
        contact_off_n=contact.positive("off_n"),
        contact_on_counts=contact.positive("on_counts"),
        debounce_s=contact.positive("debounce_s"),
    )
    for section in (topics, frames, arrows, contact, feet, table):
        section.refuse_leftovers(_ALL_KEYS)
    _check_elements(robot, file)
    on, off = robot.contact_on_n, robot.contact_off_n
    if on is not None and off is not None and off > on:
        raise contact.fault("off_n", "contact.off_n is above contact.on_n; it must not be")
    return robot


def _choice(table: TomlTable, key: str, words: Any) -> Any:  # noqa: ANN401 - a `Literal`
    return table.choice(key, get_args(words))


def _foot(table: TomlTable, name: str) -> Foot:
    topic = table.text("topic")
    if not topic:
        raise table.fault("topic" if topic is not None else "", f"{table.path('topic')} is missing")
    foot = Foot(
        name,
        topic,
        collision=table.text("collision") or "",
        leg_position=table.words("place", _LEG_POSITIONS, '["front", "left"]'),
        frame=table.frame("frame"),
        contact_point_m=table.vector("contact_point_m") or (0.0, 0.0, 0.0),
        element=table.count("element"),
        label=table.text("label") or "",
        field=_field(table),
        offset=table.number("offset") or 0.0,
        offset_n=table.vector("offset_n"),
        newtons_per_count=table.positive("newtons_per_count"),
    )
    table.refuse_leftovers(_ALL_KEYS)
    return foot


def _field(table: TomlTable) -> FootField | None:
    """Return which field is a foot's; None where the file names none."""
    path = table.text("field")
    if not path:
        for key in ("kind", "scale", "unit", "sign", "axis", "threshold"):
            if key in table.names:
                raise table.fault(key, f"{table.path(key)} needs {table.path('field')}")
        return None
    scale = table.number("scale")
    if scale == 0.0:
        raise table.fault("scale", f"{table.path('scale')} is 0; nothing would be left")
    return FootField(
        path,
        kind=table.choice("kind", KINDS) or "",
        scale=1.0 if scale is None else scale,
        newtons_per_unit=NEWTONS[table.choice("unit", tuple(NEWTONS)) or "N"],
        sign=_SIGNS[table.choice("sign", tuple(_SIGNS)) or "+"],
        axis=table.choice("axis", _AXES_OF_SENSOR) or "",
        threshold=table.number("threshold") or 0.0,
    )


def _check_elements(robot: Robot, file: TomlFile) -> None:
    """Refuse two feet that one element of a message would tell of."""
    seen: dict[str, list[int | str | None]] = {}
    for foot in robot.feet:
        others = seen.setdefault(foot.topic, [])
        own = foot.element if foot.field is None else foot.field.path
        if others and (own is None or None in others or own in others):
            key = "topic" if own is None or None in others else "element"
            key = "field" if foot.field is not None and own in others else key
            text = (
                f"two feet have the topic {foot.topic}; where its messages tell of several "
                "feet, each needs an element or a field of its own"
            )
            raise file.fault(("feet", foot.name, key), text)
        others.append(own)
