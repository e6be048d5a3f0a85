"""Recorded message definitions as trees of fields.

The texts are parsed by rosbags; here their result becomes a small closed tree that the columnar
decoder can compile, with every hostile shape (self-reference, absurd depth or size) refused.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

from dogbot_logtool.errors import DefinitionError

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc, Typesdict
    from rosbags.typesys.store import Typestore

Serialisation = Literal["ros1", "cdr"]
_MAX_TEXT: Final = 1 << 20
_MAX_DEPTH: Final = 32
_MAX_FIELDS: Final = 10_000
_MAX_FIXED_SIZE: Final = 1 << 31
_EMPTY_MESSAGE_FIELD: Final = "structure_needs_at_least_one_member"
_PARSER_FAILURES: Final = (
    ArithmeticError,
    AssertionError,
    KeyError,
    MemoryError,
    RecursionError,
    ValueError,
)
_NESTED_PARENTHESES: Final = r"\([^()]*\("
"""The IDL parser's time grows fiftyfold with every level of these."""
_IDL_STRING: Final = r'"(?:[^"\\]|\\.)*"'
"""Comments in annotations, mostly: no type needs them, and they may hold anything."""
_IDL_SECTION: Final = r"(?m)^(?:=+|IDL: .*|#include .*)\r?$"
"""Line that recorders write between the files of a definition."""

_SHIPPED: Final = Path(__file__).with_name("definitions")
"""Types that rosbags' stores do not have, and whose layout never changed, a file each. (Those of
`unitree_legged_msgs` and `spot_msgs` differ from version to version: only a log that records them
can be read.)"""

_DTYPES: Final = {
    "bool": "u1",
    "byte": "u1",
    "char": "u1",
    "octet": "u1",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "int64": "i8",
    "uint64": "u8",
    "float32": "f4",
    "float64": "f8",
}


@dataclass(frozen=True, slots=True)
class Primitive:
    """A number of fixed width."""

    dtype: str
    """numpy's name without byte order: ``f8``, ``u4`` ..."""
    name: str = field(default="", compare=False)
    """Its name in the definition: ``float64``, ``bool`` ... Some names are one dtype."""

    @property
    def size(self) -> int:
        """Width in bytes."""
        return int(self.dtype[1:])


class Text(NamedTuple):
    """A string: a 32-bit length, then bytes."""


class FixedArray(NamedTuple):
    """As many elements as the definition says, without a count."""

    element: "FieldType"
    length: int


class VariableArray(NamedTuple):
    """A 32-bit count, then so many elements."""

    element: "FieldType"


class Struct(NamedTuple):
    """A message: its fields in order."""

    name: str
    fields: tuple[tuple[str, "FieldType"], ...]


FieldType = Primitive | Text | FixedArray | VariableArray | Struct

_TIME, _DURATION = "builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"


def clock(name: str, seconds: str, nanoseconds: str) -> Struct:
    """Return a time or a duration, of two numbers."""
    return Struct(name, (("sec", Primitive(seconds)), ("nanosec", Primitive(nanoseconds))))


_ROS1_CLOCKS: Final = {_TIME: clock("time", "u4", "u4"), _DURATION: clock("duration", "i4", "i4")}
_ROS2_CLOCKS: Final = {name: clock(name, "i4", "u4") for name in _ROS1_CLOCKS}


def short_type_name(name: str) -> str:
    """Return ``package/Name`` for either spelling of a type's name."""
    return name.replace("/msg/", "/", 1)


def long_type_name(name: str) -> str:
    """Return ``package/msg/Name``, as ROS 2 spells it, for either spelling."""
    package, _, message = short_type_name(name).rpartition("/")
    return f"{package}/msg/{message}" if package and "/" not in package else name


@lru_cache(maxsize=256)
def parse_definition(type_name: str, text: str, schema_encoding: str) -> Struct:
    """Parse a recorded definition with all that it depends on.

    Args:
        type_name: ``nav_msgs/Odometry`` or ``nav_msgs/msg/Odometry``.
        text: the definition, dependencies appended as recorders do.
        schema_encoding: ``ros1msg``, ``ros2msg`` or ``ros2idl``.

    Raises:
        DefinitionError: the text is no definition, a dependency is missing, or its shape is one
            that no message can have.
    """
    if len(text) > _MAX_TEXT:
        raise DefinitionError(f"the definition of {type_name} is {len(text)} characters long")
    parsed = parse_types(type_name, text, schema_encoding)
    types = {name: fields for name, (_constants, fields) in parsed.items()}
    return _TreeBuilder(types, schema_encoding).struct(long_type_name(type_name), ())


def parse_types(type_name: str, text: str, schema_encoding: str) -> "Typesdict":
    """Parse the types of a recorded definition; see `parse_definition`.

    Raises:
        DefinitionError: the text is no definition.
    """
    text = text if schema_encoding == "ros2idl" else text.replace("\r\n", "\n")
    # Imported late: the parser takes longer to import than `--help` may take.
    from rosbags.typesys import TypesysError, get_types_from_idl, get_types_from_msg  # noqa: PLC0415

    try:
        if schema_encoding == "ros2idl":
            text = re.sub(_IDL_SECTION, "", re.sub(_IDL_STRING, '""', text))
            if re.search(_NESTED_PARENTHESES, text):
                raise DefinitionError(f"the definition of {type_name} has nested parentheses")
            return get_types_from_idl(text)
        if schema_encoding in {"ros1msg", "ros2msg"}:
            return get_types_from_msg(text, type_name)
    except (TypesysError, *_PARSER_FAILURES) as error:
        raise DefinitionError(f"the definition of {type_name} cannot be parsed") from error
    raise DefinitionError(f"{type_name} is described in {schema_encoding!r}, which is not read")


class _TreeBuilder:
    """Builds the tree below one type, counting fields so that no definition can explode."""

    def __init__(
        self,
        types: Mapping[str, Sequence[tuple[str, "FieldDesc"]]],
        schema_encoding: str,
    ) -> None:
        self._types = types
        self._clocks = _ROS1_CLOCKS if schema_encoding == "ros1msg" else _ROS2_CLOCKS
        self._is_ros1 = schema_encoding == "ros1msg"
        self._fields = 0

    def struct(self, name: str, parents: tuple[str, ...]) -> Struct:
        if name in parents or len(parents) >= _MAX_DEPTH:
            raise DefinitionError(f"the definition of {name} contains itself, or is too deep")
        if name not in self._types:
            if name in self._clocks:
                return self._clocks[name]
            raise DefinitionError(f"the definition of {name} is missing from the log")
        fields = [each for each in self._types[name] if each[0] != _EMPTY_MESSAGE_FIELD]
        names = Counter(each[0] for each in fields)
        twice = next((each for each, count in names.items() if count > 1), None)
        if twice is not None:
            raise DefinitionError(f"the definition of {name} has the field {twice!r} twice")
        self._fields += len(fields)
        if self._fields > _MAX_FIELDS:
            raise DefinitionError(f"a definition has more than {_MAX_FIELDS} fields")
        below = (*parents, name)
        built = tuple((each, self._type(desc, below)) for each, desc in fields)
        if not built and not self._is_ros1:
            # An empty message takes one byte in CDR, and none in ROS 1.
            built = ((_EMPTY_MESSAGE_FIELD, Primitive("u1")),)
        struct = Struct(name, built)
        if smallest_size(struct) >= _MAX_FIXED_SIZE:
            raise DefinitionError(f"a message of {smallest_size(struct)} bytes is absurd")
        return struct

    def _type(self, description: "FieldDesc", parents: tuple[str, ...]) -> FieldType:
        kind, detail = description[0].name, description[1]
        if kind == "BASE":
            return self._base_type(str(detail[0]))
        if kind == "NAME":
            return self.struct(str(detail), parents)
        element = self._type(detail[0], parents)  # type: ignore[arg-type]
        length = int(detail[1]) if kind == "ARRAY" else 1
        # Elements without a byte hold nothing, and may be said to be any number.
        if not 0 < length * smallest_size(element) < _MAX_FIXED_SIZE:
            raise DefinitionError(f"an array of {length} elements in {parents[-1]} is absurd")
        return FixedArray(element, length) if kind == "ARRAY" else VariableArray(element)

    def _base_type(self, name: str) -> Primitive | Text:
        if name == "string":
            return Text()
        if name == "byte" and self._is_ros1:
            return Primitive("i1", name)
        if name not in _DTYPES:
            raise DefinitionError(f"fields of type {name} are not read")
        return Primitive(_DTYPES[name], name)


def smallest_size(field_type: FieldType) -> int:
    """Return the fewest bytes that a field can take, to bound the counts that a log claims."""
    match field_type:
        case Primitive():
            return field_type.size
        case FixedArray(element, length):
            return smallest_size(element) * length
        case Struct(_, fields):
            return sum(smallest_size(inner) for _, inner in fields)
        case _:
            return 4


def type_text(field_type: FieldType) -> str:
    """Return a type as a definition spells it: ``float64[3]``, ``geometry_msgs/Point[]``."""
    match field_type:
        case Primitive(dtype, name):
            return name or dtype
        case Text():
            return "string"
        case FixedArray(element, length):
            return f"{type_text(element)}[{length}]"
        case VariableArray(element):
            return f"{type_text(element)}[]"
        case Struct(name):
            return short_type_name(name)


def known_definition(
    type_name: str, distribution: str = "", serialisation: Serialisation = "cdr"
) -> str | None:
    """Return the definition of a type with all that it depends on.

    Args:
        type_name: ``nav_msgs/msg/Odometry``.
        distribution: name of the ROS 2 distribution that recorded the log; empty: not known.
        serialisation: of ROS 1 or of ROS 2.

    Returns:
        the text as ``ros1msg`` or ``ros2msg``; None for a type that is not known.
    """
    is_ros1 = serialisation == "ros1"
    store = _store("ros1" if is_ros1 else distribution)
    name = long_type_name(type_name)
    if name not in store.fielddefs:
        return None
    return store.generate_msgdef(name, ros_version=1 if is_ros1 else 2)[0]


@lru_cache(maxsize=4)
def _store(distribution: str) -> "Typestore":
    """Return rosbags' types of a ROS 2 distribution, or of ROS 1, with those that it lacks."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: PLC0415

    named = {store.name.rpartition("_")[2].lower(): store for store in Stores}
    named["ros1"] = Stores.ROS1_NOETIC
    store = get_typestore(named.get(distribution.lower(), Stores.ROS2_HUMBLE))
    for file in sorted(_SHIPPED.glob("*/*.msg")):
        name = f"{file.parent.name}/msg/{file.stem}"
        if name not in store.fielddefs:
            store.register(get_types_from_msg(file.read_text(encoding="utf-8"), name))
    return store
