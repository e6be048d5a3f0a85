"""Options and choices of the last version that are gone, and what to use instead."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

import click

_GONE: Final[Mapping[tuple[str, str], str]] = MappingProxyType(
    {
        ("compare", "--update"): "copy ACTUAL over EXPECTED",
        ("convert", "--events"): "events are always written",
        ("convert", "--labels"): "labels are always written",
        ("convert", "--no-events"): "events are always written",
        ("convert", "--no-labels"): "labels are always written; hide their topics in the viewer",
        ("convert", "--no-scene"): "/support is always written; hide it in the viewer",
        ("convert", "--scene"): "/support is always written",
        ("convert", "--strict"): "exit code 3 says that a log is damaged",
        ("info", "--dot"): "use `info --frames --json`, which has the tree",
        ("info", "-o"): "results go to stdout",
        ("info", "--output"): "results go to stdout",
        ("info", "--overwrite"): "results go to stdout",
        ("stats", "--csv"): "use `export --table strides`",
        ("stats", "--events"): "use `export --table events -o FILE`",
        ("stats", "--label"): "use `export --dataset DIR --label NAME=VALUE`",
        ("stats", "--parquet"): "use `export --dataset DIR`",
        ("stats", "--plot"): "it is --figure now",
        ("stats", "--plot-size"): "scale the .pdf or .svg, which are 85 mm wide",
        ("stats", "--prune"): "use `export --dataset DIR --prune`",
        ("stats", "--window"): "use --start and --end",
    }
)
"""What to do instead, by command and option."""
_CHOICES_GONE: Final[Mapping[tuple[str, str], str]] = MappingProxyType(
    {("viewer", "rerun"): "Rerun opens the MCAP that `convert` writes"}
)
"""What to do instead, by option and choice."""


def explained(error: click.ClickException) -> click.ClickException:
    """Return an error that says what to use instead, if an option is gone; else the same error."""
    if isinstance(error, click.NoSuchOption) and error.ctx is not None:
        instead = _GONE.get((error.ctx.info_name or "", error.option_name))
        if instead is not None:
            return click.UsageError(f"{error.option_name} is gone: {instead}.", error.ctx)
    if isinstance(error, click.BadParameter) and error.param is not None:
        for (option, choice), instead in _CHOICES_GONE.items():
            if error.param.name == option and error.message.startswith(repr(choice)):
                what = f"--{option} {choice} is gone: {instead}."
                return click.UsageError(what, error.ctx)
    return error
