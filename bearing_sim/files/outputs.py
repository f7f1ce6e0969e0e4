# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The one way in which files are written: a draft beside the target, which takes the target's name when it is complete and on the disk.

A failed or interrupted write leaves the old file as it was, and no draft.  `Output` is a file that a user names: it never replaces an input of
the same command, nor anything but a regular file, and an existing file only by force.  `replaced` is for files that the program owns.
"""

import errno
import hashlib
import os
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: the package can be imported and computes, but writes no files
    fcntl = None

FORCE = "--force"
"""Option that allows an output to replace an existing file."""
_LONGEST_NAME = 200  # [byte] of a file whose draft has the same name with a prefix and a suffix; file systems allow 255

_CHOSEN_BY_SUFFIX = (".png", ".svg", ".pdf")  # Formats that matplotlib chooses by the name; other drafts are taken for no file of their kind.


class RefusedOutput(OSError):
    """An output that must not be written where it was asked for; the message says why and what to do.  Nothing was changed."""


class BeingWritten(RefusedOutput):
    """An output that another process is writing."""


class Output:
    """A file to be written that a user has named.

    Parameters
    ----------
    path : of the file.  A symbolic link to a file stands for that file.
    force : whether an existing file may be replaced.
    inputs : files and folders that the same command reads: none of them, and no file in such a folder, is ever replaced.

    Attributes
    ----------
    path, force, inputs : as given.
    """

    def __init__(self, path: str | Path, force: bool = False, inputs: Iterable[str | Path] = ()):
        self.path, self.force, self.inputs = Path(path), force, tuple(Path(each) for each in inputs)

    def __str__(self) -> str:
        return str(self.path)

    def check(self) -> None:
        """Raise `RefusedOutput` if the file must not be written; to be called before the work begins."""
        checked(self.path, self.force, self.inputs)

    @contextmanager
    def draft(self) -> Iterator[Path]:
        """Yield the path of an empty draft in the same folder; what is in it at the end takes the place of the file.

        The draft of a picture has the suffix of the file.  It is removed if an exception, such as KeyboardInterrupt, leaves the block.

        Raises
        ------
        RefusedOutput
            The file must not be written, at the beginning or any more at the end.
        OSError
            It cannot be written, such as on a full disk.
        """
        target = checked(self.path, self.force, self.inputs)
        with _draft(target) as draft:
            yield draft
            _keep_owner(draft, target)
            synchronise(draft)
            checked(self.path, self.force, self.inputs)
            _give_name(draft, target, self.force)

    def write_bytes(self, data: bytes) -> None:
        """Write the whole file; errors as of `draft`."""
        with self.draft() as draft:
            draft.write_bytes(data)

    def write_text(self, text: str) -> None:
        """Write the whole file in UTF-8; errors as of `draft`."""
        self.write_bytes(text.encode())


@contextmanager
def replaced(path: str | Path) -> Iterator[Path]:
    """Yield the path of an empty draft of a file that the program owns; what is in it at the end replaces the file.

    Raises
    ------
    OSError
        It cannot be written; the file is as it was.
    """
    target = Path(path)
    with _draft(target) as draft:
        yield draft
        synchronise(draft)
        _give_name(draft, target, force=True)


_files_read: ContextVar[dict[tuple[int, int], Path] | None] = ContextVar("files read by the running command", default=None)


@contextmanager
def protecting_inputs() -> Iterator[None]:
    """Remember within the block which files are read (see `remember_input`), so that no `Output` replaces them.

    The block protects what its own thread reads, and threads to which it hands a copy of its context.
    """
    before = _files_read.set({})
    try:
        yield
    finally:
        _files_read.reset(before)


def remember_input(path: str | Path) -> None:
    """Note that the running command reads a file; called by whatever opens a file that a user has named, also indirectly as in a scene."""
    files_read = _files_read.get()
    if files_read is not None:
        with suppress(OSError):
            found = os.stat(path)
            files_read[found.st_dev, found.st_ino] = Path(path)


def checked(path: Path, force: bool = False, inputs: Iterable[Path] = ()) -> Path:
    """Return the path of the file that an output would write, with symbolic links followed.

    Raises
    ------
    RefusedOutput
        It must not be written: see `Output`.
    """
    try:
        found = os.stat(path)
    except FileNotFoundError:
        if path.is_symlink():
            raise RefusedOutput(f"{path} is a link to {os.readlink(path)}, which does not exist; name the file itself, or remove the link") from None
        if not path.name or not path.parent.is_dir():
            raise RefusedOutput(f"{path}: there is no folder {path.parent}; make it first (mkdir -p), or check the name") from None
        return path.parent.resolve() / path.name
    except (OSError, ValueError) as error:
        raise RefusedOutput(f"{path} cannot be written: {getattr(error, 'strerror', None) or error}") from None
    if stat.S_ISDIR(found.st_mode):
        raise RefusedOutput(f"{path} is a folder; expected the name of a file to write")
    if not stat.S_ISREG(found.st_mode):
        raise RefusedOutput(f"{path} is {kind_of(found.st_mode)}, no regular file; it is never replaced: name another file")
    _refuse_input(path, found, inputs)
    if not force:
        raise RefusedOutput(f"{path} exists; use {FORCE} to replace it, or name another file")
    return path.resolve()


def _refuse_input(path: Path, found: os.stat_result, inputs: Iterable[Path]) -> None:
    """Raise `RefusedOutput` if an existing file is an input, by whatever name."""
    identity = found.st_dev, found.st_ino
    read = [(_files_read.get() or {}).get(identity), *(each for each in inputs if _is_among(identity, path, each))]
    for source in filter(None, read):
        name = "" if os.fspath(source) == os.fspath(path) else f" ({source})"
        raise RefusedOutput(f"{path} is an input of this command{name}, which it never overwrites, not even with {FORCE}; name another file")


def _is_among(identity: tuple[int, int], path: Path, source: Path) -> bool:
    """Return whether a file is the same as an input, or is in a folder that is an input."""
    try:
        found = os.stat(source)
    except (OSError, ValueError):
        return False
    if stat.S_ISDIR(found.st_mode):
        return source.resolve() in path.resolve().parents
    return (found.st_dev, found.st_ino) == identity


def kind_of(mode: int) -> str:
    """Return in words what a path is that is no regular file, from its mode as `os.stat` gives it."""
    kinds = (
        (stat.S_ISDIR, "a folder"),
        (stat.S_ISFIFO, "a pipe"),
        (stat.S_ISCHR, "a device"),
        (stat.S_ISBLK, "a device"),
        (stat.S_ISSOCK, "a socket"),
    )
    return next((text for is_kind, text in kinds if is_kind(mode)), "something else")


@contextmanager
def _draft(target: Path) -> Iterator[Path]:
    """Yield the path of an empty draft of a file, locked against other writers; whatever is left of it at the end is removed.

    The name of the draft depends only on the target.  One that a killed process has left is therefore overwritten by the next writer and blocks
    nobody, because the lock ended with its process.
    """
    name = target.name if len(os.fsencode(target.name)) <= _LONGEST_NAME else hashlib.sha256(os.fsencode(target.name)).hexdigest()
    draft = target.with_name(f".{name}.bearing_sim_draft{target.suffix if target.suffix.lower() in _CHOSEN_BY_SUFFIX else ''}")
    try:
        descriptor = _locked(draft, target)
    except OSError as error:
        if isinstance(error, RefusedOutput) or error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EIO):
            raise
        raise RefusedOutput(f"{target} cannot be written: {error.strerror or error}") from None
    try:
        yield draft
    finally:
        with suppress(FileNotFoundError):
            if os.path.samestat(os.lstat(draft), os.fstat(descriptor)):  # else it has got its name, and this may be that of another writer
                os.unlink(draft)
        os.close(descriptor)


def _locked(draft: Path, target: Path) -> int:
    """Return the descriptor of a draft that this process alone has locked, emptied."""
    if fcntl is None:
        raise RefusedOutput(f"{target} cannot be written: files are written under locks (flock), which this system does not have; use Linux")
    while True:
        descriptor = os.open(draft, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK, 0o666)
        try:
            _lock(descriptor, target)
            with suppress(FileNotFoundError):
                if os.fstat(descriptor).st_nlink > 1:  # a process was killed just when it had given the file its name
                    os.unlink(draft)
                elif os.path.samestat(os.lstat(draft), os.fstat(descriptor)):  # nobody has completed or removed it meanwhile
                    os.ftruncate(descriptor, 0)
                    return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)


def _lock(descriptor: int, target: Path) -> None:
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        raise RefusedOutput(f"{target} cannot be written: the name of its draft is taken by something that is no file")
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise BeingWritten(f"{target} is being written by another program; wait for it, or name another file") from None
    except OSError:
        pass  # a file system without locks: drafts of two writers may then mix


def _keep_owner(draft: Path, target: Path) -> None:
    """Give a draft the owner, as far as the user may, and the permissions of the file that it is going to replace."""
    with suppress(FileNotFoundError):
        old = os.stat(target)
        with suppress(PermissionError):
            os.chown(draft, old.st_uid, old.st_gid)
        os.chmod(draft, stat.S_IMODE(old.st_mode))


def synchronise(path: Path) -> None:
    """Wait until a file or folder is on the disk."""
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _give_name(draft: Path, target: Path, force: bool) -> None:
    """Give a complete draft its name; without force only if nobody has taken it meanwhile."""
    if force:
        os.replace(draft, target)
    else:
        try:
            rename_without_replacing(draft, target)
        except FileExistsError:
            raise RefusedOutput(f"{target} was made by another program meanwhile; use {FORCE} to replace it, or name another file") from None
    synchronise(target.parent)


def rename_without_replacing(path: Path, name: Path) -> None:
    """Give a file a name in the same folder that nobody has taken.

    A hard link fails where the name is taken, unlike renaming, so no other program can lose a file.  On a file system without links a file that
    appears between the look and the renaming is replaced.

    Raises
    ------
    FileExistsError
        The name is taken; the file keeps its own.
    OSError
        It cannot be renamed.
    """
    try:
        os.link(path, name)
    except FileExistsError:
        raise
    except OSError:
        if os.path.lexists(name):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), os.fspath(name)) from None
        os.rename(path, name)
    else:
        os.unlink(path)
