"""Free and clamped boxes on 1 to 3 ranks against Rayleigh-Ritz solutions in products of Legendre polynomials (resonant
ultrasound spectroscopy: Demarest 1971, J. Acoust. Soc. Am. 49, 768), which share nothing with finite elements."""

import unittest

import h5py
import numpy as np
from numpy.polynomial import legendre

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


def ritz_frequencies(sides, degree, held):
    """Frequencies [Hz], ascending, rigid ones included, by polynomials of up to `degree` in each of x, y and z; `held`:
    the face at the lowest z is clamped."""
    points, weights = legendre.leggauss(degree + 3)
    tables = []
    for axis, side in enumerate(sides):
        value = np.array([legendre.legval(points, c) for c in np.eye(degree + 1)])
        slope = np.array([legendre.legval(points, legendre.legder(c)) for c in np.eye(degree + 1)])
        if held and axis == 2:
            value, slope = value * (1 + points), slope * (1 + points) + value
        slope = slope * 2 / side
        weight = weights * side / 2
        tables.append({(p, q): (f * weight) @ g.T for p, f in enumerate((value, slope)) for q, g in enumerate((value, slope))})

    def product(a, b):
        """∫ ∂_a f_m ∂_b f_n over the box; a, b: axis or None."""
        factors = [tables[axis][int(a == axis), int(b == axis)] for axis in range(3)]
        return np.kron(np.kron(factors[0], factors[1]), factors[2])

    size, vectors = np.linalg.eigh(product(None, None))
    basis = vectors / np.sqrt(DENSITY * size)
    g = [[basis.T @ product(a, b) @ basis for b in range(3)] for a in range(3)]
    lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    shear = YOUNG / (2 * (1 + POISSON))
    laplace = g[0][0] + g[1][1] + g[2][2]
    stiffness = np.block(
        [[lame * g[a][b] + shear * g[b][a] + (shear * laplace if a == b else 0) for b in range(3)] for a in range(3)]
    )
    values = np.linalg.eigvalsh((stiffness + stiffness.T) / 2)
    return np.sqrt(np.maximum(values, 0)) / (2 * np.pi)


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
        oracle = ritz_frequencies(sides, degree, bool(rigid == 0))[rigid:60]
        coarser = ritz_frequencies(sides, degree - 2, bool(rigid == 0))[rigid:60]
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

    def test_free(self):
        self.compare((0.1, 0.13, 0.17), "{}", 10, 6, 1e-3)

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
