"""Loads as messages."""

from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.writer.annotations import (
    AnnotationColumns,
)
from dogbot_logtool.writer.encodings.encoding import Encoding
from tests.writer.annotated import ENCODINGS, declared, loads, messages_of, no_transforms


@pytest.mark.parametrize("encoding", ENCODINGS, ids=lambda one: type(one).__name__)
def test_loads_say_their_state(encoding: Encoding) -> None:
    annotations = declared(encoding, with_tf=False)
    states = replace(loads([0, 0, 0], [1, 2, 3]), state=np.array([0, 1, 2]))
    found = messages_of(annotations, AnnotationColumns(no_transforms(), [], [states]))
    for (_, message), state in zip(found, ("stance", "swing", "unknown"), strict=True):
        assert state.encode() in message.data
