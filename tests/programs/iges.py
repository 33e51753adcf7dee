# SPDX-License-Identifier: BSD-2-Clause
"""Drawings in IGES, written from the specification: the faces of a box, which know nothing of each other. The oracle is the
box, in inches."""

import itertools
import unittest

import numpy as np
import ricochet
from programs import Command, ProgramTest, kernel

SIDES, INCH, DENSITY = (1.0, 2.0, 3.0), 25.4, 7850.0
SCENE = f"""[bodies.box]
mesh = "box.igs"
scale = 1e-3
order = 1
material = {{ density = {DENSITY}, young = 2e11, poisson = 0.3 }}
contact = "all"
[modes]
count = 6
residual_flexibility = false
"""


def faces_of_box():
    """Corners (6, 4, 3) of the faces, the first parameter before the second."""
    faces = []
    for axis, side in itertools.product(range(3), (0, 1)):
        face = np.zeros((4, 3))
        face[:, axis] = side
        face[1::2, (axis + 1) % 3] = face[2:, (axis + 2) % 3] = 1
        faces.append(face * SIDES)
    return faces


def cards(lines, section):
    return [f"{line:<72}{section}{number:>7}" for number, line in enumerate(lines, 1)]


def folded(fields, width):
    """Lines of a record, which break between its fields."""
    lines = [""]
    for field in [f"{field}," for field in fields[:-1]] + [f"{fields[-1]};"]:
        if len(lines[-1]) + len(field) > width:
            lines.append("")
        lines[-1] += field
    return lines


def iges(faces):
    """IGES 5.3 in inches: for each face, a B-spline surface of degree 1 (entity 128), and no topology."""

    def text(words):
        return f"{len(words)}H{words}"

    day = text("20260101.000000")
    names = [text("loose"), text("loose.igs"), text("test"), text("1"), 32, 38, 6, 308, 15, text("loose")]
    header = [
        "1H,",
        "1H;",
        *names,
        1.0,
        1,
        text("INCH"),
        1,
        0.01,
        day,
        1e-7,
        10.0,
        text("x"),
        text("x"),
        11,
        0,
        day,
    ]
    directory, parameters = [], []
    for face in faces:
        # Highest indices and degrees; open, open, polynomial, not periodic; knots, weights, poles, ranges.
        fields = [128, 1, 1, 1, 1, 0, 0, 1, 0, 0, *2 * [0.0, 0.0, 1.0, 1.0], *4 * [1.0]]
        lines = folded([*fields, *map(float, np.ravel(face)), 0.0, 1.0, 0.0, 1.0], 64)
        start, entry = len(parameters) + 1, len(directory) + 1
        directory.append("".join(f"{n:>8}" for n in (128, start, 0, 0, 0, 0, 0, 0, "00000000")))
        directory.append("".join(f"{n:>8}" for n in (128, 0, 0, len(lines), 0, "", "", "", 0)))
        parameters += [f"{line:<64}{entry:>8}" for line in lines]
    sections = {"S": ["Loose faces"], "G": folded(header, 72), "D": directory, "P": parameters}
    counts = "".join(f"{name}{len(lines):>7}" for name, lines in sections.items())
    written = [card for name, lines in sections.items() for card in cards(lines, name)]
    return "\n".join([*written, *cards([counts], "T"), ""])


class Iges(ProgramTest):
    def test_loose_faces_in_inches_are_sewn_into_their_box(self):
        self.write("box.igs", iges(faces_of_box()))
        done = self.succeed(kernel(self.write("scene.toml", SCENE), self.folder))
        self.assertIn("box.igs: its 6 loose faces were sewn into a solid", done.err)
        mass = ricochet.Kernel(self.one(self.folder)).mass
        self.assertAlmostEqual(mass / (DENSITY * np.prod(SIDES) * (1e-3 * INCH) ** 3), 1, delta=1e-9)
        table = self.succeed(Command("surfaces", self.folder / "box.igs")).out.splitlines()[1:7]
        areas = sorted(float(line.split()[3]) for line in table)
        exact = np.repeat(np.sort(np.prod(SIDES) / np.array(SIDES)), 2) * INCH**2
        np.testing.assert_allclose(areas, exact, rtol=5e-4)  # four digits

    def test_a_box_without_its_lid_is_refused_with_its_free_edges(self):
        self.write("box.igs", iges(faces_of_box()[:5]))
        self.refused(
            kernel(self.write("scene.toml", SCENE), self.folder),
            "box.igs: has faces but no solid, and 4 edges of its 5",
        )

    def test_faces_that_close_but_cross_each_other_are_refused(self):
        half_turn = np.array([SIDES[0], SIDES[1], 2 * SIDES[2]])  # of the lid, on which z is SIDES[2]
        faces = [np.where(face[:, 2:] > 0, half_turn - face, face) for face in faces_of_box()]
        self.write("box.igs", iges(faces))
        self.refused(
            kernel(self.write("scene.toml", SCENE), self.folder),
            "box.igs: its 6 loose faces were sewn into a solid",
            "its faces may cross each other: export the body as a solid, in .step",
        )


if __name__ == "__main__":
    unittest.main()
