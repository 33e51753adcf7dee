# SPDX-License-Identifier: BSD-2-Clause
"""Bodies that are probably not those that are meant, from mesh to summary: ricochet-kernel and each impact print warnings."""

import math
import unittest

import scenes

from programs import ProgramTest, contact, kernel

CUBES = """
SetFactory("Built-in");
DefineConstant[cubes = 1];
For k In {0 : cubes - 1}
  p = newp; l = newl;
  Point(p) = {3 * k, 0, 0, 1}; Point(p + 1) = {3 * k + 1, 0, 0, 1};
  Point(p + 2) = {3 * k + 1, 1, 0, 1}; Point(p + 3) = {3 * k, 1, 0, 1};
  Line(l) = {p, p + 1}; Line(l + 1) = {p + 1, p + 2}; Line(l + 2) = {p + 2, p + 3}; Line(l + 3) = {p + 3, p};
  Curve Loop(100 + k) = {l : l + 3}; s = news; Plane Surface(s) = {100 + k};
  block[] = Extrude {0, 0, 1} { Surface{s}; };
  volume[k] = block[1]; foot[k] = s; top[k] = block[0]; edge[k] = l;
EndFor
Physical Volume("block") = {volume[]};
Physical Surface("foot") = {foot[]}; Physical Surface("first foot") = {foot[0]}; Physical Surface("top") = {top[]}; Physical Curve("edge") = {edge[]};
"""
SCENE = scenes.scene(
    {
        "block": """
mesh = "cubes.geo"
order = 2
material = { density = 1000.0, young = 1e7, poisson = 0.3 }
velocity = [0, 0, -1]
translate = [0, 0, 0.01]
contact = "foot"
"""
    },
    "count = 20",
    "",
    "rate_hz = 1e5\nduration = 0.05",
    {"floor": "normal = [0, 0, 1]"},
    "Cubes",
)


class Doubtful(ProgramTest):
    def warned(self, *sets):
        """Warnings of ricochet-kernel and of the impact, and the output of ricochet-kernel."""
        self.write("cubes.geo", CUBES)
        scene, out = self.write("scene.toml", SCENE), self.folder / f"out{len(list(self.folder.iterdir()))}"
        run = self.succeed(kernel(scene, out, *sets, quiet=False))
        self.succeed(contact(scene, out, *sets))
        return run.err, " ".join(self.summary(out)["warnings"]), run.out + run.err

    def test_a_usual_body_is_described_without_a_warning(self):
        kernel_warnings, impact_warnings, printed = self.warned()
        self.assertIn("block: mass 1000 kg, size 1 x 1 x 1 m, wave speed 100 m/s", printed)
        for doubt in ("not joined", "on lines", "m long", "mass of", "waves in", "through floor"):
            self.assertNotIn(doubt, kernel_warnings + impact_warnings)

    def test_each_doubt_is_stated_twice(self):
        for sets, doubt in (
            (
                ("bodies.block.geometry={cubes=2}",),
                "block consists of 2 parts that are not joined, with 12 rigid",
            ),
            (
                ("bodies.block.support={edge='xyz'}", "bodies.block.velocity=[0,0,0]"),
                "the supports of block hold x, y, z on lines or points only",
            ),
            (("bodies.block.scale=30",), "block is 30 m long"),
            (("bodies.block.material.young=210",), "waves in block run at 0.4583 m/s"),
        ):
            with self.subTest(sets=sets):
                kernel_warnings, impact_warnings, _ = self.warned(*sets)
                self.assertIn("warning: " + doubt, kernel_warnings)
                self.assertIn(doubt, impact_warnings)

    def test_a_part_without_candidates_that_passes_through_the_floor_is_found_from_the_mesh(self):
        """Two cubes in one mesh lean by 5 degrees; the second one is lower and arrives after 10 ms of 50 ms."""
        sets = (
            "bodies.block.geometry={cubes=2}",
            "bodies.block.rotate_deg=[0,5,0]",
            f"bodies.block.translate=[0,0,{4 * math.sin(math.radians(5)) + 0.01}]",
        )
        _, warnings, _ = self.warned(*sets, "bodies.block.contact=first foot")
        self.assertRegex(warnings, r"block passes 0\.0[34]\d* m through floor at t = 0\.0[45]")
        _, warnings, _ = self.warned(*sets)
        self.assertNotIn("through floor", warnings)


if __name__ == "__main__":
    unittest.main()
