# SPDX-License-Identifier: BSD-2-Clause
"""The points that carry a force in the rows of contact of a result, few of very many."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Floats

Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Entries:
    """Values (k,m,…) of the contact points (m) in the contact rows (k), of which e are kept. The others are 0."""

    #: (e) the row of each value, ascending, and its point; both from 0
    row: Ints
    point: Ints
    #: (e,…)
    values: NDArray[Any]
    #: k and m
    shape: tuple[int, int]

    @classmethod
    def of(cls, values: NDArray[Any]) -> Entries:
        """The values (k,m,…) other than 0."""
        row, point = np.nonzero(values.any(axis=tuple(range(2, values.ndim))))
        return cls(row, point, values[row, point], (values.shape[0], values.shape[1]))

    def map(self, function: Callable[[NDArray[Any]], NDArray[Any]]) -> Entries:
        """The function takes the values (e,…)."""
        return replace(self, values=function(self.values))

    def only(self, kept: NDArray[np.bool_]) -> Entries:
        """Keeps some of the entries (e)."""
        return replace(self, row=self.row[kept], point=self.point[kept], values=self.values[kept])

    def norms(self) -> Entries:
        """The magnitudes of vectors."""
        return self.map(lambda vectors: np.linalg.norm(vectors, axis=1))

    def per_row(self) -> Floats:
        """(k,…) sums over the points"""
        return self._sums(self.row, self.shape[0])

    def per_point(self) -> Floats:
        """(m,…) sums over the rows"""
        return self._sums(self.point, self.shape[1])

    def counts(self) -> Ints:
        """(k) numbers of entries"""
        return np.bincount(self.row, minlength=self.shape[0])

    def _sums(self, index: Ints, count: int) -> Floats:
        width = int(np.prod(self.values.shape[1:]))
        out = np.empty((count, width))
        for number, column in enumerate(self.values.reshape(-1, width).T):
            out[:, number] = np.bincount(index, column, count)
        return out.reshape(count, *self.values.shape[1:])

    def of_point(self, point: int, missing: float = 0) -> NDArray[Any]:
        """(k,…) with `missing` in rows without an entry"""
        here = self.point == point
        out = np.full((self.shape[0], *self.values.shape[1:]), missing, dtype=self.values.dtype)
        out[self.row[here]] = self.values[here]
        return out

    def in_row(self, row: int) -> slice:
        """The entries of a row."""
        return slice(*np.searchsorted(self.row, [row, row + 1]))

    def of_row(self, row: int) -> NDArray[Any]:
        """(m,…)"""
        out = np.zeros((self.shape[1], *self.values.shape[1:]), dtype=self.values.dtype)
        some = self.in_row(row)
        out[self.point[some]] = self.values[some]
        return out

    def of_rows(self, rows: Ints, points: Ints) -> NDArray[Any]:
        """(r,p,…) of some rows and points"""
        out = np.zeros((len(rows), len(points), *self.values.shape[1:]), dtype=self.values.dtype)
        for number, row in enumerate(rows):
            out[number] = self.of_row(row)[points]
        return out

    def dense(self, missing: float = 0) -> NDArray[Any]:
        """(k,m,…), which may take very much memory"""
        out = np.full((*self.shape, *self.values.shape[1:]), missing, dtype=self.values.dtype)
        out[self.row, self.point] = self.values
        return out


@dataclass(frozen=True)
class Contacts:
    """The points that carry a force in each contact row: e entries, in the order of time.

    A result without finite rotations has the places and normals of the start.
    """

    #: (e) the contact row, and the contact point, both from 0
    row: Ints
    point: Ints
    #: (e) end of the step [s]
    time: Floats
    #: (e) names of the first body of the pair, and of the second one or the obstacle
    a: NDArray[np.str_]
    b: NDArray[np.str_]
    #: (e,3) where the first body touches [m], and the unit normal out of it
    place: Floats
    normal: Floats
    #: (e) compressive force, the mean over the step [N], and gap [m]
    force: Floats
    gap: Floats
    #: (e,3) force of friction on the second body [N], tangential displacement of the first one relative to it
    #: [m], and (e) `OPEN`, `STICK` or `SLIP`; None without friction
    tangential_force: Floats | None = None
    tangential_displacement: Floats | None = None
    state: NDArray[np.int8] | None = None

    def __len__(self) -> int:
        return len(self.row)
