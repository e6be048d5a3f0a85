"""The columnar decoder equals rosbags' message-by-message one, on generated definitions too."""

from collections.abc import Iterator, Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.reader.decode.columns import Table, Texts
from tests.reader.decode.oracle import (
    WIRES,
    Author,
    Wire,
    assert_same,
    decode_alone,
    decode_messages,
    define,
    definitions,
    dotted_paths,
    generated,
    ros_of,
    texts_of,
)


@pytest.mark.parametrize("wire", WIRES)
@generated
@given(data=st.data(), seed=st.integers(0, 2**32), count=st.integers(0, 6))
def test_every_field_of_every_message_equals_what_rosbags_reads(
    wire: Wire, data: st.DataObject, seed: int, count: int
) -> None:
    definition = data.draw(definitions(ros_of(wire)))
    author = Author(definition, wire, seed)
    messages = author.write(count)

    decoded = decode_messages(definition.layout(wire), messages, seed)

    assert decoded.sound.all()
    assert decoded.table.rows == count
    assert_same(definition, decoded.table, [author.read(one) for one in messages])


@pytest.mark.parametrize("wire", WIRES)
@generated
@given(data=st.data(), seed=st.integers(0, 2**32))
def test_wanted_fields_are_the_same_columns_as_in_a_full_decode(
    wire: Wire, data: st.DataObject, seed: int
) -> None:
    definition = data.draw(definitions(ros_of(wire)))
    paths = sorted(set(dotted_paths(definition)))
    wanted = data.draw(st.lists(st.sampled_from(paths), unique=True)) if paths else []
    messages = Author(definition, wire, seed).write(3)

    part = decode_messages(definition.layout(wire, wanted), messages, seed)
    full = decode_messages(definition.layout(wire), messages, seed)

    assert part.sound.all()
    assert dict(flat(part.table)) == {
        path: column for path, column in flat(full.table) if is_wanted(path, wanted)
    }


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
    name = path.removesuffix("[]")
    is_below = any(f"{name}.".startswith(f"{want}.") for want in wanted)
    is_above = any(f"{want}.".startswith(f"{name}.") for want in wanted)
    return is_below or (is_above and path != name)


def test_a_ros1_byte_is_signed_and_a_char_is_not() -> None:
    definition = define(1, "byte b\nchar c\nbyte[2] more")

    table = decode_alone(definition.layout("ros1"), b"\xff\xff\xfe\x01").table

    assert table.numbers("c").tolist() == [255]
    assert table.numbers("b").tolist() == [-1]
    assert table.numbers("more").tolist() == [[-2, 1]]


def test_an_empty_message_takes_one_byte_in_cdr_even_if_its_recorded_text_is_empty() -> None:
    # rosbag2 records the .msg file, which is empty; the padding byte is in the IDL only.
    definition = define(2, "Empty nothing\nuint32 number", Empty="")
    data = bytes.fromhex("00010000 00 000000 2a000000")

    decoded = decode_alone(definition.layout("cdr little-endian"), data)

    assert decoded.sound.all()
    assert decoded.table.numbers("number").tolist() == [42]


def test_text_that_is_not_utf_8_is_replaced() -> None:
    definition = define(1, "string text")

    table = decode_alone(definition.layout("ros1"), b"\x03\0\0\0a\xffb").table

    assert table.texts("text").text(0) == "a�b"


# Columns of texts, against a plain list of strings


FEW = st.lists(st.text("ab/", max_size=3), max_size=40)
FRAMES = st.integers(0, 400).map(lambda number: "" if number == 7 else f"frame_{number}")
MANY = st.lists(FRAMES, min_size=300, max_size=600)


@settings(deadline=None)
@given(FEW | MANY)
def test_different_texts_are_numbered(values: list[str]) -> None:
    code, names = texts_of(values).encode()
    assert [names[each] for each in code.tolist()] == values
    assert list(names) == list(dict.fromkeys(values))
