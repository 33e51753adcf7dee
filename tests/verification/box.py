"""A free cube and a clamped box on 1 to 3 ranks against Rayleigh-Ritz solutions, which share nothing with finite elements."""

import unittest

import h5py
import numpy as np

import ritz
from programs import ProgramTest, kernel

DENSITY, YOUNG, POISSON = 2700.0, 70e9, 0.33

GEO = """
SetFactory("Built-in");
DefineConstant[a = 1, b = 1, c = 1, n = 2];
Point(1) = {0, 0, 0}; Point(2) = {a, 0, 0}; Point(3) = {a, b, 0}; Point(4) = {0, b, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1:4} = n + 1; Transfinite Surface{1}; Recombine Surface{1};
box[] = Extrude {0, 0, c} { Surface{1}; Layers{n}; Recombine; };
Physical Volume("box") = {box[1]};
Physical Surface("foot") = {1};
Physical Surface("top") = {box[0]};
"""

SCENE = """
[bodies.box]
mesh = "box.geo"
order = 5
material = {{ density = {density}, young = {young}, poisson = {poisson} }}
contact = "top"
[obstacles.ceiling]
point = [0, 0, 2]
normal = [0, 0, -1]
[modes]
count = 40
residual_flexibility = false
[contact]
between = ["box", "ceiling"]
direction = [0, 0, 1]
[time]
duration = 1.0
"""


def multiplicities(frequencies, tolerance):
    """Sizes of groups of frequencies that agree."""
    groups = np.split(np.arange(len(frequencies)), np.flatnonzero(np.diff(frequencies) > tolerance * frequencies[1:]) + 1)
    return [len(group) for group in groups]


class Box(ProgramTest):
    def frequencies(self, sides, support, ranks):
        self.write("box.geo", GEO)
        scene = self.write("box.toml", SCENE.format(density=DENSITY, young=YOUNG, poisson=POISSON))
        a, b, c = sides
        out = self.folder / f"{ranks}"
        self.succeed(kernel(scene, out, f"bodies.box.geometry={{ a = {a}, b = {b}, c = {c}, n = 2 }}",
                            f"bodies.box.support={support}", ranks=ranks))
        (path,) = out.glob("box-*.kernel.h5")
        with h5py.File(path) as file:
            return file["modes/angular_frequency"][:] / (2 * np.pi)

    def compare(self, sides, support, degree, rigid, bound):
        oracle = ritz.box(sides, degree, DENSITY, YOUNG, POISSON, held=rigid == 0)[rigid:60]
        coarser = ritz.box(sides, degree - 2, DENSITY, YOUNG, POISSON, held=rigid == 0)[rigid:60]
        found = [self.frequencies(sides, support, ranks) for ranks in (1, 2, 3)]
        for frequencies in found:
            self.assertEqual(np.count_nonzero(frequencies == 0), rigid)
            elastic = frequencies[rigid:]
            n = len(elastic)
            self.assertGreaterEqual(n, 40 - rigid)
            # The oracle itself is converged well within the bound.
            self.assertLess(np.abs(coarser[:n] / oracle[:n] - 1).max(), bound / 2)
            error = np.abs(elastic / oracle[:n] - 1).max()
            print(f"box {sides}, support {support}: largest error of {n} elastic frequencies {error:.1e}")
            self.assertLess(error, bound)
            np.testing.assert_allclose(frequencies, found[0], rtol=1e-9)
        return found[0], oracle

    def test_free_cube_has_its_multiple_modes(self):
        found, oracle = self.compare((0.1, 0.1, 0.1), "{}", 10, 6, 1e-3)
        n = len(found) - 6
        groups = multiplicities(found[6:], 1e-6)
        self.assertEqual(groups, multiplicities(oracle[:n], 1e-6))
        self.assertEqual(max(groups), 3)

    def test_clamped(self):
        # Stresses are singular along the clamped edges: both converge slowly there.
        self.compare((0.1, 0.13, 0.17), '{ foot = "xyz" }', 9, 0, 1e-2)


if __name__ == "__main__":
    unittest.main()
