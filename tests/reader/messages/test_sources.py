"""What all sources of messages have in common."""

import pickle

import pytest

from dogbot_logtool.reader.messages.bases.registry import BASE_SOURCES
from dogbot_logtool.reader.messages.bases.source import BaseSource
from dogbot_logtool.reader.messages.contacts.registry import SOURCES
from dogbot_logtool.reader.messages.contacts.source import ContactSource


@pytest.mark.parametrize("name", [*BASE_SOURCES, *SOURCES])
def test_a_source_can_be_sent_to_another_process(name: str) -> None:
    sources: list[BaseSource | ContactSource] = [*BASE_SOURCES.get(name, ())]
    sources += [SOURCES[name]] if name in SOURCES else []
    for source in sources:
        sent = pickle.loads(pickle.dumps(source))  # noqa: S301 - our own bytes
        assert sent.type_name == source.type_name
