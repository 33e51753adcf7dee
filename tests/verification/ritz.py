# SPDX-License-Identifier: BSD-2-Clause
"""Rayleigh-Ritz frequencies of boxes and disks in products of Legendre polynomials: resonant ultrasound spectroscopy (Demarest
1971, J. Acoust. Soc. Am. 49, 768; Visscher, Migliori, Bell & Reinert 1991, 90, 2154). There is no mesh, no element and
no shift. Errors fall exponentially with the degree. Even and odd functions do not couple, so each class is solved separately."""
import numpy as np
from numpy.polynomial import legendre


def legendre_at(degree, x):
    """P_0…P_degree and their derivatives at x: (degree + 1, len(x)) each."""
    identity = np.eye(degree + 1)
    values = np.array([legendre.legval(x, c) for c in identity])
    return values, np.array([legendre.legval(x, legendre.legder(c)) for c in identity])


def orthonormal(tables, weight=1.0):
    """The integrals, by pairs of derivatives, in a basis in which weight · tables["00"] is the identity. The functions keep
    their parities, because the triangular factor does not mix parities."""
    inverse = np.linalg.inv(np.linalg.cholesky(weight * tables["00"]))
    return {pair: inverse @ table @ inverse.T for pair, table in tables.items()}


def isotropic(young, poisson):
    """C_ijkl [Pa] of an isotropic material, (3, 3, 3, 3)."""
    lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    shear = young / (2 * (1 + poisson))
    one = np.eye(3)
    same, crossed = np.einsum("ik,jl->ijkl", one, one), np.einsum("il,jk->ijkl", one, one)
    return lame * np.einsum("ij,kl->ijkl", one, one) + shear * (same + crossed)


def tensor(constants):
    """C_ijkl from the 21 constants of a scene: the upper triangle by rows, for xx, yy, zz, yz, xz, xy."""
    matrix = np.zeros((6, 6))
    matrix[np.triu_indices(6)] = constants
    matrix += np.triu(matrix, 1).T
    place = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
    return matrix[place[:, :, None, None], place[None, None, :, :]]


def stiffness_of(g, law):
    """Stiffness, by blocks of the components x, y, z, from g[a + b] = ∫ ∂_a f_m ∂_b f_n and C_ijkl."""

    def block(i, k):
        pairs = [(j, l) for j in range(3) for l in range(3) if law[i, j, k, l] != 0]
        return sum((law[i, j, k, l] * g["xyz"[j] + "xyz"[l]] for j, l in pairs), np.zeros_like(g["xx"]))

    return [[block(i, k) for k in range(3)] for i in range(3)]


def symmetries(law, axes):
    """Reversals of the given axes, (n, 3) of 0 and 1, that leave C_ijkl as it is: mirrors, half turns and the inversion."""
    found = []
    for mask in np.ndindex(2, 2, 2):
        sign = 1 - 2 * np.array(mask)
        turned = np.einsum("i,j,k,l,ijkl->ijkl", sign, sign, sign, sign, law)
        if (
            any(mask)
            and all(axes[k] or not mask[k] for k in range(3))
            and np.allclose(turned, law, rtol=1e-12)
        ):
            found.append(mask)
    return np.array(found, dtype=int).reshape(-1, 3)


def frequencies(product, parity, law, axes=(True, True, True)):
    """All frequencies [Hz] in ascending order. Those of rigid modes are 0 to round-off.

    product(a, b) is ∫ ∂_a f_m ∂_b f_n of scalar functions with ∫ ρ f_m f_n = δ_mn, for a, b from "xyz". parity
    (functions, 3) is 0 or 1 along x, y and z. axes: whether the body is symmetric along each of them. Motions that
    differ under a symmetry of body and law do not couple.
    """
    blocks = stiffness_of({a + b: product(a, b) for a in "xyz" for b in "xyz"}, law)
    reversals = symmetries(law, axes)
    kind = np.array(
        [(parity @ reversals.T + reversals[:, c]) % 2 for c in range(3)]
    )  # (3, functions, reversals)
    number = kind @ 2 ** np.arange(len(reversals))
    values = []
    for one in np.unique(number):
        rows = [np.flatnonzero(number[c] == one) for c in range(3)]
        stiffness = np.block([[blocks[i][j][np.ix_(rows[i], rows[j])] for j in range(3)] for i in range(3)])
        values.append(np.linalg.eigvalsh((stiffness + stiffness.T) / 2))
    return np.sqrt(np.maximum(np.sort(np.concatenate(values)), 0)) / (2 * np.pi)


def multiplicities(frequencies, tolerance):
    """Sizes of groups of equal frequencies; the frequencies are in ascending order."""
    groups = np.split(frequencies, np.flatnonzero(np.diff(frequencies) > tolerance * frequencies[1:]) + 1)
    return [len(group) for group in groups]


def box(sides, degree, density, law, clamped=False):
    """Frequencies of a box with the stiffness C_ijkl by polynomials of up to `degree` in each of x, y and z. If `clamped`, the face
    at the lowest z is clamped."""
    points, weights = legendre.leggauss(degree + 3)
    tables = {}
    for axis, side in zip("xyz", sides):
        value, slope = legendre_at(degree, points)
        if clamped and axis == "z":
            value, slope = value * (1 + points), slope * (1 + points) + value
        pair = {"0": value, axis: slope * 2 / side}
        weight = weights * side / 2
        tables[axis] = orthonormal(
            {p + q: (pair[p] * weight) @ pair[q].T for p in pair for q in pair}, density ** (1 / 3)
        )

    def product(a, b):
        factors = [tables[axis][(a if a == axis else "0") + (b if b == axis else "0")] for axis in "xyz"]
        return np.kron(np.kron(factors[0], factors[1]), factors[2])

    # The factor ρ^(1/3) of each axis is also contained in the tables of derivatives, so that ∫ ρ f f = 1.
    parity = np.stack(np.meshgrid(*[np.arange(degree + 1) % 2] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    return frequencies(product, parity, law, (True, True, not clamped))


def disk(radius, thickness, degree, through, density, law):
    """Frequencies of a free disk by polynomials of total `degree` in x, y and degree `through` in z."""
    # Quadrature on the unit disk that is exact for the products: Gauss in r², and equal angles.
    radial, radial_weight = legendre.leggauss(degree + 2)
    angles = 2 * degree + 4
    r = np.sqrt((radial + 1) / 2)
    phi = 2 * np.pi * np.arange(angles) / angles
    x, y = np.outer(r, np.cos(phi)).ravel(), np.outer(r, np.sin(phi)).ravel()
    area = np.outer(radial_weight / 4, np.full(angles, 2 * np.pi / angles)).ravel() * radius**2
    px, dx = legendre_at(degree, x)
    py, dy = legendre_at(degree, y)
    pairs = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    plane = {
        "0": np.array([px[i] * py[j] for i, j in pairs]),
        "x": np.array([dx[i] * py[j] for i, j in pairs]) / radius,
        "y": np.array([px[i] * dy[j] for i, j in pairs]) / radius,
    }
    z, z_weight = legendre.leggauss(through + 2)
    pz, dz = legendre_at(through, z)
    depth = {"0": pz, "z": dz / (thickness / 2)}
    in_plane = orthonormal({a + b: (plane[a] * area) @ plane[b].T for a in plane for b in plane}, density)
    in_depth = orthonormal(
        {a + b: (depth[a] * z_weight * thickness / 2) @ depth[b].T for a in depth for b in depth}
    )

    def product(a, b):
        keys = ["".join(key if key in of else "0" for key in (a, b)) for of in ("xy", "z")]
        return np.kron(in_plane[keys[0]], in_depth[keys[1]])

    parity = np.array([(i % 2, j % 2, k % 2) for i, j in pairs for k in range(through + 1)])
    return frequencies(product, parity, law)
