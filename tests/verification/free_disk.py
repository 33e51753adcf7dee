"""The free disk of Table 1 at order 3: its first 30 elastic frequencies against a Rayleigh-Ritz solution in global
polynomials, the method of resonant ultrasound spectroscopy (Visscher, Migliori, Bell & Reinert 1991, J. Acoust. Soc.
Am. 90, 2154). It has no mesh, no elements and no shift; its error falls exponentially with the degree."""

import unittest

import h5py
import numpy as np
from numpy.polynomial import legendre

from programs import MESHES, ProgramTest, kernel

DENSITY, YOUNG, POISSON = 11.3e3, 10.4e6, 0.37
RADIUS, THICKNESS = 0.05, 5e-3


def legendre_at(degree, x):
    """P_0…P_degree and their derivatives at x: (degree + 1, len(x)) each."""
    identity = np.eye(degree + 1)
    values = np.array([legendre.legval(x, c) for c in identity])
    return values, np.array([legendre.legval(x, legendre.legder(c)) for c in identity])


def ritz_frequencies(degree, through, count):
    """Lowest `count` elastic frequencies [Hz] of the free disk, by polynomials of total `degree` in x, y and degree
    `through` in z."""
    # Quadrature on the unit disk, exact for the products: Gauss in r² and equal angles.
    radial, radial_weight = legendre.leggauss(degree + 2)
    angles = 2 * degree + 4
    r = np.sqrt((radial + 1) / 2)
    phi = 2 * np.pi * np.arange(angles) / angles
    x, y = np.outer(r, np.cos(phi)).ravel(), np.outer(r, np.sin(phi)).ravel()
    area = np.outer(radial_weight / 4, np.full(angles, 2 * np.pi / angles)).ravel()
    px, dx = legendre_at(degree, x)
    py, dy = legendre_at(degree, y)
    pairs = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    plane = {
        "0": np.array([px[i] * py[j] for i, j in pairs]),
        "x": np.array([dx[i] * py[j] for i, j in pairs]) / RADIUS,
        "y": np.array([px[i] * dy[j] for i, j in pairs]) / RADIUS,
    }
    z, dz_weight = legendre.leggauss(through + 2)
    pz, dz = legendre_at(through, z)
    depth = {"0": pz, "z": dz / (THICKNESS / 2)}

    def product(a, b):
        """∫ ∂_a f_m ∂_b f_n over the disk for all basis functions, derivative "0", "x", "y" or "z"."""
        in_plane = [key if key in "xy" else "0" for key in (a, b)]
        in_depth = [key if key == "z" else "0" for key in (a, b)]
        return np.kron(
            (plane[in_plane[0]] * area * RADIUS**2) @ plane[in_plane[1]].T,
            (depth[in_depth[0]] * dz_weight * THICKNESS / 2) @ depth[in_depth[1]].T,
        )

    # An orthonormal basis of the scalar functions first: the products above are ill-conditioned at high degree.
    gram = product("0", "0")
    size, vectors = np.linalg.eigh(gram)
    keep = size > 1e-13 * size[-1]
    basis = vectors[:, keep] / np.sqrt(DENSITY * size[keep])
    g = {a + b: basis.T @ product(a, b) @ basis for a in "xyz" for b in "xyz"}
    lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    shear = YOUNG / (2 * (1 + POISSON))
    laplace = g["xx"] + g["yy"] + g["zz"]
    stiffness = np.block(
        [[lame * g[a + b] + shear * g[b + a] + (shear * laplace if a == b else 0) for b in "xyz"] for a in "xyz"]
    )
    values = np.linalg.eigvalsh((stiffness + stiffness.T) / 2)
    return np.sqrt(values[6 : 6 + count]) / (2 * np.pi)


class FreeDisk(ProgramTest):
    def test_first_thirty_frequencies(self):
        converged = ritz_frequencies(18, 5, 30)
        # The oracle is converged to a tenth of the bound itself.
        coarser = ritz_frequencies(16, 4, 30)
        self.assertLess(np.abs(coarser / converged - 1).max(), 2e-4)
        scene = MESHES / "two-disks" / "two-disks.toml"
        self.succeed(kernel(scene, self.folder, "modes={count=36}", "bodies.lower.support={}", "output.view=false"))
        (path,) = self.folder.glob("upper-*.kernel.h5")
        with h5py.File(path) as file:
            omega = file["modes/angular_frequency"][:]
        self.assertEqual(np.count_nonzero(omega == 0), 6)
        self.assertGreaterEqual(len(omega), 36)
        error = np.abs(omega[6:36] / (2 * np.pi) / converged - 1)
        print("free disk, order 3: largest error of the first 30 elastic frequencies: {:.2e}".format(error.max()))
        self.assertLess(error.max(), 2e-3)


if __name__ == "__main__":
    unittest.main()
