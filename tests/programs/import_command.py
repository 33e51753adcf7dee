# SPDX-License-Identifier: BSD-2-Clause
"""ricochet import: body files from matrices of CalculiX and from lists of numbers, and refused input."""

import shutil
import unittest

import h5py
import numpy as np

from box_test import BoxTest
from boxes import MATERIAL, Box, listed
from mistakes_table import TABLE
from programs import Command, Run, kernel

from ricochet.errors import InputError
from ricochet.interchange.body import clockwise
from ricochet.interchange.calculix import BRICK, Model


class ImportCommand(BoxTest):
    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed: scripts/setup --tests")
    def test_matrices_of_calculix_have_its_frequencies(self):
        box, names = self.box, {"stored": ", SOLVER=MATRIXSTORAGE", "solved": ""}
        lines = [
            "*NODE, NSET=all",
            *(f"{10 * k}, {x!r}, {y!r}, {z!r}" for k, (x, y, z) in enumerate(box.node.tolist(), 1)),
            "*ELEMENT, TYPE=C3D8, ELSET=body",
            *(
                f"{k}, " + ", ".join(str(10 * (node + 1)) for node in nodes)
                for k, nodes in enumerate(box.brick, 1)
            ),
            "*ELSET, ELSET=lower, GENERATE",
            f"1, {len(box.foot)}, 1",
            "*SURFACE, NAME=foot",
            "lower, S1",
            "*MATERIAL, NAME=stuff",
            "*ELASTIC",
            "{young}, {poisson}".format(**MATERIAL),
            "*DENSITY",
            str(MATERIAL["density"]),
            "*SOLID SECTION, ELSET=body, MATERIAL=stuff",
            "*STEP",
        ]
        for name, solver in names.items():
            self.write(f"{name}.inp", "\n".join([*lines, "*FREQUENCY" + solver, "20", "*END STEP", ""]))
            self.succeed(Run(["ccx", name], cwd=self.folder))
        self.succeed(Command("import", "calculix", self.folder / "stored.inp"))
        self.succeed(
            kernel(
                self.all / "imported.toml",
                self.folder,
                f"bodies.box.mesh={self.folder / 'stored.h5'}",
                "modes.count=20",
            )
        )
        table = [line.split() for line in (self.folder / "solved.dat").read_text().splitlines()[7:27]]
        with h5py.File(self.one(self.folder)) as file, h5py.File(self.folder / "stored.h5") as body:
            omega = file["modes/angular_frequency"][6:20]
            facets, node = body["surface/foot/4"][:], body["node"][:]
        # The table has seven digits.
        np.testing.assert_allclose(omega, [float(words[2]) for words in table[6:]], rtol=2e-7)
        np.testing.assert_allclose(node, box.node, atol=1e-12)
        self.assertEqual(
            {frozenset(row) for row in facets.tolist()}, {frozenset(row) for row in box.foot.tolist()}
        )
        # Facets are oriented so that the normal points outward.
        side = node[facets]
        self.assertTrue((np.cross(side[:, 1] - side[:, 0], side[:, 2] - side[:, 0])[:, 2] < 0).all())

    def test_lists_that_do_not_fit_are_refused(self):
        files = self.matrices
        few = self.write("few.txt", listed(self.box.node[:-1]))
        far = self.write("far.txt", listed(self.box.foot + 30))
        half = self.write("half.txt", listed(self.box.foot + 0.5))
        cases = [
            ("none.txt: there is no such file.", [*files[:2], self.folder / "none.txt"]),
            ("none.mtx: there is no such file.", [self.folder / "none.mtx", *files[1:]]),
            ("names node 0.5", [*files, "--surface", f"foot={half}"]),
            ("is 108 x 108: 35 nodes have 105", [*files[:2], few]),
            ("names node 37: nodes are numbered 1 to 36", [*files, "--surface", f"foot={far}"]),
            (
                "names node 1.7",
                [*files, "--support", f"foot={self.write('part.txt', '1 2' + chr(10) + '3 1.7')}"],
            ),
            ("is empty", [*files, "--surface", f"foot={self.write('empty.txt', '')}"]),
            ("row 1 has a number that is not finite", [*files[:2], self.write("huge.txt", "1e400 0 0")]),
            ("is one of the inputs", [*files, "--out", files[1]]),
            ("must be NAME=FILE", [*files, "--surface", b"\xff=foot"]),
            ("%%MatrixMarket matrix coordinate real", [few, *files[1:]]),
        ]
        for words, arguments in cases:
            with self.subTest(words):
                self.refused(Command("import", "matrices", "--out", self.folder / "no.h5", *arguments), words)
        self.assertFalse(list(self.folder.glob("no.h5*")))
        unwritten = self.folder / "none" / "box.h5"
        self.refused(
            Command("import", "matrices", *files, "--out", unwritten), f"{unwritten}: cannot be written"
        )

    def test_bodies_that_can_never_touch_are_warned_of(self):
        command = ["import", "matrices", *self.matrices, "--out", self.folder / "box.h5"]
        self.assertIn("warning: no surface", self.succeed(Command(*command)).err)
        mixed = self.box.foot.copy()
        mixed[:2] = mixed[:2, ::-1]
        for facets, words in (
            (self.box.foot, ""),
            (mixed, "2 of 6 facets run clockwise"),
            (mixed[:, :3], "2 of 6"),
            (self.box.top[:, ::-1], "6 of 6"),
        ):
            foot = self.write("foot.txt", listed(facets + 1))
            err = self.succeed(Command(*command, "--surface", f"foot={foot}")).err
            self.assertEqual(err.count("\n"), bool(words), err)
            self.assertIn(words, err)

    def test_facets_of_a_cavity_run_right_though_they_look_at_the_middle(self):
        box = Box(cells=(3, 3, 3))
        shell = np.delete(box.brick, 13, axis=0)
        i, j = (
            3 * np.array([[np.repeat(brick, 8), np.tile(brick, 8)] for brick in shell]).transpose(1, 0, 2)
        ).reshape(2, -1)
        walls = box.brick[13][BRICK[0]]
        a, b, c, _ = box.node[walls].transpose(1, 0, 2)
        inner = np.einsum("fk,fk->f", np.cross(b - a, c - a), box.node[box.brick[13]].mean(axis=0) - a) > 0
        outward = np.where(inner[:, None], walls, walls[:, ::-1])  # from the shell into the cavity
        self.assertEqual(clockwise(box.node, outward, i, j), 0)
        self.assertEqual(clockwise(box.node, outward[:, ::-1], i, j), 6)

    def test_lists_of_one_name_are_one_list(self):
        both = [
            word
            for name in ("foot", "top")
            for kind in ("--surface", "--support")
            for word in (kind, f"s={self.all / name}.txt")
        ]
        self.succeed(Command("import", "matrices", *self.matrices, *both, "--out", self.folder / "both.h5"))
        with h5py.File(self.folder / "both.h5") as file:
            np.testing.assert_array_equal(
                file["surface/s/4"][:], np.concatenate([self.box.foot, self.box.top])
            )
            np.testing.assert_array_equal(file["nodes/s"][:], np.unique([self.box.foot, self.box.top]))

    def test_decks_that_are_wrong_are_refused_by_their_line(self):
        deck = (
            "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4, ELSET=e\n1, 1, 2, 3, 4\n"
            "*SURFACE, NAME=foot\ne, S1\n"
        )
        path = self.write("job.inp", deck)
        self.assertEqual(
            [facets.tolist() for facets in Model(path).surfaces()["foot"]], [[[2, 1, 0]]]
        )  # clockwise seen from above
        for words, old, new in TABLE["decks"]:
            self.assertIn(old, deck)
            path.write_text(deck.replace(old, new))
            with self.subTest(new), self.assertRaisesRegex(InputError, words):
                Model(path).surfaces()
        path.write_text(deck)
        for words, rows in [
            ("of no node", b"\xff.1\n"),
            ("of no node", "\u00b2.1\n".encode()),
            ("2.1 twice", b"1.1\n2.1\n2.1\n"),
        ]:
            (self.folder / "job.dof").write_bytes(rows)
            with self.subTest(rows), self.assertRaisesRegex(InputError, words):
                Model(path).matrices()


if __name__ == "__main__":
    unittest.main()
