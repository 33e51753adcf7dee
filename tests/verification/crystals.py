# SPDX-License-Identifier: BSD-2-Clause
"""Elastic constants of each crystal class, and of wood, with their oracle: Rayleigh-Ritz in products of polynomials of up to N in each
coordinate (ritz.py). Any constants would do; these are rounded from tables [GPa], with densities [kg/m³]."""
import numpy as np

import ritz

# Upper triangle by rows: xx, yy, zz, yz, xz, xy.
CLASSES = {
    # copper
    "cubic": (
        8960,
        [168.4, 121.4, 121.4, 0, 0, 0, 168.4, 121.4, 0, 0, 0, 168.4, 0, 0, 0, 75.4, 0, 0, 75.4, 0, 75.4],
    ),
    # zinc
    "hexagonal": (
        7134,
        [165, 31.1, 50, 0, 0, 0, 165, 50, 0, 0, 0, 61.8, 0, 0, 0, 39.6, 0, 0, 39.6, 0, 66.95],
    ),
    # scheelite structure, with C16
    "tetragonal": (
        4255,
        [144.7, 66.4, 46.6, 0, 0, 13.4, 144.7, 46.6, 0, 0, -13.4, 126.5, 0, 0, 0, 36.9, 0, 0, 36.9, 0, 45.1],
    ),
    # quartz
    "trigonal": (
        2649,
        [86.8, 7, 19.1, -18, 0, 0, 86.8, 19.1, 18, 0, 0, 105.8, 0, 0, 0, 58.2, 0, 0, 58.2, -18, 39.9],
    ),
    # olivine
    "orthorhombic": (3221, [328, 69, 69, 0, 0, 0, 200, 73, 0, 0, 0, 235, 0, 0, 0, 66.7, 0, 0, 81.3, 0, 80.9]),
    # diopside
    "monoclinic": (3289, [223, 77, 81, 0, 17, 0, 171, 57, 0, 7, 0, 235, 0, 43, 0, 74, 0, 7.3, 67, 0, 66]),
    # albite
    "triclinic": (
        2610,
        [69.9, 34, 30.8, 5.1, -2.4, -0.9, 183.5, 5.5, -3.9, -7.7, -5.8]
        + [179.5, -8.7, 7.1, -9.8, 24.9, -2.4, -7.2, 26.8, 0.5, 33.5],
    ),
}
# Sitka spruce along the grain, radial and tangential: E1, E2, E3; G23, G13, G12; ν23, ν13, ν12.
WOOD = (450, [11.9, 0.928, 0.512], [0.0357, 0.726, 0.762], [0.435, 0.467, 0.372])


def stiffness(young, shear, poisson):
    """Upper triangle of the inverse of the compliance, which states the strain of a tension along each axis in turn."""
    strain = np.diag([1 / modulus for modulus in [*young, *shear]])
    for ratio, (i, j) in zip(poisson, [(1, 2), (0, 2), (0, 1)]):
        strain[j, i] = strain[i, j] = -ratio / young[i]
    return np.linalg.inv(strain)[np.triu_indices(6)]


def materials():
    """By name: the table of a scene, density and C_ijkl."""
    found = {}
    for name, (density, constants) in CLASSES.items():
        given = [1e9 * value for value in constants]
        found[name] = (f"{{density={density},stiffness={given}}}", density, ritz.tensor(given))
    density, *constants = WOOD
    young, shear = ([1e9 * value for value in values] for values in constants[:2])
    table = f"{{density={density},young={young},shear={shear},poisson={constants[2]}}}"
    found["wood"] = (table, density, ritz.tensor(stiffness(young, shear, constants[2])))
    return found
