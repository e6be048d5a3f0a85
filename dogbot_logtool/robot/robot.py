"""A robot, as known before its log is opened: its file, and ``--set FIELD=VALUE`` for one call."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import MISSING, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, Final

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.toml_table import (
    FRAME,
    NOT_NEGATIVE,
    POSITIVE,
    TEXT,
    VECTOR,
    Kind,
    by_key,
    checked,
    declared_fields,
    one_of,
    parse_toml,
    read_text,
    take_fields,
    to_toml,
    toml_field,
)
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.reader.foot import Foot, FootField

GENERIC: Final = "generic"
_KNOWN: Final = Path(__file__).with_name("known")
"""Directory of the robots that come with the program."""
_ALL_KEYS: Final = "'dogbot-logtool robots dogbot' shows all that are."
_NOT_SET: Final = frozenset({"name", "description", "topic"})
"""Fields that have options of their own, or change nothing."""


@dataclass(frozen=True, slots=True)
class Robot:
    """A robot's file, checked. What is None is taken from the log or stays unknown."""

    name: str = toml_field(TEXT, MISSING)
    description: str = toml_field(TEXT, "")
    mass_kg: float | None = toml_field(POSITIVE)
    forward_axis: str = toml_field(one_of("+x", "-x", "+y", "-y"), "+x")
    wrench_frame: str = toml_field(one_of("auto", "world", "link"), "auto")
    """The frame of the recorded wrenches; auto: by evidence."""
    clock: str | None = toml_field(one_of("header", "log"))
    """What times are measured on: header stamps, or log time; None: header stamps, and log time
    where those cannot be used."""
    tare: str = toml_field(one_of("auto", "none"), "auto")
    """Whether what unloaded sensors read is estimated for feet without `offset_n`, and taken off;
    none: all forces stay as recorded."""
    com_offset_m: tuple[float, float, float] | None = toml_field(VECTOR)
    """m: the centre of mass from the base's frame, in its axes; None: taken to be there."""
    foot_rolling_m: float | None = toml_field(POSITIVE)
    """m: how far a foot's contact point travels in a stance without slipping; None: not known."""
    odometry_topic: str | None = toml_field(TEXT, key="topics.odometry")
    command_topic: str | None = toml_field(TEXT, key="topics.command")
    """Topic of the velocity commands; None: found by type and name. Likewise `imu_topic`, of the
    base's inertial unit."""
    imu_topic: str | None = toml_field(TEXT, key="topics.imu")
    odometry_scale: float | None = toml_field(POSITIVE)
    """Metres in one unit of the recorded positions of the base; None: they are in metres."""
    world_frame: str | None = toml_field(FRAME, key="frames.world")
    base_frame: str | None = toml_field(FRAME, key="frames.base")
    feet: tuple[Foot, ...] = ()
    """The first is the reference for phases."""
    newtons_per_metre: float | None = toml_field(POSITIVE, key="arrows.newtons_per_metre")
    """N of an arrow of 1 m; None: a body weight is as long as the base is high."""
    shaft_diameter_m: float = toml_field(POSITIVE, 0.04, key="arrows.shaft_diameter_m")
    contact_on_n: float | None = toml_field(POSITIVE, key="contact.on_n")
    """N: |F| from which a foot is in contact; None: a share of the weight, above the noise."""
    contact_off_n: float | None = toml_field(POSITIVE, key="contact.off_n")
    """N: |F| below which contact ends; None: as `contact_on_n`."""
    contact_on_counts: float | None = toml_field(POSITIVE, key="contact.on_counts")
    """Counts above a foot's `offset` from which a raw sensor without a scale is in contact."""
    debounce_s: float | None = toml_field(NOT_NEGATIVE, key="contact.debounce_s")
    """s: shorter swings are filled, then shorter stances dropped; None: 20 ms, or 1.5
    sampling intervals where that is more."""
    given: frozenset[str] = frozenset()
    """Fields that the user set for this call: ``mass_kg``, ``tare.front_left``."""

    @property
    def topics(self) -> frozenset[str]:
        """Every topic that the robot's file names."""
        named = (self.odometry_topic, *(foot.topic for foot in self.feet))
        return frozenset(filter(None, named))

    def feet_of(self, topic: str) -> tuple[Foot, ...]:
        """Return the feet that a topic's messages are about."""
        return tuple(foot for foot in self.feet if foot.topic == topic)


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
    return parse_robot(read_text(Path(name_or_file), "a robot's file"), name_or_file)


@cache
def _known_robot(name: str) -> Robot:
    return parse_robot(robot_toml(name), name)


def parse_robot(text: str, source: str) -> Robot:
    """Check and convert a robot's TOML.

    Args:
        text: the TOML.
        source: what to call it in errors.

    Raises:
        CallError: naming the key.
    """
    document = parse_toml(text, source)
    feet = document.pop("feet", {})
    if not isinstance(feet, dict) or not all(isinstance(foot, dict) for foot in feet.values()):
        raise CallError(f"{source}: feet must be tables: [feet.NAME]")
    given = by_key(document)
    values = take_fields(Robot, given, f"{source}: ")
    _refuse_unknown(given, source)
    found = tuple(_foot(by_key(foot), name, source) for name, foot in feet.items())
    values["name"] = values.get("name") or Path(source).stem
    robot = Robot(**values, feet=found)
    _check_thresholds(robot, source)
    return robot


def _foot(given: dict[str, Any], name: str, source: str) -> Foot:
    prefix = f"feet.{name}."
    where = f"{source}: {prefix}"
    values = take_fields(Foot, given, where)
    if not values.get("topic"):
        raise CallError(f"{where}topic is missing")
    of_field = take_fields(FootField, given, where)
    field = FootField(**of_field) if of_field.get("path") else None
    for key in of_field.keys() - {"path"} if field is None else ():
        raise CallError(f"{where}{key} needs {prefix}field")
    _refuse_unknown(given, source, prefix)
    return Foot(name, **values, field=field)


def _refuse_unknown(keys: Mapping[str, Any], source: str, prefix: str = "") -> None:
    for key in keys:
        raise CallError(f"{source}: the key {prefix}{key} is not known. {_ALL_KEYS}")


# --- settings for one call -----------------------------------------------------------------------


def with_settings(robot: Robot, options: RobotOptions) -> Robot:
    """Return a robot with fields set for this call; they are named in its `given`.

    Args:
        robot: with the feet that the log has.
        options: with a mass, and texts to `set` by field, by its name (``contact_on_n``) or its
            key in the file (``contact.on_n``, ``feet.NAME.frame``); ``tare.NAME`` is
            ``feet.NAME.offset_n``.

    Raises:
        CallError: there is no such field or foot, or the text is no value for it.
    """
    given = set[str]()
    if options.mass is not None:
        robot, given = replace(robot, mass_kg=options.mass), {"mass_kg"}
    for path, text in (options.set or {}).items():
        foot, name, value = _parsed(path, text)
        if not foot:
            robot = replace(robot, **{name: value})
            given.add(name)
            continue
        names = [each.name for each in robot.feet]
        if foot not in names:
            raise CallError(f"--set {path}: the log has no such foot; it has {listed(names)}")
        feet = (replace(e, **{name: value}) if e.name == foot else e for e in robot.feet)
        robot = replace(robot, feet=tuple(feet))
        given.add(f"tare.{foot}" if name == "offset_n" else path)
    _check_thresholds(robot, "--set")
    return replace(robot, given=frozenset(given))


def _check_thresholds(robot: Robot, source: str) -> None:
    on, off = robot.contact_on_n, robot.contact_off_n
    if on is not None and off is not None and off > on:
        raise CallError(f"{source}: contact.off_n is above contact.on_n; it must not be")


def check_robot_options(options: object) -> None:
    """Check --set and --foot before a log is opened; only that can tell the feet.

    Args:
        options: of a command; those that have neither are right.

    Raises:
        CallError: there is no such field, or no foot can have such a name.
    """
    if not isinstance(options, RobotOptions):
        return
    for path, text in (options.set or {}).items():
        _parsed(path, text)
    for name in options.foot or {}:
        if not name.replace("_", "").isalnum():
            raise CallError(f"--foot {name}: a foot's name has letters, digits and _ only")


def _parsed(path: str, text: str) -> tuple[str, str, Any]:
    """Return the foot, empty for the robot itself, the field's name and its value.

    Raises:
        CallError: there is no such field, or the text is no value for it.
    """
    first, _, rest = path.partition(".")
    foot, _, field = (rest, "", "offset_n") if first == "tare" and rest else rest.partition(".")
    of_foot = first in {"tare", "feet"} and bool(rest)
    foot, field = (foot, field) if of_foot else ("", path)
    for name, kind, key in declared_fields(Foot if of_foot else Robot):
        if field in {name, key} and name not in _NOT_SET:
            return foot, name, _value(kind, path, text)
    known = [each[0] for each in declared_fields(Robot) if each[0] not in _NOT_SET]
    known += ["tare.FOOT", *(f"feet.{foot or 'FOOT'}.{each[0]}" for each in declared_fields(Foot))]
    from difflib import get_close_matches  # noqa: PLC0415 - for wrong calls only

    near = get_close_matches(path, known, 3, 0.6)
    hint = f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(known)}"
    raise CallError(f"--set {path}: the robot's file has no such field; {hint}")


def _value(kind: Kind, path: str, text: str) -> Any:  # noqa: ANN401 - as in the file
    """Return the value that a text is: TOML, or a vector, a word or words without their marks.

    Raises:
        CallError: it is none that the field may have.
    """
    for toml in (text, f"[{text}]", to_toml(text), to_toml(tuple(text.split(",")))):
        with suppress(CallError):
            return checked(parse_toml(f"value = {toml}", "--set")["value"], kind, "")
    raise CallError(f"--set {path}={text}: it must be {kind.wanted}")
