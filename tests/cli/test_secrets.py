"""Passwords and signatures of URLs reach no output."""

import pytest

from tests.forked_cli import run
from tests.paths import TROT

QUERY = "?signature=SECRET&x=SECRET"
URL = f"http://user:SECRET@127.0.0.1:1/a.bag{QUERY}"


@pytest.mark.parametrize(
    "words",
    [
        ["info", URL.replace("127.0.0.1:1", "[bad")],
        ["info", f"gopher://user:SECRET@host/a.bag{QUERY}"],
        ["info", f"simplecache::{URL}"],
        ["info", f"zip://a.bag::{URL}"],
        ["stats", str(TROT), "--robot", URL],
        ["stats", str(TROT), "--figure", URL],
        ["stats", str(TROT), "--scheduler", URL],
        ["stats", str(TROT), "--scheduler", "tcp://user:SECRET@127.0.0.1:1"],
        ["compare", URL, URL],
        ["compare", str(TROT), str(TROT), "--tolerances", URL],
        ["compare", str(TROT), str(TROT), "--junit", URL],
        ["layout", "-o", URL],
        ["robots", URL],
    ],
    ids=" ".join,
)
def test_no_error_shows_them(words: list[str]) -> None:
    done = run(*words)
    assert done.returncode in {1, 2}
    assert done.stderr.startswith(("error: ", "Usage: "))
    assert "SECRET" not in done.stdout + done.stderr
    assert "Traceback" not in done.stderr
