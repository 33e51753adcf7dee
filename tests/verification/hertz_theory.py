# SPDX-License-Identifier: BSD-2-Clause
"""Hertz's contact of balls (Johnson, Contact Mechanics, 1985, sections 4.2 and 11.4), and the same values from a result."""

import h5py
import numpy as np

YOUNG, POISSON, DENSITY, RADIUS = 210e9, 0.3, 7850.0, 0.01
MODULUS = YOUNG / (1 - POISSON**2)  # E* on a rigid plane; half of this between two such balls
QUARTERS = 4  # the scenes contain only a quarter of each ball


def radius(force, modulus=MODULUS, curvature=RADIUS):
    return np.cbrt(3 * force * curvature / (4 * modulus))


def approach(force, modulus=MODULUS, curvature=RADIUS):
    return radius(force, modulus, curvature) ** 2 / curvature


def pressure(r, force, modulus=MODULUS, curvature=RADIUS):
    a = radius(force, modulus, curvature)
    return 3 * force / (2 * np.pi * a**2) * np.sqrt(np.maximum(1 - (r / a) ** 2, 0))


def impact(mass, speed, modulus, curvature):
    """Contact time and peak force of an impact at the relative `speed`; `mass` is the reduced mass."""
    time = 2.868 * (mass**2 / (curvature * modulus**2 * speed)) ** 0.2
    deepest = (15 * mass * speed**2 / (16 * np.sqrt(curvature) * modulus)) ** 0.4
    return time, 4 / 3 * modulus * np.sqrt(curvature) * deepest**1.5


class Contact:
    """Forces on the whole ball in one row of a result. The kernel of the body is in the folder of the result."""

    def __init__(self, path, body, row=0):
        with h5py.File(path) as file:
            self.force = QUARTERS * file["contact/force"][row]
            self.area = QUARTERS * file["contact/area"][:]
            kernel = path.parent / file["bodies"][body].attrs["kernel"].decode()
        with h5py.File(kernel) as file:
            node, centroid = file["surface/node"][:], file["surface/centroid"][:]
            element = file["surface/element"][:]
        self.distance = np.hypot(centroid[:, 0], centroid[:, 1])  # forces of patches act at their centroids
        self.total = self.force.sum()
        pressed = node[element[(self.force[element] > 0).any(axis=1)]]
        sides = pressed[:, 1:] - pressed[:, :1]
        self.pressed_area = QUARTERS * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2

    def radius(self):
        """Contact radius from the second moment of the forces: Hertz's pressure has ∫p r² = 2/5 a² ∫p. No edge must be found,
        and the error of the patches is of second order in their size."""
        return np.sqrt(2.5 * (self.force * self.distance**2).sum() / self.total)

    def radius_of_area(self):
        """Radius of a circle with the area on which the pressure Σ λ_i w_i / A_i is not 0: a pressed patch presses on all
        elements around it. This assumes no form of the pressure, but the error is a fraction of an element.
        """
        return np.sqrt(self.pressed_area / np.pi)

    def scatter(self):
        """Root mean square deviation from Hertz's pressure within his radius, divided by his peak pressure."""
        ideal = pressure(self.distance, self.total)
        inside = self.distance < radius(self.total)
        error = (self.force / self.area - ideal)[inside]
        return np.sqrt((self.area[inside] * error**2).sum() / self.area[inside].sum()) / ideal.max()
