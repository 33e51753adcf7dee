# SPDX-License-Identifier: BSD-2-Clause
"""Files that are whole under their names, or stay what they were: written beside as <name>.<process>.partial, synced, renamed."""
import contextlib
import errno
import fcntl
import io
import os
import re
import warnings
from pathlib import Path


def write(path, content):
    """`content`: bytes. Throws OSError, whose filename is `path`."""
    path = Path(path)
    try:
        if path.exists() and not path.is_file():  # a device would become a file
            raise FileExistsError(errno.EEXIST, "something that is no file has this name")
        remove_left(path)
        partial = path.with_name(f"{path.name}.{os.getpid()}.partial")
        try:
            with open(partial, "wb") as file:
                lock(file)
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            partial.rename(path)
        finally:
            partial.unlink(missing_ok=True)
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(path)) from None
    with contextlib.suppress(OSError):  # some file systems can't sync a folder; the file itself is whole either way
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def lock(file):
    """Whether the file could be locked, which tells others that its writer lives."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return True
    except OSError:
        return False


def remove_left(path):
    """Removes what killed writers of the file left."""
    mine = re.compile(re.escape(path.name) + r"\.[0-9]+\.partial")
    with contextlib.suppress(OSError):  # a folder that can't be listed
        for left in [other for other in path.parent.iterdir() if mine.fullmatch(other.name)]:
            with contextlib.suppress(OSError), open(left, "rb+") as file:  # gone by now, or another user's
                if lock(file):
                    left.unlink()


def save_picture(figure, path, **options):
    """A matplotlib figure, as PNG. Throws OSError. Dollars in titles and names are dollars: only matplotlib's own labels are
    formulas; a letter that no font has is an empty box."""
    from matplotlib.text import Text

    for text in figure.findobj(Text):
        if "$" in text.get_text() and not text.get_text().startswith(r"$\mathdefault"):
            text.set_parse_math(False)
    image = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from", UserWarning)
        figure.savefig(image, format="png", **options)
    write(path, image.getbuffer())
