"""Bodies, contact problems and sounds that other programs make, solve and play: a box whose matrices numpy assembles."""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

from boxes import MATERIAL, Box, dense, listed, matrix_market
from programs import BIN, SOURCE, ProgramTest, Run, displacement_kernel, kernel, static_responses

sys.path.insert(0, str(SOURCE / "scripts" / "modules"))
from body_file import write_body  # noqa: E402

try:
    import siconos.numerics as siconos
except ImportError:
    siconos = None

SCENE = """
title = "Box"
[bodies.box]
mesh = "{mesh}"
{material}
damping = {{ loss_factor = 0.01 }}
contact = "foot"
velocity = [0, 0, -0.1]
[obstacles.floor]
normal = [0, 0, 1]
[modes]
count = 40
[contact]
between = ["box", "floor"]
gap = 0.01
[time]
rate_hz = 40
duration = 1.5
"""
TIMES = [0.1, 0.5, 2.0, 7.0]
# Bricks that are not straight have a stiffness whose integrand is no polynomial: two rules of quadrature differ by 1e-9.
QUADRATURE = 1e-8
# Shapes of modes are within their residuals, 1e-8, times a few tens of modes.
SHAPES = 1e-6
# Gravity, a traction, a receiver and a support that moves, in vectors that ranks work at together.
EVERYTHING = ['modes={up_to_hz=0.8,basis="contact"}', 'bodies.box.support={"top"="xz"}', "bodies.box.velocity=[0,0,0]",
              'loads={gravity=[0,0,-1],motion=[{body="box",group="top",vector=[1,0,0]}],'
              'traction=[{body="box",group="foot",vector=[1,0,0]}]}']


def coordinates(matrix):
    return *np.nonzero(matrix), matrix[np.nonzero(matrix)]


def single(scene, out, *sets):
    """ricochet-kernel without mpirun, which takes longer than the body."""
    return Run([BIN / "ricochet-kernel", scene, "--out", out, "--quiet"] + [w for s in sets for w in ("--set", s)])


class Interchange(ProgramTest):
    @classmethod
    def setUpClass(cls):
        scope = tempfile.TemporaryDirectory(prefix="ricochet-interchange-")
        cls.addClassCleanup(scope.cleanup)
        cls.all = pathlib.Path(scope.name)
        cls.box = Box()
        cls.stiffness, cls.mass = cls.box.matrices()
        texts = {"box.msh": cls.box.gmsh(), "K.mtx": matrix_market(cls.stiffness), "M.mtx": matrix_market(cls.mass, False),
                 "nodes.txt": listed(cls.box.node), "foot.txt": listed(cls.box.foot + 1), "top.txt": listed(cls.box.top + 1)}
        material = "material = {" + ", ".join(f"{key} = {value}" for key, value in MATERIAL.items()) + "}"
        texts |= {"own.toml": SCENE.format(mesh="box.msh", material=material),
                  "imported.toml": SCENE.format(mesh="box.h5", material="")}
        for name, text in texts.items():
            (cls.all / name).write_text(text)
        run = Run([SOURCE / "scripts" / "import", "matrices", *(cls.all / name for name in ("K.mtx", "M.mtx", "nodes.txt")),
                   "--surface", f"foot={cls.all / 'foot.txt'}", "--surface", f"top={cls.all / 'top.txt'}",
                   "--out", cls.all / "box.h5"])
        assert run.status == 0, run.err
        for name in ("own", "imported"):
            run = single(cls.all / f"{name}.toml", cls.all / name)
            assert run.status == 0, run.err

    def one(self, out):
        (path,) = pathlib.Path(out).glob("*.kernel.h5")
        return path

    def assertSameKernel(self, first, second, tolerance):
        """What contact can tell: the displacement kernel, its static rest, mass and momentum."""
        a, b = displacement_kernel(first, TIMES), displacement_kernel(second, TIMES)
        self.assertLess(abs(a - b).max(), tolerance * abs(a).max())
        with h5py.File(first) as one, h5py.File(second) as other:
            for name in ("surface/area", "surface/normal", "surface/centroid", "body/centre", "body/inertia",
                         "modes/angular_frequency", "surface/residual_flexibility"):
                size = abs(one[name][:]).max()
                self.assertLess(abs(one[name][:] - other[name][:]).max(), tolerance * size, name)
            self.assertAlmostEqual(one.attrs["mass"], other.attrs["mass"], delta=1e-12)
            for name in ("body_force", "rotation"):  # of a multiple mode, as rigid ones are, only this is known
                a, b = (file[f"loads/{name}"][:] @ file[f"loads/{name}"][:].T for file in (one, other))
                self.assertLess(abs(a - b).max(), tolerance * abs(a).max(), name)

    def test_matrices_give_the_kernel_of_the_mesh_that_they_are_of(self):
        self.succeed(kernel(self.all / "imported.toml", self.folder, ranks=2))
        for out in (self.all / "imported", self.folder):
            self.assertSameKernel(self.one(self.all / "own"), self.one(out), QUADRATURE)

    def test_ranks_share_matrices_and_supports_loads_and_receivers_are_those_of_the_mesh(self):
        at = self.box.node[-3].tolist()
        sets = [*EVERYTHING, f'output={{view=true,receiver=[{{name="mic",body="box",at={at}}}]}}']
        self.succeed(single(self.all / "own.toml", self.folder / "own", *sets))
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

    def write_by_the_book(self, path, free=None):
        """All modes, by the writer in docs/interchange.md."""
        page = (SOURCE / "docs" / "interchange.md").read_text()
        names = {}
        exec(re.search(r"```python\n(.*?def write_modes.*?)```", page, re.DOTALL).group(1), names)
        squares, shape, flexibility = self.modes(np.arange(len(self.mass)), 6) if free is None else self.modes(free)
        node = self.box.node
        weight = self.mass[::3, ::3] @ np.ones(len(node))
        centre = weight @ node / weight.sum()
        second = (node - centre).T @ self.mass[::3, ::3] @ (node - centre)
        names["write_modes"](path, node, {"foot": self.box.foot}, np.sqrt(squares),
                             shape.reshape(len(node), 3, -1), weight.sum(), centre, np.trace(second) * np.eye(3) - second,
                             flexibility)
        if free is None:
            return
        along = np.stack([np.kron(np.ones(len(node)), e) for e in np.eye(3)])
        turn = np.stack([np.cross(e, node).ravel() for e in np.eye(3)])
        with h5py.File(path, "a") as file:
            file.attrs["supported"] = 1
            file["modes/body_force"], file["modes/rotation"] = along @ self.mass @ shape, turn @ self.mass @ shape
            file["static/body_force"] = flexibility @ self.mass @ along.T

    def test_modes_from_elsewhere_give_the_same_kernel(self):
        self.write_by_the_book(self.folder / "modes.h5")
        self.succeed(kernel(self.all / "imported.toml", self.folder, f"bodies.box.mesh={self.folder / 'modes.h5'}", ranks=2))
        self.assertSameKernel(self.one(self.all / "imported"), self.one(self.folder), SHAPES)
        with h5py.File(self.one(self.folder)) as file:
            self.assertFalse(file["modes/certificate"].attrs["complete"])

    def test_modes_of_a_supported_body_give_the_same_kernel_loads_and_receivers(self):
        held = np.unique(self.box.top)
        free = np.setdiff1d(np.arange(len(self.mass)), [3 * held, 3 * held + 1, 3 * held + 2])
        self.write_by_the_book(self.folder / "modes.h5", free)
        at = self.box.node[1].tolist()
        sets = ["bodies.box.velocity=[0,0,0]", f'output={{receiver=[{{name="mic",body="box",at={at}}}]}}',
                'loads={gravity=[0,0,-1],traction=[{body="box",group="foot",vector=[1,0,0]}]}']
        self.succeed(single(self.all / "imported.toml", self.folder / "matrices", 'bodies.box.support={"top"="xyz"}', *sets))
        self.succeed(single(self.all / "imported.toml", self.folder / "modes",
                            f"bodies.box.mesh={self.folder / 'modes.h5'}", *sets))
        matrices, modes = (self.one(self.folder / name) for name in ("matrices", "modes"))
        self.assertSameKernel(matrices, modes, SHAPES)
        matrices, modes = static_responses(matrices), static_responses(modes)
        self.assertEqual(set(matrices), set(modes))
        for name, value in matrices.items():
            self.assertLess(abs(value - modes[name]).max(), SHAPES * max(abs(value).max(), 1e-3), name)

    def refused(self, words, **changes):
        matrices = {"stiffness": self.stiffness, "mass": self.mass}
        node, foot = changes.pop("node", self.box.node), changes.pop("foot", self.box.foot)
        write_body(self.folder / "bad.h5", node, {"foot": [foot]},
                   {name: coordinates(matrix) for name, matrix in (matrices | changes).items()})
        run = single(self.all / "imported.toml", self.folder / "out", f"bodies.box.mesh={self.folder / 'bad.h5'}")
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
        self.refused("8 modes at zero frequency, but 6 rigid motions", stiffness=spring + np.outer(ends, ends), mass=heavier,
                     node=np.vstack([self.box.node, self.box.node[0]]))
        self.refused("names node 39: nodes are numbered 0 to 35", foot=self.box.foot + 35)
        by_component = np.arange(n).reshape(-1, 3).T.ravel()
        self.refused("row 3·node + k", stiffness=self.stiffness[np.ix_(by_component, by_component)],
                     mass=self.mass[np.ix_(by_component, by_component)])

    def test_modes_that_can_t_be_whole_are_refused(self):
        book = self.folder / "modes.h5"
        self.write_by_the_book(book)
        for words, change in (("has 5 modes near zero", lambda file: replace(file, "modes/angular_frequency", np.maximum(
                                  0, np.arange(102) - 4))),
                              ("less than what the modes have", lambda file: replace(file, "modes/shape",
                                                                                     2 * file["modes/shape"][:]))):
            path = self.folder / "changed.h5"
            shutil.copy(book, path)
            with h5py.File(path, "a") as file:
                change(file)
            run = single(self.all / "imported.toml", self.folder, f"bodies.box.mesh={path}")
            self.assertEqual(run.status, 2, run.err)
            self.assertIn(words, run.err)

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed: scripts/setup --tests")
    def test_matrices_of_calculix_have_its_frequencies(self):
        box, names = self.box, {"stored": ", SOLVER=MATRIXSTORAGE", "solved": ""}
        lines = ["*NODE, NSET=all", *(f"{10 * k}, {x!r}, {y!r}, {z!r}" for k, (x, y, z) in enumerate(box.node.tolist(), 1)),
                 "*ELEMENT, TYPE=C3D8, ELSET=body",
                 *(f"{k}, " + ", ".join(str(10 * (node + 1)) for node in nodes) for k, nodes in enumerate(box.brick, 1)),
                 "*ELSET, ELSET=lower, GENERATE", f"1, {len(box.foot)}, 1", "*SURFACE, NAME=foot", "lower, S1",
                 "*MATERIAL, NAME=stuff", "*ELASTIC", "{young}, {poisson}".format(**MATERIAL),
                 "*DENSITY", str(MATERIAL["density"]), "*SOLID SECTION, ELSET=body, MATERIAL=stuff", "*STEP"]
        for name, solver in names.items():
            self.write(f"{name}.inp", "\n".join([*lines, "*FREQUENCY" + solver, "20", "*END STEP", ""]))
            subprocess.run(["ccx", name], cwd=self.folder, check=True, capture_output=True)
        self.succeed(Run([SOURCE / "scripts" / "import", "calculix", self.folder / "stored.inp"]))
        self.succeed(single(self.all / "imported.toml", self.folder, f"bodies.box.mesh={self.folder / 'stored.h5'}",
                            "modes.count=20"))
        table = [line.split() for line in (self.folder / "solved.dat").read_text().splitlines()[7:27]]
        with h5py.File(self.one(self.folder)) as file, h5py.File(self.folder / "stored.h5") as body:
            omega = file["modes/angular_frequency"][6:20]
            facets, node = body["surface/foot/4"][:], body["node"][:]
        # Printed with seven digits.
        np.testing.assert_allclose(omega, [float(words[2]) for words in table[6:]], rtol=2e-7)
        np.testing.assert_allclose(node, box.node, atol=1e-12)
        self.assertEqual({frozenset(row) for row in facets.tolist()}, {frozenset(row) for row in box.foot.tolist()})
        # Facets run so that the normal points out.
        side = node[facets]
        self.assertTrue((np.cross(side[:, 1] - side[:, 0], side[:, 2] - side[:, 0])[:, 2] < 0).all())

    def test_lists_that_do_not_fit_are_refused(self):
        files = [self.all / name for name in ("K.mtx", "M.mtx", "nodes.txt")]
        few = self.write("few.txt", listed(self.box.node[:-1]))
        far = self.write("far.txt", listed(self.box.foot + 30))
        cases = [("is 108 x 108: 35 nodes have 105", [*files[:2], few]),
                 ("names node 37: nodes are numbered 1 to 36", [*files, "--surface", f"foot={far}"]),
                 ("%%MatrixMarket matrix coordinate real", [few, *files[1:]])]
        for words, arguments in cases:
            run = Run([SOURCE / "scripts" / "import", "matrices", *arguments, "--out", self.folder / "no.h5"])
            self.assertEqual(run.status, 2, run.err)
            self.assertIn(words, run.err)
        self.assertFalse(list(self.folder.glob("no.h5*")))

    def problems(self):
        """What --fclib wrote of a box that falls flat on the floor, and the forces of the run."""
        self.succeed(Run([BIN / "ricochet-contact", self.all / "imported.toml", "--out", self.all / "imported", "--quiet",
                          "--fclib", self.folder / "fclib", "--fclib-every", 4]))
        with h5py.File(self.all / "imported" / "box.result.h5") as file:
            forces = dict(zip(np.rint(file["contact/time"][:] * 40).astype(int), file["contact/force"][:]))
        return sorted((self.folder / "fclib").glob("*.hdf5")), forces

    def test_problems_of_steps_have_the_layout_of_fclib(self):
        files, forces = self.problems()
        steps = [int(re.fullmatch(r"box-i(\d{8})-12\.hdf5", path.name).group(1)) for path in files]
        self.assertEqual(steps, sorted(forces)[::4])
        for path, step in zip(files, steps):
            with h5py.File(path) as file:
                matrix = file["fclib_local/W"]
                sizes = {name: matrix[name][0] for name in ("m", "n", "nz", "nzmax")}
                self.assertEqual(sizes, {"m": 36, "n": 36, "nz": -2, "nzmax": 12 * 12 + 24})
                self.assertEqual(file["fclib_local/spacedim"][0], 3)
                full = dense(matrix)
                self.assertGreater(np.linalg.eigvalsh(full)[0], 0)
                r, u, q = file["solution/r"][:], file["solution/u"][:], file["fclib_local/vectors/q"][:]
                self.assertEqual(file["guesses/number_of_guesses"][0], 1)
                np.testing.assert_array_equal(file["guesses/1/r"][:], r)
                self.assertTrue((file["fclib_local/vectors/mu"][:] == 0).all() and file["fclib_local/vectors/mu"].shape == (12,))
                # FCLIB's reader takes the size of the type for the text with its final zero.
                self.assertEqual(file["fclib_local/info/title"].dtype.itemsize, len("Box") + 1)
            np.testing.assert_allclose(r[::3], forces[step], rtol=0, atol=1e-15 * abs(r).max())
            size = 0.01  # m: gaps are differences of displacements as large as the first one
            self.assertLess(abs(full @ r + q - u).max(), 1e-14 * size)
            self.assertGreater(u.min(), -1e-13 * size)
            self.assertLess(abs(r @ u), 1e-13 * size * r.sum())

    @unittest.skipUnless(siconos, "Siconos is not installed: scripts/setup --tests")
    def test_siconos_finds_the_same_forces(self):
        files, forces = self.problems()
        peak = np.max(list(forces.values()))
        for path in files:
            with h5py.File(path) as file:
                matrix, q = dense(file["fclib_local/W"]), file["fclib_local/vectors/q"][:]
                mu, ours = file["fclib_local/vectors/mu"][:], file["solution/r"][:]
            # Lemke's algorithm pivots to the exact solution; Gauss–Seidel stops at its tolerance.
            z, w = np.zeros(mu.size), np.zeros(mu.size)
            problem = siconos.LCP(np.asfortranarray(matrix[::3, ::3]), q[::3].copy())
            options = siconos.SolverOptions(siconos.SICONOS_LCP_LEMKE)
            self.assertEqual(siconos.linearComplementarity_driver(problem, z, w, options), 0)
            self.assertLess(abs(z - ours[::3]).max(), 1e-9 * peak)
            r, u = np.zeros(q.size), np.zeros(q.size)
            cones = siconos.FrictionContactProblem(3, matrix, q, mu)
            options = siconos.SolverOptions(siconos.SICONOS_FRICTION_3D_NSGS)
            options.dparam[0], options.iparam[0] = 1e-10, 100000
            self.assertEqual(siconos.fc3d_driver(cones, r, u, options), 0)
            self.assertLess(abs(r - ours).max(), 1e-5 * peak)

    def test_only_problems_of_one_step_and_all_points_are_written(self):
        run = Run([BIN / "ricochet-contact", self.all / "imported.toml", "--out", self.all / "imported", "--set",
                   "contact.scheme=impulse", "--fclib", self.folder / "fclib"])
        self.assertEqual(run.status, 2)
        self.assertIn("--fclib: only contact.scheme", run.err)
        self.assertFalse((self.folder / "fclib").exists())

    def faust(self, *arguments):
        return Run([SOURCE / "scripts" / "faust", *arguments])

    @unittest.skipUnless(shutil.which("faust"), "Faust is not installed: scripts/setup --tests")
    def test_faust_plays_the_modes_of_the_body(self):
        """The answer to an impulse of 1 N s, as compiled by faust, beside Σ φ φ e^{−δt} (cos ω_d t − δ/ω_d sin ω_d t)."""
        file, rate, count = self.one(self.all / "imported"), 50, 200
        text = self.succeed(self.faust(file, "--excite", 3, "--receive", 7, "--receive", "0,0,0:1,1,0", "--rate", rate)).out
        self.write("box.dsp", text)
        subprocess.run(["faust", "-lang", "cpp", "-cn", "Body", "box.dsp", "-o", "body.hpp"], cwd=self.folder, check=True)
        self.write("main.cpp", PLAYER)
        subprocess.run(["g++", "-O0", "main.cpp", "-o", "player"], cwd=self.folder, check=True)
        heard = np.loadtxt(Run([self.folder / "player", rate, count]).out.splitlines())
        with h5py.File(file) as kernel_file:
            omega, decay = kernel_file["modes/angular_frequency"][6:], kernel_file["modes/decay_rate"][6:]
            shape, normal = kernel_file["surface/shape"][:, :, 6:], kernel_file["surface/normal"][:]
            node = kernel_file["surface/node"][:]
        struck = normal[3] @ shape[3]
        at_corner = np.array([1, 1, 0]) / np.sqrt(2) @ shape[np.argmin(np.linalg.norm(node, axis=1))]
        gains = np.stack([struck * (normal[7] @ shape[7]), struck * at_corner])
        damped, time = np.sqrt(omega**2 - decay**2), np.arange(count)[:, None] / rate
        answer = np.exp(-decay * time) * (np.cos(damped * time) - decay / damped * np.sin(damped * time))
        answer[0] = 0.5  # the jump at t = 0 is met half way
        error = abs(heard - answer @ gains.T)
        # Of a mode: 2 δ/rate + (ω/rate)² δ/ω by the numerator 1 − z⁻²; in single precision, ω_d by 4·2⁻²⁴/sin(ω_d/rate) a sample.
        of_mode = 2 * decay / rate + omega * decay / rate**2 + np.arange(count)[:, None] * 4 * 2.0**-24 / np.sin(damped / rate)
        self.assertLess((error / (of_mode @ abs(gains).T)).max(), 1)
        self.assertGreater(abs(answer @ gains.T).max(), 20 * error.max())

    def test_places_that_are_not_there_are_refused(self):
        file = self.one(self.all / "imported")
        for words, excite, more in (("contact points 0 to 11", "12", []), ("\"mic\" is no receiver", "mic", []),
                                    ("no mode rings below 0.05 Hz", "1", ["--rate", 0.1]), ("is no direction", "1:w", [])):
            run = self.faust(file, "--excite", excite, "--receive", 1, *more)
            self.assertEqual((run.status, run.out), (2, ""))
            self.assertIn(words, run.err)


PLAYER = """
#include <cstdio>
#include <cstdlib>
struct Meta { void declare(const char*, const char*) {} };
struct UI { void openVerticalBox(const char*) {} void closeBox() {} };
struct dsp {};
#include "body.hpp"
int main(int, char** words) {
  const int count = std::atoi(words[2]);
  auto* body = new Body;
  body->init(std::atoi(words[1]));
  float force[4096] = {static_cast<float>(std::atoi(words[1]))}, left[4096], right[4096];
  float *in[] = {force}, *out[] = {left, right};
  body->compute(count, in, out);
  for (int k = 0; k < count; ++k) std::printf("%.9g %.9g\\n", left[k], right[k]);
}
"""


def replace(file, name, values):
    del file[name]
    file[name] = np.asarray(values, float)


if __name__ == "__main__":
    unittest.main()
