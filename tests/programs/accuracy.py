# SPDX-License-Identifier: BSD-2-Clause
"""The key `accuracy` in both programs: the settings that it chooses for rods reach it, compared with d'Alembert's waves, and the
summary names the cause if a scene cannot reach it."""

import tomllib
import unittest

import h5py

from programs import MESHES, ProgramTest, contact, kernel

ROD = MESHES / "two-rods" / "rod.geo"
SCENE = """
title = "Rods"
{accuracy}
[bodies.moving]
mesh = "{mesh}"
order = {order}
geometry = {{ elements = 60 }}
translate = [-10, 0, 0]
material = {{ density = 1, young = 1, area = 1 }}
velocity = [1, 0, 0]
contact = "right"

[bodies.resting]
mesh = "{mesh}"
order = {order}
geometry = {{ elements = 60 }}
material = {{ density = 1, young = 1, area = 1 }}
contact = "left"

[contact]
between = ["moving", "resting"]
direction = [1, 0, 0]

[time]
duration = 30
"""


class Accuracy(ProgramTest):
    def collide(self, *sets, accuracy=1e-2, order=3, computed=None):
        wanted = f"accuracy = {accuracy}" if accuracy else ""
        scene = self.write("rods.toml", SCENE.format(mesh=ROD, order=order, accuracy=wanted))
        out = self.folder / "out"
        self.succeed(kernel(scene, out, *(sets if computed is None else computed)))
        self.warned = self.succeed(contact(scene, out, *sets)).err
        with h5py.File(out / "rods.result.h5") as file:
            self.resolved = tomllib.loads(file.attrs["scene"].decode())
        return self.summary(out)

    def error(self, summary):
        """Largest deviation from the exact impact: the rods exchange velocities, and the impulse is the momentum of one."""
        velocity = summary["exit_velocity"]
        return max(
            abs(summary["impulse_ns"] / 10 - 1), abs(velocity["moving"][0]), abs(velocity["resting"][0] - 1)
        )

    def test_rods_reach_what_is_asked_for(self):
        for accuracy in (3e-2, 1e-2, 3e-3):
            with self.subTest(accuracy=accuracy):
                summary = self.collide(accuracy=accuracy)
                self.assertLess(self.error(summary), accuracy)
                self.assertLess(summary["error_estimate"]["total"], accuracy)
                self.assertEqual(
                    self.resolved["time"]["rate_hz"] * 30, round(self.resolved["time"]["rate_hz"] * 30)
                )
                self.assertIn(self.resolved["time"]["precision"], ("double", "single"))
                self.assertNotIn("accuracy =", self.warned)

    def test_the_shares_add_up_to_the_total(self):
        estimate = self.collide()["error_estimate"]
        total = estimate.pop("total")
        self.assertEqual(set(estimate), {"mesh", "modes", "step", "eigensolver", "precision", "spacing"})
        self.assertAlmostEqual(sum(estimate.values()), total, delta=1e-15)

    def test_what_is_given_stays_and_the_worst_cause_is_named(self):
        summary = self.collide("modes.count=4", "time.rate_hz=100", accuracy=1e-3)
        self.assertEqual(summary["modes"], {"moving": 4, "resting": 4})
        self.assertEqual(self.resolved["time"]["rate_hz"], 100)
        estimate = summary["error_estimate"]
        self.assertGreater(estimate["modes"], 0.5 * estimate["total"])
        self.assertGreater(3 * estimate["total"], self.error(summary))
        (warning,) = [w for w in summary["warnings"] if "accuracy" in w]
        self.assertRegex(
            warning,
            "above accuracy = 0.001; its largest share .* is that of the modes: use a higher modes.up_to_hz",
        )
        self.assertIn(warning, self.warned)

    def test_a_coarse_mesh_of_linear_elements_is_named(self):
        summary = self.collide(accuracy=1e-3, order=1)
        self.assertGreater(summary["error_estimate"]["mesh"], 1e-3)
        self.assertTrue(any("that of the mesh" in warning for warning in summary["warnings"]))

    def test_balls_are_run_with_fewer_points_where_that_hardly_matters(self):
        scene, out = MESHES / "hertz" / "two-balls.toml", self.folder / "balls"
        sets = [f"bodies.{body}.geometry={{size=1.6e-4}}" for body in ("upper", "lower")]
        self.succeed(kernel(scene, out, *sets, ranks=2))
        found = []
        for wanted in ([], ["accuracy=0.1", "time={duration=1.2e-4}"], ["accuracy=1e-4", "time.rate_hz=5e6"]):
            self.succeed(contact(scene, out, *sets, *wanted))
            found.append(self.summary(out))
        all_points, fewer, precise = found
        self.assertLess(fewer["candidates"], all_points["candidates"])
        self.assertEqual(precise["candidates"], all_points["candidates"])
        lasted = [s["contact_end_s"] - s["contact_start_s"] for s in found]
        self.assertAlmostEqual(lasted[1] / lasted[0], 1, delta=0.1)
        self.assertAlmostEqual(fewer["impulse_ns"] / all_points["impulse_ns"], 1, delta=0.01)

    def test_without_kernels_of_another_order_the_mesh_is_unknown(self):
        given = ["modes.count=20", "time.rate_hz=100"]
        summary = self.collide(*given, "accuracy=1e-1", accuracy=None, computed=given)
        self.assertIsNone(summary["error_estimate"]["mesh"])
        self.assertTrue(any("leaves out: mesh" in warning for warning in summary["warnings"]))

    def test_a_mesh_too_coarse_to_be_made_coarser_is_no_error(self):
        summary = self.collide("modes.count=150", "time.rate_hz=100")  # of 181 of order 3 and 121 of order 2
        self.assertIsNone(summary["error_estimate"]["mesh"])

    def test_nothing_is_estimated_unless_it_is_asked_for_or_something_touches(self):
        given = ["modes.count=5", "time.rate_hz=100"]
        self.assertIsNone(self.collide(*given, accuracy=None)["error_estimate"])
        self.assertIsNone(self.collide(*given, "bodies.moving.velocity=[-1,0,0]")["error_estimate"])
        self.assertIn("nothing touches", self.warned)


if __name__ == "__main__":
    unittest.main()
