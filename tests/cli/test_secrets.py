"""Passwords and signatures of URLs reach no output."""

import pytest

from tests.forked_cli import run
from tests.paths import ROOT

SAMPLE = str(ROOT / "sample_logs/dogbot_trot.bag")
QUERY = "?signature=SECRET&x=SECRET"
URL = f"http://user:SECRET@127.0.0.1:1/a.bag{QUERY}"


@pytest.mark.parametrize(
    "words",
    [
        ["info", URL.replace("127.0.0.1:1", "[bad")],
        ["info", f"gopher://user:SECRET@host/a.bag{QUERY}"],
        ["info", f"simplecache::{URL}"],
        ["info", f"zip://a.bag::{URL}"],
        ["stats", SAMPLE, "--robot", URL],
        ["stats", SAMPLE, "--figure", URL],
        ["stats", SAMPLE, "--scheduler", URL],
        ["stats", SAMPLE, "--scheduler", "tcp://user:SECRET@127.0.0.1:1"],
        ["compare", URL, URL],
        ["compare", SAMPLE, SAMPLE, "--tolerances", URL],
        ["compare", SAMPLE, SAMPLE, "--junit", URL],
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
