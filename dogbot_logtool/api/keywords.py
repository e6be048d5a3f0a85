"""Options as keywords: those of the command line, by the same names, with the types of a record."""

import inspect
import os
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

from dogbot_logtool.core.definitions import definitions
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.storage import Location, location
from dogbot_logtool.option import as_keyword, make, options_of
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.options.info import InfoOptions
from dogbot_logtool.robot.robot import check_robot_options

PathOrName = str | os.PathLike[str]
"""A file, the directory of a ROS 2 bag, or a URL."""
Log = PathOrName | Iterable[PathOrName]
"""A log; with ``join=True``, the files of one recording."""
First = TypeVar("First")
Second = TypeVar("Second")
Keywords = ParamSpec("Keywords")
Options = TypeVar("Options")
JoinedOptions = TypeVar("JoinedOptions", MeasureOptions, ConvertOptions, InfoOptions)
Result = TypeVar("Result")


def takes(
    record: Callable[Keywords, Options],
) -> Callable[[Callable[[First, Options], Result]], Callable[Concatenate[First, Keywords], Result]]:
    """Return a decorator that gives a function keywords for the options of a record.

    A checker sees the fields of the record, and `help` their definitions. The function gets them
    as `options`. Keywords that are no options are a TypeError, wrong values a CallError.
    """
    return lambda function: _with_keywords(function, record)


def takes_with_two(
    record: Callable[Keywords, Options],
) -> Callable[
    [Callable[[First, Second, Options], Result]],
    Callable[Concatenate[First, Second, Keywords], Result],
]:
    """Return the decorator of `takes` for a function of two files."""
    return lambda function: _with_keywords(function, record)


def _with_keywords(function: Callable[..., Any], record: Any) -> Callable[..., Any]:  # noqa: ANN401 - a class
    signature, words = inspect.signature(function), definitions(record)
    own = [each for each in signature.parameters.values() if each.name != "options"]

    @wraps(function)
    def call(*args: Any, **given: Any) -> Any:  # noqa: ANN401 - checked by the record
        named = {each.name: given.pop(each.name) for each in own if each.name in given}
        options = make(record, given, as_keyword)
        check_robot_options(options)
        return function(*args, **named, options=options)

    options = options_of(record)
    lines = [f"    {each.name}: {words[each.name]}" for each in options]
    call.__doc__ = "\n".join([inspect.getdoc(function) or "", "", "Keywords:", *lines])
    kind = inspect.Parameter.KEYWORD_ONLY
    added = [inspect.Parameter(each.name, kind, default=each.default) for each in options]
    call.__signature__ = signature.replace(parameters=own + added)  # type: ignore[attr-defined]
    return call


def joined(log: Log, options: JoinedOptions) -> tuple[Location, JoinedOptions]:
    """Return the log, and options with the other files of its recording.

    Raises:
        CallError: several are named and not to be joined, or none is.
    """
    paths = several(log)
    if len(paths) != 1 and not (options.join and paths):
        raise CallError(f"one log is measured at a time, not {len(paths)}; join=True merges files")
    return paths[0], replace(options, joined=tuple(paths[1:]))


def several(words: Log) -> list[Location]:
    """Return paths; a text is one word, not as many as it has letters."""
    listed = [words] if isinstance(words, str | os.PathLike) else words
    return [location(os.fspath(each)) for each in listed]
