"""Options of the last version that are gone, and what to use instead."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

_EVERYWHERE: Final[Mapping[str, str]] = MappingProxyType(
    {
        "--tare": "use --set tare.FOOT=FX,FY,FZ, or --set tare=none",
        "--wrench-frame": "use --set wrench_frame=world or link",
        "--forward-axis": "use --set forward_axis=+y",
        "--contact-on": "use --set contact_on_n=N",
        "--contact-off": "use --set contact_off_n=N",
        "--debounce": "use --set debounce_s=S",
        "--time-source": "use --set clock=header or log",
        "--command": "use --set command_topic=TOPIC",
        "--imu": "use --set imu_topic=TOPIC",
        "--without": "use --topics '!GLOB'",
        "--labels": "labels are always written",
        "--no-labels": "labels are always written; hide their topics in the viewer",
        "--no-events": "events are always written",
        "--scene": "/support is always written",
        "--no-scene": "/support is always written; hide it in the viewer",
        "--strict": "exit code 3 says that a log is damaged",
        "--update": "copy ACTUAL over EXPECTED",
        "--dot": "use `info --frames --json`, which has the tree",
        "--csv": "use `export --table strides`",
        "--parquet": "use `export --dataset DIR`",
        "--plot": "it is --figure now",
        "--plot-size": "scale the .pdf or .svg, which are 85 mm wide",
        "--window": "use --start and --end",
    }
)
"""What to do instead, whichever command it was of."""
_OF_COMMANDS: Final[Mapping[tuple[str, str], str]] = MappingProxyType(
    {
        ("convert", "--events"): "events are always written",
        ("stats", "--events"): "use `export --table events -o FILE`",
        ("stats", "--label"): "use `export --dataset DIR --label NAME=VALUE`",
        ("stats", "--prune"): "use `export --dataset DIR --prune`",
        ("info", "-o"): "results go to stdout",
        ("info", "--output"): "results go to stdout",
        ("info", "--overwrite"): "results go to stdout",
    }
)


def instead_of(option: str, command: str = "") -> str | None:
    """Return what to use instead of an option that is gone; None: it never was there."""
    return _OF_COMMANDS.get((command, option), _EVERYWHERE.get(option))
