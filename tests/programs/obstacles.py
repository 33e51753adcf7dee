# SPDX-License-Identifier: BSD-2-Clause
"""Obstacles with surfaces, from scenes to results: an elastic ball on a rigid one and on a stiff one, a box and its mesh, and what
files say about them."""

import pathlib
import struct
import unittest

import gmsh
import numpy as np
from dimensions import dimensions_of
from programs import ProgramTest, contact, impact, kernel

from ricochet.pictures.obstacles import shown_obstacles

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


def write_obj(path, size):
    """A box of quadrangles, with numbers of vertices from the first one and from the last one."""
    corners = box_facets(size).reshape(6, 6, 3)[:, [0, 1, 2, 5]].reshape(24, 3)
    lines = [
        "# a box",
        "o box",
        *(f"v {x!r} {y!r} {z!r}" for x, y, z in corners.tolist()),
        "vn 0 0 1",
        "s off",
    ]
    for first in range(1, 24, 4):
        lines.append(f"f {first} {first + 1}//1 {first + 2 - 25} {first + 3 - 25}//1")
    path.write_text("\n".join(lines))


def draw(path, make, faces=False, mesh=False):
    """Writes a drawing of what `make(occ)` adds, in millimetres. @param faces  remove the last face, and the volume
    @param mesh  write a mesh of its volume instead"""
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        occ = gmsh.model.occ
        make(occ)
        if faces:
            occ.remove([(3, 1)])
            occ.remove([(2, 6)])
        occ.synchronize()
        if mesh:
            gmsh.option.setNumber("Mesh.MeshSizeMax", 3)
            gmsh.model.mesh.generate(3)
            gmsh.model.mesh.setOrder(2)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


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
        write_obj(self.made / "box.OBJ", 1e3 * np.array(size))
        lower = f"point = [0.004, 0.003, {-size[2] / 2}]\n"
        obstacles = {
            "plane": "[obstacles.anvil]\nnormal = [0, 0, 1]\n",
            "box": f'[obstacles.anvil]\nshape = "box"\nsize = {list(size)}\n{lower}',
            "mesh": f'[obstacles.anvil]\nsurface = "box.stl"\nscale = 1e-3\n{lower}',
            "text": f'[obstacles.anvil]\nsurface = "text.stl"\nscale = 1e-3\n{lower}',
            "quadrangles": f'[obstacles.anvil]\nsurface = "box.OBJ"\nscale = 1e-3\n{lower}',
        }
        friction = "friction = 0.2\ngap = 1e-7\n"
        sideways = ("bodies.ball.velocity=[0.1,0,-0.3]",)
        for rotation in ("linear", "finite"):
            found = {
                name: self.run_of(f"{name} {rotation}", UPPER, text, rotation, friction, sideways).summary
                for name, text in obstacles.items()
            }
            # The rows are the same, but for the round-off of places.
            for name in obstacles:
                with self.subTest(rotation, name=name):
                    for key in ("impulse_ns", "peak_force_n", "friction_impulse_ns"):
                        self.assertLess(abs(found[name][key] / found["plane"][key] - 1), 1e-9, key)

    def test_a_result_holds_the_triangles_of_an_obstacle(self):
        rigid = (
            '[obstacles."the bowl"]\nshape = "sphere"\nside = "inside"\nradius = 0.05\npoint = [0, 0, 0.05]\n'
        )
        scene = SCENE.replace('"anvil"', '"the bowl"').replace("1.2e-4", "1e-5")
        path = self.made / "bowl.toml"
        path.write_text(scene.format(bodies=UPPER, obstacle=rigid, rotation="finite", contact="gap = 1e-6"))
        result = impact(path, self.out, 'title="bowl"')
        ((name, bowl),) = shown_obstacles(result._file, result.scene, -np.ones(3), np.ones(3)).items()
        self.assertEqual(name, "the bowl")
        self.assertLess(np.max(np.abs(np.linalg.norm(bowl.at(0) - [0, 0, 0.05], axis=1) - 0.05)), 1e-15)
        found = dimensions_of(result.path)
        self.assertEqual(found["obstacles/1/node"], ["/obstacles/1/vertex", "/component"])
        self.assertEqual(found["obstacles/1/element"], ["/obstacles/1/triangle", "/obstacles/1/corner"])
        edges = {(a, b) for t in bowl.element.tolist() for a, b in zip(t, t[1:] + t[:1])}
        self.assertEqual(edges, {(b, a) for a, b in edges})

    def drawn(self, name, lower, extra="", rotation="linear"):
        """The scene of a ball on this drawing, without a run."""
        path = self.made / f"{pathlib.Path(name).stem}.toml"
        text = f'[obstacles.anvil]\nsurface = "{name}"\nscale = 1e-3\npoint = {lower}\n{extra}'
        path.write_text(SCENE.format(bodies=UPPER, obstacle=text, rotation=rotation, contact=""))
        return path

    def test_a_drawing_acts_like_its_closed_form(self):
        """A zone of contact of 0.2 mm lies within a few triangles of 0.7 mm. Their curvature there differs by about a tenth, and the
        force of a Hertzian impact depends on it to the power of 1/5. Steps are the same."""
        round_ones = {
            "sphere": (lambda occ: occ.addSphere(0, 0, 0, 10), "ball.step", f"radius = {RADIUS}\n"),
            "cylinder": (
                lambda occ: occ.addCylinder(-20, 0, 0, 40, 0, 0, 10),
                "rod.brep",
                f"radius = {RADIUS}\nlength = 0.04\nrotate_deg = [0, 90, 0]\n",
            ),
        }
        for shape, (make, name, sizes) in round_ones.items():
            draw(self.made / name, make)
            for rotation in ("linear", "finite"):
                with self.subTest(shape, rotation=rotation):
                    closed = f'[obstacles.anvil]\nshape = "{shape}"\npoint = {BELOW}\n{sizes}'
                    exact = self.run_of(f"{shape} {rotation}", UPPER, closed, rotation).summary
                    scene = self.drawn(name, BELOW, "size_factor = 0.5\n", rotation)
                    found = impact(scene, self.out, f'title="{name} {rotation}"').summary
                    for key, share in (("impulse_ns", 0.01), ("peak_force_n", 0.03)):
                        self.assertLess(abs(found[key] / exact[key] - 1), share, key)
            (stored,) = self.out.glob("anvil-*.stl")
            deviation = 1e-3 * float(stored.read_text().split("\n", 1)[0].split()[-1])
            # Half of what flat triangles of s = 0.7 mm are off, s²/(8 R)
            self.assertTrue(0 < deviation < 3e-6, deviation)
            stored.unlink()

    def test_a_mesh_of_volumes_is_an_obstacle_by_its_outer_faces(self):
        draw(self.made / "block.msh", lambda occ: occ.addBox(-30, -25, -20, 60, 50, 20), mesh=True)
        plane = "[obstacles.anvil]\nnormal = [0, 0, 1]\n"
        exact = self.run_of("plane of a block", UPPER, plane, contact="gap = 1e-7\n").summary
        path = self.drawn("block.msh", "[0.0041, 0.0032, -1e-7]")
        found = impact(path, self.out, 'title="block"').summary
        self.assertLess(abs(found["impulse_ns"] / exact["impulse_ns"] - 1), 1e-6)
        (stored,) = self.out.glob("anvil-*.stl")
        stored.unlink()

    def test_what_is_no_closed_surface_is_refused_in_one_line_on_all_ranks(self):
        draw(self.made / "shell.brep", lambda occ: occ.addBox(-5, -5, -5, 10, 10, 10), faces=True)
        out = self.folder / "out"
        self.refused(
            kernel(self.drawn("shell.brep", BELOW), out, ranks=2),
            "shell.brep",
        )
        self.refused(
            kernel(self.drawn("none.step", BELOW), out, ranks=2), "obstacles.anvil.surface", "no such file"
        )
        (self.made / "odd.step").write_text("no drawing")
        self.refused(kernel(self.drawn("odd.step", BELOW), out, ranks=2), "odd.step")
        self.assertFalse(list(out.glob("*.stl")) + list(out.glob("*.partial")))
        write_obj(self.made / "plate.obj", (60, 50, 20))
        kernel(self.drawn("plate.obj", "[0, 0, -0.01]"), out)
        for text, complaint in (("v 0 0 0\nv 1 0 0\nf 1 2 3\n", "line 3"), ("v 0 0\n", "line 1")):
            (self.made / "odd.obj").write_text(text)
            self.refused(contact(self.drawn("odd.obj", BELOW), out), "odd.obj", f": {complaint} is no")

    def test_a_program_without_gmsh_names_the_command_that_makes_the_triangles(self):
        draw(self.made / "ball.step", lambda occ: occ.addSphere(0, 0, 0, 10))
        path = self.drawn("ball.step", BELOW)
        self.refused(
            contact(path, self.folder), "the triangles of ball.step are not at", f"Run ricochet-kernel {path}"
        )


if __name__ == "__main__":
    unittest.main()
