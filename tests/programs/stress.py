# SPDX-License-Identifier: BSD-2-Clause
"""Stress and strain at gauges, from mesh to result, compared with closed forms: at rest under contact, in bending, in a rod that
hits a wall, and under friction with both kinds of rotation."""

import unittest

import numpy as np

import h5py

import scenes
from programs import ProgramTest, impact, kernel
from ricochet import principal_stresses, von_mises
from ricochet.pictures.gauges import gauges_picture
from ricochet.pictures.loaded_result import LoadedResult

BLOCK = """
SetFactory("Built-in");
Point(1) = {0, 0, 0}; Point(2) = {LENGTH, 0, 0}; Point(3) = {LENGTH, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = ALONG + 1; Transfinite Curve{2, 4} = 3; Transfinite Surface{1}; Recombine Surface{1};
block[] = Extrude {0, 0, HEIGHT} { Surface{1}; Layers{LAYERS}; Recombine; };
Physical Volume("block") = {block[1]};
Physical Surface("foot") = {1}; Physical Surface("top") = {block[0]};
Physical Surface("right") = {block[3]}; Physical Surface("left") = {block[5]};
Physical Surface("sides") = {block[2], block[3], block[4], block[5]};
"""


def block(length=1, along=2, height=2, layers=4):
    sizes = {"LENGTH": length, "ALONG": along, "HEIGHT": height, "LAYERS": layers}
    text = BLOCK
    for name, value in sizes.items():
        text = text.replace(name, str(value))
    return text


def gauge(name, body, more):
    return f'[[output.gauge]]\nname = "{name}"\nbody = "{body}"\n{more}\n'


def histories(result):
    """Times and, by name, the stress (K,6) and the strain (K), if there is one, of the gauges."""
    return result.gauge_time, {name: (gauge.stress, gauge.strain) for name, gauge in result.gauges.items()}


class Stress(ProgramTest):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"

    def check_envelope(self, result, body, snapshots):
        """Compares the envelope of a surface with all steps, each of which is a snapshot. NumPy makes all of its figures. The
        kernel and the products of this test are in single precision; 1e-5 is some of its roundings."""
        stress = result.surface_stress(body)
        self.assertEqual(len(stress), snapshots)
        time = result.snapshots["time"]
        ends = principal_stresses(stress)
        figures = {
            "von_mises": von_mises(stress),
            "principal": ends[..., 0],
            "shear": (ends[..., 0] - ends[..., 2]) / 2,
        }
        envelope = result.stress[body]
        largest = figures["von_mises"].max()
        nodes = np.arange(stress.shape[1])
        for name, all_steps in figures.items():
            found, when = getattr(envelope, name), getattr(envelope, f"{name}_time")
            np.testing.assert_allclose(
                found, all_steps.max(axis=0), rtol=0, atol=1e-5 * largest, err_msg=name
            )
            at = np.abs(time[:, None] - when).argmin(axis=0)
            np.testing.assert_allclose(time[at], when, rtol=0, atol=1e-12)
            np.testing.assert_allclose(all_steps[at, nodes], found, rtol=0, atol=1e-5 * largest)
        peak = result.summary["stress"][body]
        self.assertGreaterEqual(peak["von_mises_pa"], envelope.von_mises.max())
        return stress

    # σ_zz = −ρ g (H − z) in the axes of the body, which lies on its back. The contact carries all of it, and
    # elements of order 2 hold the exact displacement.
    def test_a_block_at_rest_carries_the_weight_above(self):
        self.write("block.geo", block())
        density, young, g, height, strength = 3.0, 1e5, 2.0, 2.0, 10.0
        body = f"""
mesh = "block.geo"
order = 2
material = {{ density = {density}, young = {young}, poisson = 0.0, yield = {strength} }}
contact = "foot"
support = {{ sides = "xy" }}
rotate_deg = [90, 0, 0]
"""
        points = {
            "foot": (0.5, 0.5, 0.0),
            "inside": (0.3, 0.4, 0.7),
            "edge": (1.0, 1.0, 1.0),
            "top": (0.5, 0.5, 2.0),
        }
        more = f"[loads]\ngravity = [0, {g}, 0]\n[output]\nstress = true\nsnapshot_every = 1\n"
        for name, (x, y, z) in points.items():
            in_world = f"at = [{x}, {-z}, {y}]\ndirection = [0, 1, 0]"
            in_body = f"at_body = [{x}, {y}, {z}]\ndirection = [0, 0, 1]"
            more += gauge(name, "block", in_body if name == "inside" else in_world)
        text = scenes.scene(
            {"block": body},
            "count = 3",
            'scheme = "static"',
            "duration = 1.0",
            {"floor": "normal = [0, -1, 0]"},
            "Weight",
            more,
        )
        result = impact(self.write("weight.toml", text), self.out)
        time, gauges = histories(result)
        self.assertEqual(time.shape, result.time.shape)
        largest = density * g * height
        for name, (_, _, z) in points.items():
            stress, strain = gauges[name]
            exact = -density * g * (height - z)
            # Round-off of the static response, which spans stiffnesses of contact and bulk.
            np.testing.assert_allclose(
                stress[-1], [0, 0, exact, 0, 0, 0], rtol=0, atol=1e-6 * largest, err_msg=name
            )
            self.assertAlmostEqual(strain[-1], exact / young, delta=1e-6 * largest / young)
        stress = self.check_envelope(result, "block", 1)[0]
        with h5py.File(next(self.out.glob("block-*.kernel.h5"))) as file:
            height_of = file["view/node"][:, 2]
        exact = np.zeros_like(stress)
        exact[:, 2] = -density * g * (height - height_of)
        np.testing.assert_allclose(stress, exact, rtol=0, atol=1e-5 * largest)  # single precision
        peak = result.summary["stress"]["block"]
        self.assertAlmostEqual(peak["von_mises_pa"], largest, delta=1e-5 * largest)
        self.assertAlmostEqual(peak["at"][2], 0, delta=1e-12)
        self.assertAlmostEqual(peak["ratio_to_yield"], largest / strength, delta=1e-5)
        self.assertTrue(any("of block reaches" in w and "1.2 times yield" in w for w in result.warnings))

    # Bending by a dead shear force at the end: σ_xx = F (L − x) z / I and σ_xz = −(3/2) F/A in the middle.
    def test_a_cantilever_bends_as_a_beam(self):
        length, load = 8.0, 0.01
        self.write("beam.geo", block(length, 16, 1, 2))
        body = """
mesh = "beam.geo"
order = 2
material = { density = 1.0, young = 1e5, poisson = 0.0 }
contact = "right"
support = { left = "xyz" }
"""
        more = f'[[loads.traction]]\nbody = "beam"\ngroup = "right"\nvector = [0, 0, {-load}]\n'
        places = {"upper": (3, 0.5, 1), "lower": (3, 0.5, 0), "middle": (4, 0.5, 0.5)}
        more += "[output]\nstress = true\n"
        for name, at in places.items():
            more += gauge(name, "beam", f"at = {list(at)}\ndirection = [1, 0, 0]\nlength = 1.0")
        text = scenes.scene(
            {"beam": body},
            "count = 4",
            "",
            "rate_hz = 1000\nduration = 0.01",
            {"wall": "point = [20, 0, 0]\nnormal = [-1, 0, 0]"},
            "Beam",
            more,
        )
        result = impact(self.write("beam.toml", text), self.out)
        time, gauges = histories(result)
        self.assertEqual(len(time), 11)
        bending = load * (length - 3) * 0.5 / (1 / 12)
        for row in (0, -1):  # it starts in equilibrium and stays there
            for name, sign in (("upper", 1), ("lower", -1)):
                stress, strain = gauges[name]
                self.assertAlmostEqual(stress[row, 0], sign * bending, delta=0.01 * bending)
                self.assertAlmostEqual(strain[row], sign * bending / 1e5, delta=0.01 * bending / 1e5)
                self.assertLess(np.abs(stress[row, 1:]).max(), 0.01 * bending)
            shear = gauges["middle"][0][row, 4]
            self.assertAlmostEqual(shear, -1.5 * load, delta=0.03 * 1.5 * load)
        with h5py.File(next(self.out.glob("beam-*.kernel.h5"))) as file:
            node = file["view/node"][:]
        # On the upper and lower faces, a height away from the support and from the load (Saint-Venant).
        seen = (np.abs(node[:, 2] - 0.5) > 0.49) & (node[:, 0] > 1) & (node[:, 0] < length - 1)
        self.assertGreater(seen.sum(), 50)
        exact = load * (length - node[seen, 0]) * 0.5 / (1 / 12)
        np.testing.assert_allclose(result.stress["beam"].von_mises[seen], exact, rtol=0, atol=0.01 * bending)

    # A wave of σ = −ρ c v runs from the wall to the free end and back; then the rod is free of stress.
    def test_a_rod_on_a_wall_has_the_stress_of_the_wave(self):
        elements, speed = 200, 0.01
        self.write("rod.geo", scenes.rod(1, elements))
        rod = f'mesh = "rod.geo"\norder = 1\nmaterial = {{ density = 1.0, young = 1.0, area = 1.0 }}\nvelocity = [{-speed}, 0, 0]\ncontact = "left"'
        places = (0.1, 0.5, 0.8)
        more = "[output]\nstress = true\nsnapshot_every = 1\n"
        more += "".join(gauge(f"at {x}", "rod", f"at = [{x}, 0, 0]\ndirection = [1, 0, 0]") for x in places)
        text = scenes.scene(
            {"rod": rod},
            f"count = {elements + 1}",
            "",
            "rate_hz = 1000\nduration = 2.5",
            {"wall": "normal = [1, 0, 0]"},
            "Wave",
            more,
        )
        result = impact(self.write("wave.toml", text), self.out)
        time, gauges = histories(result)
        for x in places:
            stress, strain = gauges[f"at {x}"]
            np.testing.assert_allclose(strain, stress[:, 0], rtol=0, atol=1e-12)  # E = 1
            self.assertEqual(np.abs(stress[:, 1:]).max(), 0)
            inside = (time > x + 0.02) & (time < 2 - x - 0.02)
            self.assertAlmostEqual(stress[inside, 0].mean(), -speed, delta=0.01 * speed)
            arrival = time[np.argmax(stress[:, 0] < -speed / 2)]
            self.assertAlmostEqual(arrival, x, delta=1.5 / elements)
            after = time > 2 - x + 0.05
            self.assertLess(abs(stress[after, 0].mean()), 0.02 * speed)
        # The envelope is that of all steps; here, each of them is a row.
        stress = self.check_envelope(result, "rod", len(time))
        with h5py.File(next(self.out.glob("rod-*.kernel.h5"))) as file:
            place = file["view/node"][:, 0]
        for x in places:
            np.testing.assert_allclose(
                stress[:, np.abs(place - x).argmin()], gauges[f"at {x}"][0], rtol=0, atol=1e-5 * speed
            )
        peak = result.summary["stress"]["rod"]
        self.assertEqual(peak["von_mises_pa"], result.stress["rod"].von_mises.max())
        self.assertIsNone(peak["gauge"])
        worst = result.stress["rod"].von_mises.argmax()
        self.assertAlmostEqual(peak["at"][0], place[worst], delta=1e-12)
        self.assertEqual(peak["time_s"], result.stress["rod"].von_mises_time[worst])
        self.assertIsNone(peak["ratio_to_yield"])

    # Both kinds of rotation have their own paths from forces to candidates.
    def test_finite_and_linear_rotation_agree_under_friction(self):
        self.write("block.geo", scenes.skewed_block(0.5))
        more = gauge("low", "block", "at_body = [0.5, 0.5, 0.15]\ndirection = [1, 0, 1]")
        more += gauge("skin", "block", "at_body = [0.5, 0, 0.3]")
        more += "[output]\nstress = true\nsnapshot_every = 1\n"
        scene = self.write("slide.toml", scenes.sliding_block(more))
        linear = impact(scene, self.out, "motion.rotation=linear")
        finite = impact(scene, self.out, "motion.rotation=finite")
        (time, one), (_, other) = histories(linear), histories(finite)
        for name, (stress, strain) in one.items():
            largest = np.abs(stress).max()
            self.assertGreater(largest, 1e-4)
            self.assertGreater(np.abs(stress[:, 3:]).max(), 0.05 * largest)  # friction shears it
            self.assertLess(np.abs(other[name][0] - stress).max(), 0.03 * largest, name)
        for result in (linear, finite):
            self.check_envelope(result, "block", len(time))
        self.assertEqual(time[0], 0)
        self.check_picture(finite)

    def check_picture(self, result):
        """Compares the curves of the picture with the rows, for a gauge with a direction and one without."""
        stresses, strains = gauges_picture(LoadedResult(result.path)).axes
        curves = {line.get_label(): line for line in stresses.lines}
        self.assertEqual(sorted(curves), ["low", "skin"])
        factor = {"Pa": 1, "mPa": 1e3}[stresses.get_ylabel().removeprefix("von Mises stress (")[:-1]]
        for name, line in curves.items():
            np.testing.assert_allclose(line.get_ydata(), factor * von_mises(result.gauges[name].stress))
            np.testing.assert_allclose(line.get_xdata(), result.gauge_time)  # some seconds
        self.assertEqual((strains.get_ylabel(), strains.get_xlabel()), ("strain (10⁻⁶)", "time (s)"))
        (line,) = strains.lines
        self.assertEqual((line.get_label(), line.get_color()), ("low", curves["low"].get_color()))
        np.testing.assert_allclose(line.get_ydata(), 1e6 * result.gauges["low"].strain)

    def test_rows_are_as_many_as_those_of_receivers(self):
        self.write("rod.geo", scenes.rod(1, 20))
        rod = 'mesh = "rod.geo"\norder = 1\nmaterial = { density = 1.0, young = 1.0, area = 1.0 }\nvelocity = [-0.01, 0, 0]\ncontact = "left"'
        more = "[output]\nreceivers_rate_hz = 50\n" + gauge("mid", "rod", "at = [0.5, 0, 0]")
        text = scenes.scene(
            {"rod": rod},
            "count = 21",
            "",
            "rate_hz = 1000\nduration = 2.0",
            {"wall": "normal = [1, 0, 0]"},
            "Rows",
            more,
        )
        time, gauges = histories(impact(self.write("rows.toml", text), self.out))
        np.testing.assert_allclose(time, np.arange(101) / 50, rtol=0, atol=1e-12)
        self.assertEqual(gauges["mid"][0].shape, (101, 6))
        self.assertIsNone(gauges["mid"][1])

    def test_sampled_responses_have_none(self):
        self.write("block.geo", block())
        text = scenes.block_on_floor("Table", "count = 8", 'kernel = "table"\ngap = 0.1', "duration = 1.0")
        scene = self.write("table.toml", text + gauge("low", "block", "at = [0.5, 0.5, 0.2]"))
        self.refused(kernel(scene, self.out), "output.gauge", 'kernel = "table" gives no stress')


if __name__ == "__main__":
    unittest.main()
