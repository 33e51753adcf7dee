# SPDX-License-Identifier: BSD-2-Clause
"""The colours of a film: one scale for all bodies, and for each body a few fields that change them over time.

Vertices have the colour of the largest value over the run, which viewers without morph targets of colours show. The fields
change it to that of each snapshot. They are superposed, so colours are linear in the value.
"""
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ricochet.arrays import Array
from ricochet.films.basis import Basis, Values, basis_of
from ricochet.films.document import linear
from ricochet.films.fields import ColourField, Quantity

LEFT_OUT = 3e-3  # allowed relative root mean square error of a field, with fewer fields than allowed
TOP = 99.0  # percentile of the largest values that has the last colour: sharp dents would leave no colours to the rest
LOW, HIGH = np.array(linear("#d9dce1")), np.array(linear("#c00000"))


@dataclass
class Tint:
    """The colours of a body with V vertices."""

    start: Array  # (V,3) linear red, green and blue
    fields: Array  # (c,V,3) their changes
    basis: Basis  # of the values


class Colours:
    """The colours of the bodies, by name.

    @param quantity  what they show
    @param fields    of each body
    @param most      number of fields of a body
    """

    def __init__(self, quantity: Quantity, fields: Mapping[str, ColourField], most: int) -> None:
        self.quantity = quantity
        largest = np.concatenate([field.largest for field in fields.values()])
        self.top = float(np.percentile(largest, TOP)) or float(largest.max()) or 1.0
        self.tints = {name: self._tint(field, most) for name, field in fields.items()}

    def _tint(self, field: ColourField, most: int) -> Tint:
        start = np.minimum(field.largest, self.top)
        basis = basis_of(self._bounded(field.values), start, most, LEFT_OUT)
        share = (HIGH - LOW) / self.top
        colour = np.clip(LOW + start[:, None] * share, 0, 1)  # round-off
        return Tint(colour, basis.fields[:, :, None] * share, basis)

    def _bounded(self, values: Values) -> Values:
        return lambda some: np.minimum(values(some), self.top)

    def extras(self) -> dict[str, object]:
        """The scale, as data of the file."""
        return {
            "quantity": self.quantity.name,
            "unit": self.quantity.unit,
            "range": [0.0, self.top],
            "error": {name: tint.basis.error for name, tint in self.tints.items()},
            "linear_rgb": [LOW.tolist(), HIGH.tolist()],
        }
