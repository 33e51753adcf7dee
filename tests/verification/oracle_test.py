# SPDX-License-Identifier: BSD-2-Clause
"""The closed forms and reference solutions of contact, against their limits, balances of energy and other computations."""

import unittest

import numpy as np

import hertz_theory as hertz
import mindlin
import modal_hertz
import oblique_impact as oblique
import random_rods as rods

CHI = oblique.chi(0.3)
SWEEP = np.array([0.05, 0.2, 0.5, 0.9, 1, 1.2, 1.9, 2.7, 3.6, 4.2, 4.6])


class RodsTest(unittest.TestCase):
    """The waves of random_rods.py, against solutions by hand and a leapfrog of masses and springs."""

    def pair(self, length, seed=3):
        a, b = (rods.Rod(np.random.default_rng(seed)) for _ in range(2))
        b.length = length * a.length
        return a, b

    def test_equal_impedances(self):
        for length, clamped in ((1, False), (2.5, False), (2.5, True)):
            a, b = self.pair(length)
            first = rods.touches(rods.waves(a, b, clamped, 2.0, 3 * a.there_and_back), 3 * a.there_and_back)[
                0
            ]
            self.assertAlmostEqual(first[1] / a.there_and_back, 1, 6)  # the moving rod stops
            self.assertAlmostEqual(first[2] / (2 * a.mass), 1, 6)
        # A stiff short end is a wall: the rod returns.
        a, b = self.pair(1e-3)
        b.area *= 1e3
        ((_, _, impulse),) = rods.touches(
            rods.waves(a, b, True, 1.0, 2 * a.there_and_back), 2 * a.there_and_back
        )
        self.assertAlmostEqual(impulse / (2 * a.mass), 1, 2)

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


class ObliqueImpactTest(unittest.TestCase):
    def test_definitions(self):
        self.assertAlmostEqual(CHI, 3.5 * 0.7 / 1.7, 14)
        self.assertAlmostEqual(oblique.psi(0.3, 0.2, 0.1, 0.5), 2 * 0.7 / 1.7 / 0.2 * 0.1 / 0.5, 14)
        time, velocity, approach = oblique.steps(100)
        self.assertAlmostEqual(time[-1], oblique.DURATION, 6)
        np.testing.assert_allclose(velocity**2 + approach**2.5, 1, atol=1e-12)
        np.testing.assert_allclose(time + time[::-1], time[-1], rtol=1e-12)
        # δ = t to the lowest orders, and v_n² = 1 - δ^(5/2) between
        self.assertAlmostEqual(np.interp(0.02, time, approach), 0.02, 4)

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

    def test_sticking_circle_before_slip(self):
        """While the edge sticks, it gathers no slip: ψ1 < 1 has no heat until ψ = v_n."""
        history = oblique.history(0.3, [0.3])
        _, velocity, _ = oblique.steps(200)
        loading = (velocity > 0) & (np.abs(history.psi[:, 0]) < velocity - 0.02)
        self.assertTrue(loading.sum() > 100)
        self.assertEqual(history.heat[np.flatnonzero(loading)[-1], 0], 0)

    def test_springs_converge_to_annuli(self):
        fine = oblique.springs(SWEEP, CHI, 800).psi[-1]
        springs = [np.abs(oblique.springs(SWEEP, CHI, n).psi[-1] - fine).max() for n in (25, 50, 100, 200)]
        annuli = [np.abs(oblique.annuli(SWEEP, CHI, n).psi[-1] - fine).max() for n in (12, 24, 48)]
        self.assertLess(springs[-1], 2e-4)
        self.assertLess(annuli[-1], 2.5e-3)
        for errors in (springs, annuli):
            order = -np.polyfit(np.log2(2.0) * np.arange(len(errors)), np.log2(errors), 1)[0]
            self.assertGreater(order, 1.6)

    def test_histories_of_springs_and_annuli(self):
        psi1 = np.array([0.5, 1.9, 3.6])
        springs, annuli = oblique.springs(psi1, CHI, 48), oblique.annuli(psi1, CHI, 48)
        self.assertLess(np.abs(springs.force - annuli.force).max(), 0.02)
        self.assertTrue((np.abs(annuli.force) <= annuli.normal[:, None] + 1e-12).all())
        self.assertLess(np.mean(np.abs(springs.stick - annuli.stick)), 0.02)

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

    def test_error_and_symmetry(self):
        found = oblique.impact(0.3, 0.1, SWEEP)
        self.assertLess(found.error.max(), 5e-4)
        np.testing.assert_allclose(oblique.impact(0.3, 0.7, -SWEEP).psi2, -found.psi2, atol=1e-14)
        one = oblique.impact(0.3, 0.1, 0.5)
        self.assertAlmostEqual(one.psi2, found.psi2[2], 14)
        self.assertAlmostEqual(one.psi2, 0.04783, 4)
        ratio = 0.1 / oblique.stiffness_ratio(0.3)
        self.assertAlmostEqual(one.spin + one.slowing, ratio * (0.5 - one.psi2), 14)

    def test_minimum(self):
        """ψ2 passes through -1 at ψ1 = 4χ - 1 and is below just before."""
        psi2 = oblique.impact(0.3, 1, np.linspace(0.05, 4.75, 95)).psi2
        self.assertAlmostEqual(psi2.min(), -1.481, 3)
        self.assertTrue(psi2[0] > 0)


class SphereTest(unittest.TestCase):
    P, MU, A = 40.0, 0.3, 2e-4
    C = mindlin.compliance((210e9, 0.3), (210e9, 0.3))

    def setUp(self):
        self.rest = (self.P, self.MU, self.A, self.C)

    def test_first_loading(self):
        limit = self.MU * self.P
        force = np.linspace(0, 1, 11) * limit
        shift = mindlin.displacement(force, *self.rest)
        np.testing.assert_allclose(mindlin.tangential_force(shift, *self.rest), force, atol=1e-9 * limit)
        small = 1e-6 * limit
        shear = 210e9 / 2.6
        self.assertAlmostEqual(
            mindlin.displacement(small, *self.rest) / (2 * 1.7 / (8 * shear * self.A) * small), 1, 5
        )
        self.assertEqual(mindlin.tangential_force(1.0, *self.rest), limit)

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


class BeltTest(unittest.TestCase):
    ARGS = dict(mass=0.5, stiffness=800.0, speed=0.1, normal=20.0, static=0.4, dynamic=0.25)

    def test_direct_integration(self):
        m, k, v, n, mus, mud = self.ARGS.values()
        cycle = mindlin.belt(**self.ARGS)
        step, x, u, stuck = 1e-5, 0.0, v, True
        times, xs, switches = [], [], []
        for i in range(60000):
            times.append(i * step)
            xs.append(x)
            if stuck and k * x > mus * n:
                stuck = False
                switches.append((i * step, "slip"))
            if stuck:
                x += v * step
                continue
            before, half = u, u + step / 2 * (mud * n - k * x) / m
            x += step * half
            u = half + step / 2 * (mud * n - k * x) / m
            if u >= v > before and k * x < mud * n:
                stuck, u = True, v
                switches.append((i * step, "stick"))
        slips = [t for t, what in switches if what == "slip"]
        sticks = [t for t, what in switches if what == "stick"]
        self.assertGreater(len(slips), 2)
        np.testing.assert_allclose(np.diff(slips), cycle.period, atol=5e-5)
        np.testing.assert_allclose(np.subtract(sticks, slips[: len(sticks)]), cycle.slip, atol=5e-5)
        self.assertAlmostEqual(max(xs[20000:]), cycle.centre + cycle.amplitude, 5)
        self.assertAlmostEqual(min(xs[20000:]), cycle.centre - cycle.amplitude, 5)
        exact, _, _ = mindlin.belt_motion(np.array(times), **self.ARGS)
        np.testing.assert_allclose(xs, exact, atol=1e-5)

    def test_work(self):
        """The belt's work in a cycle is the heat; x and x' are continuous."""
        cycle = mindlin.belt(**self.ARGS)
        time = np.linspace(0, cycle.period, 400001) + 3 * cycle.period
        x, u, sticks = mindlin.belt_motion(time, **self.ARGS)
        friction = np.where(sticks, self.ARGS["stiffness"] * x, self.ARGS["dynamic"] * self.ARGS["normal"])
        work = self.ARGS["speed"] * np.mean(friction) * cycle.period
        self.assertAlmostEqual(work / cycle.heat, 1, 4)
        self.assertAlmostEqual(np.abs(np.diff(x)).max(), 0, 5)
        self.assertLess(np.abs(np.diff(u)).max(), 1e-3)
        self.assertAlmostEqual(((u[1:] + u[:-1]) / 2 * np.diff(time)).sum(), x[-1] - x[0], 6)

    def test_equal_friction(self):
        equal = mindlin.belt(0.5, 800, 0.1, 20, 0.3, 0.3)
        self.assertEqual(equal.stick, 0)
        self.assertAlmostEqual(equal.period, 2 * np.pi * np.sqrt(0.5 / 800), 12)
        with self.assertRaises(ValueError):
            mindlin.belt(0.5, 800, 0.1, 20, 0.2, 0.3)

    def test_oscillator(self):
        points, half = mindlin.coulomb_oscillator(0.5, 800, 0.1, 20, 0.4, 0.4)
        np.testing.assert_allclose(points, [0.1, -0.08, 0.06, -0.04, 0.02, 0], atol=1e-15)
        self.assertAlmostEqual(half, np.pi * 0.025, 12)


class RodTest(unittest.TestCase):
    def test_stopping(self):
        rod = mindlin.rod(2.0, 5000.0, 300.0, velocity=1.05, friction=60.0, pieces=20)
        # F_c/Z = 0.2: velocities 0.85, 0.45, 0.05, then 2q = -0.15 and stick
        np.testing.assert_allclose(rod.velocity[:8], [0.85, 0.85, 0.45, 0.45, 0.05, 0.05, 0, 0])
        self.assertAlmostEqual(rod.stop, 6 * 2 / 5000, 15)
        self.assertAlmostEqual(rod.energy[-1] / (2 * 300 * 2 / 5000 * 0.075**2), 1, 12)
        np.testing.assert_allclose(rod.energy + rod.heat, rod.energy[0], rtol=1e-13)
        self.assertAlmostEqual(rod.energy[0], 300 / 5000 * 2 * 1.05**2 / 2, 12)  # ρ A L = Z L/c
        self.assertEqual(mindlin.rod(2, 5000, 300, 0.1, 60, 9).stop, 0)

    def test_balances_with_pull(self):
        rod = mindlin.rod(2.0, 5000.0, 300.0, velocity=-0.37, friction=60.0, pieces=60, pull=75.0)
        np.testing.assert_allclose(rod.energy + rod.heat - rod.work, rod.energy[0], rtol=1e-11, atol=1e-12)
        impulse = np.concatenate([[0], np.cumsum(rod.friction + 75)]) * 2 / 5000
        mass = 300 * 2 / 5000
        np.testing.assert_allclose(mass * (rod.mean_velocity - rod.mean_velocity[0]), impulse, atol=1e-13)
        self.assertTrue((np.diff(rod.heat) >= 0).all())
        self.assertTrue(rod.stick.any() and not rod.stick.all())

    def test_direct_integration(self):
        """Finite volumes of the characteristics with fine cells: d'Alembert's solution shifted by one cell a step."""
        cells, length, c, z, limit, pull = 50, 2.0, 5000.0, 300.0, 60.0, 75.0
        p, q = np.full(cells, -0.185), np.full(cells, -0.185)
        found = []
        for _ in range(30 * cells):
            come, go = q[0], p[-1]
            start = 2 * come
            force = -start * z if abs(start) * z <= limit else -limit * np.sign(start)
            found.append(start + force / z)
            p = np.concatenate([[come + force / z], p[:-1]])
            q = np.concatenate([q[1:], [go + pull / z]])
        exact = mindlin.rod(length, c, z, -0.37, limit, 30, pull).velocity
        np.testing.assert_allclose(
            np.reshape(found, (30, cells)), exact[:, None] + np.zeros(cells), atol=1e-12
        )


class ModalHertzTest(unittest.TestCase):
    MASS, SPEED, MODULUS, CURVATURE = 0.03, 0.3, 110e9, 0.01
    STIFFNESS = 4 / 3 * MODULUS * np.sqrt(CURVATURE)

    def impact(self, omega, shape, rate, step=1e-7):
        return modal_hertz.impact(*map(np.array, (omega, shape, rate)), self.STIFFNESS, step, 2.5e-4)

    def test_a_rigid_mass_follows_the_closed_form_of_hertz(self):
        start = self.SPEED * np.sqrt(self.MASS)
        time, force, rate = self.impact([0.0], [1 / np.sqrt(self.MASS)], [start])
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
