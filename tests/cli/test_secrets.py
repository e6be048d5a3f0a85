"""Passwords and signatures of URLs reach no output."""

import pytest

from dogbot_logtool.io.storage import shown, without_secrets
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


@pytest.mark.parametrize(
    ("text", "clean"),
    [
        (f"{URL}: no such file", "http://127.0.0.1:1/a.bag: no such file"),
        (f"'{URL}'; see {URL}.", "'http://127.0.0.1:1/a.bag'; see http://127.0.0.1:1/a.bag."),
        (f"({URL}), and so on", "(http://127.0.0.1:1/a.bag), and so on"),
        ("http:/a:b@c/d#e: no", "http:/c/d: no"),
        ("/a/b?c: is it? me@home", "/a/b?c: is it? me@home"),
        ("c:/a and b@c", "c:/a and b@c"),
    ],
)
def test_sentences_lose_them(text: str, clean: str) -> None:
    assert without_secrets(text) == clean


def test_a_place_that_is_no_url_can_be_shown() -> None:
    assert shown("http://u:p@[bad/x?q") == "http://[bad/x"
