"""What a package index shows of README.md, which cannot follow links into the repository."""

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

_PICTURE = re.compile(r"!\[([^\]]*)\]\(([^)\s]+)\)\n?")
_LINK = re.compile(r"\[([^\]]*)\]\(([^)\s]+)\)")
_WHOLE = ("http://", "https://")


def long_description(readme: str, repository: str, version: str) -> str:
    """Return a README whose links lead into a repository; without one, as plain words.

    Args:
        readme: in Markdown, with links relative to the root of the repository.
        repository: its URL, where files lie below ``blob/v<version>/`` and, as they are, below
            ``raw/v<version>/``; empty: there is none that all can reach.
        version: of the program.
    """

    def picture(found: re.Match[str]) -> str:
        words, link = found.groups()
        if link.startswith(_WHOLE):
            return found[0]
        return f"![{words}]({repository}/raw/v{version}/{link})\n" if repository else ""

    def linked(found: re.Match[str]) -> str:
        words, link = found.groups()
        if link.startswith(_WHOLE):
            return found[0]
        return f"[{words}]({repository}/blob/v{version}/{link})" if repository else words

    return _LINK.sub(linked, _PICTURE.sub(picture, readme))


class CustomMetadataHook(MetadataHookInterface):
    """Adds the long description and the project's URLs."""

    def update(self, metadata: dict[str, Any]) -> None:
        """See `MetadataHookInterface.update`."""
        repository = str(self.config.get("repository", "")).rstrip("/")
        version = str(metadata["version"])
        readme = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        text = long_description(readme, repository, version)
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
        if repository:
            metadata["urls"] = {
                "Repository": repository,
                "Documentation": f"{repository}/blob/v{version}/README.md",
                "Changelog": f"{repository}/blob/v{version}/CHANGELOG.md",
                "Issues": f"{repository}/issues",
            }
