"""What a package index shows of README.md has no link that leads nowhere."""

import re

import pytest

from hatch_build import long_description
from tests.paths import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
LINK = re.compile(r"\]\(([^)\s]+)\)")


@pytest.mark.parametrize("repository", ["", "https://example.org/lab/tool"])
def test_no_link_is_relative(repository: str) -> None:
    text = long_description(README, repository, "1.2.3")
    assert [link for link in LINK.findall(text) if not link.startswith("https://")] == []
    assert ("![" in text) == bool(repository)
    assert len(text) > 3000


def test_links_become_words_or_lead_into_the_repository() -> None:
    text = "![A walk](docs/walk.png)\nSee [the\nfigures](docs/metrics.md#feet), [mcap](https://mcap.dev).\n"
    assert long_description(text, "", "1.2.3") == ("See the\nfigures, [mcap](https://mcap.dev).\n")
    assert long_description(text, "https://example.org/x", "1.2.3") == (
        "![A walk](https://example.org/x/raw/v1.2.3/docs/walk.png)\n"
        "See [the\nfigures](https://example.org/x/blob/v1.2.3/docs/metrics.md#feet), "
        "[mcap](https://mcap.dev).\n"
    )
