# SPDX-License-Identifier: BSD-2-Clause
"""What stresses amount to. Stresses are arrays (…,6) of xx, yy, zz, yz, xz, xy, as gauges and surfaces record them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ricochet.arrays import Floats


@dataclass(frozen=True)
class StressEnvelope:
    """The largest stresses of a whole run at the V nodes of a visualisation surface, over all steps, and when they first
    occurred. Each (V)."""

    von_mises: Floats  #: [Pa]
    von_mises_time: Floats  #: [s]
    principal: Floats  #: largest principal stress [Pa]
    principal_time: Floats  #: [s]
    shear: Floats  #: maximum shear stress, half the difference of the largest and the smallest principal stress [Pa]
    shear_time: Floats  #: [s]


def von_mises(stress: Floats) -> Floats:
    """The von Mises stress (…) of stresses (…,6) [Pa]. Raises ValueError for other shapes."""
    normal, shear = _parts(stress)
    apart = normal - np.roll(normal, 1, axis=-1)
    return np.asarray(np.sqrt((apart**2).sum(axis=-1) / 2 + 3 * (shear**2).sum(axis=-1)))


def principal_stresses(stress: Floats) -> Floats:
    """The principal stresses (…,3) of stresses (…,6), descending [Pa]. Raises ValueError for other shapes."""
    (x, y, z), (yz, xz, xy) = (np.moveaxis(part, -1, 0) for part in _parts(stress))
    tensor = np.stack([np.stack(row, axis=-1) for row in ((x, xy, xz), (xy, y, yz), (xz, yz, z))], axis=-2)
    return np.asarray(np.linalg.eigvalsh(tensor)[..., ::-1])


def _parts(stress: Floats) -> tuple[Floats, Floats]:
    stress = np.asarray(stress, float)
    if stress.ndim == 0 or stress.shape[-1] != 6:
        raise ValueError(
            f"stress has the shape {stress.shape}: the last length must be 6, of xx, yy, zz, yz, xz, xy"
        )
    return stress[..., :3], stress[..., 3:]
