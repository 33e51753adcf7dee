"""Balls of meshes/hertz against Hertz, and at rest also against an elastic ball in Legendre series: Hertz's is half a space,
and that of a ball approaches by 0.54 a/R less."""

import sys
import unittest

import h5py
import numpy as np

from elastic_ball import ElasticBall
from programs import MESHES, SOURCE, ProgramTest, contact, kernel

sys.path.append(str(SOURCE / "scripts"))
import hertz_theory as hertz

SCENES = MESHES / "hertz"
GRAVITY = 7485.97


class RestingBall(ProgramTest):
    def rest(self, size, *sets):
        out = self.folder / str(size)
        sets = [f"bodies.ball.geometry={{size={size}}}", *sets]
        self.succeed(kernel(SCENES / "resting-ball.toml", out, *sets))
        self.succeed(contact(SCENES / "resting-ball.toml", out, *sets))
        path = out / "resting-ball.result.h5"
        with h5py.File(path) as file:
            self.weight = hertz.QUARTERS * GRAVITY * file["bodies/ball"].attrs["mass"]
            self.reaction = file["bodies/ball/reaction"][0]
        return hertz.Contact(path, "ball"), self.summary(out)

    def test_radius_approach_and_pressure_converge_to_an_elastic_ball_and_are_near_hertz(self):
        errors = []
        for size in (1e-4, 5e-5, 2.5e-5):
            found, summary = self.rest(size)
            approach = summary["pairs"][0]["approach_m"]
            ideal = hertz.radius(found.total)
            self.assertAlmostEqual(found.total / self.weight, 1, delta=1e-10)
            self.assertLess(np.abs(self.reaction).max(), 1e-10 * self.weight)  # the planes of symmetry carry nothing
            self.assertLess(summary["max_penetration_m"], 1e-10 * approach)
            ball = ElasticBall(hertz.POISSON, 1.5 * ideal / hertz.RADIUS, 30)
            forces, depth = ball.press(found.total / hertz.YOUNG / hertz.RADIUS**2)
            exact = hertz.RADIUS * np.sqrt(2.5 * (forces * ball.square).sum() / forces.sum())
            errors.append(
                {
                    "radius": abs(found.radius() / exact - 1),
                    "approach": abs(approach / (hertz.RADIUS * depth) - 1),
                    "pressure": found.scatter(),
                    "radius of the area": abs(found.radius_of_area() / ideal - 1),
                }
            )
            print(size, ", ".join(f"{name} {100 * error:.2f} %" for name, error in errors[-1].items()))
        # Radius and area at the rate of h or faster, and pressure, rough at the edge, a little slower.
        for coarse, fine in zip(errors, errors[1:]):
            for name in coarse:
                self.assertLess(fine[name], 0.7 * coarse[name], name)
        self.assertLess(errors[-1]["radius"], 0.005)
        self.assertLess(errors[-1]["approach"], 0.002)
        self.assertLess(errors[-1]["pressure"], 0.1)
        self.assertLess(errors[-1]["radius of the area"], 0.02)
        self.assertAlmostEqual(found.radius() / ideal, 1, delta=0.02)
        self.assertAlmostEqual(approach / hertz.approach(found.total), 1, delta=0.02)

    def test_uzawa_agrees_with_the_exact_solver(self):
        exact, _ = self.rest(1e-4)
        slow, summary = self.rest(1e-4, "contact.solver=uzawa")
        self.assertGreater(summary["iterations"], 100)
        # It stops at 1e-9 of the gap closed; forces follow by the condition of the flexibility, some hundreds.
        self.assertLess(np.abs(slow.force - exact.force).max(), 1e-5 * exact.force.max())


class TwoBalls(ProgramTest):
    def test_contact_time_peak_force_and_rebound_are_those_of_hertz(self):
        scene = SCENES / "two-balls.toml"
        self.succeed(kernel(scene, self.folder))
        self.succeed(contact(scene, self.folder))
        summary = self.summary(self.folder)
        mass = hertz.DENSITY * 4 / 3 * np.pi * hertz.RADIUS**3
        time, peak = hertz.impact(mass / 2, 0.3, hertz.MODULUS / 2, hertz.RADIUS / 2)
        self.assertEqual(len(summary["episodes"]), 1)
        self.assertAlmostEqual((summary["contact_end_s"] - summary["contact_start_s"]) / time, 1, delta=0.03)
        self.assertAlmostEqual(hertz.QUARTERS * summary["peak_force_n"] / peak, 1, delta=0.03)
        # Waves keep little of an impact so slow: Hunter's estimate (1957) is below a thousandth of the energy.
        for body, sign in (("upper", 1), ("lower", -1)):
            self.assertAlmostEqual(summary["exit_velocity"][body][2], sign * 0.15, delta=0.01 * 0.15)


if __name__ == "__main__":
    unittest.main()
