"""What is read of plain definitions is what rosbags' parser says; the rest is left to it."""

from typing import Any, Final

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore

from dogbot_logtool.reader.decode.plain_definition import Types, plain_types

SEPARATOR: Final = "=" * 80
TEXT: Final = f"""\
  # a comment
uint8 LEVEL=3 # not a field
Header header
pkg/Inner[] many   # some
msg/Other[12] few
float64 x
\tstring[] names
time t
{SEPARATOR}
MSG: pkg/Inner

bool yes
"""


def spelt(types: Any) -> dict[str, list[tuple[str, str]]]:
    return {
        name: [(field, words(description)) for field, description in fields]
        for name, fields in types.items()
    }


def words(description: Any) -> str:
    kind, detail = description
    if kind.name in {"ARRAY", "SEQUENCE"}:
        return f"{kind.name} {detail[1]} {words(detail[0])}"
    return f"{kind.name} {detail}"


def of_rosbags(name: str, text: str) -> dict[str, Any] | None:
    try:
        return {name: fields for name, (_, fields) in get_types_from_msg(text, name).items()}
    except (TypesysError, ValueError):
        return None


@pytest.mark.parametrize(
    ("store", "version"), [(Stores.ROS1_NOETIC, 1), (Stores.ROS2_HUMBLE, 2), (Stores.ROS2_JAZZY, 2)]
)
def test_known_types_are_read_as_by_rosbags(store: Stores, version: int) -> None:
    known, plain = get_typestore(store), 0
    for name in known.fielddefs:
        text, _ = known.generate_msgdef(name, ros_version=version)
        found: Types | None = plain_types(name, text)
        plain += found is not None
        assert found is None or spelt(found) == spelt(of_rosbags(name, text)), name
    assert plain > 0.8 * len(known.fielddefs)


def test_text_is_read_as_by_rosbags() -> None:
    found = plain_types("demo/Root", TEXT)
    assert found is not None
    assert spelt(found) == spelt(of_rosbags("demo/Root", TEXT))


@given(
    place=st.integers(0, len(TEXT)),
    removed=st.integers(0, 5),
    added=st.text("\n =[]<>/#@\"'-+_aZ09é\0\tm", max_size=6),
    name=st.sampled_from(["demo/Root", "demo/msg/Root", "demo/action/Root", "Root", "a/b/Root"]),
)
def test_damaged_text_is_left_or_read_as_by_rosbags(
    place: int, removed: int, added: str, name: str
) -> None:
    damaged = TEXT[:place] + added + TEXT[place + removed :]
    found, expected = plain_types(name, damaged), of_rosbags(name, damaged)
    assert found is None or (expected is not None and spelt(found) == spelt(expected))


@pytest.mark.parametrize("line", ["float64 x 3", "string<=5 x", "int32[<=4] x", "int32 from", "x"])
def test_what_is_not_plain_is_left(line: str) -> None:
    assert plain_types("demo/Root", line) is None
