"""Output paths of logs, from the word of -o."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Final

from dogbot_logtool.errors import CallError
from dogbot_logtool.io import storage
from dogbot_logtool.io.output import refuse_bad_target
from dogbot_logtool.io.storage import Location

_SUFFIXES: Final = {
    "a ROS 1 bag": ".bag .active",
    "a file of a ROS 2 bag": ".db3",
    "an MCAP": ".mcap",
    "an HTML page": ".html .htm",
    "JSON": ".json",
    "a table": ".csv .parquet",
    "XML": ".xml",
    "TOML": ".toml",
    "YAML": ".yaml .yml",
    "a view for RViz": ".rviz",
    "a text": ".txt",
    "a picture": ".pdf .svg .png .jpg .jpeg .gif",
    "a compressed file": ".zstd .zst .lz4 .gz .bz2 .xz",
    "an archive": ".zip .tar .tgz .7z",
}
_FORMATS: Final = {suffix: what for what, each in _SUFFIXES.items() for suffix in each.split()}
"""Formats by well-known suffixes."""


@dataclass(frozen=True, slots=True)
class Output:
    """The file or directory for results."""

    path: Location
    is_folder: bool
    """It is a directory, which is made if it is missing; else a file."""


def output_at(word: str | None, ending: str, *, several: bool) -> Output:
    """Return what the word of -o means: a directory, or the file of one log.

    A word that ends in a slash is a directory, and so is one that names one. Where there may be
    several logs, every other word is one too unless its suffix is that of the results; a URL is
    always read so.

    Args:
        word: as given; None: the current directory.
        ending: that results have, such as ``.report.html``.
        several: see `may_be_several`.

    Raises:
        CallError: the word promises something that the results are not.
        ExtraMissingError: it is a URL, and what reads URLs is not installed.
    """
    if word is None:
        return Output(Path(), is_folder=True)
    refuse_no_name(word)
    path = storage.location(word)
    if ends_in_slash(word) or _is_folder(path):
        return Output(path, is_folder=True)
    suffix = "." + ending.rpartition(".")[2]
    refuse_other_format(path, suffix)
    is_file = path.suffix == suffix or (not several and isinstance(path, Path))
    return Output(path, is_folder=not is_file)


def may_be_several(words: Sequence[str], logs: Sequence[Location]) -> bool:
    """Tell whether words may name several logs: all but one that names the one log itself.

    The contents of a directory, a glob or a list may change; results go to the same path still.
    """
    if len(words) > 1 or len(logs) > 1:
        return True
    named, found = storage.location(words[0]), logs[0]
    return storage.from_root(named) != storage.from_root(found)


def output_file(
    word: str | None, suffix: str, inputs: Sequence[Location] = (), *, overwrite: bool
) -> Path | None:
    """Return the file that -o names; None: none, which is stdout.

    Raises:
        CallError: the word names no file, promises another format than that of a suffix, or the
            file may not be written; see `refuse_bad_target`.
    """
    if word is None:
        return None
    refuse_no_name(word)
    if ends_in_slash(word):
        raise CallError(f"{word}: is a directory's name; name a file in it")
    refuse_other_format(Path(word), suffix)
    refuse_bad_target(Path(word), inputs, overwrite=overwrite)
    return Path(word)


def refuse_no_name(word: str) -> None:
    """Refuse what names no output: nothing, and the usual name of stdout.

    Raises:
        CallError: it is one of them.
    """
    if not word:
        raise CallError("an empty name names no output; is a variable of the shell empty?")
    if word == "-":
        raise CallError("-: does not stand for stdout here; name a file")


def refuse_other_format(target: Location, suffix: str) -> None:
    """Refuse a name whose suffix promises another format.

    Args:
        target: the name.
        suffix: a usual one of what is written.

    Raises:
        CallError: it does.
    """
    promised, written = _FORMATS.get(target.suffix.lower()), _FORMATS[suffix]
    if promised not in {None, written}:
        name = f"{target.stem.removesuffix(suffix)}{suffix}"
        raise CallError(
            f"{storage.name_of(target)}: the name is that of {promised}, but {written} is written; "
            f"name it {name}"
        )


def ends_in_slash(word: str) -> bool:
    """Tell whether a word says by its end that it names a directory."""
    return word.endswith(tuple({"/", os.sep}))


def _is_folder(path: Location) -> bool:
    try:
        return isinstance(path, Path) and path.is_dir()
    except OSError:
        # A name that no disk takes; opening it tells.
        return False


def targets(
    logs: Sequence[Location], output: Output, ending: str, below: Sequence[PurePath] = ()
) -> list[tuple[Location, Location]]:
    """Return the output of every log.

    Args:
        logs: the inputs.
        output: where outputs go.
        ending: of the name in a directory, after that of the log.
        below: the directory of each output below that one; none: there.

    Raises:
        CallError: several logs would go to one file.
    """
    if not output.is_folder:
        if len(logs) > 1:
            raise CallError(
                f"{storage.name_of(output.path)}: is a file's name, and there are {len(logs)} "
                f"logs; name a directory, such as {output.path.with_suffix('').name}/"
            )
        return [(logs[0], output.path)]
    folders = below or [PurePath()] * len(logs)
    pairs = [
        (log, _below(output.path, folder) / f"{storage.file_stem(log)}{ending}")
        for log, folder in zip(logs, folders, strict=True)
    ]
    taken: set[Location] = set()
    for log, target in pairs:
        if target in taken:
            raise CallError(
                f"{storage.name_of(log)}: another log has the same name, so both would go to "
                f"{storage.name_of(target)}"
            )
        taken.add(target)
    return pairs


def _below(folder: Location, below: PurePath) -> Location:
    # A store takes a dot for a name.
    return folder / below if below.parts else folder
