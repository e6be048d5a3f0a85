"""The registry of viewers for which `layout` sets up a view."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.io.plain_json import to_json

if TYPE_CHECKING:
    from dogbot_logtool.report.layouts.view import View

DEFAULT_VIEWER: Final = "foxglove"


@dataclass(frozen=True, slots=True)
class Viewer:
    """One viewer."""

    name: str
    summary: str
    suffix: str
    """Suffix of its files."""
    layout: Callable[["View"], bytes]
    """Returns the content of its file."""


def _foxglove(view: "View") -> bytes:
    from dogbot_logtool.report.layouts.foxglove import foxglove_layout  # noqa: PLC0415

    return _json(foxglove_layout(view))


def _rviz(view: "View") -> bytes:
    from dogbot_logtool.report.layouts.rviz import rviz_config  # noqa: PLC0415

    # JSON is YAML, too.
    return _json(rviz_config(view))


def _json(layout: dict[str, Any]) -> bytes:
    return (to_json(layout, indent=2) + "\n").encode()


_VIEWERS: Final = (
    Viewer("foxglove", "Foxglove and Lichtblick", ".json", _foxglove),
    Viewer("rviz", "RViz, for logs converted with --encoding ros1", ".rviz", _rviz),
)
VIEWERS: Final[Mapping[str, Viewer]] = {each.name: each for each in _VIEWERS}
"""By name, in the order of ``--help``."""
