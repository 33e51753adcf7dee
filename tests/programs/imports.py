# SPDX-License-Identifier: BSD-2-Clause
"""Bodies from other programs: a box whose matrices numpy assembles."""

import re
import shutil
import subprocess
import unittest

import h5py
import numpy as np

from box_test import BoxTest
from boxes import MATERIAL, Box, listed
from programs import BIN, SOURCE, Run, contact, displacement_kernel, kernel, static_responses

from ricochet.errors import InputError
from ricochet.interchange.body import Body, clockwise
from ricochet.interchange.calculix import BRICK, Model

TIMES = [0.1, 0.5, 2.0, 7.0]
# Bricks that are not straight have a stiffness whose integrand is no polynomial: two rules of quadrature differ by 1e-9.
QUADRATURE = 1e-8
# Shapes of modes are within their residuals, 1e-8, times a few tens of modes.
SHAPES = 1e-6
# Gravity, a traction, a receiver and a support that moves, in vectors that ranks work at together.
EVERYTHING = [
    'modes={up_to_hz=0.8,basis="contact"}',
    'bodies.box.support={"top"="xz"}',
    "bodies.box.velocity=[0,0,0]",
    'loads={gravity=[0,0,-1],motion=[{body="box",group="top",vector=[1,0,0]}],'
    'traction=[{body="box",group="foot",vector=[1,0,0]}]}',
]


def coordinates(matrix):
    return *np.nonzero(matrix), matrix[np.nonzero(matrix)]


class Imports(BoxTest):
    def assertSameKernel(self, first, second, tolerance):
        """What contact can tell: the displacement kernel, its static rest, mass and momentum."""
        a, b = displacement_kernel(first, TIMES), displacement_kernel(second, TIMES)
        self.assertLess(abs(a - b).max(), tolerance * abs(a).max())
        with h5py.File(first) as one, h5py.File(second) as other:
            for name in (
                "surface/area",
                "surface/normal",
                "surface/centroid",
                "body/centre",
                "body/inertia",
                "modes/angular_frequency",
                "surface/residual_flexibility",
            ):
                size = abs(one[name][:]).max()
                self.assertLess(abs(one[name][:] - other[name][:]).max(), tolerance * size, name)
            self.assertAlmostEqual(one.attrs["mass"], other.attrs["mass"], delta=1e-12)
            for name in (
                "body_force",
                "rotation",
            ):  # of a multiple mode, as rigid ones are, only this is known
                a, b = (file[f"loads/{name}"][:] @ file[f"loads/{name}"][:].T for file in (one, other))
                self.assertLess(abs(a - b).max(), tolerance * abs(a).max(), name)

    def test_matrices_give_the_kernel_of_the_mesh_that_they_are_of(self):
        self.succeed(kernel(self.all / "imported.toml", self.folder, ranks=2))
        for out in (self.all / "imported", self.folder):
            self.assertSameKernel(self.one(self.all / "own"), self.one(out), QUADRATURE)

    def test_ranks_share_matrices_and_supports_loads_and_receivers_are_those_of_the_mesh(self):
        at = self.box.node[-3].tolist()
        sets = [*EVERYTHING, f'output={{view=true,receiver=[{{name="mic",body="box",at={at}}}]}}']
        self.succeed(kernel(self.all / "own.toml", self.folder / "own", *sets))
        self.succeed(kernel(self.all / "imported.toml", self.folder / "imported", *sets, ranks=3))

        def responses(path):
            with h5py.File(path) as file:  # Γ itself cancels from what a support that moves does slowly
                gamma = file["motions/top/participation"][:]
            return static_responses(path) | {("top", "inertia"): gamma @ gamma.T}

        own, imported = (responses(self.one(self.folder / name)) for name in ("own", "imported"))
        self.assertEqual(set(own), set(imported))
        for name, value in own.items():
            self.assertLess(abs(value - imported[name]).max(), QUADRATURE * max(abs(value).max(), 1e-3), name)

    def modes(self, free, rigid=0):
        """Of dense LAPACK on the free rows: ω², shapes at all rows without the rigid ones, and Σ φφᵀ/ω²."""
        lower = np.linalg.inv(np.linalg.cholesky(self.mass[np.ix_(free, free)]))
        squares, vectors = np.linalg.eigh(lower @ self.stiffness[np.ix_(free, free)] @ lower.T)
        shape = np.zeros((len(self.mass), squares.size - rigid))
        shape[free], squares = (lower.T @ vectors)[:, rigid:], squares[rigid:]
        return squares, shape, (shape / squares) @ shape.T

    def write_by_the_book(self, path, free=None, surface="foot", origin=(0, 0, 0)):
        """All modes, by the writer in docs/interchange.md. One of the box's sides takes part in contact."""
        page = (SOURCE / "docs" / "interchange.md").read_text()
        names = {}
        exec(re.search(r"```python\n(.*?def write_modes.*?)```", page, re.DOTALL).group(1), names)
        squares, shape, flexibility = (
            self.modes(np.arange(len(self.mass)), 6) if free is None else self.modes(free)
        )
        node = self.box.node + origin
        weight = self.mass[::3, ::3] @ np.ones(len(node))
        centre = weight @ node / weight.sum()
        second = (node - centre).T @ self.mass[::3, ::3] @ (node - centre)
        names["write_modes"](
            path,
            node,
            {surface: getattr(self.box, surface)},
            np.sqrt(squares),
            shape.reshape(len(node), 3, -1),
            weight.sum(),
            centre,
            np.trace(second) * np.eye(3) - second,
            flexibility,
        )
        if free is None:
            return
        along = np.stack([np.kron(np.ones(len(node)), e) for e in np.eye(3)])
        turn = np.stack([np.cross(e, node).ravel() for e in np.eye(3)])
        with h5py.File(path, "a") as file:
            file.attrs["supported"] = 1
            file["modes/body_force"], file["modes/rotation"] = (
                along @ self.mass @ shape,
                turn @ self.mass @ shape,
            )
            file["static/body_force"] = flexibility @ self.mass @ along.T

    def test_modes_from_elsewhere_give_the_same_kernel(self):
        self.write_by_the_book(self.folder / "modes.h5")
        self.succeed(
            kernel(
                self.all / "imported.toml",
                self.folder,
                f"bodies.box.mesh={self.folder / 'modes.h5'}",
                ranks=2,
            )
        )
        self.assertSameKernel(self.one(self.all / "imported"), self.one(self.folder), SHAPES)
        with h5py.File(self.one(self.folder)) as file:
            self.assertEqual(file["modes"].attrs["basis"], b"imported")
            self.assertFalse(file["modes/certificate"].attrs["complete"])

    def test_modes_from_elsewhere_make_the_same_impact(self):
        self.write_by_the_book(self.folder / "modes.h5")
        runs = {
            "own": (self.all / "own.toml", self.all / "own", []),
            "imported": (
                self.all / "imported.toml",
                self.folder,
                [f"bodies.box.mesh={self.folder / 'modes.h5'}"],
            ),
        }
        self.succeed(kernel(*runs["imported"][:2], *runs["imported"][2], ranks=1))
        found = {}
        for name, (scene, out, sets) in runs.items():
            self.succeed(contact(scene, out, *sets, "accuracy=0.1"))
            found[name] = self.summary(out)
        own, imported = found["own"], found["imported"]
        self.assertEqual((own["basis"], imported["basis"]), ({"box": "modes"}, {"box": "imported"}))
        self.assertGreater(own["contact_steps"], 10)
        for key in ("impulse_ns", "peak_force_n", "contact_end_s", "energy_lost_contact"):
            self.assertAlmostEqual(imported[key] / own[key], 1, delta=100 * SHAPES, msg=key)
        # Its file has no residuals.
        self.assertIsNotNone(own["error_estimate"]["eigensolver"])
        self.assertIsNone(imported["error_estimate"]["eigensolver"])

    def test_imported_modes_are_cut_to_fewer_but_not_to_those_that_contact_needs(self):
        self.write_by_the_book(self.folder / "modes.h5")
        mesh = f"bodies.box.mesh={self.folder / 'modes.h5'}"
        self.succeed(kernel(self.all / "imported.toml", self.folder / "all", mesh))
        self.succeed(kernel(self.all / "imported.toml", self.folder / "few", mesh, "modes.count=20"))
        few, made = self.one(self.folder / "few"), self.folder / "made"
        recast = [BIN / "ricochet-recast", self.one(self.folder / "all"), "--out", made]
        self.succeed(Run([*recast, "--count", 20]))
        self.assertEqual(self.one(made).name, few.name)
        with h5py.File(few) as one, h5py.File(self.one(made)) as other:
            self.assertEqual(other["modes/certificate"].attrs["count_by_inertia"], 0)
            np.testing.assert_array_equal(
                one["modes/angular_frequency"][:], other["modes/angular_frequency"][:]
            )
        run = Run([*recast, "--up-to-hz", 0.5, "--flexibility-error", 0.1])
        self.assertEqual(run.status, 2)
        self.assertIn("not known to be complete", run.err)

    def test_modes_of_the_second_body_are_checked_before_modes_of_the_first_are_computed(self):
        lower = {"origin": (0, 0, -0.6), "surface": "top"}
        node = self.box.node + lower["origin"]
        matrices = {"stiffness": coordinates(self.stiffness), "mass": coordinates(self.mass)}
        Body(node, matrices, {"top": [self.box.top]}).write(self.folder / "matrices.h5")
        self.write_by_the_book(self.folder / "modes.h5", **lower)
        text = (
            (self.all / "imported.toml")
            .read_text()
            .replace('mesh = "box.h5"', f"mesh = \"{self.all / 'box.h5'}\"")
        )
        text = (
            text.replace(
                "[obstacles.floor]\nnormal = [0, 0, 1]",
                '[bodies.lower]\nmesh = "lower.h5"\ncontact = "top"\n' "damping = { loss_factor = 0.01 }",
            )
            .replace('"floor"]', '"lower"]')
            .replace("gap = 0.01\n", "")
        )
        scene = self.write("two.toml", text)
        found = {}
        for name in ("matrices", "modes"):
            mesh = f"bodies.lower.mesh={self.folder / name}.h5"
            self.succeed(kernel(scene, self.folder / name, mesh, ranks=2))
            self.succeed(contact(scene, self.folder / name, mesh))
            found[name] = self.summary(self.folder / name)
        self.assertGreater(found["modes"]["contact_steps"], 10)
        self.assertAlmostEqual(
            found["modes"]["impulse_ns"] / found["matrices"]["impulse_ns"], 1, delta=100 * SHAPES
        )

        with h5py.File(self.folder / "modes.h5", "a") as file:
            replace(file, "modes/shape", 2 * file["modes/shape"][:])
        run = kernel(scene, self.folder / "bad", f"bodies.lower.mesh={self.folder / 'modes.h5'}", ranks=2)
        self.assertEqual(run.status, 2, run.err)
        self.assertIn("smaller than the flexibility of the modes", run.err)
        self.assertFalse(list((self.folder / "bad").glob("*.h5")))

    def test_modes_of_a_supported_body_give_the_same_kernel_loads_and_receivers(self):
        held = np.unique(self.box.top)
        free = np.setdiff1d(np.arange(len(self.mass)), [3 * held, 3 * held + 1, 3 * held + 2])
        self.write_by_the_book(self.folder / "modes.h5", free)
        at = self.box.node[1].tolist()
        sets = [
            "bodies.box.velocity=[0,0,0]",
            f'output={{receiver=[{{name="mic",body="box",at={at}}}]}}',
            'loads={gravity=[0,0,-1],traction=[{body="box",group="foot",vector=[1,0,0]}]}',
        ]
        self.succeed(
            kernel(
                self.all / "imported.toml",
                self.folder / "matrices",
                'bodies.box.support={"top"="xyz"}',
                *sets,
            )
        )
        self.succeed(
            kernel(
                self.all / "imported.toml",
                self.folder / "modes",
                f"bodies.box.mesh={self.folder / 'modes.h5'}",
                *sets,
            )
        )
        matrices, modes = (self.one(self.folder / name) for name in ("matrices", "modes"))
        self.assertSameKernel(matrices, modes, SHAPES)
        matrices, modes = static_responses(matrices), static_responses(modes)
        self.assertEqual(set(matrices), set(modes))
        for name, value in matrices.items():
            self.assertLess(abs(value - modes[name]).max(), SHAPES * max(abs(value).max(), 1e-3), name)

    def refused(self, words, **changes):
        matrices = {"stiffness": self.stiffness, "mass": self.mass}
        node, foot = changes.pop("node", self.box.node), changes.pop("foot", self.box.foot)
        matrices = {name: coordinates(matrix) for name, matrix in (matrices | changes).items()}
        Body(node, matrices, {"foot": [foot]}).write(self.folder / "bad.h5")
        run = kernel(
            self.all / "imported.toml", self.folder / "out", f"bodies.box.mesh={self.folder / 'bad.h5'}"
        )
        self.assertEqual(run.status, 2, run.err)
        (line,) = [line for line in run.err.splitlines() if line]
        self.assertIn(words, line)
        self.assertFalse(list((self.folder / "out").glob("*.h5")))

    def test_matrices_of_no_body_are_refused(self):
        n = len(self.stiffness)
        bent = self.stiffness.copy()
        bent[3, 4] *= 1.01
        self.refused('"/stiffness" is not symmetric: row 3', stiffness=bent)
        coupled = self.mass.copy()
        for k in range(3):
            coupled[k, 3 + k] = coupled[3 + k, k] = 2 * coupled[0, 0]
        self.refused("mass is not positive definite: 3 of its eigenvalues", mass=coupled)
        self.refused("resists rigid motion", stiffness=self.stiffness + 1e-2 * np.eye(n))
        # A node at the place of another one, held to it by a spring along (1, 1, 1) alone: two directions are loose.
        spring = np.zeros((n + 3, n + 3))
        spring[:n, :n] = self.stiffness
        ends = np.concatenate([np.ones(3), np.zeros(n - 3), -np.ones(3)])
        heavier = np.zeros((n + 3, n + 3))
        heavier[:n, :n], heavier[n:, n:] = self.mass, 0.1 * np.eye(3)
        self.refused(
            "8 modes at zero frequency, but 6 rigid motions",
            stiffness=spring + np.outer(ends, ends),
            mass=heavier,
            node=np.vstack([self.box.node, self.box.node[0]]),
        )
        self.refused("names node 39: nodes are numbered 0 to 35", foot=self.box.foot + 35)
        by_component = np.arange(n).reshape(-1, 3).T.ravel()
        self.refused(
            "row 3·node + k",
            stiffness=self.stiffness[np.ix_(by_component, by_component)],
            mass=self.mass[np.ix_(by_component, by_component)],
        )

    def test_modes_that_can_t_be_whole_are_refused(self):
        book = self.folder / "modes.h5"
        self.write_by_the_book(book)
        for words, change in (
            (
                "has 5 modes near zero",
                lambda file: replace(file, "modes/angular_frequency", np.maximum(0, np.arange(102) - 4)),
            ),
            (
                "smaller than the flexibility of the modes",
                lambda file: replace(file, "modes/shape", 2 * file["modes/shape"][:]),
            ),
        ):
            path = self.folder / "changed.h5"
            shutil.copy(book, path)
            with h5py.File(path, "a") as file:
                change(file)
            run = kernel(self.all / "imported.toml", self.folder, f"bodies.box.mesh={path}")
            self.assertEqual(run.status, 2, run.err)
            self.assertIn(words, run.err)

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
            subprocess.run(["ccx", name], cwd=self.folder, check=True, capture_output=True)
        self.succeed(Run([BIN / "ricochet", "import", "calculix", self.folder / "stored.inp"]))
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
        # Printed with seven digits.
        np.testing.assert_allclose(omega, [float(words[2]) for words in table[6:]], rtol=2e-7)
        np.testing.assert_allclose(node, box.node, atol=1e-12)
        self.assertEqual(
            {frozenset(row) for row in facets.tolist()}, {frozenset(row) for row in box.foot.tolist()}
        )
        # Facets run so that the normal points out.
        side = node[facets]
        self.assertTrue((np.cross(side[:, 1] - side[:, 0], side[:, 2] - side[:, 0])[:, 2] < 0).all())

    def test_lists_that_do_not_fit_are_refused(self):
        files = [self.all / name for name in ("K.mtx", "M.mtx", "nodes.txt")]
        few = self.write("few.txt", listed(self.box.node[:-1]))
        far = self.write("far.txt", listed(self.box.foot + 30))
        half = self.write("half.txt", listed(self.box.foot + 0.5))
        text = files[0].read_text()

        def changed(name, old, new):
            self.assertIn(old, text)
            return [self.write(name, text.replace(old, new, 1)), *files[1:]]

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
            ("entry 2 is 1.7 1", changed("half.mtx", "\n2 1 ", "\n1.7 1 ")),
            ("must be finite numbers", changed("inf.mtx", text.splitlines()[4], "2 1 inf")),
            ("both triangles", changed("both.mtx", "\n2 1 ", "\n1 2 ")),
            ("has sizes", changed("sizes.mtx", "\n108 ", "\n" + 5000 * "1" + " ")),
            ("is one of the inputs", [*files, "--out", files[1]]),
            ("must be NAME=FILE", [*files, "--surface", b"\xff=foot"]),
            ("%%MatrixMarket matrix coordinate real", [few, *files[1:]]),
        ]
        for words, arguments in cases:
            with self.subTest(words):
                self.refuses(words, ["matrices", "--out", self.folder / "no.h5", *arguments])
        self.assertFalse(list(self.folder.glob("no.h5*")))
        unwritten = self.folder / "none" / "box.h5"
        run = Run([BIN / "ricochet", "import", "matrices", *files, "--out", unwritten])
        self.assertEqual((run.status, run.err.count("\n")), (2, 1), run.err)
        self.assertIn(f"{unwritten}: cannot be written", run.err)

    def test_bodies_that_can_never_touch_are_warned_of(self):
        command = [
            BIN / "ricochet",
            "import",
            "matrices",
            *(self.all / name for name in ("K.mtx", "M.mtx", "nodes.txt")),
            "--out",
            self.folder / "box.h5",
        ]
        self.assertIn("warning: no surface", self.succeed(Run(command)).err)
        mixed = self.box.foot.copy()
        mixed[:2] = mixed[:2, ::-1]
        for facets, words in (
            (self.box.foot, ""),
            (mixed, "2 of 6 facets run clockwise"),
            (mixed[:, :3], "2 of 6"),
            (self.box.top[:, ::-1], "6 of 6"),
        ):
            err = self.succeed(
                Run([*command, "--surface", f"foot={self.write('foot.txt', listed(facets + 1))}"])
            ).err
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

    def refuses(self, words, arguments, lead=()):
        command = [*lead, BIN / "ricochet", "import", *arguments]
        done = subprocess.run(
            [w if isinstance(w, bytes) else str(w) for w in command],
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn(words, done.stderr.splitlines()[-1])
        self.assertNotIn("Traceback", done.stderr)
        self.assertNotIn("Warning", done.stderr)

    def test_lists_of_one_name_are_one_list(self):
        files = [self.all / name for name in ("K.mtx", "M.mtx", "nodes.txt")]
        both = [
            word
            for name in ("foot", "top")
            for kind in ("--surface", "--support")
            for word in (kind, f"s={self.all / name}.txt")
        ]
        self.succeed(
            Run([BIN / "ricochet", "import", "matrices", *files, *both, "--out", self.folder / "both.h5"])
        )
        with h5py.File(self.folder / "both.h5") as file:
            np.testing.assert_array_equal(
                file["surface/s/4"][:], np.concatenate([self.box.foot, self.box.top])
            )
            np.testing.assert_array_equal(file["nodes/s"][:], np.unique([self.box.foot, self.box.top]))

    def test_a_full_disk_leaves_the_earlier_body_file(self):
        out = self.write("body.h5", "earlier")
        self.refuses(
            "body.h5: cannot be written (File too large)",
            ["matrices", *(self.all / name for name in ("K.mtx", "M.mtx", "nodes.txt")), "--out", out],
            ["prlimit", "--fsize=4096"],
        )
        self.assertEqual(
            [(path.name, path.read_text()) for path in self.folder.iterdir()], [("body.h5", "earlier")]
        )

    def test_decks_that_are_wrong_are_refused_by_their_line(self):
        deck = (
            "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4, ELSET=e\n1, 1, 2, 3, 4\n"
            "*SURFACE, NAME=foot\ne, S1\n"
        )
        path = self.write("job.inp", deck)
        self.assertEqual(
            [facets.tolist() for facets in Model(path).surfaces()["foot"]], [[[2, 1, 0]]]
        )  # clockwise from above
        for words, old, new in [
            ('line 9: surface foot has "S7"', "e, S1", "e, S7"),
            ('line 9: surface foot has "S0"', "e, S1", "e, S0"),
            ("line 9: names the set nope", "e, S1", "nope, S1"),
            ("line 9: .* element 99", "e, S1", "99, S1"),
            ('line 9: surface foot has ""', "e, S1", "e"),
            ('line 8: surface "skin"', "foot", "skin"),
            ("line 10: includes .* being read already", "e, S1\n", "e, S1\n*INCLUDE, INPUT=job.inp\n"),
            ("element 1 is there twice", "3, 4\n", "3, 4\n1, 1, 2, 3, 4\n"),
            ("line 3: node 2 has a coordinate", "2, 1, 0", "2, nan, 0"),
            (r"line 3: can't be read as \*NODE", "2, 1, 0", "2, x, 0"),
        ]:
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


def replace(file, name, values):
    del file[name]
    file[name] = np.asarray(values, float)


if __name__ == "__main__":
    unittest.main()
