"""One HTML page a log, which draws itself wherever it is opened."""

from importlib.util import find_spec

from dogbot_logtool.errors import ExtraMissingError


def require_libraries() -> None:
    """Check for the library that fills the page's templates: the base install leaves it out.

    Raises:
        ExtraMissingError: it is not there.
    """
    if find_spec("jinja2") is None:
        raise ExtraMissingError("report", "report")
