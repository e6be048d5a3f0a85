"""Options as keywords: those of the command line, by the same names."""

import inspect
import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeVar

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.storage import Location, location
from dogbot_logtool.option import as_keyword, definitions, make, options_of
from dogbot_logtool.robot.settings import check_robot_options

PathOrName = str | os.PathLike[str]
"""A file, the directory of a ROS 2 bag, or a URL."""
Function = TypeVar("Function", bound=Callable[..., Any])
Options = TypeVar("Options")
Word = TypeVar("Word", bound=PathOrName)


def takes(record: type) -> Callable[[Function], Function]:
    """Return a decorator that shows the options of a record in a function's help."""

    def document(function: Function) -> Function:
        words, options = definitions(record), options_of(record)
        lines = [f"    {each.name}: {words[each.name]}" for each in options]
        own = inspect.cleandoc(function.__doc__ or "")
        function.__doc__ = "\n".join([own, "", "Keywords:", *lines])
        signature = inspect.signature(function)
        parameters = signature.parameters.values()
        shown = [each for each in parameters if each.kind is not each.VAR_KEYWORD]
        shown += [
            inspect.Parameter(each.name, inspect.Parameter.KEYWORD_ONLY, default=each.default)
            for each in options
            if each.name not in signature.parameters
        ]
        function.__signature__ = signature.replace(parameters=shown)  # type: ignore[attr-defined]
        return function

    return document


def options_from(record: type[Options], given: Mapping[str, Any]) -> Options:
    """Make a record of options from keywords.

    Raises:
        TypeError: there is no such option.
        CallError: one is not what it must be.
    """
    made = make(record, given, as_keyword)
    check_robot_options(made)
    return made


def log_and_others(
    log: PathOrName | Iterable[PathOrName], *, join: bool
) -> tuple[Location, tuple[Location, ...]]:
    """Return the log, and further files of the same recording.

    Raises:
        CallError: several are named and not to be joined, or none is.
    """
    paths = [location(os.fspath(path)) for path in several(log)]
    if len(paths) != 1 and not (join and paths):
        raise CallError(f"one log is measured at a time, not {len(paths)}; join=True merges files")
    return paths[0], tuple(paths[1:])


def several(words: Iterable[Word] | Word) -> Iterable[Word]:
    """Return words; a text is one word, not as many as it has letters."""
    return [words] if isinstance(words, str | os.PathLike) else words
