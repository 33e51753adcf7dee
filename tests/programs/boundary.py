# SPDX-License-Identifier: BSD-2-Clause
"""contact = "all" gives the kernel of a physical surface over the whole boundary, on any number of ranks."""

import unittest

import h5py
import numpy as np

import scenes
from parts import grid, msh
from programs import ProgramTest, kernel

SKIN = 'Physical Surface("skin") = {1, block[0], block[2], block[3], block[4], block[5]};\n'
FLOOR = {"floor": "normal = [0, 0, 1]"}


def scene_of(mesh, contact, order=2):
    """A block that turns while it falls on a floor."""
    body = f"""
mesh = "{mesh}"
order = {order}
material = {{ density = 2.0, young = 3.0, poisson = 0.3 }}
contact = "{contact}"
"""
    finite = '[motion]\nrotation = "finite"'
    return scenes.scene(
        {"block": body}, "count = 30", "direction = [0, 0, -1]", "duration = 1.0", FLOOR, more=finite
    )


class Boundary(ProgramTest):
    def kernel_of(self, mesh, contact, *, order=2, ranks=1):
        """The data of a kernel by name, with the modes as the sum that no choice of vectors changes."""
        out = self.folder / f"{mesh}-{contact}-{order}-{ranks}"
        scene = self.write(f"{mesh}-{contact}.toml", scene_of(mesh, contact, order))
        self.succeed(kernel(scene, out, ranks=ranks))
        with h5py.File(self.one(out)) as file:
            data = {
                name: file[f"surface/{name}"][:]
                for name in ("node", "centroid", "bulge", "normal", "area", "group", "residual_flexibility")
            }
            omega, shape = file["modes/angular_frequency"][:], file["surface/shape"][:]
        shape = shape.reshape(-1, len(omega))
        return data | {"omega": omega, "compliance": (shape / (1 + omega**2)) @ shape.T}

    def compare(self, one, other, order=slice(None)):
        """`order`: of the candidates of `other`."""
        count = len(one["area"])
        rows = np.arange(3 * count).reshape(count, 3)[order].ravel()
        for name, expected in one.items():
            found = other[name]
            if name == "group":
                continue
            if name in ("residual_flexibility", "compliance"):
                self.assertEqual(found.shape, (3 * count, 3 * count))  # all candidates, in all components
                found = found[np.ix_(rows, rows)]
            elif name != "omega":
                found = found[order]
            size = max(np.abs(expected).max(), 1e-3)  # flat patches have no bulge
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * size, err_msg=name)

    def test_is_the_kernel_of_a_physical_surface_over_it(self):
        self.write("block.geo", scenes.skewed_block(0.6) + SKIN)
        for order in (1, 2, 3):
            with self.subTest(order=order):
                skin, everything = (
                    self.kernel_of("block.geo", name, order=order) for name in ("skin", "all")
                )
                self.assertEqual(set(everything["group"]), {b"all"})
                self.compare(skin, everything)

    def test_is_the_same_on_two_ranks(self):
        self.write("block.geo", scenes.skewed_block(0.6))
        self.compare(*(self.kernel_of("block.geo", "all", ranks=ranks) for ranks in (1, 2)))

    def test_of_a_mesh_in_parts_is_that_of_the_mesh_in_one_file(self):
        nodes, elements = grid()
        self.write("whole.msh", msh(nodes, elements, range(len(elements))))
        for part in range(3):
            chosen = [e for e in range(len(elements)) if e // 4 % 3 == part]
            self.write(f"split_{part + 1}.msh", msh(nodes, elements, chosen))
        whole, split = self.kernel_of("whole.msh", "all"), self.kernel_of("split.msh", "all", ranks=2)
        order = [np.lexsort(np.round(data["node"], 9).T) for data in (whole, split)]
        self.assertEqual(len(whole["area"]), 4 * 4 * 5 - 2 * 2 * 3)  # nodes on the outside of 3 × 3 × 4 cells
        self.compare(whole, split, order[1][np.argsort(order[0])])


if __name__ == "__main__":
    unittest.main()
