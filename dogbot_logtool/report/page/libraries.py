"""The libraries that draw the page are an extra: the base install leaves them out."""

from importlib.util import find_spec

from dogbot_logtool.errors import ExtraMissingError


def require_libraries() -> None:
    """Check for the libraries that draw the page.

    Raises:
        ExtraMissingError: one is not there.
    """
    if any(find_spec(name) is None for name in ("plotly", "jinja2")):
        raise ExtraMissingError("report", "report")
