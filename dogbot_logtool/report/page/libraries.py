"""The libraries that draw the page are an extra: the base install leaves them out."""

from importlib.util import find_spec

from dogbot_logtool.errors import LogtoolError


def require_libraries() -> None:
    """Check for the libraries that draw the page.

    Raises:
        LogtoolError: saying how to install them.
    """
    missing = [name for name in ("plotly", "jinja2") if find_spec(name) is None]
    if missing:
        raise LogtoolError(
            f"a report needs {' and '.join(missing)}, which the base install leaves out; "
            "install with: pip install 'dogbot-logtool[report]'"
        )
