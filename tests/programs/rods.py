# SPDX-License-Identifier: BSD-2-Clause
"""The two rods of the paper from mesh to impact, compared with the wave solution: they part at t = 2L/c = 20 with exchanged
velocities after a constant force of Zv/2 = 1/2 (Taylor & Papadopoulos 1993)."""

import pathlib
import tempfile
import unittest

import h5py
import numpy as np

from programs import MESHES, ProgramTest, contact, kernel

SCENE = MESHES / "two-rods" / "two-rods.toml"
STEP = 0.01


class Rods(ProgramTest):
    @classmethod
    def setUpClass(cls):
        scope = tempfile.TemporaryDirectory(prefix="ricochet-rods-")
        cls.addClassCleanup(scope.cleanup)
        cls.out = pathlib.Path(scope.name)
        run = kernel(SCENE, cls.out, ranks=2)
        assert run.status == 0, run.err

    def collide(self, *sets):
        for old in self.out.glob("two-rods.*"):
            old.unlink()
        self.succeed(contact(SCENE, self.out, *sets))
        with h5py.File(self.out / "two-rods.result.h5") as file:
            result = {
                name: file[name][:] for name in ("time", "contact/time", "contact/force", "contact/gap")
            }
            result["energy"] = {name: data[:] for name, data in file["energy"].items()}
        return self.summary(self.out), result

    def mean_force(self, result):
        """Mean force from t = 1 to 18, away from both ends of the contact."""
        inside = (result["contact/time"] > 1 + STEP / 2) & (result["contact/time"] < 18 + STEP / 2)
        return result["contact/force"][inside].sum() * STEP / 17

    def creep(self, summary, result):
        """Mean rate of penetration from t = 1 to 18."""
        time, gap = result["contact/time"], result["contact/gap"][:, 0]
        first, last = np.searchsorted(time, [1 - STEP / 2, 18 - STEP / 2])
        return (gap[first] - gap[last]) / (time[last] - time[first])

    def test_compliant_exchanges_the_velocities(self):
        summary, result = self.collide()
        self.assertAlmostEqual(summary["exit_velocity"]["moving"][0], 0, delta=0.01)
        self.assertAlmostEqual(summary["exit_velocity"]["resting"][0], 1, delta=0.01)
        self.assertAlmostEqual(summary["contact_end_s"], 20, delta=0.15)
        self.assertAlmostEqual(self.mean_force(result), 0.5, delta=0.005)
        self.assertLess(summary["max_penetration_m"], 1e-10)
        self.assertLess(summary["energy_lost_contact"], 0.005)
        energy = result["energy"]
        mechanical = energy["kinetic"] + energy["strain"] + energy["residual"]
        # A point that opens may take back what contact has removed before, but never more.
        self.assertLess(mechanical.max(), (1 + 1e-12) * mechanical[0])
        self.assertLess(summary["energy_drift"], 1e-12)

    def test_single_precision_gives_the_same_impact(self):
        double, forces = self.collide()
        single, narrow = self.collide("time.precision=single")
        self.assertEqual([double["precision"], single["precision"]], ["double", "single"])
        # 1e-6: ten times the round-off of a single-precision number.
        self.assertAlmostEqual(single["impulse_ns"], double["impulse_ns"], delta=1e-6 * double["impulse_ns"])
        self.assertAlmostEqual(
            single["exit_velocity"]["resting"][0], double["exit_velocity"]["resting"][0], delta=1e-6
        )
        # 2e-3: round-off 6e-8 of displacements of 10 m, for a hundred modes, divided by
        # the flexibility of a step, 0.01 m/N.
        first = slice(0, 500)
        difference = narrow["contact/force"][first] - forces["contact/force"][first]
        self.assertLess(abs(difference).max(), 2e-3 * forces["contact/force"].max())
        self.assertGreater(abs(difference).max(), 0)
        self.assertLess(single["energy_drift"], 1e-12)

    def test_jump_creeps_as_its_formula_says(self):
        summary, result = self.collide("contact.scheme=impulse", "contact.admittance=jump")
        # For finite elements with all modes, Ṅ(0+) of a rod end is the end entry of M⁻¹. With
        # 100 of the 101 modes, the share of the highest mode is missing. It follows from a
        # dense eigenproblem of the 101 nodes.
        elements, length = 100, 10.0
        h = length / elements
        element = np.zeros((elements + 1, elements + 1))
        stiffness = element.copy()
        for e in range(elements):
            element[e : e + 2, e : e + 2] += h / 6 * np.array([[2, 1], [1, 2]])
            stiffness[e : e + 2, e : e + 2] += np.array([[1, -1], [-1, 1]]) / h
        lower = np.linalg.inv(np.linalg.cholesky(element))
        _, vectors = np.linalg.eigh(lower @ stiffness @ lower.T)
        end = (lower.T @ vectors)[0, :100]
        admittance = (end**2).sum()
        pressure = 1 / (1 + 1 + STEP * (admittance + admittance) / 2)
        # The creep is steady except for the ripple of the truncated modes. The formula holds to three digits.
        self.assertAlmostEqual(self.mean_force(result) / pressure, 1, delta=2e-3)
        self.assertAlmostEqual(self.creep(summary, result) / (pressure * STEP * admittance), 1, delta=2e-3)
        # This admittance loses much energy in contact, which is the finding.
        self.assertGreater(summary["energy_lost_contact"], 0.2)

    def test_difference_neither_creeps_nor_loses_the_force(self):
        summary, result = self.collide("contact.scheme=impulse", "contact.admittance=difference")
        self.assertAlmostEqual(self.mean_force(result), 0.5, delta=0.005)
        # v Δ, reached in the first step. The modes, and hence v, are accurate to 1e-8.
        self.assertLessEqual(summary["max_penetration_m"], 1.0 * STEP * (1 + 1e-8))
        self.assertLess(abs(self.creep(summary, result)), 1e-4)

    def test_a_second_run_computes_no_kernel_again(self):
        before = {path: path.stat().st_mtime_ns for path in self.out.glob("*.kernel.h5")}
        self.succeed(kernel(SCENE, self.out, "bodies.moving.velocity=[2,0,0]"))
        self.assertEqual(before, {path: path.stat().st_mtime_ns for path in self.out.glob("*.kernel.h5")})


if __name__ == "__main__":
    unittest.main()
