# SPDX-License-Identifier: BSD-2-Clause
"""Bodies from other programs: a box with matrices assembled by numpy."""

import re
import shutil
import unittest

import h5py
import numpy as np

from box_test import BoxTest
from programs import BIN, SOURCE, Run, contact, displacement_kernel, impact, kernel, static_responses

from ricochet.interchange.body import Body

TIMES = [0.1, 0.5, 2.0, 7.0]
# The integrand of the stiffness of skewed bricks is not a polynomial: two quadrature rules differ by 1e-9.
QUADRATURE = 1e-8
# Mode shapes are accurate to their residuals, 1e-8, times a few tens of modes.
SHAPES = 1e-6
# Gravity, a traction, a receiver and a moving support, with vectors that ranks compute together.
EVERYTHING = [
    # Loads of all components span all vectors that are found; those along the normals alone leave the
    # choice of further vectors to round-off.
    'modes={up_to_hz=0.8,basis="contact",residual_components="all"}',
    'bodies.box.support={"top"="xz"}',
    "bodies.box.velocity=[0,0,0]",
    'loads={gravity=[0,0,-1],motion=[{body="box",group="top",vector=[1,0,0]}],'
    'traction=[{body="box",group="foot",vector=[1,0,0]}]}',
]


def coordinates(matrix):
    return *np.nonzero(matrix), matrix[np.nonzero(matrix)]


class Imports(BoxTest):
    def assertSameKernel(self, first, second, tolerance):
        """Compares the data that contact depends on: displacement kernel, residual, mass and momentum."""
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
            ):  # for multiple modes, such as rigid ones, only this product is unique
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
            with h5py.File(path) as file:  # Γ itself cancels in the slow response to a moving support
                gamma = file["motions/top/participation"][:]
            return static_responses(path) | {("top", "inertia"): gamma @ gamma.T}

        own, imported = (responses(self.one(self.folder / name)) for name in ("own", "imported"))
        self.assertEqual(set(own), set(imported))
        for name, value in own.items():
            self.assertLess(abs(value - imported[name]).max(), QUADRATURE * max(abs(value).max(), 1e-3), name)

    def test_gauges_need_elements(self):
        sets = [f'output.gauge=[{{name="foil",body="box",at={self.box.node[-3].tolist()}}}]']
        run = kernel(self.all / "imported.toml", self.folder, *sets)
        self.refused(run, 'output.gauge "foil": bodies.box has no elements', "leave the gauge out")

    def modes(self, free, rigid=0):
        """Modes by dense LAPACK on the free rows: ω², shapes at all rows, and Σ φφᵀ/ω², without the rigid modes."""
        lower = np.linalg.inv(np.linalg.cholesky(self.mass[np.ix_(free, free)]))
        squares, vectors = np.linalg.eigh(lower @ self.stiffness[np.ix_(free, free)] @ lower.T)
        shape = np.zeros((len(self.mass), squares.size - rigid))
        shape[free], squares = (lower.T @ vectors)[:, rigid:], squares[rigid:]
        return squares, shape, (shape / squares) @ shape.T

    def write_by_the_book(self, path, free=None, surface="foot", origin=(0, 0, 0)):
        """Writes all modes with the writer in docs/interchange.md. One side of the box takes part in contact."""
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
        self.succeed(kernel(*runs["imported"][:2], *runs["imported"][2]))
        found = {}
        for name, (scene, out, sets) in runs.items():
            self.succeed(contact(scene, out, *sets, "accuracy=0.1"))  # with the kernels of one mesh alone
            found[name] = self.summary(out)
        own, imported = found["own"], found["imported"]
        self.assertEqual((own["basis"], imported["basis"]), ({"box": "modes"}, {"box": "imported"}))
        self.assertGreater(own["contact_steps"], 10)
        for key in ("impulse_ns", "peak_force_n", "contact_end_s"):
            self.assertAlmostEqual(imported[key] / own[key], 1, delta=100 * SHAPES, msg=key)
        # A share of the energy at the start, of which it is the small difference of large terms.
        lost = "energy_lost_contact"
        self.assertAlmostEqual(imported[lost], own[lost], delta=100 * SHAPES)
        # The imported file has no residuals.
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
        self.refused(run, "not known to be complete")

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
            found[name] = impact(scene, self.folder / name, mesh, ranks=2).summary
        self.assertGreater(found["modes"]["contact_steps"], 10)
        self.assertAlmostEqual(
            found["modes"]["impulse_ns"] / found["matrices"]["impulse_ns"], 1, delta=100 * SHAPES
        )

        with h5py.File(self.folder / "modes.h5", "a") as file:
            replace(file, "modes/shape", 2 * file["modes/shape"][:])
        run = kernel(scene, self.folder / "bad", f"bodies.lower.mesh={self.folder / 'modes.h5'}", ranks=2)
        self.refused(run, "smaller than the flexibility of the modes")
        self.assertFalse(list((self.folder / "bad").glob("*.h5")))

    def test_modes_of_a_supported_body_give_the_same_kernel_loads_and_receivers(self):
        clamped = np.unique(self.box.top)
        free = np.setdiff1d(np.arange(len(self.mass)), [3 * clamped, 3 * clamped + 1, 3 * clamped + 2])
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

    def refuses(self, words, **changes):
        matrices = {"stiffness": self.stiffness, "mass": self.mass}
        node, foot = changes.pop("node", self.box.node), changes.pop("foot", self.box.foot)
        matrices = {name: coordinates(matrix) for name, matrix in (matrices | changes).items()}
        Body(node, matrices, {"foot": [foot]}).write(self.folder / "bad.h5")
        run = kernel(
            self.all / "imported.toml", self.folder / "out", f"bodies.box.mesh={self.folder / 'bad.h5'}"
        )
        self.refused(run, words)
        self.assertFalse(list((self.folder / "out").glob("*.h5")))

    def test_matrices_of_no_body_are_refused(self):
        n = len(self.stiffness)
        bent = self.stiffness.copy()
        bent[3, 4] *= 1.01
        self.refuses('"/stiffness" is not symmetric: row 3', stiffness=bent)
        coupled = self.mass.copy()
        for k in range(3):
            coupled[k, 3 + k] = coupled[3 + k, k] = 2 * coupled[0, 0]
        self.refuses("mass is not positive definite: 3 of its eigenvalues", mass=coupled)
        self.refuses("resists rigid motion", stiffness=self.stiffness + 1e-2 * np.eye(n))
        # A node coincides with another one and is connected to it only by a spring along
        # (1, 1, 1), so two directions are free.
        spring = np.zeros((n + 3, n + 3))
        spring[:n, :n] = self.stiffness
        ends = np.concatenate([np.ones(3), np.zeros(n - 3), -np.ones(3)])
        heavier = np.zeros((n + 3, n + 3))
        heavier[:n, :n], heavier[n:, n:] = self.mass, 0.1 * np.eye(3)
        self.refuses(
            "8 modes at zero frequency, but 6 rigid motions",
            stiffness=spring + np.outer(ends, ends),
            mass=heavier,
            node=np.vstack([self.box.node, self.box.node[0]]),
        )
        self.refuses("names node 39: nodes are numbered 0 to 35", foot=self.box.foot + 35)
        by_component = np.arange(n).reshape(-1, 3).T.ravel()
        self.refuses(
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


def replace(file, name, values):
    del file[name]
    file[name] = np.asarray(values, float)


if __name__ == "__main__":
    unittest.main()
