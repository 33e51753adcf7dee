# SPDX-License-Identifier: BSD-2-Clause
"""Quantities of contact points as maps: a row for each point, by place, and columns of equal duration."""
import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.contacts import Entries
from ricochet.pictures.loaded_result import LoadedResult


class Grid:
    """The rows and columns of a map of a run with contact.

    `order` are the contact points of the rows and `where` their places [m], which `what` describes; `left_out`
    points have no row.
    """

    def __init__(
        self, result: LoadedResult, used: NDArray[np.bool_], columns: int, rows: int, by_impulse: bool = False
    ) -> None:
        """`used`: the points (m) that the map shows, in at most `columns` columns. Of more than `rows` points it
        shows those with the largest impulse, or else some that are evenly spread by place."""
        order, where, self.what = result.positions()
        inside = used[order]
        self.order, self.where = order[inside], where[inside]
        self.left_out = max(0, len(self.order) - rows)
        if self.left_out:
            picked = np.linspace(0, len(self.order) - 1, rows).astype(int)
            if by_impulse:
                picked = np.sort(np.argsort(result.impulse()[self.order])[::-1][:rows])
            self.order, self.where = self.order[picked], self.where[picked]
        t, step = result.contact_time, result.spacing
        self.start, self.end = result.spans()[0][0], float(t[-1])
        self.columns = min(columns, int(round((t[-1] - t[0]) / step)) + 1)
        column = ((t - t[0] + 0.5 * step) / (t[-1] - t[0] + step) * self.columns).astype(int)
        self.column = np.minimum(column, self.columns - 1)

    def largest(self, found: Entries) -> Array:
        """(columns, rows) the largest value in each cell of values (k,m) ≥ 0; 0 in cells without a row."""
        cells = np.zeros((self.columns, len(self.order)), dtype=found.values.dtype)
        place = np.full(found.shape[1], -1)
        place[self.order] = np.arange(len(self.order))
        shown = found.only(place[found.point] >= 0)
        np.maximum.at(cells, (self.column[shown.row], place[shown.point]), shown.values)
        return cells
