# SPDX-License-Identifier: BSD-2-Clause
"""Rayleigh-Ritz frequencies of boxes and disks in products of Legendre polynomials: resonant ultrasound spectroscopy (Demarest
1971, J. Acoust. Soc. Am. 49, 768; Visscher, Migliori, Bell & Reinert 1991, 90, 2154). There is no mesh, no element and
no shift. Errors fall exponentially with the degree. Even and odd functions do not couple, so each class is solved separately."""
import numpy as np
import scipy.linalg
from numpy.polynomial import legendre


def product_of(factors, numbers, rows, columns):
    """Products of entries of the `factors`. Function k has the number numbers[k, f] in factor f."""
    found = 1.0
    for factor, number in zip(factors, numbers.T):
        found = found * factor[np.ix_(number[rows], number[columns])]
    return found


def legendre_at(degree, x):
    """P_0…P_degree and their derivatives at x: (degree + 1, len(x)) each."""
    identity = np.eye(degree + 1)
    values = np.array([legendre.legval(x, c) for c in identity])
    return values, np.array([legendre.legval(x, legendre.legder(c)) for c in identity])


def orthonormal_basis(gram):
    """Factors that make functions with these integrals of products orthonormal. The functions keep their parities, because the
    triangular factor does not mix parities."""
    return np.linalg.inv(np.linalg.cholesky(gram))


def orthonormal(tables, weight=1.0):
    """The integrals, by pairs of derivatives, in a basis in which weight · tables["00"] is the identity."""
    basis = orthonormal_basis(weight * tables["00"])
    return {pair: basis @ table @ basis.T for pair, table in tables.items()}


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


def stiffness_of(product, law, rows):
    """Stiffness of the functions rows[i] of each component i, from product(a, b, m, n) = ∫ ∂_a f_m ∂_b f_n and C_ijkl."""

    def block(i, k):
        pairs = [(j, l) for j in range(3) for l in range(3) if law[i, j, k, l] != 0]
        found = np.zeros((len(rows[i]), len(rows[k])))
        for j, l in pairs:
            found += law[i, j, k, l] * product("xyz"[j], "xyz"[l], rows[i], rows[k])
        return found

    return np.block([[block(i, k) for k in range(3)] for i in range(3)])


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


def frequencies(product, parity, law, axes=(True, True, True), count=None):
    """All frequencies [Hz], or the lowest ones, in ascending order. Those of rigid modes are 0 to round-off.

    product(a, b, m, n) is ∫ ∂_a f_m ∂_b f_n of the scalar functions numbered m and n, with ∫ ρ f_m f_n = δ_mn, for a, b from "xyz". parity
    (functions, 3) is 0 or 1 along x, y and z. axes: whether the body is symmetric along each of them. Motions that
    differ under a symmetry of body and law do not couple.
    """
    reversals = symmetries(law, axes)
    kind = np.array(
        [(parity @ reversals.T + reversals[:, c]) % 2 for c in range(3)]
    )  # (3, functions, reversals)
    number = kind @ 2 ** np.arange(len(reversals))
    values = []
    for one in np.unique(number):
        stiffness = stiffness_of(product, law, [np.flatnonzero(number[c] == one) for c in range(3)])
        some = count and (0, min(count, len(stiffness)) - 1)
        values.append(scipy.linalg.eigvalsh(stiffness, subset_by_index=some, overwrite_a=True))
    return np.sqrt(np.maximum(np.sort(np.concatenate(values)), 0))[:count] / (2 * np.pi)


def multiplicities(frequencies, tolerance):
    """Sizes of groups of equal frequencies; the frequencies are in ascending order."""
    groups = np.split(frequencies, np.flatnonzero(np.diff(frequencies) > tolerance * frequencies[1:]) + 1)
    return [len(group) for group in groups]


class Box:
    """Functions of a box: products of polynomials of up to `degree`, a number or three, in x, y and z, with ∫ ρ f_m f_n = δ_mn.
    If `clamped`, they vanish on the face at the lowest z, and their degree in z is higher by 1. `powers` (functions, 3) are the
    numbers of the polynomials, and `mean_on_top` (functions) the means over the face at the highest z."""

    def __init__(self, sides, degree, density, clamped=False):
        degrees = np.broadcast_to(degree, 3)
        self.tables, along = {}, []
        for axis, side, highest in zip("xyz", sides, degrees):
            points, weights = legendre.leggauss(highest + 3)
            value, slope = legendre_at(highest, points)
            end = np.ones(highest + 1)
            if clamped and axis == "z":
                value, slope, end = value * (1 + points), slope * (1 + points) + value, 2 * end
            pair = {"0": value, axis: slope * 2 / side}
            weight = weights * side / 2
            factor = density ** (1 / 3)
            basis = orthonormal_basis(factor * (value * weight) @ value.T)
            self.tables[axis] = {
                p + q: basis @ (pair[p] * weight) @ pair[q].T @ basis.T for p in pair for q in pair
            }
            along.append(basis @ (end if axis == "z" else value @ weight / side))
        powers = np.stack(np.meshgrid(*map(np.arange, degrees + 1), indexing="ij"), axis=-1).reshape(-1, 3)
        self.powers = powers
        self.mean_on_top = np.prod([one[powers[:, k]] for k, one in enumerate(along)], axis=0)

    def product(self, a, b, rows, columns):
        """∫ ∂_a f_m ∂_b f_n. The factor ρ^(1/3) of each axis is also in the tables of derivatives, so that ∫ ρ f f = 1."""
        factors = [self.tables[axis][(a if a == axis else "0") + (b if b == axis else "0")] for axis in "xyz"]
        return product_of(factors, self.powers, rows, columns)


def box(sides, degree, density, law, clamped=False, count=None):
    """Frequencies of a `Box` with the stiffness C_ijkl. @param count  of the lowest ones; by default all"""
    functions = Box(sides, degree, density, clamped)
    return frequencies(functions.product, functions.powers % 2, law, (True, True, not clamped), count)


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

    numbers = np.array([(p, k) for p in range(len(pairs)) for k in range(through + 1)])

    def product(a, b, rows, columns):
        keys = ["".join(key if key in of else "0" for key in (a, b)) for of in ("xy", "z")]
        return product_of([in_plane[keys[0]], in_depth[keys[1]]], numbers, rows, columns)

    parity = np.array([(i % 2, j % 2, k % 2) for i, j in pairs for k in range(through + 1)])
    return frequencies(product, parity, law)
