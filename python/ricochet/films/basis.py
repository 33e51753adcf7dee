# SPDX-License-Identifier: BSD-2-Clause
"""Quantities of the vertices at all snapshots as a few fields times amplitudes, as morph targets and their weights."""
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array

BLOCK = 2000  # vertices that are treated at once, to save memory

#: from numbers of vertices (b) to the values (b,S) of a field there
Values = Callable[[NDArray[np.int64]], Array]


@dataclass
class Basis:
    """Fields (r,V) or (r,V,3) and amplitudes (S,r), of which the largest is 1; their products are the quantity."""

    fields: Array
    amplitudes: Array
    error: float = 0.0  # largest at all snapshots and vertices, in the unit of the quantity
    largest: float = 0.0  # largest value of the quantity

    @property
    def relative(self) -> float:
        """The largest error relative to the largest value."""
        return self.error / self.largest if self.largest else 0.0

    def note(self, errors: Array, values: Array) -> None:
        """Counts the errors and the values of some vertices."""
        self.error = max(self.error, float(np.abs(errors).max(initial=0)))
        self.largest = max(self.largest, float(np.abs(values).max(initial=0)))


def blocks(count: int) -> Iterator[NDArray[np.int64]]:
    """The numbers of `count` vertices in parts."""
    yield from np.array_split(np.arange(count), count // BLOCK + 1)


def normalised(fields: Array, amplitudes: Array) -> Basis:
    """Scales amplitudes (S,r) so that the largest of each is 1, and fields (r,…) the other way round."""
    size = np.abs(amplitudes).max(axis=0, initial=0)
    size[size == 0] = 1
    return Basis(fields * size.reshape(-1, *[1] * (fields.ndim - 1)), amplitudes / size)


def basis_of(values: Values, start: Array, most: int, left_out: float) -> Basis:
    """The best fields for the differences of a field from `start` (V), by the eigenvectors of the products of snapshots.

    @param most      number of fields; fewer if the root mean square error, relative to that of the field, is within `left_out`
    """
    parts = list(blocks(len(start)))
    products: Array = np.zeros(())
    size_of_field = 0.0
    for some in parts:
        exact = values(some)
        rest = exact - start[some, None]
        products = products + rest.T @ rest
        size_of_field += float(np.sum(exact**2))
    size, right = np.linalg.eigh(products)
    left = np.append(np.cumsum(np.maximum(size, 0))[::-1], 0)  # squared error with the first 0, 1, … fields
    count = min(int(np.argmax(left <= left_out**2 * size_of_field)), most)
    right = right[:, ::-1][:, :count]
    fields = np.concatenate([(values(some) - start[some, None]) @ right for some in parts]).T
    basis = normalised(fields, right)
    for some in parts:
        exact = values(some)
        basis.note(exact - start[some, None] - basis.fields[:, some].T @ basis.amplitudes.T, exact)
    return basis
