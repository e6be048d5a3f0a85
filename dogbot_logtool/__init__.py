"""See and measure a legged robot's footfalls from a recorded log.

    import dogbot_logtool as dl

    walk = dl.measure("walk.bag", robot="dogbot")
    walk.gait.name
    walk.strides["duty_factor"]
    dl.convert("walk.bag", "walk.mcap")

Names are loaded when they are used, so that the import costs next to nothing.
"""

TYPE_CHECKING = False  # as checkers know it; `typing` takes longer than all the rest of this
if TYPE_CHECKING:
    from typing import Final

    from dogbot_logtool.api.functions import (
        check,
        compare,
        compare_gait,
        convert,
        info,
        measure,
        read,
    )
    from dogbot_logtool.api.recording import Recording
    from dogbot_logtool.api.table import Table
    from dogbot_logtool.api.walk import Walk
    from dogbot_logtool.errors import CallError, LogError, LogtoolError

__version__ = "0.3.0"
__all__ = [
    "CallError",
    "LogError",
    "LogtoolError",
    "Recording",
    "Table",
    "Walk",
    "check",
    "compare",
    "compare_gait",
    "convert",
    "info",
    "measure",
    "read",
]
_MODULES: "Final" = {
    "CallError": "errors",
    "LogError": "errors",
    "LogtoolError": "errors",
    "Recording": "api.recording",
    "Table": "api.table",
    "Walk": "api.walk",
}
"""Modules of the public names that are no functions, below this package."""


if not TYPE_CHECKING:  # else a checker would take every name for one of ours

    def __getattr__(name: str) -> object:
        """Load a public name."""
        from importlib import import_module  # noqa: PLC0415

        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        module = _MODULES.get(name, "api.functions")
        return getattr(import_module(f"{__name__}.{module}"), name)


def __dir__() -> list[str]:
    """List the public names only."""
    return [*__all__, "__version__"]
