# SPDX-License-Identifier: BSD-2-Clause
"""An elastic ball on a rigid plane, pressed by its own weight, in Legendre series: no mesh and no half-space.

In a unit ball, with P_n' = dP_n/dθ, Navier's equations have the regular solutions of degree n (Love 1927, section 173)

    (u_r, u_θ) = r^(n-1) (n P_n, P_n')      and      r^(n+1) ((n + α) P_n, P_n'),
    α = -2 (nλ + (3n + 1) μ) / ((n + 3) λ + (n + 5) μ),

and under a uniform body force r² (P_1, P_1') replaces the first solution of degree 1, a rigid motion. The plane presses
along the axis on rings around the pole θ = 0. The pressure on a ring is constant, and its displacement is a mean."""

import numpy as np


def responses(degrees, poisson):
    """(n,2,2): coefficients of (u_r, u_θ) at r = 1, relative to the mean displacement of the ball, for unit coefficients of the
    tractions (σ_rr, σ_rθ), in (P_n, P_n'). Young's modulus is 1."""
    mu, lam = 0.5 / (1 + poisson), poisson / ((1 + poisson) * (1 - 2 * poisson))
    out = []
    for n in degrees:
        if n == 0:
            out.append(np.diag([1 / (3 * lam + 2 * mu), 0]))
            continue
        alpha = -2 * (n * lam + (3 * n + 1) * mu) / ((n + 3) * lam + (n + 5) * mu)
        second = [lam * (2 * n + alpha * (n + 3)) + 2 * mu * (n + alpha) * (n + 1), mu * (2 * n + alpha)]
        if n == 1:
            mean = 3 / 5 + alpha / 5  # mean of r² e_z + α z x; that of r² e_z is 3/5
            motion = np.array([[2 / 5, 1 + alpha - mean], [2 / 5, 1 - mean]])
            first = [2 * lam + 4 * mu, 2 * mu]
        else:
            motion = np.array([[n, n + alpha], [1, 1]])
            first = [2 * mu * n * (n - 1), 2 * mu * (n - 1)]
        out.append(motion @ np.linalg.inv(np.array([first, second]).T))
    return np.array(out)


class ElasticBall:
    def __init__(self, poisson, reach, rings, terms=12):
        """Radius and Young's modulus are 1; `rings` of equal width up to the angle `reach`; degrees up to `terms` / width."""
        width = reach / rings
        point, weight = np.polynomial.legendre.leggauss(4)
        angle = (width * (np.arange(rings)[:, None] + (point + 1) / 2)).ravel()
        cosine, sine = np.cos(angle), np.sin(angle)
        share = (sine * np.tile(weight, rings) * width / 2).reshape(rings, -1)

        def mean(f):
            return (f.reshape(rings, -1) * share).sum(axis=1) / share.sum(axis=1)

        self.gap = mean(2 * np.sin(angle / 2) ** 2)
        self.square = mean(sine**2)  # mean square of the distance from the axis

        degrees = np.arange(int(terms / width))
        along = np.zeros((len(degrees), 2, rings))  # unit force on a ring against the axis: along r and θ
        below, here = np.zeros_like(angle), np.ones_like(angle)
        for n in degrees:
            slope = n * (cosine * here - below) / sine
            along[n] = -mean(here * cosine), mean(slope * sine)
            below, here = here, ((2 * n + 1) * cosine * here - n * below) / (n + 1)
        norm = (2 * degrees + 1) / 2
        scale = np.stack([norm, norm / np.maximum(degrees * (degrees + 1), 1)], axis=1)
        response = responses(degrees, poisson) * scale[:, None, :]
        flat = along.reshape(-1, rings)
        self.flexibility = flat.T @ (response @ along).reshape(-1, rings) / (2 * np.pi)

    def press(self, force):
        """Forces of the rings and the approach of the centre of mass, under the given force / (E R²)."""
        for pressing in range(1, len(self.gap)):
            inner = slice(0, pressing)
            stiff, soft = np.linalg.solve(
                self.flexibility[inner, inner], np.stack([np.ones(pressing), self.gap[inner]], axis=1)
            ).T
            approach = (force + soft.sum()) / stiff.sum()
            rings = approach * stiff - soft
            if rings[-1] < 0:
                break
            best = rings, approach
        rings, approach = best
        return np.concatenate([rings, np.zeros(len(self.gap) - len(rings))]), approach
