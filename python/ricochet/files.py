# SPDX-License-Identifier: BSD-2-Clause
"""Writes files atomically: into <name>.<process>.partial in the same folder, which is synced and renamed."""
import contextlib
import csv
import errno
import fcntl
import io
import os
import re
import warnings
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from ricochet.errors import InputError

if TYPE_CHECKING:  # imported only for type checks: the import takes half a second, and few commands draw
    from matplotlib.figure import Figure


@contextlib.contextmanager
def writing(path: Path, choose: str) -> Iterator[None]:
    """Converts an OSError for `path` to an InputError that advises another value of `choose`."""
    try:
        yield
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}). Choose another {choose}.") from None


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yields the path of a new file beside `path`, which is synced and renamed when the block ends, and removed
    if the block raises an exception. Raises OSError with the filename `path`."""
    try:
        if path.exists() and not path.is_file():  # a device would be replaced by a file
            raise FileExistsError(errno.EEXIST, "this name belongs to something other than a file")
        remove_left(path)
        partial = path.with_name(f"{path.name}.{os.getpid()}.partial")
        try:
            with open(partial, "wb") as file:
                lock(file)
                yield partial
                os.fsync(file.fileno())
            partial.rename(path)
        finally:
            partial.unlink(missing_ok=True)
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(path)) from None
    with contextlib.suppress(OSError):  # some file systems cannot sync a folder; the file itself is complete
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def write(path: Path, content: bytes | memoryview) -> None:
    """Writes the file completely or leaves it unchanged. Raises OSError with the filename `path`."""
    with replacing(path) as partial, open(partial, "r+b") as file:
        file.write(content)


def lock(file: BinaryIO) -> bool:
    """Locks the file, so that others see that its writer is alive. Returns whether that was possible."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return True
    except OSError:
        return False


def remove_left(path: Path) -> None:
    """Removes partial files whose writers were killed."""
    mine = re.compile(re.escape(path.name) + r"\.[0-9]+\.partial")
    with contextlib.suppress(OSError):  # the folder may not be readable
        for left in [other for other in path.parent.iterdir() if mine.fullmatch(other.name)]:
            with contextlib.suppress(OSError), open(left, "rb+") as file:  # gone, or of another user
                if lock(file):
                    left.unlink()


def write_csv(path: Path, titles: Iterable[str], rows: Iterable[Sequence[Any]]) -> None:
    """Writes a table. Raises OSError."""
    text = io.StringIO(newline="")
    table = csv.writer(text)
    table.writerow(list(titles))
    table.writerows(rows)
    write(path, text.getvalue().encode())


def save_picture(figure: "Figure", path: Path, **options: Any) -> None:
    """Writes a figure as PNG. Raises OSError.

    Dollar signs in titles and names are printed as they are; only matplotlib's own labels are formulas. A
    character that no font contains is drawn as an empty box.
    """
    from matplotlib.text import Text

    for text in figure.findobj(Text):
        if "$" in text.get_text() and not text.get_text().startswith(r"$\mathdefault"):
            text.set_parse_math(False)
    image = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from", UserWarning)
        figure.savefig(image, format="png", **options)
    write(path, image.getbuffer())
