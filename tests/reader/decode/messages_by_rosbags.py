"""Messages of a definition as rosbags writes and reads them, one at a time."""

from typing import Any

import numpy as np
from rosbags.serde import SerdeError

from tests.reader.decode.generated_definitions import NUMPY_NAMES, ROOT, Definition, Field, Wire


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
