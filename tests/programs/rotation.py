# SPDX-License-Identifier: BSD-2-Clause
"""Which rotation a scene gets that does not give it: that of the key, to the last bit, by the angle by which a bar turns. The bar falls
on one of its ends, which turns it by some degrees within 20 ms. As a thin rigid rod that leaves the floor as fast as it came, its spin is
ω = 12 v cos α / (L (1 + 3 cos² α)), 16 rad/s."""

import json
import unittest
from unittest import mock

import h5py
import numpy as np

import ricochet
import scenes
from programs import Command, ProgramTest, contact, impact, kernel, scene_of

LENGTH, TILT, SPEED = 0.2, 30, 1.0  # m, degrees, m/s
BAR = """
SetFactory("OpenCASCADE");
DefineConstant[apart = 0];
Box(1) = {-0.1, -0.015, -0.01, 0.2 - apart, 0.03, 0.02};
volumes[] = {1};
If (apart > 0)
  Box(2) = {0.1 - apart / 2, -0.015, -0.01, apart / 2, 0.03, 0.02}; volumes[] = {1, 2};
EndIf
Mesh.MeshSizeMax = 0.02;
Physical Volume("bar") = {volumes[]};
"""
BODY = f"""
mesh = "bar.geo"
order = 1
contact = "all"
material = {{ young = 2e8, poisson = 0.35, density = 1200 }}
damping = {{ ratio = 0.02 }}
rotate_deg = [5, {TILT}, 0]
translate = [0, 0, 0.0612]
velocity = [0, 0, {-SPEED}]
"""
SHORT = "time.duration=2e-3"  # the touch begins at 1.4 ms
SMOOTH = ("contact.friction=0", "contact.direction=[0,0,-1]")


def differences(one, other):
    """The names of the data that differ in the files of two results."""
    found = []
    with h5py.File(one.path) as a, h5py.File(other.path) as b:

        def compare(name, item):
            if isinstance(item, h5py.Dataset) and not (
                name in b and np.array_equal(item[()], b[name][()], equal_nan=item.dtype.kind == "f")
            ):
                found.append(name)

        a.visititems(compare)
        if a.visititems(lambda name, _: None if name in b else name) or len(a) != len(b):
            found.append("names")
    return found


def turned(body):
    """The angle between the attitudes at the start and at the end [degrees]."""
    return np.degrees(2 * np.arccos(min(1, abs(body.attitude[0] @ body.attitude[-1]))))


class RotationOfABar(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        (cls.made / "bar.geo").write_text(BAR)
        cls.scene, cls.out = cls.made / "bar.toml", cls.made / "out"
        floor, time = {"floor": "normal = [0, 0, 1]"}, "rate_hz = 48000\nduration = 0.02"
        cls.scene.write_text(
            scenes.scene({"bar": BODY}, "up_to_hz = 4000", "friction = 0.2", time, floor, "Bar")
        )

    def run_as(self, title, *sets):
        return impact(self.scene, self.out, f"title={title}", *sets)

    def expect_finite(self, *sets):
        """The run without the key is that with it."""
        by_itself, given = self.run_as("itself", *sets), self.run_as("given", "motion.rotation=finite", *sets)
        self.assertEqual(by_itself.summary["rotation"], "finite")
        self.assertEqual(by_itself.scene["motion"]["rotation"], "finite")
        self.assertEqual(differences(by_itself, given), [])
        self.assertEqual(by_itself.summary["warnings"], given.summary["warnings"])
        return by_itself

    def expect_linear(self, *sets):
        by_itself, given = self.run_as("itself", *sets), self.run_as("given", "motion.rotation=linear", *sets)
        self.assertEqual(by_itself.summary["rotation"], "linear")
        self.assertEqual(differences(by_itself, given), [])
        return by_itself

    def test_is_finite_if_the_bar_spins(self):
        result = self.expect_finite("bodies.bar.angular_velocity=[0,0,30]", SHORT)
        self.assertAlmostEqual(turned(result.bodies["bar"]), np.degrees(30 * 2e-3), delta=0.5)

    def test_is_finite_if_the_impact_turns_the_bar(self):
        result = self.expect_finite()
        # The bar is not thin and vibrates, and its ends touch several times.
        self.assertGreater(turned(result.bodies["bar"]), 5)
        printed = self.succeed(contact(self.scene, self.out, quiet=False)).out
        self.assertIn("bar turns by more than 1 degree: repeated with finite rotation", printed)
        self.assertRegex(printed, r"rotation +finite: bar turns by more than 1 degree\n")

    def test_is_finite_if_the_impact_turns_the_bar_by_two_degrees(self):
        result = self.expect_finite("time.duration=4e-3")
        self.assertGreater(turned(result.bodies["bar"]), 1)
        self.assertLess(turned(result.bodies["bar"]), 4)

    def test_is_linear_if_the_impact_hardly_turns_the_bar(self):
        result = self.expect_linear(SHORT)
        self.assertGreater(result.summary["impulse_ns"], 0)
        tilt = np.radians(TILT)
        spin = 12 * SPEED * np.cos(tilt) / (LENGTH * (1 + 3 * np.cos(tilt) ** 2))
        self.assertLess(np.degrees(spin * 2e-3), 2)  # the most if it touched at once
        self.assertNotIn("rotation", result.scene.get("motion", {}))

    def test_is_linear_if_a_key_excludes_finite_ones(self):
        result = self.expect_linear("contact.reach=1")
        self.assertTrue(any("rotations are linearised" in text for text in result.summary["warnings"]))
        self.assertFalse(result.summary["needs_turning_kernels"])

    def test_is_linear_without_kernels_for_finite_ones_which_the_command_computes(self):
        out = self.folder
        self.succeed(kernel(self.scene, out, *SMOOTH))
        self.succeed(contact(self.scene, out, *SMOOTH))
        linear = ricochet.Result(out / "bar.result.h5")
        self.assertEqual(linear.summary["rotation"], "linear")
        self.assertTrue(linear.summary["needs_turning_kernels"])
        (warning,) = [text for text in linear.summary["warnings"] if "motion.rotation" in text]
        self.assertRegex(
            warning, r'^bar turned by \d+\.?\d* degrees, .* set motion.rotation = "finite" and run'
        )
        self.succeed(contact(self.scene, out, *SMOOTH, "title=given", "motion.rotation=linear"))
        self.assertEqual(differences(linear, ricochet.Result(out / "given.result.h5")), [])

        words = [
            "run",
            "-n",
            "1",
            self.scene,
            "--out",
            out,
            *[word for one in SMOOTH for word in ("--set", one)],
        ]
        with mock.patch("ricochet.cli.plot.draw"), mock.patch("ricochet.pages.write_page"):
            self.succeed(Command(*words))
            summary = json.loads((out / "bar.summary.json").read_text())
            self.assertEqual(summary["rotation"], "finite")
            self.assertIn("up to date", self.succeed(Command(*words)).out)
        # Their kernels are there now.
        self.succeed(contact(self.scene, out, *SMOOTH, "title=again"))
        self.assertEqual(ricochet.Result(out / "again.result.h5").summary["rotation"], "finite")

    def test_is_linear_if_finite_ones_fail(self):
        two = "bodies.bar.geometry.apart=0.02"  # one body of two parts, with twelve rigid modes
        result = self.expect_linear(two)
        self.assertTrue(any("12 rigid modes" in text for text in result.summary["warnings"]))

    def test_of_a_sweep_is_that_of_each_impact(self):
        scene = scene_of(self.scene, "title=study")
        study = ricochet.sweep(scene, {"time.duration": [2e-3, 0.02]}, out=self.out, jobs=1, ranks=1)
        np.testing.assert_array_equal(study["finite_rotation"], [0, 1])

    def test_of_a_simulation_is_what_its_start_says(self):
        kernels = ricochet.kernels(self.scene, 1, self.out)
        for spin, finite in ((0, False), (30, True)):
            scene = scene_of(self.scene, f"bodies.bar.angular_velocity=[0,0,{spin}]")
            simulation = ricochet.Simulation(scene, kernels)
            if finite:
                simulation.push("bar", [0, 0, 1], [0, 0, 0])
            else:
                with self.assertRaisesRegex(ricochet.InputError, "motion.rotation"):
                    simulation.push("bar", [0, 0, 1], [0, 0, 0])

    def test_by_accuracy_is_that_of_its_settings(self):
        results = {}
        for title, more in {"itself": [], "given": ["motion.rotation=finite"]}.items():
            out, sets = self.folder / title, [f"title={title}", "accuracy=0.5", *more]
            printed = self.succeed(kernel(self.scene, out, *sets, quiet=False)).out
            self.assertEqual("searches with finite rotation" in printed, not more)
            # From the settings, the search goes on with finite rotation.
            self.assertNotIn("searches", self.succeed(kernel(self.scene, out, *sets, quiet=False)).out)
            self.succeed(contact(self.scene, out, *sets))
            results[title] = ricochet.Result(out / f"{title}.result.h5")
        self.assertEqual(differences(results["itself"], results["given"]), [])
        self.assertEqual(results["itself"].summary["rotation"], "finite")
        self.assertGreater(results["itself"].summary["error_estimate"]["until_s"], 0)
        self.assertIn('rotation = "finite"', self.one(self.folder / "itself", "*.settings.toml").read_text())


if __name__ == "__main__":
    unittest.main()
