"""Packages that tables and curves are handed to, where they are installed."""

from collections.abc import Callable
from importlib import import_module
from typing import Any, TypeVar

from dogbot_logtool.errors import LogtoolError

Result = TypeVar("Result")


def with_package(package: str, make: Callable[[Any], Result]) -> Result:
    """Call a function with a package that may not be installed.

    Raises:
        LogtoolError: it is not installed.
    """
    try:
        module = import_module(package)
    except ImportError as error:
        raise LogtoolError(
            f"{package} is not installed; 'pip install {package}' into the environment of this "
            "Python installs it"
        ) from error
    return make(module)
