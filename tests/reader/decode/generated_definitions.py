"""Definitions of messages, written here or made up by hypothesis."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any, Final, Literal

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from rosbags.interfaces.typing import Typesdict
from rosbags.typesys import get_types_from_msg
from rosbags.typesys.store import Typestore

from dogbot_logtool.reader.decode.definition import parse_definition
from dogbot_logtool.reader.decode.message_layout import Layout, Serialisation, compile_layout

Wire = Literal["ros1", "cdr little-endian", "cdr big-endian"]
WIRES: Final[tuple[Wire, ...]] = ("ros1", "cdr little-endian", "cdr big-endian")
ROOT: Final = "demo/Root"
SEPARATOR: Final = "=" * 80 + "\n"

NUMPY_NAMES: Final = {
    "bool": "bool",
    "byte": "int8",
    "char": "uint8",
    "int8": "int8",
    "uint8": "uint8",
    "int16": "int16",
    "uint16": "uint16",
    "int32": "int32",
    "uint32": "uint32",
    "int64": "int64",
    "uint64": "uint64",
    "float32": "float32",
    "float64": "float64",
}
CLOCKS: Final = {
    "time": "builtin_interfaces/Time",
    "duration": "builtin_interfaces/Duration",
}

generated = settings(
    max_examples=30,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


@dataclass(frozen=True)
class Field:
    name: str
    kind: str
    """A primitive's name, ``string``, ``time``, ``duration``, or a message's ``package/Name``."""
    array: int | Literal["variable"] | None = None

    @property
    def is_number(self) -> bool:
        return self.kind in NUMPY_NAMES

    @property
    def message(self) -> str | None:
        """The message that the field, or each of its elements, is."""
        if self.is_number or self.kind == "string":
            return None
        return CLOCKS.get(self.kind, self.kind)

    def line(self) -> str:
        array = ""
        if self.array is not None:
            array = "[]" if self.array == "variable" else f"[{self.array}]"
        return f"{self.kind}{array} {self.name}\n"


ROS1_CLOCKS: Final[dict[str, tuple[Field, ...]]] = {
    "builtin_interfaces/Time": (Field("sec", "uint32"), Field("nanosec", "uint32")),
    "builtin_interfaces/Duration": (Field("sec", "int32"), Field("nanosec", "int32")),
}
ROS2_CLOCKS: Final[dict[str, tuple[Field, ...]]] = dict.fromkeys(
    ROS1_CLOCKS, (Field("sec", "int32"), Field("nanosec", "uint32"))
)


@dataclass(frozen=True)
class Definition:
    """A message type with all that it depends on."""

    messages: dict[str, tuple[Field, ...]]
    ros: Literal[1, 2]
    clocks_recorded: bool = False

    def text(self) -> str:
        """As a recorder writes it."""
        sections = {
            name: lines_of(fields)
            for name, fields in self.messages.items()
            if self.clocks_recorded or name not in ROS1_CLOCKS
        }
        root = sections.pop(ROOT)
        return root + "".join(f"{SEPARATOR}MSG: {name}\n{body}" for name, body in sections.items())

    def layout(self, wire: Wire, wanted: Sequence[str] | None = None) -> Layout:
        struct = parse_definition(ROOT, self.text(), "ros1msg" if self.ros == 1 else "ros2msg")
        return compile_layout(struct, serialisation_of(wire), wanted)

    def store(self) -> Typestore:
        """The definition for rosbags, one for author and reader."""
        return store_of(self.text(), *(lines_of(self.messages[name]) for name in ROS1_CLOCKS))


@lru_cache(maxsize=1)
def store_of(text: str, *clocks: str) -> Typestore:
    store = Typestore()
    types = dict(get_types_from_msg(text, ROOT))
    for name, lines in zip(ROS1_CLOCKS, clocks, strict=True):
        types |= clock_types(lines, name)
    store.register(types)
    return store


@cache
def clock_types(lines: str, name: str) -> Typesdict:
    return get_types_from_msg(lines, name)


def lines_of(fields: Sequence[Field]) -> str:
    return "".join(field.line() for field in fields)


def define(ros: Literal[1, 2], **messages: str) -> Definition:
    """Build a definition from lines such as ``float64[3] x``; `Root` is what is decoded."""
    parsed = {}
    for message, lines in messages.items():
        fields = []
        for line in lines.splitlines():
            kind, name = line.split()
            kind, _, array = kind.removesuffix("]").partition("[")
            is_array = kind + name != line.replace(" ", "")
            length: int | Literal["variable"] | None = int(array) if array else "variable"
            kind = f"demo/{kind}" if kind in messages else kind
            fields.append(Field(name, kind, length if is_array else None))
        parsed[f"demo/{message}"] = tuple(fields)
    return Definition(parsed | clocks(ros), ros)


def clocks(ros: Literal[1, 2]) -> dict[str, tuple[Field, ...]]:
    return ROS1_CLOCKS if ros == 1 else ROS2_CLOCKS


def takes_no_bytes(messages: dict[str, tuple[Field, ...]], name: str) -> bool:
    return all(
        field.message is not None
        and field.array != "variable"
        and takes_no_bytes(messages, field.message)
        for field in messages[name]
    )


@st.composite
def definitions(draw: st.DrawFn, ros: Literal[1, 2]) -> Definition:
    """Several levels of messages of every kind of field; the last one is the root."""
    padding = Field("structure_needs_at_least_one_member", "uint8")
    messages = {"demo/Empty": () if ros == 1 else (padding,)} | clocks(ros)
    names = ["demo/Empty", *(CLOCKS if ros == 1 else ROS2_CLOCKS)]
    kinds = st.sampled_from([*NUMPY_NAMES, "string", "string"])
    arrays: st.SearchStrategy[Any] = st.sampled_from([None, None, "variable", "variable", 1, 3])
    below = draw(st.integers(0, 3))
    for level in range(below + 1):
        name = ROOT if level == below else f"demo/Level{level}"
        fields = []
        for index in range(draw(st.integers(2 if level else 0, 6))):
            # Two in three are references, if there is more than the simple ones to refer to.
            nested = draw(st.integers(0, 2)) < (2 if level else 1)
            kind = draw(st.sampled_from(names[-4:])) if nested else draw(kinds)
            field = Field(f"f{index}", kind, draw(arrays))
            if field.message and takes_no_bytes(messages, field.message):
                field = Field(field.name, kind)  # see the tests of arrays of empty messages
            fields.append(field)
        if not fields and ros == 2:
            fields = [padding]
        messages[name] = tuple(fields)
        names.append(name)
    return Definition(messages, ros, clocks_recorded=ros == 2 and draw(st.booleans()))


def ros_of(wire: Wire) -> Literal[1, 2]:
    return 1 if wire == "ros1" else 2


def serialisation_of(wire: Wire) -> Serialisation:
    return "ros1" if wire == "ros1" else "cdr"


def dotted_paths(definition: Definition, name: str, prefix: str) -> Iterator[str]:
    for field in definition.messages[name]:
        yield prefix + field.name
        if field.message is not None:
            yield from dotted_paths(definition, field.message, f"{prefix}{field.name}.")
