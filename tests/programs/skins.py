# SPDX-License-Identifier: BSD-2-Clause
"""The skins that pictures and pages draw: compared with the motion at the contact points, and with the files for ParaView, which
the program computes by itself."""

import shutil
import unittest

import h5py
import numpy as np

from motion import BLOCK, BLOCKS, SINGLE, read_xdmf
from programs import ProgramTest, impact
from ricochet.pages.motion import motion_of
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.moving_surfaces import moving_surfaces

# Linear elements, on which a skin interpolates without error.
LINEAR = BLOCKS.replace("order = 2", "order = 1")


def patch_means(field, node, element):
    """(V) means of a field (V) that is linear on each triangle, weighted with the hat function of each node."""
    corner = node[element]
    area = (
        np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)[:, None]
        / 2
    )
    moment, weight = np.zeros(len(node)), np.zeros(len(node))
    # ∫ of the product of two hats over a triangle: area/6 for a hat with itself, otherwise area/12.
    np.add.at(moment, element, area / 12 * (field[element].sum(axis=1, keepdims=True) + field[element]))
    np.add.at(weight, element, area / 3)
    return np.divide(moment, weight, out=np.zeros(len(node)), where=weight > 0)


class Skins(ProgramTest):
    def run_blocks(self, *sets):
        """The history of a run, its skins and the times of the snapshots."""
        out = self.folder / "out"
        history = LoadedResult(impact(self.folder / "blocks.toml", out, *sets).path)
        return (history, *moving_surfaces(history, out))

    def setUp(self):
        super().setUp()
        self.write("block.geo", BLOCK)
        self.write("ramp.csv", "0,0\n0.03,1\n0.05,0.5\n")
        self.write("blocks.toml", LINEAR)

    def at_the_points(self, history, skin, k):
        """Displacements of the skin of body a along the normals at the contact points, as means over their patches, of
        rigid motion at the points from which gaps are measured.
        The candidates of linear elements are the nodes of the skin."""
        with h5py.File(self.folder / "out" / history.file.text("/bodies/striker", "kernel")) as file:
            candidate, own = file["surface/node"][:], file["surface/centroid"][:]
            rigid = np.flatnonzero(file["modes/angular_frequency"][:] == 0)
        centre = own @ skin.rotation.T + skin.translation
        near = np.linalg.norm(centre[:, None] - history.point_a, axis=2).argmin(axis=0)
        node = np.linalg.norm(skin.node[:, None] - candidate[near], axis=2).argmin(axis=0)
        bottom = skin.element[np.all(skin.node[skin.element, 2] < 1e-9, axis=1)]
        (along,) = np.unique(history.normal.round(12), axis=0)
        moved = (skin.at(k) - skin.node @ skin.rotation.T - skin.translation) @ along
        # Contact takes rigid rotation at the point of a patch from which gaps are measured, not at its mean.
        x, u = skin.node - skin.node.mean(axis=0), skin.shape[:, :, rigid] @ skin.coordinates[k, rigid]
        turn = np.linalg.solve((x**2).sum() * np.eye(3) - x.T @ x, np.cross(x, u).sum(axis=0))
        mean = np.stack([patch_means(x, skin.node, bottom) for x in skin.node.T], axis=1)[node]
        aside = np.cross(turn, own[near] - mean) @ skin.rotation.T @ along
        return patch_means(moved, skin.node, bottom)[node] + aside

    def test_move_with_the_contact_points(self):
        history, skins, time = self.run_blocks(
            "output.vtk_every=0", "output.view=true", "output.snapshot_every=1"
        )
        skin, checked = skins["striker"], 0
        kept = history.snapshots["striker"].shape[1]
        modes_alone = skin.coordinates.copy()
        modes_alone[:, kept:] = 0
        for row, when in enumerate(history.contact_time):
            (k,) = np.flatnonzero(np.abs(time - when) < 1e-9)
            moved = history.motions["displacement_a"][row]
            found = self.at_the_points(history, skin, k)
            # 5: fields of forces in 32 bits, summed to 1e-5 of the forces
            np.testing.assert_allclose(found, moved, rtol=0, atol=5 * SINGLE)
            if history.force[row].sum() > 0.5 * history.force.sum(axis=1).max():
                exact, skin.coordinates = skin.coordinates, modes_alone
                without = np.abs(self.at_the_points(history, skin, k) - moved).max()
                skin.coordinates = exact
                self.assertGreater(without, 5e-3)  # the static part is not negligible here
                checked += 1
        self.assertGreater(checked, 3)

    def test_are_those_that_paraview_shows(self):
        # Above half of the lower rate, modes are quasi-static. Under impulses there is no static response to forces.
        for setting in ("time.rate_hz=2000", "time.rate_hz=25", "contact.scheme=impulse"):
            history, skins, time = self.run_blocks(setting, "output.vtk_every=1", "output.snapshot_every=1")
            self.assertGreater(history.force.max(), 0)
            film = read_xdmf(self.folder / "out" / "blocks.motion.xdmf")
            for name, skin in skins.items():
                largest = np.abs(skin.shape[:, :, skin.modes :]).max(axis=(0, 1))
                np.testing.assert_allclose(largest, 1, rtol=1e-6)  # so that amplitudes are displacements
                np.testing.assert_allclose(film[name]["time"], time, rtol=1e-12)
                drawn = np.stack([skin.at(k) for k in range(len(time))])
                np.testing.assert_allclose(drawn, film[name]["position"], rtol=0, atol=5 * SINGLE)
                bent = np.linalg.norm(film[name]["deformation"], axis=2).max(axis=1)
                np.testing.assert_allclose(
                    [skin.deformation(k) for k in range(len(time))], bent, rtol=0, atol=5 * SINGLE
                )
            # The shapes of a page are fitted to 3e-4 of all nodes and times; the largest error is of one node.
            self.assertLess(motion_of(history, self.folder / "out", history.scene)["missed"], 1e-2)

    def test_of_older_files_move_with_their_modes(self):
        out = self.folder / "out"
        self.run_blocks("output.vtk_every=0", "output.view=true", "output.snapshot_every=9")
        for missing in ("the forces", "the responses"):
            older = self.folder / missing
            shutil.copytree(out, older)
            for path in older.glob("*.h5"):
                with h5py.File(path, "r+") as file:
                    if "static" in file and missing == "the forces":
                        del file["static"]
                    for name in [n for n in file.get("view", ()) if "residual" in n]:
                        if missing == "the responses":
                            del file[f"view/{name}"]
            history = LoadedResult(older / "blocks.result.h5")
            skins, _ = moving_surfaces(history, older)
            for name, skin in skins.items():
                self.assertEqual(skin.shape.shape[2], history.snapshots[name].shape[1])
                np.testing.assert_array_equal(skin.coordinates, history.snapshots[name])


if __name__ == "__main__":
    unittest.main()
