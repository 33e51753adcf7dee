# SPDX-License-Identifier: BSD-2-Clause
"""Result and kernel files: HDF5, with checks of the content while it is read."""
import contextlib
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ricochet.errors import InputError


NEWEST = {
    "ricochet-kernel": 3,
    "ricochet-result": 2,
}  # newest version that is read, of each kind of file; otherwise 1


def is_there(path: Path) -> bool:
    """Whether the file exists and can be opened. Raises InputError if it exists but cannot be opened."""
    try:
        if not path.is_file():
            return False
        with open(path, "rb"):
            return True
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read ({error.strerror}). Change its permissions, or name another one."
        ) from None


@contextlib.contextmanager
def expected(path: Path, program: str = "ricochet-contact") -> Iterator[None]:
    """Raises InputError in place of any exception that the content of a foreign file causes."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # NumPy warns of numbers that no run produces
            yield
    except (InputError, MemoryError):
        raise
    except Exception:
        raise InputError(f"{path}: holds what {program} does not write. Compute it again.") from None


class File:
    """An HDF5 file. Datasets are checked when they are read."""

    def __init__(self, path: Path, kind: str) -> None:
        self.path = path
        if not is_there(path):
            result = "a .result.h5 that ricochet-contact wrote"
            name = "a .kernel.h5 that ricochet-kernel wrote" if kind == "ricochet-kernel" else result
            raise InputError(f"{path}: there is no such file. Name {name}.")
        try:
            self.file = h5py.File(path, "r")
        except OSError:
            what = "a damaged or truncated" if h5py.is_hdf5(path) else "not an"
            raise InputError(f"{path}: is {what} HDF5 file. Compute it again.") from None
        if self.text("/", "format") != kind:
            raise InputError(f"{path}: is not a {kind} file. Name a file that Ricochet wrote.")

        version = self.attribute("/", "version")
        if not isinstance(version, (int, np.integer)):
            raise InputError(f"{path}: has no valid format version. Compute it again.")
        newest = NEWEST.get(kind, 1)
        if not 1 <= version <= newest:
            raise InputError(
                f"{path}: has format version {version}, and this program reads {newest}. Use a newer Ricochet."
            )

    def text(self, where: str, name: str) -> str | None:
        """An attribute, or None if it is not text."""
        value = self.attribute(where, name)
        if isinstance(value, bytes):
            return value.decode(errors="replace")
        return value if isinstance(value, str) else None

    def attribute(self, where: str, name: str) -> Any:
        try:
            return self.file[where].attrs.get(name) if where in self.file else None
        except (KeyError, OSError, RuntimeError):
            what = f'attribute "{name}" of "{where}"'
            raise InputError(f"{self.path}: {what} is damaged. Compute it again.") from None

    def has(self, name: str) -> bool:
        try:
            item = self.file.get(name)
        except RuntimeError:  # links that form a circle
            return False
        return isinstance(item, h5py.Dataset) and item.file.filename == self.file.filename

    def names(self, group: str) -> list[str]:
        try:
            return sorted(self.file[group]) if isinstance(self.file.get(group), h5py.Group) else []
        except RuntimeError:  # links that form a circle
            return []

    def texts(self, name: str) -> list[str]:
        """The values of a dataset (·) of texts."""
        data = self._dataset(name, (None,))
        if data.dtype.kind != "S":
            raise InputError(f'{self.path}: dataset "{name}" holds other than texts. Compute it again.')
        try:
            return [value.decode(errors="replace") for value in data[:]]
        except OSError:
            raise InputError(f'{self.path}: dataset "{name}" is damaged. Compute it again.') from None

    def array(self, name: str, *shape: int | None) -> NDArray[Any]:
        """The values of a dataset, floats or integers. None in `shape` stands for a dimension of any
        length."""
        return self._values(name, self._dataset(name, shape), ())

    def blocks(self, name: str, *shape: int | None) -> Iterator[NDArray[Any]]:
        """The values of a dataset as for `array`, in consecutive parts of its first dimension of at most
        64 MiB."""
        data = self._dataset(name, shape)
        rows = max(1, 2**26 * len(data) // max(data.nbytes, 1))
        for first in range(0, len(data), rows):
            yield self._values(name, data, (slice(first, first + rows),))

    def diagonal(self, name: str, count: int, width: int) -> NDArray[Any]:
        """(count,width,width) blocks on the diagonal of a square dataset, which is read in parts to save memory."""
        data, out = self._dataset(name, (count * width,) * 2), np.empty((count, width, width))
        for first in range(0, count, 256):
            some = np.arange(first, min(first + 256, count))
            rows = slice(first * width, (int(some[-1]) + 1) * width)
            part = self._values(name, data, (rows, rows)).reshape(len(some), width, len(some), width)
            out[some] = part[some - first, :, some - first]
        return out

    def _dataset(self, name: str, shape: tuple[int | None, ...]) -> h5py.Dataset:
        refused = f'{self.path}: dataset "{name}"'
        if not self.has(name):
            raise InputError(f"{refused} is missing. Compute it again.")
        data = self.file[name]
        if len(data.shape) != len(shape) or any(s not in (None, d) for s, d in zip(shape, data.shape)):
            expected = ", ".join("*" if s is None else str(s) for s in shape)
            raise InputError(f"{refused} has shape {data.shape}, expected ({expected}). Compute it again.")
        if data.nbytes > 64 * self.path.stat().st_size:  # a damaged file must not exhaust the memory
            raise InputError(f"{refused} claims more than the file can hold. Compute it again.")
        return data

    def _values(self, name: str, data: h5py.Dataset, part: tuple[slice, ...]) -> NDArray[Any]:
        refused = f'{self.path}: dataset "{name}"'
        try:
            values: NDArray[Any] = data[part]
        except OSError:
            raise InputError(f"{refused} is damaged. Compute it again.") from None
        if values.dtype.kind not in "fi" or not np.isfinite(values).all():
            raise InputError(f"{refused} holds values that are not finite numbers. Compute it again.")
        return values


def are_finite(values: Any, count: int) -> bool:
    """Whether an attribute consists of `count` finite numbers."""
    numbers = np.asarray(values)
    return numbers.size == count and numbers.dtype.kind in "fi" and bool(np.isfinite(numbers).all())
