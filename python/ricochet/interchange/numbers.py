# SPDX-License-Identifier: BSD-2-Clause
"""Reads numbers, lists and sparse matrices from text files. Raises InputError."""
import warnings
from pathlib import Path

import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError

LONGEST_RANGE = 10**7  # of numbers of nodes or elements, such as 1 THRU 10
Entries = tuple[Array, Array, Array]  # rows, columns and values of a sparse matrix


def numbers(path: Path, text: bytes) -> Array:
    """The numbers in a text, which must contain nothing else."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # NumPy issues it if text follows the numbers
        try:
            return np.fromstring(text, sep=" ")
        except DeprecationWarning:
            raise InputError(f"{path}: contains text where numbers are expected") from None


def is_number(word: str) -> bool:
    """Whether a word is a valid node number, element number or count. int() accepts other words too."""
    return word.isdecimal() and len(word) < 16


def entries_of(path: Path, values: Array, rows: int, columns: int) -> Entries:
    """Entries, numbered from 0, of a flat array that contains row, column (both from 1) and value of each
    entry in turn."""
    table = values.reshape(-1, 3)
    wrong = np.flatnonzero(~np.isfinite(table).all(axis=1))
    if wrong.size:
        raise InputError(
            f"{path}: entry {wrong[0] + 1} is {' '.join(f'{x:g}' for x in table[wrong[0]])}: must be finite numbers"
        )
    wrong = np.flatnonzero(
        ((table[:, :2] < 1) | (table[:, :2] > [rows, columns]) | (table[:, :2] % 1 != 0)).any(axis=1)
    )
    if wrong.size:
        raise InputError(
            f"{path}: entry {wrong[0] + 1} is {' '.join(f'{x:.17g}' for x in table[wrong[0]])}: must be a row from 1 to "
            f"{rows}, a column from 1 to {columns} and a value"
        )
    return table[:, 0].astype(np.int64) - 1, table[:, 1].astype(np.int64) - 1, table[:, 2]


def both_triangles(path: Path, i: Array, j: Array, value: Array) -> Entries:
    """Completes a symmetric matrix of which one triangle is given."""
    if (i < j).any() and (i > j).any():
        raise InputError(f"{path}: has entries of both triangles of a symmetric matrix: give one of them")
    off = i != j
    return np.concatenate([i, j[off]]), np.concatenate([j, i[off]]), np.concatenate([value, value[off]])


def read_matrix_market(path: Path) -> tuple[Entries, tuple[int, int]]:
    """Reads a real matrix in coordinate format: its entries, numbered from 0, and its shape. Of a symmetric
    matrix, both triangles are returned."""
    with open(path, "rb") as file:
        words = file.readline().decode("latin-1").lower().split()
        if (
            words[:3] != ["%%matrixmarket", "matrix", "coordinate"]
            or words[3:4] not in (["real"], ["integer"])
            or words[4:5] not in (["general"], ["symmetric"])
        ):
            raise InputError(
                f"{path}: begins with \"{' '.join(words[:6])[:60]}\": must be \"%%MatrixMarket matrix coordinate real\" "
                "general or symmetric"
            )
        line = file.readline()
        while line.startswith(b"%") or line.strip() == b"":
            if not line:
                raise InputError(f"{path}: ends before its sizes")
            line = file.readline()
        sizes = line.decode("latin-1").split()
        if len(sizes) != 3 or not all(is_number(size) for size in sizes):
            raise InputError(
                f"{path}: has sizes \"{' '.join(sizes)[:60]}\": must be rows, columns and entries"
            )
        rows, columns, entries = (int(size) for size in sizes)
        values = numbers(path, file.read())
    if values.size != 3 * entries:
        raise InputError(
            f"{path}: has {values.size} numbers after its sizes, expected {entries} entries of 3"
        )
    found = entries_of(path, values, rows, columns)
    return both_triangles(path, *found) if words[4] == "symmetric" else found, (rows, columns)


def table(path: Path, rows: str) -> Array:
    """The numbers of a list. `rows` describes a row in messages."""
    try:
        with open(path) as file, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # NumPy warns if a list is empty
            numbers = np.loadtxt(file, ndmin=2)
    except ValueError as error:
        raise InputError(
            f"{path}: {' '.join(str(error).split()).rstrip('.')}: each row must be {rows}"
        ) from None
    if not numbers.size:
        raise InputError(f"{path}: is empty: each row must be {rows}")
    if wrong := np.flatnonzero(~np.isfinite(numbers).all(axis=1)).tolist():
        raise InputError(f"{path}: row {wrong[0] + 1} has a number that is not finite")
    return numbers


def numbers_from_zero(path: Path, nodes: int, rows: str) -> Array:
    """The node numbers in a list, which are from 1 to `nodes`, converted to start from 0."""
    numbers = table(path, rows)
    wrong = numbers[(numbers < 1) | (numbers > nodes) | (numbers % 1 != 0)]
    if wrong.size:
        raise InputError(f"{path}: names node {wrong[0]:.17g}: nodes are numbered 1 to {nodes}")
    return numbers.astype(np.int64) - 1
