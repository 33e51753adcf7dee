# SPDX-License-Identifier: BSD-2-Clause
"""A box that slides on a floor with friction, from mesh to result: what is printed, the memory that it needs, and which kernels are
computed. The manual compares its motion, its rest and its belt with Coulomb's law."""

import unittest

import h5py

from boxes import Box
from programs import BIN, ProgramTest, Run, contact, impact, kernel, settings

# The box is stiff enough to sag by 2e-4 m only. Strong damping brings it to rest on its foot within a few ms.
SCENE = """
title = "Slide"
[bodies.box]
mesh = "box.msh"
material = { density = 2.0, young = 3e4, poisson = 0.3 }
damping = { ratio = 0.3 }
contact = "foot"
velocity = [1, 0, 0]
[obstacles.floor]
normal = [0, 0, 1]
[modes]
count = 30
[contact]
between = ["box", "floor"]
gap = 1e-6
friction = 0.3
[time]
rate_hz = 8000
duration = 0.5
[loads]
gravity = [0, 0, -9.81]
"""


class Friction(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("box.msh", Box().gmsh())
        self.scene = self.write("slide.toml", SCENE)
        self.out = self.folder / "out"

    def kernels(self):
        return sorted(path.name for path in self.out.glob("*.kernel.h5"))

    def test_prints_its_figures(self):
        self.succeed(kernel(self.scene, self.out))
        text = self.succeed(contact(self.scene, self.out, quiet=False)).out
        for line in ("energy to friction", "friction impulse", "longest slip"):
            self.assertIn(line, text)
        smooth = self.succeed(contact(self.scene, self.out, "contact.friction=0", quiet=False)).out
        self.assertNotIn("friction", smooth)
        self.write("belt.csv", "0, 0\n10, 6\n")
        motion = 'loads.motion=[{obstacle="floor",vector=[0,1,0],history="belt.csv"}]'
        warned = self.succeed(contact(self.scene, self.out, "contact.friction=0", motion)).err
        self.assertIn("has no effect without friction", warned)

    def test_does_not_flicker_between_stick_and_slip_at_its_limit(self):
        """Pulled by exactly μ times its weight, a damped box comes to rest and stays in its states. Without damping its points
        bounce, so that the count has something to find."""
        scene = self.write("limit.toml", SCENE.replace("velocity = [1, 0, 0]\n", ""))
        pulls = (["loads.gravity=[2.943,0,-9.81]"], ["loads.gravity=[1.7658,2.3544,-9.81]"])
        for sets, calm in ((pulls[0], True), (pulls[1], True), ([*pulls[0], "bodies.box.damping={}"], False)):
            result = impact(scene, self.out, *sets)
            before, after = result.state[:-1], result.state[1:]
            changes = (before != after) & (before > 0) & (after > 0)
            late = result.contact_time[1:] > 0.1
            self.assertGreater(changes[~late].sum(), 0)
            self.assertEqual(late.sum() > 0 and changes[late].sum() == 0, calm, sets)
            if calm:
                self.assertLessEqual(changes.sum(axis=0).max(), 8)  # a few while it settles

    def test_names_a_sudden_load_on_a_body_that_lies_on_the_floor(self):
        """Its weight deforms it by round-off, as a free body falls; the sudden push presses its foot into the floor."""
        self.write("push.csv", "0, 1\n1, 1\n")
        push = (
            'body = "box"\nat = [0.0351225, 0.3491522, 0.2469295]\nvector = [1, 0, 0]\nhistory = "push.csv"\n'
        )
        text = SCENE.replace("velocity = [1, 0, 0]\n", "").replace("gap = 1e-6", "gap = 0")
        scene = self.write("push.toml", f'{text}[[loads.point]]\nname = "push"\n{push}')
        self.succeed(kernel(scene, self.out))
        self.refused(contact(scene, self.out), 'loads: "push" begins with the factor 1 at t = 0')

    def test_at_rest_takes_loads_in_as_many_parts_as_asked_for(self):
        self.write("push.csv", "t, factor\n0, 0\n1, 1\n")
        text = SCENE.replace("velocity = [1, 0, 0]\n", "").replace("gap", 'scheme = "static"\ngap')
        push = 'body = "box"\nat = [0.5, 0.35, 0]\nvector = [1, 0, 0]\nhistory = "push.csv"\n'
        scene = self.write("push.toml", f"{text}[[loads.point]]\n{push}")
        parts = ([], ["contact.increments=2"])  # of 20
        many, few = (impact(scene, self.out, *sets).summary["iterations"] for sets in parts)
        self.assertLess(few, many / 4)

    def test_needs_kernels_that_serve_all_other_coefficients(self):
        direction = "contact.direction=[0,0,-1]"
        self.succeed(kernel(self.scene, self.out))
        (rough,) = self.kernels()
        with h5py.File(self.out / rough) as file:
            self.assertEqual(file["surface/shape"].shape[1], 3)
            rows = file["surface/residual_flexibility"].shape[0]
            self.assertEqual(rows, 3 * len(file["surface/area"]))
        for same in (
            ["contact.friction=0.7"],
            ["contact.friction=0"],
            [direction],
            ["contact.friction={static=0.4,dynamic=0.2,stribeck_velocity=0.1}"],
        ):
            self.succeed(contact(self.scene, self.out, "time.duration=0.01", *same))
            self.succeed(kernel(self.scene, self.out, *same))
            self.assertEqual(self.kernels(), [rough], same)
        # Without friction, one direction is enough, and it is derived from the kernel of all.
        run = self.succeed(kernel(self.scene, self.out, direction, "contact.friction=0", quiet=False))
        self.assertEqual(len(self.kernels()), 2)
        self.assertIn(rough, run.out + run.err)

    def test_does_not_take_kernels_of_normals_alone(self):
        self.succeed(kernel(self.scene, self.out, "contact.friction=0"))
        (smooth,) = self.kernels()
        self.refused(contact(self.scene, self.out), "no kernel for body")
        self.succeed(kernel(self.scene, self.out))
        self.assertEqual(len(self.kernels()), 2)
        self.assertIn(smooth, self.kernels())

    def test_is_refused_where_its_matrices_exceed_the_memory(self):
        """361 points close together: 34 matrices of 1083 rows are 319 MB; without friction, 26 of 361 rows are 27 MB."""
        self.write("box.msh", Box(cells=(18, 18, 1)).gmsh())
        self.scene.write_text(SCENE.replace("count = 30", "count = 6\nresidual_flexibility = false"))
        self.succeed(kernel(self.scene, self.out))
        for limit_mb, sets, fits in ((380, [], False), (600, [], True), (380, ["contact.friction=0"], True)):
            words = [BIN / "ricochet-contact", self.scene, "--out", self.out, "--quiet"]
            run = Run(["prlimit", f"--as={limit_mb}000000", *words, *settings([*sets, "time.duration=4e-4"])])
            self.assertEqual(run.status, 0 if fits else 2, run.err)
            if not fits:
                need = r"361 contact points with friction need 0\.3\d+ GB of memory, and there are 0\.3\d+\. Set fewer"
                self.assertRegex(
                    run.err, rf"^ricochet-contact: \S+slide\.toml: {need} candidates: contact\.spacing.*\n$"
                )


if __name__ == "__main__":
    unittest.main()
