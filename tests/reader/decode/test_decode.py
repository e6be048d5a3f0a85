"""The columnar decoder equals rosbags' message-by-message one, on generated definitions too."""

import tracemalloc
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any, Final, Literal, NamedTuple

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbags.interfaces.typing import Typesdict
from rosbags.serde import SerdeError
from rosbags.typesys import get_types_from_msg
from rosbags.typesys.store import Typestore

from dogbot_logtool.core.geometry.arrays import Flags
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.columns import Table, Texts
from dogbot_logtool.reader.decode.decode import MAX_VARIABLE_ELEMENTS, decode
from dogbot_logtool.reader.decode.definition import parse_definition
from dogbot_logtool.reader.decode.message_layout import (
    Layout,
    Serialisation,
    compile_layout,
)

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


# --- definitions ------------------------------------------------------------------------------


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


# --- messages, written and read by rosbags ----------------------------------------------------


class Author:
    """Writes random messages of a definition; rosbags serialises them."""

    def __init__(self, definition: Definition, wire: Wire, seed: int) -> None:
        self._definition = definition
        self._store = definition.store()
        self._wire = wire
        self._random = np.random.default_rng(seed)

    def write(self, count: int) -> list[bytes]:
        return [self.serialise(self._message(ROOT)) for _ in range(count)]

    def serialise(self, message: Any) -> bytes:
        name = long_name(ROOT)
        if self._wire == "ros1":
            return bytes(self._store.serialize_ros1(message, name))
        little = self._wire == "cdr little-endian"
        return bytes(self._store.serialize_cdr(message, name, little_endian=little))

    def message(self, name: str, **values: Any) -> Any:
        return self._store.types[long_name(name)](**values)

    def _message(self, name: str) -> Any:
        fields = self._definition.messages[name]
        return self.message(name, **{field.name: self._value(field) for field in fields})

    def _value(self, field: Field) -> Any:
        if field.array is None:
            return self._number(field.kind).item() if field.is_number else self._single(field)
        count = int(self._random.integers(0, 5)) if field.array == "variable" else field.array
        if field.is_number:
            numbers = [self._number(field.kind) for _ in range(count)]
            return np.array(numbers, NUMPY_NAMES[field.kind])
        return [self._single(field) for _ in range(count)]

    def _single(self, field: Field) -> Any:
        if field.message is None:
            letters = "ab \0é€😀/_" if self._random.random() < 0.1 else "ab \0/_"
            return "".join(self._random.choice(list(letters), self._random.integers(0, 9)))
        return self._message(field.message)

    def _number(self, kind: str) -> Any:
        dtype = np.dtype(NUMPY_NAMES[kind])
        if kind == "bool":
            return dtype.type(self._random.integers(0, 2))
        if kind.startswith("float") and self._random.random() < 0.5:
            special = [0.0, -0.0, 1.5, np.inf, -np.inf, np.nan, 5e-324, 1e-40]
            return dtype.type(self._random.choice(special))
        return np.frombuffer(self._random.bytes(dtype.itemsize), dtype)[0]


class Oracle:
    """rosbags' reading of one message, as nested lists and dictionaries; None if refused."""

    def __init__(self, definition: Definition, wire: Wire) -> None:
        self._definition = definition
        self._store = definition.store()
        self._wire = wire
        self.refusal = ""
        """Why the last message was refused."""

    def read(self, data: bytes) -> Any:
        name = long_name(ROOT)
        try:
            if self._wire == "ros1":
                message = self._store.deserialize_ros1(data, name)
            else:
                message = self._store.deserialize_cdr(data, name)
        except SerdeError as error:
            self.refusal = "not UTF-8" if "codec can't decode" in str(error) else str(error)
            return None
        return self._plain(message, ROOT)

    def _plain(self, message: Any, name: str) -> dict[str, Any]:
        plain = {}
        for field in self._definition.messages[name]:
            value = getattr(message, field.name)
            if field.array is None:
                plain[field.name] = self._plain_single(value, field)
            else:
                plain[field.name] = [self._plain_single(one, field) for one in value]
        return plain

    def _plain_single(self, value: Any, field: Field) -> Any:
        if field.message is not None:
            return self._plain(value, field.message)
        return comparable(value, field.kind)

    def excused(self, wire: Wire) -> bool:
        """Tell whether the last refusal is for something that the decoder knowingly accepts."""
        if self.refusal == "not UTF-8":
            return True
        empty_string = "Invalid string length 0 ", "Invalid sequence length "
        return wire != "ros1" and self.refusal.startswith(empty_string)


def long_name(name: str) -> str:
    return name.replace("/", "/msg/")


def comparable(value: Any, kind: str) -> Any:
    """Make values of equal meaning equal: NaN equals itself, zeros have signs."""
    if kind == "string":
        return value
    number = value.item() if isinstance(value, np.generic) else value
    if kind == "bool":
        return bool(number)
    if kind == "byte":  # rosbags reads it signed, see the test of ROS 1 bytes
        return number & 0xFF
    return float.hex(number) if isinstance(number, float) else number


# --- columns back to messages -----------------------------------------------------------------


def messages_of(definition: Definition, table: Table) -> list[Any]:
    """Convert a table to one nested value a row."""
    return struct_rows(definition, ROOT, table, "")


def struct_rows(definition: Definition, name: str, table: Table, prefix: str) -> list[Any]:
    fields = definition.messages[name]
    values = [field_rows(definition, field, table, prefix + field.name) for field in fields]
    names = [field.name for field in fields]
    return [dict(zip(names, row, strict=True)) for row in zip(*values, strict=True)] or [
        {} for _ in range(table.rows)
    ]


def field_rows(definition: Definition, field: Field, table: Table, path: str) -> list[Any]:
    if field.array is None:
        if field.message is not None:
            return struct_rows(definition, field.message, table, f"{path}.")
        return single_rows(field, table, path)
    if field.is_number and field.array != "variable":
        matrix = table.numbers(path)
        assert matrix.shape == (table.rows, field.array)
        return [[comparable(number, field.kind) for number in row] for row in matrix]
    nested = table.nested(path)
    assert len(nested.parent) == nested.table.rows
    if field.message is not None:
        elements = struct_rows(definition, field.message, nested.table, "")
    else:
        elements = single_rows(field, nested.table, "value")
    rows: list[list[Any]] = [[] for _ in range(table.rows)]
    for parent, element in zip(nested.parent.tolist(), elements, strict=True):
        rows[parent].append(element)
    return rows


def single_rows(field: Field, table: Table, path: str) -> list[Any]:
    if field.kind == "string":
        texts = table.texts(path)
        return [texts.text(row) for row in range(table.rows)]
    numbers = table.numbers(path)
    assert numbers.shape == (table.rows,)
    return [comparable(number, field.kind) for number in numbers]


class Decoded(NamedTuple):
    """What `decode` returns."""

    table: Table
    sound: Flags


def decode_messages(layout: Layout, messages: Sequence[bytes], seed: int = 0) -> Decoded:
    """Decode messages that stand in a buffer in any order, with rubbish between them."""
    random = np.random.default_rng(seed)
    start = np.zeros(len(messages), np.int64)
    buffer = bytearray()
    for row in random.permutation(len(messages)):
        buffer += b"\xff" * int(random.integers(0, 9))
        start[row] = len(buffer)
        buffer += messages[row]
    return decode_at(layout, bytes(buffer), start, [len(message) for message in messages])


def decode_alone(layout: Layout, message: bytes) -> Decoded:
    """Decode a message that is all there is in the buffer."""
    return decode_at(layout, message, np.zeros(1, np.int64), [len(message)])


def decode_at(layout: Layout, buffer: bytes, start: Any, length: Sequence[int]) -> Decoded:
    end = start + np.array(length, np.int64)
    return Decoded(*decode(layout, np.frombuffer(buffer, np.uint8), start, end))


# --- sound messages ---------------------------------------------------------------------------


@pytest.mark.parametrize("wire", WIRES)
@generated
@given(data=st.data(), seed=st.integers(0, 2**32), count=st.integers(0, 6))
def test_every_field_of_every_message_equals_what_rosbags_reads(
    wire: Wire, data: st.DataObject, seed: int, count: int
) -> None:
    definition = data.draw(definitions(ros_of(wire)))
    messages = Author(definition, wire, seed).write(count)
    oracle = Oracle(definition, wire)

    decoded = decode_messages(definition.layout(wire), messages, seed)

    assert decoded.sound.all()
    assert decoded.table.rows == count
    assert messages_of(definition, decoded.table) == [oracle.read(one) for one in messages]


@pytest.mark.parametrize("wire", WIRES)
@generated
@given(data=st.data(), seed=st.integers(0, 2**32))
def test_wanted_fields_are_the_same_columns_as_in_a_full_decode(
    wire: Wire, data: st.DataObject, seed: int
) -> None:
    definition = data.draw(definitions(ros_of(wire)))
    paths = sorted(set(dotted_paths(definition, ROOT, "")))
    wanted = data.draw(st.lists(st.sampled_from(paths), unique=True)) if paths else []
    messages = Author(definition, wire, seed).write(3)

    part = decode_messages(definition.layout(wire, wanted), messages, seed)
    full = decode_messages(definition.layout(wire), messages, seed)

    assert part.sound.all()
    assert dict(flat(part.table)) == {
        path: column for path, column in flat(full.table) if is_wanted(path, wanted)
    }


def dotted_paths(definition: Definition, name: str, prefix: str) -> Iterator[str]:
    for field in definition.messages[name]:
        yield prefix + field.name
        if field.message is not None:
            yield from dotted_paths(definition, field.message, f"{prefix}{field.name}.")


def flat(table: Table, prefix: str = "") -> Iterator[tuple[str, object]]:
    """Every column by its whole path; an array is a column of parents, named with ``[]``."""
    for name in (name for run in table.runs for name in run.dtype.names or ()):
        yield prefix + name, table.numbers(name).tobytes()
    for name, column in table.columns.items():
        path = prefix + name
        if isinstance(column, Texts):
            yield path, [column.text(row) for row in range(table.rows)]
        else:
            nested = table.nested(name)
            yield f"{path}[]", nested.parent.tolist()
            yield from flat(nested.table, f"{path}.")


def is_wanted(path: str, wanted: Sequence[str]) -> bool:
    if path.endswith("[]"):
        array = path.removesuffix("[]")
        return any(f"{want}.".startswith(f"{array}.") for want in wanted) or is_wanted(
            array, wanted
        )
    return any(f"{path}.".startswith(f"{want}.") for want in wanted)


def test_no_messages_give_an_empty_table_with_every_column() -> None:
    definition = define(1, Root="uint8 a\nstring b\nInner[] c\nstring[2] d", Inner="string x")

    decoded = decode_at(definition.layout("ros1"), b"", np.zeros(0, np.int64), [])

    assert decoded.sound.tolist() == []
    assert decoded.table.rows == 0
    assert set(decoded.table.columns) == {"b", "c", "d"}
    assert decoded.table.numbers("a").shape == (0,)
    assert set(decoded.table.nested("c").table.columns) == {"x"}


def test_elements_of_one_message_stay_in_their_order() -> None:
    definition = define(1, Root="Inner[] inner", Inner="uint32 number\nstring text")
    author = Author(definition, "ros1", 0)
    counts = [3, 0, 5, 1]
    messages = [
        author.serialise(
            author.message(
                ROOT,
                inner=[
                    author.message("demo/Inner", number=number, text="x" * (5 - number))
                    for number in range(count)
                ],
            )
        )
        for count in counts
    ]

    nested = decode_messages(definition.layout("ros1"), messages).table.nested("inner")

    for row, count in enumerate(counts):
        assert nested.table.numbers("number")[nested.parent == row].tolist() == list(range(count))


def test_ros1_times_are_unsigned_and_durations_are_signed() -> None:
    definition = define(1, Root="time at\nduration lasting")
    data = bytes.fromhex("ffffffff fffffffe ffffffff fffffffe")

    table = decode_alone(definition.layout("ros1"), data).table

    assert table.numbers("at.sec").tolist() == [2**32 - 1]
    assert table.numbers("at.nanosec").tolist() == [0xFEFFFFFF]
    assert table.numbers("lasting.sec").tolist() == [-1]
    assert table.numbers("lasting.nanosec").tolist() == [-0x1000001]


def test_ros2_times_and_durations_have_signed_seconds_and_unsigned_nanoseconds() -> None:
    definition = define(2, Root="time at\nduration lasting")
    data = bytes.fromhex("00010000 ffffffff fffffffe ffffffff fffffffe")

    table = decode_alone(definition.layout("cdr little-endian"), data).table

    for field in ("at", "lasting"):
        assert table.numbers(f"{field}.sec").tolist() == [-1]
        assert table.numbers(f"{field}.nanosec").tolist() == [0xFEFFFFFF]


def test_a_ros1_byte_is_signed_and_a_char_is_not() -> None:
    definition = define(1, Root="byte b\nchar c\nbyte[2] more")

    table = decode_alone(definition.layout("ros1"), b"\xff\xff\xfe\x01").table

    assert table.numbers("c").tolist() == [255]
    assert table.numbers("b").tolist() == [-1]
    assert table.numbers("more").tolist() == [[-2, 1]]


def test_a_ros2_byte_is_an_octet() -> None:
    definition = define(2, Root="byte b\nchar c")

    table = decode_alone(definition.layout("cdr little-endian"), b"\0\1\0\0\xff\xff").table

    assert table.numbers("b").tolist() == [255]
    assert table.numbers("c").tolist() == [255]


def test_an_empty_message_takes_one_byte_in_cdr_even_if_its_recorded_text_is_empty() -> None:
    # rosbag2 records the .msg file, which is empty; the padding byte is in the IDL only.
    definition = define(2, Root="Empty nothing\nuint32 number", Empty="")
    data = bytes.fromhex("00010000 00 000000 2a000000")

    decoded = decode_alone(definition.layout("cdr little-endian"), data)

    assert decoded.sound.all()
    assert decoded.table.numbers("number").tolist() == [42]


def test_an_empty_message_takes_nothing_in_ros1() -> None:
    definition = define(1, Root="Empty nothing\nuint32 number\nEmpty[] many", Empty="")
    data = bytes.fromhex("2a000000 00000000")

    decoded = decode_alone(definition.layout("ros1"), data)

    assert decoded.sound.all()
    assert decoded.table.numbers("number").tolist() == [42]
    assert decoded.table.nested("many").table.rows == 0


def test_a_fixed_array_of_empty_messages_takes_nothing_in_ros1() -> None:
    definition = define(1, Root="Empty[2] nothing\nuint8 number\nEmpty[3] none", Empty="")

    decoded = decode_alone(definition.layout("ros1"), b"\x2a")

    assert decoded.sound.all()
    assert decoded.table.numbers("number").tolist() == [42]
    assert decoded.table.nested("none").parent.tolist() == [0, 0, 0]


def test_an_array_of_no_elements_is_a_column_of_no_width() -> None:
    definition = define(1, Root="uint8 before\nfloat64[0] none\nuint8 after")

    table = decode_alone(definition.layout("ros1"), b"\x01\x02").table

    assert table.numbers("none").shape == (1, 0)
    assert table.numbers("after").tolist() == [2]


def test_a_cdr_string_of_recorded_length_zero_is_empty() -> None:
    # Some writers leave the terminator of an empty string out; rosbags refuses that.
    definition = define(2, Root="string text\nuint32 number")
    data = bytes.fromhex("00010000 00000000 2a000000")

    decoded = decode_alone(definition.layout("cdr little-endian"), data)

    assert decoded.sound.all()
    assert decoded.table.texts("text").text(0) == ""
    assert decoded.table.numbers("number").tolist() == [42]


def test_text_that_is_not_utf_8_is_replaced() -> None:
    definition = define(1, Root="string text")

    table = decode_alone(definition.layout("ros1"), b"\x03\0\0\0a\xffb").table

    assert table.texts("text").text(0) == "a�b"


@given(texts=st.lists(st.sampled_from(["", "a", "ab", "ba", "world", "words", "é"]), max_size=30))
@generated
def test_encoded_texts_are_numbered_by_their_first_appearance(texts: list[str]) -> None:
    definition = define(1, Root="string text")
    raw = [text.encode() for text in texts]
    messages = [len(text).to_bytes(4, "little") + text for text in raw]

    code, names = decode_messages(definition.layout("ros1"), messages).table.texts("text").encode()

    assert list(names) == list(dict.fromkeys(texts))
    assert [names[number] for number in code] == texts


def test_cdr_elements_are_padded_between_but_not_after_the_last() -> None:
    definition = define(2, Root="Pair[] pairs\nuint8 after", Pair="float64 x\nuint8 y")
    count, gap = bytes.fromhex("00010000 02000000 00000000"), bytes(7)
    pairs = [np.float64(x).tobytes() + bytes([y]) for x, y in ((1.5, 7), (2.5, 8))]
    message = count + gap.join(pairs) + b"\x09"
    layout = definition.layout("cdr little-endian")

    decoded = decode_messages(layout, [message, message[:-1], message[:-2]])

    assert decoded.sound.tolist() == [True, False, False]
    nested = decoded.table.nested("pairs").table
    assert nested.numbers("x").tolist() == [1.5, 2.5]
    assert nested.numbers("y").tolist() == [7, 8]
    assert decoded.table.numbers("after").tolist() == [9]


# --- malformed messages -----------------------------------------------------------------------


def truncations(message: bytes) -> list[bytes]:
    return [message[:length] for length in range(len(message))]


def flips(message: bytes) -> list[bytes]:
    """One byte at a time, made huge, negated, or one more or less (as counts go wrong)."""
    changes: tuple[Callable[[int], int], ...] = (
        lambda byte: byte ^ 0xFF,
        lambda byte: (byte + 1) & 0xFF,
        lambda byte: (byte - 1) & 0xFF,
    )
    return [
        message[:place] + bytes([change(message[place])]) + message[place + 1 :]
        for place in range(len(message))
        for change in changes
    ]


def hostile_words(message: bytes) -> list[bytes]:
    """Four bytes at a time, as the largest and the most nearly negative counts."""
    words = (b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\x7f\xff\xff\xff", b"\0\0\0\x80")
    return [
        message[:place] + word + message[place + 4 :]
        for place in range(len(message) - 3)
        for word in words
    ]


def extensions(message: bytes) -> list[bytes]:
    return [message + bytes(count) for count in range(1, 10)]


DAMAGES: Final[dict[str, Callable[[bytes], list[bytes]]]] = {
    "truncated": truncations,
    "with a byte changed": flips,
    "with a hostile count": hostile_words,
    "with bytes appended": extensions,
}


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("wire", WIRES)
@settings(generated, max_examples=12)
@given(data=st.data(), seed=st.integers(0, 2**32))
def test_a_message_is_unsound_if_and_only_if_rosbags_refuses_it(
    wire: Wire, damage: str, data: st.DataObject, seed: int
) -> None:
    definition = data.draw(definitions(ros_of(wire)))
    layout = definition.layout(wire)
    oracle = Oracle(definition, wire)
    first, damaged, last = Author(definition, wire, seed).write(3)
    messages = [first, *thinned(DAMAGES[damage](damaged), 200, seed), last]
    expected = [oracle_verdict(oracle, wire, message, first) for message in messages]

    decoded = decode_messages(layout, messages, seed)

    assert decoded.sound[[0, -1]].all()
    assert decoded.table.rows == decoded.sound.sum()
    rows = iter(messages_of(definition, decoded.table))
    for sound, (accepted, value) in zip(decoded.sound.tolist(), expected, strict=True):
        row = next(rows) if sound else None
        if accepted is not None:
            assert sound == accepted
            assert row == value


def thinned(messages: list[bytes], at_most: int, seed: int) -> list[bytes]:
    if len(messages) <= at_most:
        return messages
    chosen = np.random.default_rng(seed).choice(len(messages), at_most, replace=False)
    return [messages[index] for index in chosen]


def oracle_verdict(
    oracle: Oracle, wire: Wire, message: bytes, first: bytes
) -> tuple[bool | None, Any]:
    """Whether a message is sound, and its value; None where no verdict can be had."""
    value = oracle.read(message)
    if value is None:
        return (None if oracle.excused(wire) else False), None
    if wire != "ros1" and message[1] != first[1]:
        return False, None  # the byte order is another one than its neighbours'
    return True, value


@pytest.mark.parametrize("wire", WIRES)
@settings(generated, max_examples=15)
@given(data=st.data(), seed=st.integers(0, 2**32))
def test_a_message_is_judged_the_same_when_it_is_alone_in_its_buffer(
    wire: Wire, data: st.DataObject, seed: int
) -> None:
    definition = data.draw(definitions(ros_of(wire)))
    paths = sorted(set(dotted_paths(definition, ROOT, "")))
    wanted = data.draw(st.none() | st.lists(st.sampled_from(paths))) if paths else None
    layout = definition.layout(wire, wanted)
    oracle = Oracle(definition, wire)
    message = Author(definition, wire, seed).write(1)[0]
    damaged = [variant for damage in DAMAGES.values() for variant in damage(message)]

    for variant in thinned(damaged, 20, seed):
        accepted, _ = oracle_verdict(oracle, wire, variant, variant)
        decoded = decode_alone(layout, variant)
        assert accepted is None or decoded.sound.tolist() == [accepted]


def test_a_truncated_message_alone_is_unsound_though_wanted_fields_lie_far_apart() -> None:
    text = "uint8[10] a\nuint8[900] b\nfloat64 c\nuint8[200] d\nfloat64 e"
    layout = define(1, Root=text).layout("ros1", ("a", "c", "e"))

    for length in range(10 + 900 + 8 + 200 + 8):
        decoded = decode_alone(layout, bytes(length))

        assert decoded.sound.tolist() == [False]
        assert decoded.table.rows == 0


@cache
def author_of_hostility() -> tuple[Definition, list[bytes]]:
    definition = define(
        2,
        Root="string a\nfloat64[] b\nInner[] c\nstring[] d\nInner[2] e\nuint8[] f",
        Inner="uint8 x\nstring y\nuint32[] z\nEven[] even",
        Even="float64 x\nfloat64 y",
    )
    return definition, Author(definition, "cdr little-endian", 5).write(40)


def test_counts_that_no_message_can_hold_allocate_nothing() -> None:
    definition, messages = author_of_hostility()
    layout = definition.layout("cdr little-endian")
    worst = max(messages, key=len)
    places = range(4, len(worst) - 3)
    hostile = [worst[:place] + b"\xff" * 4 + worst[place + 4 :] for place in places]
    decode_messages(layout, hostile)

    tracemalloc.start()
    try:
        decode_messages(layout, hostile)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()

    assert peak < 100 * sum(len(message) for message in hostile)


def test_absurdly_large_messages_are_unsound_and_allocate_nothing_if_defined_at_all() -> None:
    definition = define(1, Root="uint8[2000000000] x")

    with suppress(DefinitionError):
        decoded = decode_messages(definition.layout("ros1"), [b"abc"] * 5000)
        assert not decoded.sound.any()


def test_the_size_of_absurdly_large_elements_does_not_overflow_if_they_are_defined_at_all() -> None:
    # 4 * (2**31 - 1) bytes an element, times 2**31: more than an int64 counts to.
    large = "\n".join(f"uint8[2147483647] x{index}" for index in range(4))
    definition = define(1, Root="Large[] many", Large=large)

    with suppress(DefinitionError):
        decoded = decode_messages(definition.layout("ros1"), [b"\0\0\0\x80"] * 1000)
        assert not decoded.sound.any()


@pytest.mark.parametrize(("excess", "sound"), [(0, True), (1, False)])
def test_arrays_of_uneven_elements_have_a_limit(excess: int, sound: bool) -> None:  # noqa: FBT001
    definition = define(1, Root="string[] texts")
    count = MAX_VARIABLE_ELEMENTS + excess
    message = count.to_bytes(4, "little") + bytes(4 * count)
    neighbour = (1).to_bytes(4, "little") + (2).to_bytes(4, "little") + b"ab"

    decoded = decode_messages(definition.layout("ros1"), [neighbour, message, neighbour])

    assert decoded.sound.tolist() == [True, sound, True]


def test_arrays_of_even_elements_have_no_limit() -> None:
    definition = define(1, Root="uint16[] numbers")
    count = 5 * MAX_VARIABLE_ELEMENTS
    message = count.to_bytes(4, "little") + bytes(2 * count)

    decoded = decode_messages(definition.layout("ros1"), [message])

    assert decoded.sound.all()
    assert decoded.table.nested("numbers").table.rows == count


def test_an_array_of_empty_messages_cannot_claim_more_elements_than_bytes() -> None:
    definition = define(1, Root="Empty[] nothing\nuint8[] rest", Empty="")
    claims = (2**32 - 1).to_bytes(4, "little") + (1).to_bytes(4, "little") + b"\0"

    decoded = decode_messages(definition.layout("ros1"), [claims])

    assert not decoded.sound.any()


@pytest.mark.parametrize("header", [b"\0\2", b"\0\3", b"\0\6", b"\1\0", b"\xff\xff"])
def test_other_encapsulations_than_plain_cdr_are_unsound(header: bytes) -> None:
    layout = define(2, Root="uint32 number").layout("cdr little-endian")
    plain = bytes.fromhex("00010000 2a000000")

    decoded = decode_messages(layout, [header + plain[2:], plain, header + plain[2:]])

    assert decoded.sound.tolist() == [False, True, False]
    assert decoded.table.numbers("number").tolist() == [42]


def test_a_message_in_another_byte_order_than_its_neighbours_is_unsound() -> None:
    layout = define(2, Root="uint32 number").layout("cdr little-endian")
    little, big = bytes.fromhex("00010000 2a000000"), bytes.fromhex("00000000 0000002a")

    decoded = decode_messages(layout, [little, big, little])

    assert decoded.sound.tolist() == [True, False, True]
    assert decoded.table.numbers("number").tolist() == [42, 42]


@pytest.mark.parametrize(("padding", "sound"), [(0, True), (3, True), (4, False)])
def test_cdr_may_be_followed_by_three_bytes_of_padding(
    padding: int,
    sound: bool,  # noqa: FBT001
) -> None:
    layout = define(2, Root="uint8 number").layout("cdr little-endian")

    decoded = decode_alone(layout, bytes.fromhex("00010000 2a") + bytes(padding))

    assert decoded.sound.tolist() == [sound]


def test_a_cdr_string_without_its_terminator_is_unsound() -> None:
    layout = define(2, Root="string text").layout("cdr little-endian")

    good, bad = bytes.fromhex("00010000 02000000 6100"), bytes.fromhex("00010000 02000000 6162")

    assert decode_messages(layout, [good, bad, good]).sound.tolist() == [True, False, True]
