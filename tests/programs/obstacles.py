# SPDX-License-Identifier: BSD-2-Clause
"""Obstacles with surfaces, from scenes to results: an elastic ball on a rigid one and on a stiff one, a box and its mesh, and what
files say about them."""

import struct
import unittest

import numpy as np
from dimensions import dimensions_of
from programs import ProgramTest, impact

from ricochet.pictures.planes import solids_of

RADIUS = 0.01
BALL = f"""SetFactory("OpenCASCADE");
Sphere(1) = {{0, 0, 0, {RADIUS}}};
Mesh.MeshSizeMax = 0.005;
Physical Volume("body") = {{1}};
Physical Surface("skin") = {{1}};
"""
STEEL = "young = {}, poisson = 0.3, density = {}"
BODY = """
[bodies.{name}]
mesh = "ball.geo"
order = 2
contact = "skin"
material = {{ {material} }}
{more}
"""
# One ball comes down on another one, or on an obstacle, both around points of the z axis.
SCENE = """{bodies}
{obstacle}
[modes]
up_to_hz = 3e5
[contact]
between = ["ball", "anvil"]
{contact}
[motion]
rotation = "{rotation}"
[time]
rate_hz = 2e6
duration = 1.2e-4
"""
UPPER = BODY.format(
    name="ball",
    material=STEEL.format(2e11, 7800),
    more=f"translate = [0, 0, {RADIUS}]\nvelocity = [0, 0, -0.3]",
)
BELOW = f"[0, 0, {-RADIUS - 1e-7}]"


def box_facets(size):
    """(12,3,3) the triangles of a box around the origin, anticlockwise seen from outside."""
    facets = []
    for axis in range(3):
        for sign in (-1, 1):
            corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])[::sign]
            face = np.insert(corner, 0, sign, axis=1)
            face = np.roll(face, axis, axis=1) * np.array(size) / 2
            facets += [face[[0, 1, 2]], face[[0, 2, 3]]]
    return np.array(facets)


def write_stl(path, facets):
    records = b"".join(struct.pack("<12fH", 0, 0, 0, *np.ravel(facet), 0) for facet in facets)
    path.write_bytes(bytes(80) + struct.pack("<I", len(facets)) + records)


def write_text_stl(path, facets):
    lines = ["solid box"]
    for facet in facets:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x!r} {y!r} {z!r}" for x, y, z in facet.tolist()]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid box"]))


class Obstacles(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        cls.out = cls.made / "out"
        (cls.made / "ball.geo").write_text(BALL)

    def run_of(self, name, bodies, obstacle="", rotation="linear", contact="", settings=()):
        path = self.made / f"{name}.toml"
        path.write_text(SCENE.format(bodies=bodies, obstacle=obstacle, rotation=rotation, contact=contact))
        return impact(path, self.out, f'title="{name}"', *settings)

    def test_a_ball_as_an_obstacle_acts_like_an_elastic_ball_1e4_times_as_stiff(self):
        """The other ball is also 1e4 times as dense, so that it stays: it takes 1e-4 of the speed, and its compliance is 1e-4."""
        stiff = BODY.format(name="anvil", material=STEEL.format(2e15, 7.8e7), more=f"translate = {BELOW}")
        rigid = f'[obstacles.anvil]\nshape = "sphere"\nradius = {RADIUS}\npoint = {BELOW}\n'
        for rotation in ("linear", "finite"):
            with self.subTest(rotation):
                elastic = self.run_of(f"stiff {rotation}", UPPER + stiff, rotation=rotation).summary
                found = self.run_of(f"rigid {rotation}", UPPER, rigid, rotation=rotation).summary
                for key in ("impulse_ns", "peak_force_n", "restitution"):
                    self.assertLess(abs(found[key] / elastic[key] - 1), 0.01, key)
                self.assertGreater(found["restitution"], 0.99)
                span = [one["contact_end_s"] - one["contact_start_s"] for one in (found, elastic)]
                self.assertLess(abs(span[0] / span[1] - 1), 0.02)  # in steps: 60 of 5e-7 s

    def test_a_box_acts_like_its_mesh_and_like_a_half_space(self):
        """The plane of one of its faces is all that the ball meets. Its coordinates in millimetres are numbers of single precision."""
        size = (0.06, 0.05, 0.02)
        write_stl(self.made / "box.stl", box_facets(1e3 * np.array(size)))
        write_text_stl(self.made / "text.stl", box_facets(1e3 * np.array(size)))
        lower = f"point = [0.004, 0.003, {-size[2] / 2}]\n"
        obstacles = {
            "plane": "[obstacles.anvil]\nnormal = [0, 0, 1]\n",
            "box": f'[obstacles.anvil]\nshape = "box"\nsize = {list(size)}\n{lower}',
            "mesh": f'[obstacles.anvil]\nsurface = "box.stl"\nscale = 1e-3\n{lower}',
            "text": f'[obstacles.anvil]\nsurface = "text.stl"\nscale = 1e-3\n{lower}',
        }
        friction = "friction = 0.2\ngap = 1e-7\n"
        sideways = ("bodies.ball.velocity=[0.1,0,-0.3]",)
        for rotation in ("linear", "finite"):
            found = {
                name: self.run_of(f"{name} {rotation}", UPPER, text, rotation, friction, sideways).summary
                for name, text in obstacles.items()
            }
            # With linear rotation, all have the same rows. With finite rotation, candidates around the point of a ball that touches have
            # springs of their own over a half-space only, which changes where the force acts, and so the spin.
            allowed = {"impulse_ns": 0.005, "peak_force_n": 0.02, "friction_impulse_ns": 0.15}
            for name in ("box", "mesh", "text"):
                with self.subTest(rotation, name=name):
                    for key, share in allowed.items():
                        difference = abs(found[name][key] / found["plane"][key] - 1)
                        self.assertLess(difference, share if rotation == "finite" else 1e-9, key)

    def test_a_result_holds_the_triangles_of_an_obstacle(self):
        rigid = (
            '[obstacles."the bowl"]\nshape = "sphere"\nside = "inside"\nradius = 0.05\npoint = [0, 0, 0.05]\n'
        )
        scene = SCENE.replace('"anvil"', '"the bowl"').replace("1.2e-4", "1e-5")
        path = self.made / "bowl.toml"
        path.write_text(scene.format(bodies=UPPER, obstacle=rigid, rotation="finite", contact="gap = 1e-6"))
        result = impact(path, self.out, 'title="bowl"')
        ((name, (node, element)),) = solids_of(result._file).items()
        self.assertEqual(name, "the bowl")
        self.assertLess(np.max(np.abs(np.linalg.norm(node - [0, 0, 0.05], axis=1) - 0.05)), 1e-15)
        found = dimensions_of(result.path)
        self.assertEqual(found["obstacles/1/node"], ["/obstacles/1/vertex", "/component"])
        self.assertEqual(found["obstacles/1/element"], ["/obstacles/1/triangle", "/obstacles/1/corner"])
        edges = {(a, b) for t in element.tolist() for a, b in zip(t, t[1:] + t[:1])}
        self.assertEqual(edges, {(b, a) for a, b in edges})


if __name__ == "__main__":
    unittest.main()
