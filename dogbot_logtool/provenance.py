"""How a file tells what `convert` added to it: a metadata record, and a mark on each channel."""

from collections.abc import Mapping
from typing import Final

PROVENANCE: Final = "dogbot_logtool"
"""Name of the metadata record that tells how the file was made."""
ANNOTATION_MARK: Final = {"dogbot_logtool": "annotation"}
"""Metadata of the channels that were added. Other tools renumber channels, but keep this."""


def is_marked(metadata: Mapping[str, str]) -> bool:
    """Tell whether a channel with such metadata is an annotation."""
    return ANNOTATION_MARK.items() <= metadata.items()
