# SPDX-License-Identifier: BSD-2-Clause
"""A mesh gives the same kernel in one file and in several, on any number of ranks."""

import pathlib
import tempfile
import unittest

import h5py
import numpy as np

import scenes
from programs import ProgramTest, displacement_kernel, kernel, static_responses

CELLS = (3, 3, 4)

MORE = """
[[loads.traction]]
body = "{name}"
group = "top"
vector = [0, 0, 1]
[[loads.point]]
body = "{name}"
at = [0.5, 0.6, 0.5]
vector = [1, 0, 0]
[[loads.motion]]
body = "{name}"
group = "foot"
vector = [1, 1, 1]
[[output.receiver]]
name = "mic"
body = "{name}"
at = [0.3, 0.9, 0.4]
"""


def scene_of(name):
    """A scene with the block of NAME.msh below a wall."""
    body = f"""
mesh = "{name}.msh"
material = {{ density = 2.0, young = 3.0, poisson = 0.3 }}
contact = "top"
support = {{ foot = "xyz" }}
"""
    wall = {"wall": "point = [0, 0, 2]\nnormal = [0, 0, -1]"}
    contact, more = "direction = [0, 0, 1]", MORE.format(name=name)
    return scenes.scene({name: body}, "count = 40", contact, "duration = 1.0", wall, "Parts", more)


def grid():
    """Nodes and elements (type, group, nodes) of a skewed block: hexahedra, and facets at its top and foot."""
    n = np.array(CELLS) + 1

    def number(i, j, k):
        return 1 + i + n[0] * (j + n[1] * k)

    nodes = [
        (i / 3 + 0.05 * k, j / 3 * 1.2, k / 4 * (1 + 0.1 * i))
        for k in range(n[2])
        for j in range(n[1])
        for i in range(n[0])
    ]

    def square(i, j, k):
        return [number(i, j, k), number(i + 1, j, k), number(i + 1, j + 1, k), number(i, j + 1, k)]

    elements = []
    for k in range(CELLS[2]):
        for j in range(CELLS[1]):
            for i in range(CELLS[0]):
                elements.append((5, 1, square(i, j, k) + square(i, j, k + 1)))
                if k == 0:
                    elements.append((3, 2, square(i, j, k)))
                if k == CELLS[2] - 1:
                    elements.append((3, 3, square(i, j, k + 1)))
    return nodes, elements


def msh(nodes, elements, chosen):
    """The chosen elements (by index) and their nodes in the format 4.1 of gmsh."""
    used = sorted({node for e in chosen for node in elements[e][2]})
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat"]
    lines += ["$PhysicalNames", "3", '3 1 "block"', '2 2 "foot"', '2 3 "top"', "$EndPhysicalNames"]
    box = "0 0 0 2 2 2"
    lines += ["$Entities", "0 0 2 1", f"2 {box} 1 2 0", f"3 {box} 1 3 0", f"1 {box} 1 1 0", "$EndEntities"]
    lines += ["$Nodes", f"1 {len(used)} 1 {len(nodes)}", f"3 1 0 {len(used)}", *map(str, used)]
    lines += [f"{x!r} {y!r} {z!r}" for node in used for x, y, z in [nodes[node - 1]]]
    blocks = [(2, 2, 3), (2, 3, 3), (3, 1, 5)]  # dimension, group, type
    lines += ["$EndNodes", "$Elements", f"{len(blocks)} {len(chosen)} 1 {len(elements)}"]
    for dim, group, kind in blocks:
        here = [e for e in chosen if elements[e][:2] == (kind, group)]
        lines.append(f"{dim} {group} {kind} {len(here)}")
        lines += [" ".join(map(str, [e + 1, *elements[e][2]])) for e in here]
    return "\n".join(lines + ["$EndElements", ""])


class Parts(ProgramTest):
    def kernel_of(self, name, *sets, **options):
        scene = self.write(f"{name}.toml", scene_of(name))
        out = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
        self.succeed(kernel(scene, out, *sets, **({"ranks": 2} | options)))
        return next(out.glob("*.kernel.h5"))

    def test_three_files_give_the_kernel_functions_of_one(self):
        nodes, elements = grid()
        everything = range(len(elements))
        self.write("whole.msh", msh(nodes, elements, everything))
        for part in range(3):
            # Each part consists of columns of elements, so that it has facets and shares nodes with others.
            self.write(
                f"split_{part + 1}.msh", msh(nodes, elements, [e for e in everything if e // 4 % 3 == part])
            )
        for modes in ("{ count = 40 }", '{ up_to_hz = 1.0, basis = "contact" }'):
            with self.subTest(modes=modes):
                self.compare(f"modes={modes}")

    def compare(self, setting):
        whole, split = self.kernel_of("whole", setting), self.kernel_of("split", setting)
        places = []
        for path in (whole, split):
            with h5py.File(path) as file:
                places.append(np.round(file["surface/node"][:].reshape(-1, 3), 9))
        order = [np.lexsort(place.T) for place in places]
        np.testing.assert_array_equal(places[0][order[0]], places[1][order[1]])
        times = np.concatenate([np.linspace(0, 30, 50), np.linspace(0, 1, 50)])
        one, other = (
            displacement_kernel(path, times)[:, rows][:, :, rows] for path, rows in zip((whole, split), order)
        )
        self.assertGreater(np.abs(one).max(), 1e-3)
        self.assertLess(np.abs(one - other).max(), 1e-8 * np.abs(one).max())
        one, other = static_responses(whole), static_responses(split)
        self.assertEqual(len(one), 9)
        for key, value in one.items():
            self.assertLess(np.abs(other[key] - value).max(), 1e-8 * max(np.abs(value).max(), 1e-3), key)

    def test_any_number_of_ranks_finds_the_same_frequencies(self):
        nodes, elements = grid()
        everything = range(len(elements))
        self.write("whole.msh", msh(nodes, elements, everything))
        self.write("split_1.msh", msh(nodes, elements, [e for e in everything if e % 3]))
        self.write("split_2.msh", msh(nodes, elements, [e for e in everything if e % 3 == 0]))
        basis = 'modes={ up_to_hz = 1.0, basis = "contact" }'  # all ranks share the body
        found = []
        for name, ranks in (("whole", 1), ("whole", 4), ("split", 3)):
            with h5py.File(self.kernel_of(name, basis, ranks=ranks)) as file:
                found.append(file["modes/angular_frequency"][:])
        for other in found[1:]:
            np.testing.assert_allclose(other, found[0], rtol=1e-9)

    def test_a_fault_in_the_range_of_one_rank_ends_in_one_line(self):
        nodes, elements = grid()
        text = msh(nodes, elements, range(len(elements)))
        tag, *corners = text.splitlines()[-2].split()
        for fault, said in (
            (
                f"{tag} {' '.join(corners[:-1])} 9999",
                "whole.msh: an element has node 9999, which does not exist",
            ),
            (
                f"{tag} {' '.join(corners[:-1])} x",
                f'whole.msh: line {text.count(chr(10)) - 1}: "x" instead of a node',
            ),
            (f"1 {' '.join(corners)}", "whole.msh: element 1 occurs twice"),
        ):
            with self.subTest(said=said):
                self.write("whole.msh", text.replace(f"\n{tag} {' '.join(corners)}\n", f"\n{fault}\n"))
                run = kernel(self.write("whole.toml", scene_of("whole")), self.folder / "out", ranks=2)
                self.assertEqual(run.status, 2)
                self.assertEqual(run.err.count(said), 1, run.err)

    def test_a_missing_part_ends_in_one_line(self):
        nodes, elements = grid()
        for part in (1, 3):
            self.write(f"split_{part}.msh", msh(nodes, elements, range(len(elements))))
        run = kernel(self.write("split.toml", scene_of("split")), self.folder / "out", ranks=2)
        self.assertEqual(run.status, 2)
        self.assertEqual(run.err.count("split_2.msh: no such file"), 1)


if __name__ == "__main__":
    unittest.main()
