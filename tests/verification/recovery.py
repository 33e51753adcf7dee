# SPDX-License-Identifier: BSD-2-Clause
"""The recovery of gradients that docs/theory/bodies.md describes, written a second time: at a corner of tetrahedra of order 2, from the
displacement at the nodes of a mesh, whichever code has found it."""
import itertools

import numpy as np

ORDER = 2
PER_COEFFICIENT = 1.25  # nodes for each coefficient of a polynomial
LEAST_SHARE, LEAST_SHARE_OF_HIGHEST = 1e-4, 1e-2  # of a monomial that lower ones do not represent
ENLARGEMENTS = 3
# Exponents of the monomials, by degree.
EXPONENTS = np.array(
    sorted(
        (e for e in itertools.product(range(ORDER + 3), repeat=3) if sum(e) <= ORDER + 2),
        key=lambda e: (sum(e), -e[0], -e[1]),
    )
)
LOWER = int(np.sum(EXPONENTS.sum(axis=1) <= ORDER + 1))


def monomials(x):
    """(n, monomials) at x (n,3)."""
    return np.prod(x[:, None, :] ** EXPONENTS, axis=2)


def slopes(x):
    """(monomials, 3) derivatives at x (3)."""
    found = []
    for c in range(3):
        less = EXPONENTS - np.eye(3, dtype=int)[c]
        found.append(EXPONENTS[:, c] * np.prod(x ** np.maximum(less, 0), axis=1))
    return np.stack(found, axis=1)


def independent(gram, lower):
    """Numbers of the monomials that earlier ones do not represent."""
    kept = []
    for k in range(len(gram)):
        rest = gram[k, k]
        if kept:
            across = gram[k, kept]
            rest -= across @ np.linalg.solve(gram[np.ix_(kept, kept)], across)
        if rest > (LEAST_SHARE if k < lower else LEAST_SHARE_OF_HIGHEST) * gram[k, k]:
            kept.append(k)
    return kept


class Patch:
    """The polynomial around a corner by the nodes of some elements."""

    def __init__(self, node, corner, nodes):
        self.nodes = nodes
        place = node[nodes]
        centre = place.mean(axis=0)
        size, axes = np.linalg.eigh(np.cov(place.T, bias=True))
        scale = (axes / np.sqrt(size)).T[::-1]
        value = monomials((place - centre) @ scale.T)
        weight = (np.sum(((place - node[corner]) @ scale.T) ** 2, axis=1) + 0.5) ** -2
        gram = (weight * value.T) @ value
        kept = independent(gram, LOWER)
        self.determined = sum(k < LOWER for k in kept)
        self.enough = len(nodes) >= PER_COEFFICIENT * len(kept)
        if not self.enough:
            kept = [k for k in independent(gram[:LOWER, :LOWER], LOWER)]
        self.sufficient = self.enough and self.determined == LOWER
        fit = np.linalg.solve(gram[np.ix_(kept, kept)], (weight * value.T)[kept])
        self.gradient = scale.T @ slopes(scale @ (node[corner] - centre))[kept].T @ fit  # (3, nodes)


def patch_of(node, element, corner):
    """The patch of a corner: the elements around it, and the next ones until the nodes suffice or determine no more."""
    seeds, before = [corner], None
    for _ in range(ENLARGEMENTS + 1):
        inside = element[np.isin(element[:, :4], seeds).any(axis=1)]
        patch = Patch(node, corner, np.unique(inside))
        if before is not None and before.enough and patch.determined == before.determined:
            return before
        if patch.sufficient:
            return patch
        seeds, before = np.unique(inside[:, :4]), patch
    return patch


def stresses(node, element, corners, displacement, young, poisson):
    """Stresses (corners,6), xx, yy, zz, yz, xz, xy, of an isotropic material [Pa]. @param displacement  (n,3) [m]"""
    mu = young / (2 * (1 + poisson))
    lame = 2 * mu * poisson / (1 - 2 * poisson)
    found = []
    for corner in corners:
        patch = patch_of(node, element, corner)
        gradient = patch.gradient @ displacement[patch.nodes]
        strain = (gradient + gradient.T) / 2
        stress = lame * np.trace(strain) * np.eye(3) + 2 * mu * strain
        found.append(stress[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]])
    return np.array(found)
