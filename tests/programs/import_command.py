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
from ricochet.interchange.body import wrong_edge, wrong_facet
from ricochet.interchange.calculix import Model
from ricochet.interchange.elements import BRICK


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

    def test_a_body_without_a_surface_is_warned_of(self):
        command = ["import", "matrices", *self.matrices, "--out", self.folder / "box.h5"]
        self.assertIn("warning: no surface", self.succeed(Command(*command)).err)
        self.assertEqual(
            self.succeed(Command(*command, "--surface", f"foot={self.all / 'foot.txt'}")).err, ""
        )

    def test_facets_that_are_not_on_the_outside_are_refused(self):
        """Facets numbered from 0 are those of other nodes, some of which are none of the body."""
        foot, top = self.box.foot + 1, self.box.top + 1
        layer = self.box.top + 1 - len(self.box.node) // 3  # the middle one, inside the body
        mixed = foot.copy()
        mixed[1] = mixed[1, ::-1]
        for facets, words in (
            (top - 1, "facet 1, of nodes 24 25 29 28, is not a face of an element"),
            (layer, "lies inside the body: the stiffness couples it with nodes on both sides"),
            (mixed, "facet 2, of nodes 3 7 6 2, runs clockwise seen from outside"),
            (mixed[:, :3], "facet 2, of nodes 3 7 6, runs clockwise"),
            (top[:, ::-1], "facet 1"),
            (np.vstack([foot, foot[:1]]), "surface s: two facets run from node 1 to node"),
        ):
            with self.subTest(words):
                listing = self.write("s.txt", listed(facets))
                self.refused(
                    Command(
                        "import",
                        "matrices",
                        *self.matrices,
                        "--surface",
                        f"s={listing}",
                        "--out",
                        self.folder / "no.h5",
                    ),
                    words,
                )
        self.assertFalse((self.folder / "no.h5").exists())

    def test_matrices_that_are_not_symmetric_are_refused_with_their_worst_entry(self):
        bent = self.stiffness.copy()
        bent[3, 4] *= 1.01
        bent[7, 0] += 1e-12 * bent[0, 0]  # the last digit
        rows = [f"{i + 1} {j + 1} {bent[i, j]!r}" for i, j in np.argwhere(bent != 0)]
        header = f"%%MatrixMarket matrix coordinate real general\n{len(bent)} {len(bent)} {len(rows)}\n"
        path = self.write("bent.mtx", header + "\n".join(rows) + "\n")
        run = Command("import", "matrices", path, *self.matrices[1:], "--out", self.folder / "no.h5")
        self.refused(run, "bent.mtx: is not symmetric: row 4 has", "in column 5, row 5 has")

    def test_facets_of_a_cavity_run_right_though_they_look_at_the_middle(self):
        box = Box(cells=(3, 3, 3))
        shell = np.delete(box.brick, 13, axis=0)
        i, j = (
            3 * np.array([[np.repeat(brick, 8), np.tile(brick, 8)] for brick in shell]).transpose(1, 0, 2)
        ).reshape(2, -1)
        walls = box.brick[13][BRICK.faces]
        a, b, c, _ = box.node[walls].transpose(1, 0, 2)
        inner = np.einsum("fk,fk->f", np.cross(b - a, c - a), box.node[box.brick[13]].mean(axis=0) - a) > 0
        outward = np.where(inner[:, None], walls, walls[:, ::-1])  # from the shell into the cavity
        self.assertIsNone(wrong_facet(box.node, outward, i, j))
        self.assertIsNone(wrong_edge([outward]))
        for k in range(6):
            self.assertIn("clockwise", wrong_facet(box.node, outward[k : k + 1, ::-1], i, j)[1])

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
