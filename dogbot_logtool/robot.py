"""What is known of a robot before its log is opened: feet, topics, frames, mass, thresholds."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path
from typing import Any, Final

from dogbot_logtool.errors import CallError

AXES: Final = ("+x", "-x", "+y", "-y")
"""Body axes that can point forward."""
GENERIC: Final = "generic"
_PLACES: Final = ({"front", "middle", "back"}, {"left", "right", "centre"})


@dataclass(frozen=True, slots=True)
class Foot:
    """One foot of a robot."""

    name: str
    topic: str
    """Contact topic."""
    collision: str = ""
    """Glob for the name of the foot's collision; empty: recognised by the names in the log."""
    place: tuple[str, str] | None = None
    """("front" | "middle" | "back", "left" | "right" | "centre"); None when not known."""
    element: int | None = None
    """Place in the arrays of a message that tells of all feet; None: told by the message type."""
    offset: float = 0.0
    """Counts of a raw sensor that is not loaded."""
    newtons_per_count: float = 1.0
    """Of a raw sensor."""

    @property
    def is_uncalibrated(self) -> bool:
        """Whether nobody has said what a raw sensor's counts mean."""
        return self.offset == 0.0 and self.newtons_per_count == 1.0


@dataclass(frozen=True, slots=True)
class Robot:
    """A robot's file, checked. What is None is taken from the log or stays unknown."""

    name: str
    description: str = ""
    mass_kg: float | None = None
    forward_axis: str = "+x"
    foot_rolling_m: float = 0.0
    """m: how far a rolling foot's contact point travels in a stance without slipping."""
    odometry_topic: str | None = None
    world_frame: str | None = None
    base_frame: str | None = None
    feet: tuple[Foot, ...] = ()
    """The first is the reference for phases."""
    newtons_per_metre: float = 100.0
    shaft_diameter_m: float = 0.04
    contact_on_n: float | None = None
    """N: |F| from which a foot is in contact; None: max(10 N, 5 % of body weight)."""
    contact_off_n: float | None = None
    """N: |F| below which contact ends; None: half of `contact_on_n`."""
    debounce_s: float = 0.020
    """s: shorter swings are filled, then shorter stances dropped."""

    @property
    def topics(self) -> frozenset[str]:
        """Every topic that the robot's file names."""
        named = {foot.topic for foot in self.feet}
        if self.odometry_topic is not None:
            named.add(self.odometry_topic)
        return frozenset(named)

    def with_mass(self, mass_kg: float | None) -> "Robot":
        """Return this robot with another mass, where one is given."""
        return self if mass_kg is None else replace(self, mass_kg=mass_kg)


def known_robots() -> tuple[str, ...]:
    """Return the names of the robots that come with the program, sorted."""
    folder = resources.files("dogbot_logtool") / "robots"
    return tuple(sorted(file.name[:-5] for file in folder.iterdir() if file.name.endswith(".toml")))


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
    file = resources.files("dogbot_logtool") / "robots" / f"{name}.toml"
    return file.read_text(encoding="utf-8")


def load_robot(name_or_file: str) -> Robot:
    """Load a known robot by name, or any robot from its TOML file.

    Raises:
        CallError: there is no such robot or file, or the file is not a robot's.
    """
    if not name_or_file.endswith(".toml"):
        return parse_robot(robot_toml(name_or_file), name_or_file)
    try:
        text = Path(name_or_file).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CallError(f"{name_or_file}: cannot be read as a robot's file: {error}") from error
    return parse_robot(text, name_or_file)


def parse_robot(text: str, source: str) -> Robot:
    """Check and convert a robot's TOML.

    Args:
        text: the TOML.
        source: what to call it in errors.

    Raises:
        CallError: naming the key, and for broken TOML the line.
    """
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise CallError(f"{source}: not valid TOML: {error}") from error
    table = _Table(source, "", document)
    topics = table.section("topics")
    frames = table.section("frames")
    arrows = table.section("arrows")
    contact = table.section("contact")
    feet = table.section("feet")
    robot = Robot(
        name=table.text("name") or Path(source).stem,
        description=table.text("description") or "",
        mass_kg=table.positive("mass_kg"),
        forward_axis=table.choice("forward_axis", AXES) or "+x",
        foot_rolling_m=table.positive("foot_rolling_m") or 0.0,
        odometry_topic=topics.text("odometry"),
        world_frame=frames.frame("world"),
        base_frame=frames.frame("base"),
        feet=tuple(_foot(feet.section(name), name) for name in list(feet.values)),
        newtons_per_metre=arrows.positive("newtons_per_metre") or 100.0,
        shaft_diameter_m=arrows.positive("shaft_diameter_m") or 0.04,
        contact_on_n=contact.positive("on_n"),
        contact_off_n=contact.positive("off_n"),
        debounce_s=contact.positive("debounce_s") or 0.020,
    )
    for section in (topics, frames, arrows, contact, feet, table):
        section.refuse_leftovers()
    _check_feet(robot, source)
    return robot


def _foot(table: "_Table", name: str) -> Foot:
    topic = table.text("topic")
    if not topic:
        raise CallError(f"{table.source}: {table.path}topic is missing")
    foot = Foot(
        name,
        topic,
        table.text("collision") or "",
        table.place("place"),
        table.element("element"),
        table.number("offset") or 0.0,
        table.positive("newtons_per_count") or 1.0,
    )
    table.refuse_leftovers()
    return foot


def _check_feet(robot: Robot, source: str) -> None:
    for topic in dict.fromkeys(foot.topic for foot in robot.feet):
        elements = [foot.element for foot in robot.feet if foot.topic == topic]
        if len(elements) > 1 and (None in elements or len(set(elements)) < len(elements)):
            raise CallError(
                f"{source}: two feet have the topic {topic}; where its messages tell of several "
                "feet, each needs an element of its own"
            )
    on, off = robot.contact_on_n, robot.contact_off_n
    if on is not None and off is not None and off > on:
        raise CallError(f"{source}: contact.off_n is above contact.on_n; it must not be")


class _Table:
    """A TOML table whose keys are taken out one by one, so that unknown keys remain and show."""

    def __init__(self, source: str, path: str, values: Mapping[str, Any]) -> None:
        self.source = source
        self.path = path
        self.values = dict(values)

    def _fault(self, key: str, value: object, wanted: str) -> CallError:
        return CallError(f"{self.source}: {self.path}{key} is {value!r}; it must be {wanted}")

    def section(self, key: str) -> "_Table":
        value = self.values.pop(key, {})
        if not isinstance(value, dict):
            raise self._fault(key, value, "a table")
        return _Table(self.source, f"{self.path}{key}.", value)

    def text(self, key: str) -> str | None:
        value = self.values.pop(key, None)
        if value is not None and not isinstance(value, str):
            raise self._fault(key, value, "a text")
        return value

    def frame(self, key: str) -> str | None:
        value = self.text(key)
        if value is not None and (not value or value.startswith("/")):
            raise self._fault(key, value, "a frame name without a leading slash")
        return value

    def choice(self, key: str, choices: tuple[str, ...]) -> str | None:
        value = self.text(key)
        if value is not None and value not in choices:
            raise self._fault(key, value, f"one of {', '.join(choices)}")
        return value

    def positive(self, key: str) -> float | None:
        value = self.values.pop(key, None)
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value < 1e9:
            raise self._fault(key, value, "a number above 0")
        return float(value)

    def number(self, key: str) -> float | None:
        value = self.values.pop(key, None)
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e9:
            raise self._fault(key, value, "a number")
        return float(value)

    def element(self, key: str) -> int | None:
        value = self.values.pop(key, None)
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 100:
            raise self._fault(key, value, "a place in an array, counted from 0")
        return value

    def place(self, key: str) -> tuple[str, str] | None:
        value = self.values.pop(key, None)
        if value is None:
            return None
        ends, sides = _PLACES
        if (
            not isinstance(value, list)
            or len(value) != 2
            or not all(isinstance(word, str) for word in value)
            or value[0] not in ends
            or value[1] not in sides
        ):
            raise self._fault(key, value, 'a pair such as ["front", "left"]')
        return value[0], value[1]

    def refuse_leftovers(self) -> None:
        for key in self.values:
            raise CallError(
                f"{self.source}: the key {self.path}{key} is not known. "
                "'dogbot-logtool robots dogbot' shows all that are."
            )
