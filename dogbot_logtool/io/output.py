"""Where output goes, from the word of -o, and output that cannot be half.

A file on a disk gets its name when it is whole; until then it has none where the system allows
that, so that not even a killed process leaves anything, elsewhere a temporary one. To a store it is
uploaded as one object, which is there when the store has all of it.
"""

import contextlib
import os
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

from dogbot_logtool.errors import CallError, LogtoolError
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location

if TYPE_CHECKING:
    from upath import UPath


def refuse_bad_target(
    target: Location,
    inputs: Sequence[Location] = (),
    *,
    overwrite: bool,
) -> None:
    """Check a target before any work is done, and once more before it gets its name.

    Args:
        target: where the output is to be.
        inputs: what is read.
        overwrite: whether a file that is there may be replaced.

    Raises:
        CallError: it is no regular file, is an input itself, exists and may not be overwritten, or
            lies in what is no directory.
    """
    try:
        if isinstance(target, Path):
            folder = next(filter(Path.exists, target.parents), target)
            if folder.is_file():
                raise CallError(f"{folder}: is a file, not a folder")
            is_there = os.path.lexists(target)
            if is_there:
                storage.refuse_special(target)
            is_input = is_there and any(_is_file(target, source) for source in inputs)
        else:
            is_input = target in inputs
            is_there = not overwrite and storage.exists(target)
    except OSError as error:
        raise CallError(f"{target}: cannot be written: {error.strerror}") from error
    name = storage.name_of(target)
    if is_input:
        raise CallError(f"{name}: is the input itself; choose another output")
    if is_there and not overwrite:
        raise CallError(f"{name}: exists already; --overwrite replaces it, or name another")


def _is_file(target: Path, source: Location) -> bool:
    return isinstance(source, Path) and source.exists() and target.samefile(source)


@contextlib.contextmanager
def whole_file(target: Location, *, overwrite: bool) -> Iterator[BinaryIO]:
    """Open a file that becomes the target when the block ends without an error.

    On any error or interruption nothing of it stays. A URL is uploaded while it is written. A
    directory that is missing is made; a link stays one: what it leads to is replaced.

    Args:
        target: where the output is to be.
        overwrite: replace a file that is there.

    Raises:
        LogtoolError: the file cannot be written, a full disk for instance.
        CallError: the target has come to exist in the meantime and may not be overwritten.
    """
    opened = (
        _file_on_disk(target, overwrite=overwrite)
        if isinstance(target, Path)
        else _uploaded_object(target, overwrite=overwrite)
    )
    try:
        with opened as file:
            yield file
    except (NotImplementedError, OSError) as error:
        why = getattr(error, "strerror", None) or str(error) or "the store takes no files"
        raise LogtoolError(f"{storage.name_of(target)}: cannot be written: {why}") from error


@contextlib.contextmanager
def _file_on_disk(target: Path, *, overwrite: bool) -> Iterator[BinaryIO]:
    path = target.resolve()
    folder = next(filter(Path.is_dir, path.parents))
    # Known before it is there, so that an interruption in between leaves nothing.
    part = folder / f".dogbot-logtool.{os.urandom(8).hex()}.part"
    try:
        with _nameless(folder) or part.open("xb") as file:
            yield file
            file.flush()
            # A power failure leaves a whole file, the one before, or none.
            os.fsync(file.fileno())
            refuse_bad_target(target, overwrite=overwrite)
            path.parent.mkdir(parents=True, exist_ok=True)
            if not part.exists():
                # Only with a descriptor does Python follow the link that stands for an open file.
                number, name = file.fileno(), part if overwrite else path
                os.link(f"/proc/self/fd/{number}", name, src_dir_fd=number, follow_symlinks=True)
        if part.exists():
            part.replace(path)
    finally:
        with contextlib.suppress(OSError):
            part.unlink()


def _nameless(folder: Path) -> BinaryIO | None:
    # Where a system or a filesystem has no such thing, the file is named; other faults show again.
    with contextlib.suppress(AttributeError, OSError):
        return os.fdopen(os.open(folder, os.O_TMPFILE | os.O_WRONLY, 0o666), "wb")
    return None


@contextlib.contextmanager
def _uploaded_object(target: "UPath", *, overwrite: bool) -> Iterator[BinaryIO]:
    target.fs.invalidate_cache()
    file: Any = target.fs.open(target.path, "wb", autocommit=False)
    try:
        yield file
        file.close()
        refuse_bad_target(target, overwrite=overwrite)
        file.commit()
    except BaseException:
        # A later close must not complete the upload.
        with contextlib.suppress(AttributeError):
            file.closed = True
        file.discard()
        raise


class Output(NamedTuple):
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
        ending: that results have, such as ``.report.html``; empty: any.
        several: see `may_be_several`.

    Raises:
        CallError: the word promises something that the results are not.
        ExtraMissingError: it is a URL, and what reads URLs is not installed.
    """
    if word is None:
        return Output(Path(), is_folder=True)
    if not word:
        raise CallError("an empty name names no output; is a variable of the shell empty?")
    if word == "-":
        raise CallError("-: does not stand for stdout here; name a file")
    path = storage.location(word)
    is_on_disk = isinstance(path, Path)
    if word.endswith(("/", os.sep)) or (is_on_disk and storage.is_folder(path)):
        return Output(path, is_folder=True)
    is_named_so = ending != "" and path.suffix == Path(ending).suffix
    if not is_named_so and (several or not is_on_disk):
        return Output(path, is_folder=True)
    if is_on_disk and not path.parent.exists():
        raise CallError(f"{path.parent}: no such folder")
    return Output(path, is_folder=False)


def may_be_several(words: Sequence[str], logs: Sequence[Location]) -> bool:
    """Tell whether words may name several logs: all but one that names the one log itself.

    The contents of a directory, a glob or a list may change; results go to the same path still.
    """
    is_one = len(words) == len(logs) == 1
    return not is_one or storage.location(words[0]).absolute() != logs[0].absolute()


def output_file(
    word: str | None, inputs: Sequence[Location] = (), *, overwrite: bool
) -> Path | None:
    """Return the file that -o names; None: none, which is stdout.

    Args:
        word: as given.
        inputs: what is read.
        overwrite: whether a file that is there may be replaced.

    Raises:
        CallError: the word names no file, or the file may not be written; see `refuse_bad_target`.
    """
    if word is None:
        return None
    path, is_folder = output_at(word, "", several=False)
    if is_folder or not isinstance(path, Path):
        raise CallError(f"{word}: is a directory's name, or a URL; name a file of this disk")
    refuse_bad_target(path, inputs, overwrite=overwrite)
    return path


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
        # A store takes the dot of an empty path for a name.
        (log, output.path.joinpath(*folder.parts, f"{storage.file_stem(log)}{ending}"))
        for log, folder in zip(logs, folders, strict=True)
    ]
    for target, count in Counter(target for _, target in pairs).items():
        if count > 1:
            what = f"{count} logs of one name would go there"
            raise CallError(f"{storage.name_of(target)}: {what}; call it for each")
    return pairs
