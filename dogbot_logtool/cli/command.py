"""click's commands, made of the records of options."""

import os
from collections.abc import Callable
from importlib import import_module
from typing import Any, Final

import click

from dogbot_logtool.core.definitions import definitions
from dogbot_logtool.option import Option, make, options_of
from dogbot_logtool.options import (
    ClusterOptions,
    CommonOptions,
    JobOptions,
    JoinOptions,
    QuietOptions,
    RobotOptions,
    SpanOptions,
)

_GROUPS: Final = {
    "Robot": (RobotOptions,),
    "Log": (JoinOptions, SpanOptions),
    "Common": (CommonOptions, QuietOptions, JobOptions, ClusterOptions),
}
"""Parts of a command's help, and the records whose options stand there; all others are its own."""
_FILES: Final = {"logs", "log", "expected", "actual", "against", "output", "robot", "words"}
"""Options and arguments that shells complete as files, beside paths."""


class GroupedOption(click.Option):
    """An option of a record; its help is read from the source when it is shown."""

    def __init__(self, option: Option, record: type) -> None:
        names = [option.words, option.name, *([option.how.short] if option.how.short else [])]
        is_flag = option.kind == "flag"
        if option.default is True:
            names[0] = f"{option.words}/--no-{option.words[2:]}"
        super().__init__(
            names,
            default=None,
            is_flag=is_flag,
            multiple=option.kind in {"texts", "pairs"},
            metavar=None if is_flag else option.how.metavar or None,
            type=None if is_flag else _type_of(option),
        )
        self.option: Final = option
        self.record: Final = record

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        """See `click.Option`."""
        text = definitions(self.record)[self.option.name]
        default = self.option.default
        if default not in (None, (), False, True) and self.option.name != "jobs":
            shown = f"{default:g}" if isinstance(default, float) else default
            text = f"{text}  [default: {shown}]"
        self.help = text
        return super().get_help_record(ctx)


class GroupedCommand(click.Command):
    """A command whose options are shown in groups."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """See `click.Command`."""
        groups: dict[str, list[tuple[str, str]]] = {title: [] for title in ("Options", *_GROUPS)}
        for param in self.get_params(ctx):
            row = param.get_help_record(ctx)
            if row is not None and isinstance(param, click.Option):
                owner = param.option.owner if isinstance(param, GroupedOption) else CommonOptions
                titles = (title for title, records in _GROUPS.items() if owner in records)
                groups[next(titles, "Options")].append(row)
        for title, rows in groups.items():
            if rows:
                with formatter.section(title):
                    formatter.write_dl(rows)


def _type_of(option: Option) -> "click.ParamType[Any]":
    """Return click's type, for completion; what a value may be is checked by the record."""
    if option.kind == "choice":
        return click.Choice(option.choices)
    return click.Path() if option.kind == "path" or option.name in _FILES else click.STRING


def command(record: type) -> click.Command:
    """Return the command of a record; it calls `run` of its module, which is loaded then."""
    options = options_of(record)
    params: list[click.Parameter] = [
        _argument(each) if each.how.is_argument else GroupedOption(each, record)
        for each in sorted(options, key=lambda each: each.owner is not record)
    ]
    text = record.__doc__ or ""
    return GroupedCommand(
        record.__name__.lower(),
        params=params,
        help=text.replace("    Examples:", "    \b\n    Examples:"),
        short_help=text.partition("\n")[0],
        callback=_callback(record),
    )


def _argument(option: Option) -> click.Argument:
    return click.Argument(
        [option.name],
        nargs=-1 if option.kind == "texts" else 1,
        required=option.how.is_required,
        metavar=option.how.metavar,
        type=_type_of(option),
    )


def _callback(record: type) -> Callable[..., None]:
    def call(**values: Any) -> None:  # noqa: ANN401 - click's words
        given = {name: value for name, value in values.items() if value not in (None, ())}
        if "jobs" in values:
            given.setdefault("jobs", _cores())
        module = import_module(f"dogbot_logtool.cli.{record.__name__.lower()}")
        module.run(make(record, given, as_words))

    return call


def as_words(name: str, value: object) -> str:
    """Write an option as on the command line; see `make`."""
    return f"--{name.replace('_', '-')} {value}"


def _cores() -> int:
    """Return how much is done at once unless --jobs says otherwise."""
    affinity = getattr(os, "sched_getaffinity", None)
    return min(len(affinity(0)) if affinity else os.cpu_count() or 1, 256)
