# SPDX-License-Identifier: BSD-2-Clause
"""The closed forms and reference solutions of contact, against their limits, balances of energy and other computations."""

import unittest

import numpy as np

import hertz_theory as hertz
import mindlin
import modal_hertz
import oblique_impact as oblique
import random_rods as rods
from cases import struck_bar

CHI = oblique.chi(0.3)
SWEEP = np.array([0.05, 0.2, 0.5, 0.9, 1, 1.2, 1.9, 2.7, 3.6, 4.2, 4.6])


class RodsTest(unittest.TestCase):
    """The waves of random_rods.py, against solutions by hand and a leapfrog of masses and springs."""

    def test_masses_and_springs(self):
        random = np.random.default_rng(11)
        for _ in range(4):
            a, b, clamped, speed, duration, impulse = rods.draw(random)
            found = [self.leapfrog(a, b, clamped, speed, duration, n) for n in (100, 200)]
            # The lumped chain is of first order at a front.
            self.assertLess(abs(2 * found[1] - found[0] - impulse) / impulse, 1e-2)

    def leapfrog(self, a, b, clamped, speed, duration, n):
        """Impulse of two chains of n springs, whose ends meet as one mass while they press."""
        step = min(rod.there_and_back for rod in (a, b)) / 2 / n * 0.5
        x = [np.zeros(n + 1) for _ in range(2)]
        v = [np.full(n + 1, speed), np.zeros(n + 1)]
        mass = [np.full(n + 1, rod.mass / n) for rod in (a, b)]
        for m in mass:
            m[[0, -1]] /= 2
        impulse = 0.0
        for _ in range(round(duration / step)):
            for k, rod in enumerate((a, b)):
                pull = rod.young * rod.area * n / rod.length * np.diff(x[k])
                v[k][:-1] += step * pull / mass[k][:-1]
                v[k][1:] -= step * pull / mass[k][1:]
            if clamped:
                v[1][-1] = 0
            gap = x[1][0] + step * v[1][0] - x[0][-1] - step * v[0][-1]
            if gap < 0:
                push = -gap / step / (1 / mass[0][-1] + 1 / mass[1][0])
                v[0][-1] -= push / mass[0][-1]
                v[1][0] += push / mass[1][0]
                impulse += push
            for k in range(2):
                x[k] += step * v[k]
        return impulse


class StruckBarTest(unittest.TestCase):
    """The measured record of struck_bar.py, against the figures that were published with it."""

    def setUp(self):
        self.time, self.strain = struck_bar.scaled(struck_bar.TIME, struck_bar.RECORD)

    def test_the_record_has_the_figures_of_its_source(self):
        self.assertEqual(len(struck_bar.RECORD), 242)
        self.assertAlmostEqual(struck_bar.RECORD.sum(), 409374.5, delta=0.05)
        inside = (struck_bar.TIME >= 20) & (struck_bar.TIME <= 140)
        self.assertAlmostEqual(struck_bar.RECORD[inside].mean(), 2599, delta=3)  # of 121 or of 120 samples
        self.assertAlmostEqual(self.time[0], struck_bar.FIRST, delta=0.01)  # times start at the half rise
        self.assertAlmostEqual(self.strain.max(), 1.165, delta=1e-3)
        _, end = struck_bar.passing(self.time, self.strain, 0.5)
        self.assertAlmostEqual(end, 159.7, delta=0.05)
        np.testing.assert_allclose(
            struck_bar.extrema(self.time, self.strain),
            [struck_bar.MAXIMA, struck_bar.MINIMA],
            rtol=0,
            atol=0.05,  # as rounded
        )

    def test_rods_without_dispersion_do_not_ring(self):
        _, end = struck_bar.passing(self.time, self.strain, 0.5)
        thin = struck_bar.thin_rods(self.time, end, struck_bar.rise(self.time, self.strain))
        self.assertAlmostEqual(struck_bar.rise(self.time, thin), 9.27, delta=0.01)
        self.assertAlmostEqual(struck_bar.passing(self.time, thin, 0.5)[1], end, delta=1e-9)
        self.assertEqual(thin.max(), 1)
        self.assertGreater(np.std((thin - self.strain)[(self.time > 20) & (self.time < 85)]), 0.05)


class ObliqueImpactTest(unittest.TestCase):
    def test_gross_slip(self):
        psi1 = np.array([4 * CHI - 1, 4.9, 6, 20])
        exact = oblique.gross_slip(psi1, CHI)
        np.testing.assert_allclose(exact, psi1 - 4 * CHI)
        for solve in (oblique.springs, oblique.annuli):
            np.testing.assert_allclose(solve(psi1, CHI, 20).psi[-1], exact, atol=1e-9)
        self.assertTrue(np.isnan(oblique.gross_slip(4 * CHI - 1.01, CHI)))
        np.testing.assert_allclose(
            oblique.rigid_coulomb(np.array([1, 7, -7]), CHI), [0, 7 - 4 * CHI, 4 * CHI - 7]
        )
        # momentum: 2/7 of the change of v_t slows the centre by 2 μ v_n1, and 5/7 makes spin
        sliding = oblique.impact(0.3, 0.1, 6)
        self.assertAlmostEqual(sliding.slowing, 0.2, 9)
        self.assertAlmostEqual(sliding.spin, 0.5, 9)

    def test_springs_converge_to_annuli(self):
        fine = oblique.springs(SWEEP, CHI, 800).psi[-1]
        springs = [np.abs(oblique.springs(SWEEP, CHI, n).psi[-1] - fine).max() for n in (25, 50, 100, 200)]
        annuli = [np.abs(oblique.annuli(SWEEP, CHI, n).psi[-1] - fine).max() for n in (12, 24, 48)]
        self.assertLess(springs[-1], 2e-4)
        self.assertLess(annuli[-1], 2.5e-3)
        for errors in (springs, annuli):
            order = -np.polyfit(np.log2(2.0) * np.arange(len(errors)), np.log2(errors), 1)[0]
            self.assertGreater(order, 1.6)

    def test_energy(self):
        for poisson in (0, 0.3, 0.5):
            chi = oblique.chi(poisson)
            errors = []
            for cells in (100, 200):
                history = oblique.springs(SWEEP, chi, cells)
                self.assertGreaterEqual(np.diff(history.heat, axis=0).min(), -1e-15)
                lost = (SWEEP**2 - history.psi[-1] ** 2) / (4 * chi)
                errors.append(np.abs(lost - history.heat[-1]).max())
            self.assertLess(errors[1], 3e-4)
            self.assertLess(errors[1], 0.35 * errors[0])


class SphereTest(unittest.TestCase):
    P, MU, A = 40.0, 0.3, 2e-4
    C = mindlin.compliance((210e9, 0.3), (210e9, 0.3))

    def setUp(self):
        self.rest = (self.P, self.MU, self.A, self.C)

    def test_traction(self):
        r = (np.arange(200000) + 0.5) / 200000 * self.A
        for part in (0.2, 0.9, 1):
            q = mindlin.traction(r, part * self.MU * self.P, self.P, self.MU, self.A)
            whole = (2 * np.pi * r * q).sum() * self.A / 200000
            self.assertAlmostEqual(whole / (self.MU * self.P), part, 6)
        # the tractions move the stick circle by δ: kernel (2 - ν) / (4πG) / d for each body, at the centre ∫ q 2π dr
        q = mindlin.traction(r, 0.6 * self.MU * self.P, self.P, self.MU, self.A)
        centre = 2 * self.C / np.pi * (2 * np.pi * q).sum() * self.A / 200000
        shift = mindlin.displacement(0.6 * self.MU * self.P, *self.rest)
        self.assertAlmostEqual(centre / shift, 1, 6)

    def test_loop(self):
        point, weight = np.polynomial.legendre.leggauss(60)
        for part in (0.01, 0.3, 0.8, 1):
            top = part * self.MU * self.P
            args = (top, *self.rest)
            for T in (-top, top):
                self.assertAlmostEqual(mindlin.unloading(T, *args) / mindlin.reloading(T, *args), 1, 9)
            self.assertAlmostEqual(
                mindlin.unloading(top, *args) / mindlin.displacement(top, *self.rest), 1, 12
            )
            T = top * point  # ∮ T dδ = ∫ (δ_u - δ_r) dT
            area = top * (weight * (mindlin.unloading(T, *args) - mindlin.reloading(T, *args))).sum()
            self.assertAlmostEqual(mindlin.loop_energy(*args) / area, 1, 4)
        top = 1e-3 * self.MU * self.P
        small = 2 / 9 * self.C / self.A * top**3 / (self.MU * self.P)
        self.assertAlmostEqual(mindlin.loop_energy(top, *self.rest) / small, 1, 2)
        self.assertAlmostEqual(mindlin.unloading_stick_radius(0.5, 0.5, self.P, self.MU), 1)

    def test_springs_give_the_loop(self):
        """The reduction to springs of oblique_impact.py, under a constant normal force."""
        x = (np.arange(4000) + 0.5) / 4000
        room, w, force = 1 - x**2, np.zeros(4000), []
        path = np.concatenate([np.linspace(0, 0.6, 61), np.linspace(0.6, -0.6, 61)[1:]])
        for step in np.diff(path):
            w = np.clip(w + step, -room, room)
            force.append(1.5 * w.mean())
        first = mindlin.tangential_force(0.6, 1, 1, 1, 2 / 3)
        self.assertAlmostEqual(force[59], first, 6)
        back = mindlin.unloading(np.array(force[60:]), first, 1, 1, 1, 2 / 3)
        np.testing.assert_allclose(back, path[61:], atol=1e-5)


class ModalHertzTest(unittest.TestCase):
    MASS, SPEED, MODULUS, CURVATURE = 0.03, 0.3, 110e9, 0.01
    STIFFNESS = 4 / 3 * MODULUS * np.sqrt(CURVATURE)

    def impact(self, omega, shape, rate, step=1e-7):
        return modal_hertz.impact(*map(np.array, (omega, shape, rate)), self.STIFFNESS, step, 2.5e-4)

    def test_a_rigid_mass_follows_the_closed_form_of_hertz(self):
        start = self.SPEED * np.sqrt(self.MASS)
        time, force, rate, _ = self.impact([0.0], [1 / np.sqrt(self.MASS)], [start])
        duration, peak = hertz.impact(self.MASS, self.SPEED, self.MODULUS, self.CURVATURE)
        ((begin, end, highest),) = modal_hertz.episodes(time, force)
        self.assertEqual(begin, 0)
        # A step is 0.001 of the duration, and Hertz's 2.868 has four digits.
        self.assertAlmostEqual(end / duration, 1, delta=2e-3)
        self.assertAlmostEqual(highest / peak, 1, delta=1e-3)
        self.assertAlmostEqual(rate[0] / start, -1, delta=1e-5)

    def test_modes_agree_with_runge_and_kutta(self):
        omega, shape = np.array([0.0, 2e4, 1.1e5]), np.array([1 / np.sqrt(self.MASS), -4.0, 7.0])
        start = np.array([self.SPEED * np.sqrt(self.MASS), 0.0, 0.0])

        def motion(state):
            q, rate = np.split(state, 2)
            force = self.STIFFNESS * max(shape @ q, 0) ** 1.5
            return np.concatenate([rate, -(omega**2) * q - shape * force])

        state, tiny = np.concatenate([np.zeros(3), start]), 2.5e-8
        for _ in range(10000):
            one = motion(state)
            two = motion(state + tiny / 2 * one)
            three = motion(state + tiny / 2 * two)
            four = motion(state + tiny * three)
            state = state + tiny / 6 * (one + 2 * two + 2 * three + four)
        errors = []
        for step in (2e-7, 1e-7):
            rate = self.impact(omega, shape, start, step)[2]
            errors.append(np.abs(rate - state[3:]).max() / start[0])
        self.assertLess(errors[1], 1e-4)
        self.assertGreater(errors[0] / errors[1], 3)  # second order


if __name__ == "__main__":
    unittest.main()
