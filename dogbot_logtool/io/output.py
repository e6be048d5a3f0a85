"""Where output goes, from the word of -o, and output that cannot be half.

A file on a disk gets its name when it is whole; until then it has none where the system allows
that, so that not even a killed process leaves anything, elsewhere a temporary one. To a store it is
uploaded as one object, which is there when the store has all of it.
"""

import contextlib
import os
import re
import stat
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, BinaryIO, Final, NamedTuple

from dogbot_logtool.errors import CallError, LogtoolError, StoreError
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location

if TYPE_CHECKING:
    from upath import UPath

_OPEN_FILES: Final = Path("/proc/self/fd")
"""The directory in which Linux names open files of a process, also those without another name."""
_KNOWN: Final = re.compile(
    r"\.(7z|active|bag|bz2|csv|db3|gif|gz|html?|jpe?g|json|lz4|mcap|parquet|pdf|png|rviz|svg|tar|tgz|"
    r"toml|txt|xml|xz|ya?ml|zip|zstd?)"
)
"""Suffixes that promise a format."""
_ALIKE: Final = {".html": (".htm",), ".pdf": (".svg", ".png", ".jpg", ".jpeg", ".gif")}
"""Suffixes beside one of ours that are as good."""


def refuse_bad_target(
    target: Location,
    inputs: Sequence[Location] = (),
    *,
    overwrite: bool,
    makes_folder: bool = False,
) -> None:
    """Check a target before any work is done.

    Args:
        target: where the output is to be.
        inputs: what is read.
        overwrite: whether a file that is there may be replaced.
        makes_folder: whether a directory that is missing is made.

    Raises:
        CallError: it is no regular file, is an input itself, exists and may not be overwritten, or
            its directory does not exist.
    """
    try:
        if isinstance(target, Path):
            there = _status_of(target) is not None
            is_input = there and any(_is_file(target, source) for source in inputs)
        else:
            is_input = target in inputs
            there = not overwrite and storage.exists(target)
        if is_input:
            what = "is the input itself; choose another output"
            raise CallError(f"{storage.name_of(target)}: {what}")
        if there and not overwrite:
            raise _exists_already(target)
        if isinstance(target, Path):
            _refuse_no_folder(target.parent, makes_folder=makes_folder)
    except OSError as error:
        raise CallError(f"{target}: cannot be written: {error.strerror}") from error


def _is_file(target: Path, source: Location) -> bool:
    return isinstance(source, Path) and source.exists() and target.samefile(source)


def _refuse_no_folder(folder: Path, *, makes_folder: bool) -> None:
    if makes_folder:
        folder = next(one for one in (folder, *folder.parents) if one.exists())
    if not folder.is_dir():
        what = "is a file, not a folder" if folder.exists() else "no such folder"
        raise CallError(f"{folder}: {what}")


def _exists_already(target: Location) -> CallError:
    what = "exists already; --overwrite replaces it, or name another"
    return CallError(f"{storage.name_of(target)}: {what}")


def _status_of(target: Path) -> os.stat_result | None:
    """Return the status of the file that a name leads to; None if there is none.

    Raises:
        CallError: there is something that is no regular file, or a link to nothing.
        OSError: this cannot be found out.
    """
    try:
        status = target.stat()
    except (FileNotFoundError, NotADirectoryError):
        if target.is_symlink():
            raise CallError(
                f"{target}: is a link to nothing; remove it, or name another output"
            ) from None
        return None
    if stat.S_ISDIR(status.st_mode):
        raise CallError(f"{target}: is a directory; name a file in it")
    if not stat.S_ISREG(status.st_mode):
        kind = storage.kind_of(status.st_mode)
        raise CallError(f"{target}: is {kind}, not a file; name another output")
    return status


@contextlib.contextmanager
def whole_file(
    target: Location,
    *,
    overwrite: bool,
    makes_folder: bool = False,
) -> Iterator[BinaryIO]:
    """Open a file that becomes the target when the block ends without an error.

    On any error or interruption nothing of it stays. A URL is uploaded while it is written. A file
    that is replaced hands on its permissions; a link stays one: what it leads to is replaced.

    Args:
        target: where the output is to be.
        overwrite: replace a file that is there.
        makes_folder: make its directory if it is missing.

    Raises:
        LogtoolError: the file cannot be written, a full disk for instance.
        CallError: the target has come to exist in the meantime and may not be overwritten.
    """
    if not isinstance(target, Path):
        with _uploaded_object(target, overwrite=overwrite) as file:
            yield file
        return
    try:
        replaced = _status_of(target) if overwrite else None
        path = target.resolve() if overwrite and target.is_symlink() else target
        parents = path.parents if makes_folder else path.parents[:1]
        folder = next(filter(Path.is_dir, parents), path.parent)
        # Known before it is there, so that an interruption in between leaves nothing.
        part = folder / f".dogbot-logtool.{os.urandom(8).hex()}.part"
        try:
            with _nameless(folder) or part.open("xb") as file:
                if replaced is not None and hasattr(os, "fchmod"):  # not on Windows
                    os.fchmod(file.fileno(), stat.S_IMODE(replaced.st_mode))
                yield file
                file.flush()
                # A power failure leaves a whole file, the one before, or none.
                os.fsync(file.fileno())
                if makes_folder:
                    path.parent.mkdir(parents=True, exist_ok=True)
                if not part.exists():
                    _give_name(file, part)
            if overwrite:
                part.replace(path)
            elif not _take_free_name(part, path):
                raise _exists_already(target)
        finally:
            with contextlib.suppress(OSError):
                part.unlink()
    except OSError as error:
        raise LogtoolError(f"{target}: cannot be written: {error.strerror or error}") from error


def _nameless(folder: Path) -> BinaryIO | None:
    flag = getattr(os, "O_TMPFILE", None)
    if flag is None or not _OPEN_FILES.is_dir():
        return None
    # Where a filesystem has no such thing, the file is named; other faults show again.
    with contextlib.suppress(OSError):
        return os.fdopen(os.open(folder, flag | os.O_WRONLY, 0o666), "wb")
    return None


def _give_name(file: BinaryIO, name: Path) -> None:
    """Give a file a name that has none yet."""
    folder = os.open(name.parent, os.O_RDONLY)
    try:
        # Only with a directory given does Python follow the link that stands for an open file.
        source = _OPEN_FILES / str(file.fileno())
        os.link(source, name.name, dst_dir_fd=folder, follow_symlinks=True)
    finally:
        os.close(folder)


def _take_free_name(name: Path, path: Path) -> bool:
    """Give a file another name; tell whether that was free."""
    try:
        os.link(name, path)
    except FileExistsError:
        return False
    except OSError:  # a filesystem without hard links
        if os.path.lexists(path):
            return False
        name.replace(path)
    return True


@contextlib.contextmanager
def _uploaded_object(target: "UPath", *, overwrite: bool) -> Iterator[BinaryIO]:
    target.fs.invalidate_cache()
    try:
        file = target.fs.open(target.path, "wb", autocommit=False)
        try:
            yield file
            file.close()
            refuse_bad_target(target, overwrite=overwrite)
            file.commit()
        except BaseException:
            _discard(file)
            raise
    except NotImplementedError as error:
        what = "this kind of store is read only"
        raise StoreError(f"{storage.name_of(target)}: cannot be written: {what}") from error
    except OSError as error:
        what = str(error) or "no reason given"
        raise StoreError(f"{storage.name_of(target)}: cannot be written: {what}") from error


def _discard(file: Any) -> None:  # noqa: ANN401 - a file of fsspec, or of one of its stores
    # A later close must not complete the upload.
    with contextlib.suppress(AttributeError):
        file.closed = True
    file.discard()


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
    if ends_in_slash(word) or (isinstance(path, Path) and storage.is_folder(path)):
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
    promised = target.suffix.lower()
    alike = (suffix, *_ALIKE.get(suffix, ()))
    if _KNOWN.fullmatch(promised) and promised not in alike:
        name = f"{target.stem.removesuffix(suffix)}{suffix}"
        raise CallError(
            f"{storage.name_of(target)}: the name ends in {promised}, but {suffix} is written; "
            f"name it {name}"
        )


def ends_in_slash(word: str) -> bool:
    """Tell whether a word says by its end that it names a directory."""
    return word.endswith(tuple({"/", os.sep}))


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
