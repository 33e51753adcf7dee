# SPDX-License-Identifier: BSD-2-Clause
"""Exported contact problems and sounds, which other programs solve and play."""

import re
import shutil
import unittest

import h5py
import numpy as np

from box_test import BoxTest
from boxes import dense
from programs import BIN, Command, ProgramTest, Run, kernel, settings

import ricochet
from ricochet.interchange.instrument import instrument_of

try:
    import siconos.numerics as siconos
except ImportError:
    siconos = None


class Exports(BoxTest):
    def problems(self, *sets, every=4, out=None):
        """Returns the files that --fclib wrote for a box that falls flat on the floor, and the forces of the run.

        @param out  folder of the kernel; None: the one without friction
        """
        out = out or self.all / "imported"
        words = ["--fclib", self.folder / "fclib", "--fclib-every", every, *settings(sets)]
        scene = self.all / "imported.toml"
        self.succeed(Run([BIN / "ricochet-contact", scene, "--out", out, "--quiet", *words]))
        with h5py.File(out / "box.result.h5") as file:
            forces = dict(zip(np.rint(file["contact/time"][:] * 40).astype(int), file["contact/force"][:]))
        return sorted((self.folder / "fclib").glob("*.hdf5")), forces

    def rough_problems(self, *friction, more=()):
        """The same for a box that also slides, with friction and in steps of backward Euler."""
        sets = (
            *friction,
            "contact.integration=backward-euler",
            "bodies.box.velocity=[0.05, 0.02, -0.1]",
            *more,
        )
        out = self.folder / "rough"
        self.succeed(kernel(self.all / "imported.toml", out, *sets))
        return self.problems(*sets, every=1, out=out)

    def steps(self, files):
        return [int(re.fullmatch(r"box-i(\d{8})-12\.hdf5", path.name).group(1)) for path in files]

    def test_problems_of_conserving_steps_hold_the_forces_at_their_ends(self):
        files, forces = self.problems(every=1)
        ends = {}
        for path, step in zip(files, self.steps(files)):
            with h5py.File(path) as file:
                ends[step] = file["solution/r"][::3]
        # The first steps may be a shock, and the last ones may be reduced.
        inside = sorted(ends)[4:-4]
        self.assertGreater(len(inside), 10)
        for k in inside:
            mean = 0.625 * ends[k] + 0.25 * ends[k - 1] + 0.125 * ends[k - 2]
            np.testing.assert_allclose(forces[k], mean, rtol=1e-9, atol=1e-12 * max(mean))

    def test_problems_of_steps_have_the_layout_of_fclib(self):
        # Steps of backward Euler, so that forces of the run are those at the ends of steps.
        files, forces = self.problems("contact.integration=backward-euler")
        steps = self.steps(files)
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
                self.assertTrue(
                    (file["fclib_local/vectors/mu"][:] == 0).all()
                    and file["fclib_local/vectors/mu"].shape == (12,)
                )
                # FCLIB's reader relies on the type having the size of the text with its final zero.
                self.assertEqual(file["fclib_local/info/title"].dtype.itemsize, len("Box") + 1)
            np.testing.assert_allclose(r[::3], forces[step], rtol=0, atol=1e-15 * abs(r).max())
            size = 0.01  # m; gaps are differences of displacements that are as large as the first one
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
            # Lemke's algorithm pivots to the exact solution, whereas Gauss–Seidel stops at its tolerance.
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

    def test_problems_with_friction_hold_coulombs_law(self):
        mu = 0.3
        files, forces = self.rough_problems(f"contact.friction={mu}")
        found = {"open": 0, "stick": 0, "slip": 0}
        for path, step in zip(files, self.steps(files)):
            with h5py.File(path) as file:
                full = dense(file["fclib_local/W"])
                r, u, q = file["solution/r"][:], file["solution/u"][:], file["fclib_local/vectors/q"][:]
                np.testing.assert_array_equal(file["fclib_local/vectors/mu"][:], np.full(12, mu))
                self.assertEqual(file["fclib_local/W/nzmax"][0], 36 * 36)
            np.testing.assert_allclose(full, full.T, rtol=0, atol=1e-15 * abs(full).max())
            self.assertGreater(np.linalg.eigvalsh(full)[0], 0)
            np.testing.assert_allclose(r[::3], forces[step], rtol=0, atol=1e-15 * abs(r).max())
            size = (
                0.01  # m; gaps and slips are differences of displacements that are as large as the first gap
            )
            self.assertLess(abs(full @ r + q - u).max(), 1e-13 * size)
            for push, way in zip(r.reshape(-1, 3), u.reshape(-1, 3)):
                across, slip = np.hypot(*push[1:]), np.hypot(*way[1:])
                self.assertLessEqual(across, mu * push[0] * (1 + 1e-12))
                self.assertGreater(way[0], -1e-11 * size)
                self.assertLess(push[0] * way[0], 1e-11 * size * r.max())
                state = "open" if push[0] == 0 else "slip" if slip > 1e-9 * size else "stick"
                found[state] += 1
                if state == "slip":  # the force on the floor is along the slip −u of the box
                    np.testing.assert_allclose(push[1:], -mu * push[0] * way[1:] / slip, atol=1e-6 * across)
        self.assertGreater(min(found.values()), 5, found)

    @unittest.skipUnless(siconos, "Siconos is not installed: scripts/setup --tests")
    def test_siconos_finds_the_same_forces_of_friction(self):
        for friction in (
            ["contact.friction=0.2"],
            # μ differs from point to point and from step to step, so the files must give that of the step.
            ["contact.friction={static = 0.4, dynamic = 0.1, stribeck_velocity = 0.03}"],
        ):
            with self.subTest(friction):
                shutil.rmtree(self.folder / "fclib", ignore_errors=True)
                files, forces = self.rough_problems(*friction)
                self.assertGreater(len(files), 20)
                peak = np.max(list(forces.values()))
                coefficients = set()
                for path in files:
                    with h5py.File(path) as file:
                        matrix, q = dense(file["fclib_local/W"]), file["fclib_local/vectors/q"][:]
                        mu, ours = file["fclib_local/vectors/mu"][:], file["solution/r"][:]
                    coefficients.update(mu)
                    # In units of the mean flexibility, so that r and u are of one size. μ is so small that there is
                    # one solution.
                    unit = np.diag(matrix).mean()
                    cones = siconos.FrictionContactProblem(3, np.asfortranarray(matrix / unit), q / unit, mu)
                    for method in (siconos.SICONOS_FRICTION_3D_NSGS, siconos.SICONOS_FRICTION_3D_NSN_AC):
                        r, u = np.zeros(q.size), np.zeros(q.size)
                        options = siconos.SolverOptions(method)
                        options.dparam[0], options.iparam[0] = 1e-12, 100000
                        self.assertEqual(siconos.fc3d_driver(cones, r, u, options), 0)
                        self.assertLess(abs(r - ours).max(), 1e-6 * peak)
                self.assertEqual(len(coefficients) > 10, len(friction[0]) > 20)

    def test_only_problems_of_one_step_and_all_points_are_written(self):
        words = ["--set", "contact.scheme=impulse", "--fclib", self.folder / "fclib"]
        scene = self.all / "imported.toml"
        run = Run([BIN / "ricochet-contact", scene, "--out", self.all / "imported", *words])
        self.refused(run, "--fclib: only contact.scheme")
        self.assertFalse((self.folder / "fclib").exists())

    def faust(self, *arguments):
        return Command("export", "--faust", *arguments)

    @unittest.skipUnless(shutil.which("faust"), "Faust is not installed: scripts/setup --tests")
    def test_faust_plays_the_modes_of_the_body(self):
        """The response to an impulse of 1 N s, compiled by faust, is Σ φ φ e^{−δt} (cos ω_d t − δ/ω_d sin ω_d t)."""
        file, rate, count = self.one(self.all / "imported"), 50, 200
        text = self.succeed(
            self.faust(file, "--excite", 3, "--receive", 7, "--receive", "0,0,0:1,1,0", "--rate", rate)
        ).out
        self.assertEqual(text.splitlines()[0], 'declare name "box";')
        self.write("box.dsp", text)
        words = ["-lang", "cpp", "-cn", "Body", "box.dsp", "-o", "body.hpp"]
        self.succeed(Run(["faust", *words], cwd=self.folder))
        self.write("main.cpp", PLAYER)
        self.succeed(Run(["g++", "-O0", "main.cpp", "-o", "player"], cwd=self.folder))
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
        answer[0] = 0.5  # at the jump at t = 0, the filter gives the mean
        error = abs(heard - answer @ gains.T)
        # Error of a mode: 2 δ/rate + (ω/rate)² δ/ω by the numerator 1 − z⁻²; in single precision, ω_d errs
        # by 4·2⁻²⁴/sin(ω_d/rate) per sample.
        of_mode = (
            2 * decay / rate
            + omega * decay / rate**2
            + np.arange(count)[:, None] * 4 * 2.0**-24 / np.sin(damped / rate)
        )
        self.assertLess((error / (of_mode @ abs(gains).T)).max(), 1)
        self.assertGreater(abs(answer @ gains.T).max(), 20 * error.max())

    def test_places_that_are_not_there_are_refused(self):
        file = self.one(self.all / "imported")
        for words, excite, more in (
            ("contact points 0 to 11", "12", []),
            ('"mic" is not a receiver', "mic", []),
            ("no mode rings below 0.05 Hz", "1", ["--rate", 0.1]),
            ("is not a direction", "1:w", []),
        ):
            run = self.faust(file, "--excite", excite, "--receive", 1, *more)
            self.refused(run, words)
            self.assertEqual(run.out, "")

    def test_damaged_kernels_make_no_model(self):
        def version(file):
            file.attrs["version"] = 99

        def silent(file):
            file["modes/angular_frequency"][7] = float("nan")

        cases = [
            ('--receive: "²" is not a receiver', "²", None),
            ('"." is not a receiver', ".:x", None),
            ('"nan,0,0" is not a receiver', "nan,0,0", None),
            ("has format version 99", 7, version),
            ("not finite numbers", 7, silent),
        ]
        cases += [
            (f'"/{name}" is missing', 7, lambda file, name=name: file.__delitem__(name))
            for name in ("surface/node", "surface/shape", "modes/angular_frequency")
        ]
        for words, place, change in cases:
            path = shutil.copy(self.one(self.all / "imported"), self.folder / "damaged.kernel.h5")
            if change:
                with h5py.File(path, "r+") as file:
                    change(file)
            with self.subTest(words):
                run = self.faust(path, "--excite", 3, "--receive", place)
                self.refused(run, words)
                self.assertEqual(run.out, "")


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


BAR = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 0.35, 0.05, 0.02};
Physical Volume("body") = {1};
Physical Surface("skin") = {1:6};
Mesh.MeshSizeMax = 0.015;
"""
BALL = """
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 0.012};
Physical Volume("body") = {1};
Physical Surface("skin") = {1};
Mesh.MeshSizeMax = 0.006;
"""
STRUCK_BAR = """
[bodies.bar]
mesh = "bar.geo"
order = 1
rotate_deg = [0, 0, 90]
translate = [0.02, 0, 0]
material = { density = 1200, young = 15e9, poisson = 0.3 }
damping = { loss_factor = 4e-3 }
contact = "skin"
[bodies.ball]
mesh = "ball.geo"
order = 1
translate = [0, 0.05, 0.05]
material = { density = 1100, young = 50e6, poisson = 0.4 }
velocity = [0, 0, -1]
contact = "skin"
[modes]
up_to_hz = 20000
[contact]
between = ["ball", "bar"]
direction = [0, 0, -1]
gap = 1e-5
reach = 2e-3
[time]
rate_hz = 88200
duration = 0.02
[output]
receiver = [
  { name = "mic", body = "bar", at_body = [0.08, 0.025, 0.019] },
  { name = "own", body = "bar", at_body = [0.08, 0.025, 0.019], axes = "body" },
]
"""


class Heard(ProgramTest):
    """A free bar that a soft ball strikes, for the channels of an instrument."""

    @classmethod
    def setUpClass(cls):
        folder = cls.shared_folder()
        for name, text in (("bar.geo", BAR), ("ball.geo", BALL), ("bar.toml", STRUCK_BAR)):
            (folder / name).write_text(text)
        cls.scene = ricochet.Scene(folder / "bar.toml")
        cls.kernels = ricochet.kernels(cls.scene)

    def heard(self, **sound):
        scene = self.scene.changed({f"output.sound.{key}": value for key, value in sound.items()})
        return instrument_of(scene, self.kernels, most=0)

    # The receiver is near a node of the lowest bending mode, which the blow excites most. High modes move it most along z if all
    # have the same share, but the soft ball hardly excites them.
    def test_axis_is_the_one_that_is_loudest_after_the_blow(self):
        pickups = [ricochet.Pickup("bar", axis, "mic") for axis in np.eye(3).tolist()]
        simulation = ricochet.Simulation(self.scene, self.kernels, pickups)
        sound = simulation.step_block(4000).velocity[1000:]  # after the blow
        self.assertEqual(simulation.active, 0)
        loud = (sound - sound.mean(axis=0)).std(axis=0)  # a free body goes on
        self.assertGreater(loud[1], 2 * loud[2])
        self.assertEqual(self.heard().channels, ["mic y", "own x"])

    def test_sound_of_the_scene_is_heard_along_its_direction(self):
        mono = self.heard(receivers="mic", direction=[0, 0, 2])
        self.assertEqual(mono.channels, ["mic along [0, 0, 1]"] * 2)
        z = ricochet.Kernel(next(self.scene.out.glob("bar-*.h5"))).receivers["mic"].shape[2]
        self.assertLess(np.abs(mono.sound - z).max(), 1e-12 * np.abs(z).max())

    def test_direction_is_in_the_axes_of_the_receiver(self):
        both = self.heard(receivers=["own", "mic"], direction=[1, 0, 0])
        self.assertEqual(both.channels, ["own along [1, 0, 0]", "mic along [1, 0, 0]"])
        x, y, _ = self.kernels["bar"].receivers["own"].shape  # of the mesh, which is turned from x to y
        self.assertLess(np.abs(both.sound - [x, -y]).max(), 1e-12 * np.abs(x).max())


if __name__ == "__main__":
    unittest.main()
