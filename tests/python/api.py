# SPDX-License-Identifier: BSD-2-Clause
"""The Python interface: scenes, kernels, impacts, steps, studies, and the texts shown in notebooks."""

import _thread
import contextlib
import gc
import pathlib
import pickle
import shutil
import subprocess
import sys
import tempfile
import signal
import threading
import time
import unittest
import warnings
from unittest import mock
from xml.etree import ElementTree

import h5py
import numpy as np
import scipy.integrate
import scipy.interpolate

import programs
import ricochet
from boxes import Box
from programs import MESHES, ProgramTest


MIC = {"name": "mic", "body": "resting", "at": [5, 0, 0]}


def setUpModule():
    # A shell starts tasks in the background without this signal.
    signal.signal(signal.SIGINT, signal.default_int_handler)


class ScenesTest(ProgramTest):
    """Tests with a copy of the two rods: `self.file`, and `self.scene` with 30 modes."""

    def setUp(self):
        super().setUp()
        shutil.copytree(MESHES / "two-rods", self.folder / "rods", ignore=shutil.ignore_patterns("out"))
        self.file = self.folder / "rods" / "two-rods.toml"
        self.scene = ricochet.Scene(self.file)
        self.scene.set({"modes.count": 30, "output.view": False})


class KernelsTest(ScenesTest):
    """Tests with kernels, which are computed once for all tests of the class."""

    @classmethod
    def setUpClass(cls):
        scope = tempfile.TemporaryDirectory(prefix="ricochet-test-")
        cls.addClassCleanup(scope.cleanup)
        cls.stored = pathlib.Path(scope.name)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.stored, self.scene.out)
        self.kernels = ricochet.kernels(self.scene, ranks=1)
        shutil.copytree(self.scene.out, self.stored, dirs_exist_ok=True)


class Accelerations(KernelsTest):
    """A rod that is struck at 300 m/s. Waves of 10 km/s pass its middle after 0.5 ms and, reflected by the free end,
    after 1.5 ms; each of them changes the velocity there by 150 m/s."""

    RATE = 44100

    def setUp(self):
        super().setUp()
        shock = {f"bodies.{body}.material.young": 1e8 for body in ("moving", "resting")}
        shock |= {"bodies.moving.velocity": [300, 0, 0], "time.rate_hz": self.RATE, "time.duration": 0.006}
        self.scene.set(shock | {"output.receiver": [MIC]})
        ricochet.kernels(self.scene, ranks=1)
        shutil.copytree(self.scene.out, self.stored, dirs_exist_ok=True)

    def struck(self, **time):
        """The result with these keys of [time], and its figures of the receiver."""
        with warnings.catch_warnings(action="ignore"):
            result = ricochet.impact(
                self.scene.changed({f"time.{key}": value for key, value in time.items()})
            )
        return result, result.summary["acceleration"]["mic"]

    def test_behind_a_filter_are_those_of_the_waves(self):
        fine, peaks = self.struck(rate_hz=8 * self.RATE)
        _, coarse = self.struck(contact_rate_hz=8 * self.RATE)
        time = np.linspace(0, 0.006, 60001)
        for cfc in (60, 180, 600, 1000):
            # The response of the filter to a change of velocity by 1: its gain is 1/(1 + (f/f_d)⁴).
            corner = 2.0775 * cfc
            wanted = 0
            for arrival in (0.5e-3, 1.5e-3):
                turn = np.sqrt(2) * np.pi * corner * np.abs(time - arrival)
                response = np.exp(-turn) * (np.cos(turn) + np.sin(turn))
                wanted = wanted + 150 * np.pi * corner / np.sqrt(2) * response
            # 0.005: frequencies of the grid of output samples, and of elements
            self.assertAlmostEqual(
                peaks["cfc_peak_m_per_s2"][str(cfc)], wanted.max(), delta=0.006 * wanted.max()
            )
            # A wave front changes the velocity within one output sample, the largest of which misses the top.
            least = 1 - 0.015 - (np.sqrt(2) * np.pi * corner / self.RATE) ** 2 / 3
            share = coarse["cfc_peak_m_per_s2"][str(cfc)] / wanted.max()
            self.assertTrue(least < share < 1.006, (cfc, share))
        means = fine.receivers["mic"].mean_acceleration
        filtered = ricochet.cfc_filter(means, 8 * self.RATE, 600, rest=0)
        self.assertAlmostEqual(
            np.abs(filtered[:, 0]).max() / peaks["cfc_peak_m_per_s2"]["600"], 1, delta=1e-6
        )  # single precision

    def test_are_those_of_every_step_whatever_is_stored(self):
        every, peaks = self.struck(rate_hz=8 * self.RATE)
        size = np.abs(every.receivers["mic"].acceleration[:, 0])
        self.assertEqual(peaks["peak_m_per_s2"], size.max())
        self.assertEqual(peaks["time_s"], every.receiver_time[size.argmax()])
        self.scene.set({"output.every": 50, "output.receivers_rate_hz": self.RATE / 10})
        some, same = self.struck(contact_rate_hz=8 * self.RATE)
        self.assertLess(
            np.abs(some.receivers["mic"].acceleration).max(), 0.95 * peaks["peak_m_per_s2"]
        )  # between its rows
        self.assertAlmostEqual(same["peak_m_per_s2"] / peaks["peak_m_per_s2"], 1, delta=1e-9)

    def test_have_no_class_for_which_samples_are_too_few(self):
        _, peaks = self.struck(rate_hz=1800)
        self.assertEqual(
            [cfc for cfc, peak in peaks["cfc_peak_m_per_s2"].items() if peak is None], ["600", "1000"]
        )

    def test_of_other_programs_are_filtered_and_have_spectra(self):
        rate, q = 20e3, 25
        shock = np.zeros((2000, 2))
        shock[100:121, 0] = 500 * np.sin(np.linspace(0, np.pi, 21))
        shock[:, 1] = 9.81
        self.assertEqual(ricochet.cfc_filter(shock, rate, 60).shape, shock.shape)
        np.testing.assert_allclose(ricochet.cfc_filter(shock, rate, 60)[:, 1], 9.81)
        spectrum = ricochet.shock_response_spectrum(shock, rate, q=q)
        self.assertEqual(spectrum.acceleration.shape, (len(spectrum.frequency_hz), 2))
        self.assertEqual(spectrum.frequency_hz[0], 10)
        self.assertTrue(1800 < spectrum.frequency_hz[-1] <= 2000)
        np.testing.assert_allclose(spectrum.acceleration[:, 1], 9.81)
        k = np.abs(spectrum.frequency_hz - 400).argmin()
        turn = 2 * np.pi * spectrum.frequency_hz[k]
        base = scipy.interpolate.interp1d(np.arange(2000) / rate, shock[:, 0])
        moved = scipy.integrate.solve_ivp(
            lambda t, z: [z[1], -turn / q * z[1] - turn**2 * z[0] - base(t)],
            (0, 0.02),
            [0, 0],
            max_step=0.5 / rate,
            rtol=1e-9,
            atol=1e-12,
            t_eval=np.arange(400) / rate,
        )
        felt = np.abs(turn / q * moved.y[1] + turn**2 * moved.y[0])
        self.assertAlmostEqual(spectrum.acceleration[k, 0] / felt.max(), 1, delta=1e-4)
        for refused, message in {
            (lambda: ricochet.cfc_filter(shock, 599, 60)): "CFC 60 needs at least 600 samples",
            (lambda: ricochet.cfc_filter([], rate, 60)): "at least one sample",
            (lambda: ricochet.cfc_filter([np.nan], rate, 60)): "finite",
            (lambda: ricochet.shock_response_spectrum(shock, rate, [0])): "frequency_hz: must be above 0",
            (lambda: ricochet.shock_response_spectrum(shock, rate, q=0.5)): "critical damping",
            (lambda: ricochet.shock_response_spectrum(shock, -1)): "rate_hz = -1",
        }.items():
            with self.assertRaisesRegex(ricochet.InputError, message):
                refused()


class Scene(ScenesTest):
    def test_has_keys_as_given_and_defaults(self):
        self.assertEqual(self.scene["time.duration"], 30)
        self.assertEqual(self.scene["contact.between"], ["moving", "resting"])
        self.assertEqual(self.scene["contact.pair[0].between[1]"], "resting")
        self.assertEqual(self.scene["contact.scheme"], "compliant")  # a default
        self.assertNotIn("contact.gap", self.scene)
        for missing in ("contact.gap", "contact.pair[7]", "", "time.", "time..duration"):
            with self.assertRaises(KeyError):
                self.scene[missing]

    def test_takes_values_of_numpy_and_keys_in_quotes(self):
        self.scene["bodies.moving.velocity"] = np.array([2.0, 0, 0])
        self.scene['bodies.moving.support."left"'] = "yz"
        self.scene["time.rate_hz"] = np.float64(50)
        self.scene['obstacles."a wall"'] = {"normal": (1, 0, 0), "point": np.zeros(3)}
        self.assertEqual(self.scene["bodies.moving.velocity"], [2, 0, 0])
        self.assertEqual(self.scene['bodies.moving.support."left"'], "yz")
        self.assertEqual(self.scene.resolved["time"]["rate_hz"], 50)
        self.assertEqual(ricochet.Scene(self.scene.write(self.file)).to_toml(), self.scene.to_toml())

    def test_that_would_not_be_valid_is_refused_as_by_the_programs_and_stays_as_it_was(self):
        before = self.scene.to_toml()
        for key, value in {"time.rate_hz": -1, "x[": 1}.items():  # mistakes.py compares the lines of many
            run = programs.contact(self.file, self.folder, f"{key}={value}")
            with self.assertRaises(ricochet.InputError) as refused:
                self.scene[key] = value
            self.assertEqual(run.err, f"ricochet-contact: {refused.exception}\n")
            self.assertEqual(self.scene.to_toml(), before)

    def test_that_cannot_be_read_is_refused_in_one_line(self):
        self.write("broken.toml", "title = [")
        for name, why in {"none.toml": "no such file", "broken.toml": "broken.toml:1:"}.items():
            with self.assertRaisesRegex(ricochet.InputError, why) as refused:
                ricochet.Scene(self.folder / name)
            self.assertNotIn("\n", str(refused.exception))
        with self.assertRaisesRegex(ricochet.InputError, "scene.toml: bodies: is missing"):
            ricochet.Scene({"title": "Nothing"})

    def test_that_is_written_elsewhere_is_the_same_scene_with_the_same_kernels(self):
        path = self.scene.write(self.folder / "other" / "copy.toml")
        copy = ricochet.Scene(path)
        self.assertIn("[bodies.moving]\n", path.read_text())
        self.assertEqual(
            (path.parent / copy["bodies.moving.mesh"]).resolve(), self.folder / "rods" / "rod.geo"
        )
        same = copy.changed({f"bodies.{body}.mesh": "rod.geo" for body in copy.bodies})
        self.assertEqual(same.to_toml(), self.scene.to_toml())
        names = [[file.name for _, file, _ in s._core.kernel_files(s.out)] for s in (copy, self.scene)]
        self.assertEqual(*names)
        with self.assertRaisesRegex(ricochet.InputError, "cannot be written"):
            self.scene.write(self.file / "inside-a-file.toml")

    def test_of_a_dictionary_is_that_of_the_file(self):
        same = ricochet.Scene(self.scene.resolved, self.folder / "rods")
        self.assertEqual(same.to_toml(), self.scene.to_toml())
        self.assertEqual(same.out, self.scene.out)

    def test_without_contact_is_enough_for_kernels_alone(self):
        table = self.scene.resolved
        scene = ricochet.Scene({key: table[key] for key in ("bodies", "modes")}, self.folder / "rods")
        kernel = ricochet.kernels(scene, ranks=1)["moving"]
        self.assertEqual((len(kernel.frequency), len(kernel.modes.frequency_hz)), (30, 30))
        for function in (ricochet.impact, ricochet.Simulation):
            with self.assertRaisesRegex(ricochet.InputError, "contact: is missing"):
                function(scene)

    def test_that_is_changed_leaves_the_first_one_alone(self):
        fast = self.scene.changed({"bodies.moving.velocity": [2, 0, 0], "title": "Fast"})
        self.assertEqual((fast.title, fast.slug, fast["modes.count"]), ("Fast", "fast", 30))
        self.assertEqual(self.scene["bodies.moving.velocity"], [1, 0, 0])


class Kernels(KernelsTest):
    def test_are_those_of_a_rod(self):
        kernel = self.kernels["moving"]
        n = np.arange(30)
        # Linear elements have a relative error of (n pi / 100)^2 / 24, 3.5 % at n = 29.
        # The wave speed is 1, the length 10.
        np.testing.assert_allclose(kernel.frequency, n / 20, rtol=0.04, atol=1e-12)
        np.testing.assert_allclose(kernel.mass, 10)
        np.testing.assert_allclose(kernel.centre, [5, 0, 0])
        modes = kernel.modes
        # The rigid mode has the shape 1/√10 and hence the entire mass. The others are cosines with
        # shape² = 2/10 at the end and have no momentum.
        np.testing.assert_allclose(modes.effective_mass[:, 0], [10] + [0] * 29, atol=1e-9)
        # Their static flexibilities 0.2 / ω² add up to that of the end, L / 3. Linear
        # elements have the same error as above.
        self.assertTrue(np.isnan(modes.contact_share[0]))
        error = modes.contact_share[1:] * (np.pi * n[1:]) ** 2 / 6 - 1
        np.testing.assert_array_less(abs(error), 1e-3 + (n[1:] * np.pi / 100) ** 2 / 6)
        self.assertTrue(kernel.certificate.complete)
        self.assertEqual(kernel.certificate.count_found, 30)
        with h5py.File(kernel.path) as file:
            for name, array in {
                "modes/angular_frequency": kernel.angular_frequency,
                "modes/residual": kernel.residual,
                "surface/node": kernel.node,
                "surface/normal": kernel.normal,
                "surface/area": kernel.area,
                "surface/residual_flexibility": kernel.residual_flexibility,
                "loads/body_force": kernel.body_force,
            }.items():
                np.testing.assert_array_equal(file[name][:], array)
            np.testing.assert_array_equal(file["surface/shape"][:], kernel.shape[:, 0])
        with self.assertRaises(ValueError):
            kernel.shape[:] = 0
        self.assertIsNone(kernel.visualisation_surface)
        lines = (self.folder / "modes.csv", str(modes), modes._repr_html_())
        modes.to_csv(lines[0])
        table = np.genfromtxt(lines[0], delimiter=",", names=True)
        np.testing.assert_array_equal(table["frequency_hz"], modes.frequency_hz)
        self.assertEqual(len(lines[1].splitlines()), 35)
        self.assertEqual(len(ElementTree.fromstring(lines[2]).findall("tbody/tr")), 30)

    def test_have_arrays_that_outlive_them(self):
        path = self.kernels["moving"].path
        shape = ricochet.Kernel(path).shape
        gc.collect()
        np.testing.assert_array_equal(shape, ricochet.Kernel(path).shape)

    def test_that_are_there_are_not_computed_again(self):
        with mock.patch("ricochet.runs._compute", side_effect=AssertionError):
            again = ricochet.kernels(self.scene.write(self.file.with_name("copy.toml")))
        self.assertEqual(
            [kernel.hash for kernel in again.values()], [kernel.hash for kernel in self.kernels.values()]
        )

    def test_that_cannot_be_computed_are_refused_in_one_line(self):
        self.scene["bodies.moving.mesh"] = "none.geo"
        with self.assertRaisesRegex(ricochet.InputError, "none.geo"):
            ricochet.kernels(self.scene, ranks=1)
        with self.assertRaisesRegex(ricochet.InputError, "^[^\n]*no kernel for body[^\n]*$"):
            ricochet.impact(ricochet.Scene(self.file))
        with self.assertRaisesRegex(ricochet.InputError, "^[^\n]*no such file[^\n]*$"):
            ricochet.Kernel("none.kernel.h5")


class Impact(KernelsTest):
    def setUp(self):
        super().setUp()
        self.scene["output.snapshot_every"] = 100

    def by_program(self, scene):
        """The result file of ricochet-contact in a separate folder."""
        out = self.folder / "by-program"
        out.mkdir()
        for kernel in scene.out.glob("*.kernel.h5"):
            (out / kernel.name).symlink_to(kernel)
        self.succeed(programs.contact(scene.write(self.file.with_name("same.toml")), out))
        return out / f"{scene.slug}.result.h5"

    def test_has_the_arrays_of_the_program_bit_for_bit(self):
        self.scene.set({"output.receiver": [MIC], "time.duration": 5})  # resampling of long sounds takes long
        ricochet.kernels(self.scene, ranks=1)
        result = ricochet.impact(self.scene)
        with h5py.File(self.by_program(self.scene)) as file:
            arrays = {
                "time": result.time,
                "contact/time": result.contact_time,
                "contact/force": result.force,
                "contact/gap": result.gap,
                "contact/initial_gap": result.initial_gap,
                "contact/area": result.area,
                "contact/point_a": result.point_a,
                "contact/point_b": result.point_b,
                "contact/normal": result.normal,
                "receivers/time": result.receiver_time,
            }
            for name in ("displacement", "velocity", "acceleration"):
                arrays[f"receivers/mic/{name}"] = getattr(result.receivers["mic"], name)
            for body in ("moving", "resting"):
                for name in ("velocity", "momentum", "angular_momentum", "reaction"):
                    arrays[f"bodies/{body}/{name}"] = getattr(result.bodies[body], name)
                arrays[f"snapshots/{body}"] = result.snapshots[body]
            for name in file["energy"]:
                arrays[f"energy/{name}"] = result.energy[name]
            self.assertEqual(len(result.energy), len(file["energy"]))
            for name, array in arrays.items():
                np.testing.assert_array_equal(file[name][:], array, err_msg=name)
        np.testing.assert_array_equal(result.receivers["mic"].point, [5, 0, 0])
        self.assertAlmostEqual(result.bodies["moving"].mass, 10)
        self.assertAlmostEqual(result.total_force.sum() * 0.01, result.summary["impulse_ns"], places=12)

    def test_has_the_force_of_rows_of_state_if_contact_goes_on_after_the_last_of_them(self):
        self.scene.set(
            {"time.contact_rate_hz": 400, "time.duration": 10, "output.every": 3}
        )  # it ends 1 sample later
        result = ricochet.impact(self.scene)
        self.assertGreater(result.contact_time[-1], result.time[-1])
        before = result.contact_time < result.time[-1] + 1e-9
        impulse = result.force[before].sum() * result.contact_step
        self.assertAlmostEqual(result.total_force.sum() * 0.03, impulse, places=12)

    def test_in_single_precision_is_the_same_up_to_its_round_off(self):
        double, single = (
            ricochet.impact(self.scene.changed({"time.precision": p})) for p in ("double", "single")
        )
        self.assertEqual([one.summary["precision"] for one in (double, single)], ["double", "single"])
        impulse = double.summary["impulse_ns"]
        # 1e-6: ten times the round-off of a single-precision number.
        self.assertAlmostEqual(single.summary["impulse_ns"], impulse, delta=1e-6 * impulse)
        exits = [one.summary["exit_velocity"]["resting"][0] for one in (double, single)]
        self.assertAlmostEqual(*exits, delta=1e-6)
        # 2e-3: round-off 6e-8 of displacements of 10 m, for thirty modes, divided by the flexibility of a step, 0.01 m/N.
        first = slice(0, 500)
        difference = abs(single.force[first] - double.force[first]).max()
        self.assertLess(difference, 2e-3 * double.force.max())
        self.assertGreater(difference, 0)
        self.assertLess(single.summary["energy_drift"], 1e-12)

    def test_lets_other_threads_run(self):
        self.scene.set({"time.rate_hz": 5000, "output.every": 1000, "output.snapshot_every": 0})
        ticks, ended = [], threading.Event()

        def tick():
            while not ended.wait(1e-3):
                ticks.append(time.monotonic())

        thread = threading.Thread(target=tick)
        thread.start()
        started = time.monotonic()
        ricochet.impact(self.scene)
        between = time.monotonic()
        ricochet.Simulation(self.scene).step_block(100_000)
        finished = time.monotonic()
        ended.set()
        thread.join()
        for start, end in ((started, between), (between, finished)):
            quarter = (end - start) / 4
            # Some of a hundred or more ticks. With the lock held there would be none.
            self.assertGreater(sum(start + quarter < t < end - quarter for t in ticks), 5)

    def test_is_ended_by_an_interrupt_and_leaves_nothing_behind(self):
        long = {"time.rate_hz": 100_000, "time.duration": 1000, "output.every": 10_000, "title": "Long"}
        self.scene.set(long)
        threading.Timer(0.5, _thread.interrupt_main).start()
        with self.assertRaises(KeyboardInterrupt):
            ricochet.impact(self.scene)
        self.assertEqual([path.name for path in self.scene.out.iterdir() if "long" in path.name], [])

    def test_keeps_its_arrays_when_another_one_gets_its_name(self):
        first = ricochet.impact(self.scene)
        second = ricochet.impact(self.scene.changed({"bodies.moving.velocity": [2, 0, 0]}))
        self.assertEqual(first.path, second.path)
        np.testing.assert_allclose(second.force, 2 * first.force, rtol=1e-9, atol=1e-12)
        # The momentum that one rod loses, 10 kg at 1 m/s, up to the truncated modes.
        self.assertAlmostEqual(first.total_force.sum() * 0.01, 10, delta=0.1)

    def test_warns_where_the_model_leaves_its_validity(self):
        with self.assertWarnsRegex(UserWarning, "approach speed"):
            result = ricochet.impact(self.scene)
        # The rods meet at the wave speed.
        self.assertTrue(any("approach speed" in warning for warning in result.warnings))

    def test_is_shown_with_its_figures_and_its_force(self):
        result = ricochet.impact(self.scene)
        page = ElementTree.fromstring(f"<div>{result._repr_html_()}</div>")
        shown = {row.find("th").text: row.find("td").text for row in page.iter("tr")}
        self.assertEqual(shown["peak force"], f"{result.summary['peak_force_n']:.6g} N")
        self.assertIsNotNone(page.find("svg/polyline"))
        self.assertIn("peak force", repr(result))
        with self.assertRaisesRegex(ricochet.InputError, "no such file"):
            ricochet.Result(self.folder / "none.result.h5")

    def test_of_bodies_at_rest_has_one_row(self):
        scene = self.scene.changed({"contact.scheme": "static", "output.snapshot_every": 0})
        scene.set({"bodies.resting.support.right": "x", "loads.gravity": [1, 0, 0], "title": "Rest"})
        ricochet.kernels(scene, ranks=1)
        result = ricochet.impact(scene)
        self.assertAlmostEqual(result.total_force[0], 10)  # the weight of the other rod
        self.assertIn("10 N on 1 points", result._repr_html_())

    def test_is_drawn_and_reported(self):
        result = ricochet.impact(self.scene)
        pictures = ricochet.plot(result, self.folder / "pictures")
        self.assertEqual([p.path.name for p in pictures], ["two-rods-contact.png", "two-rods-energy.png"])
        self.assertTrue(all(p._repr_png_().startswith(b"\x89PNG") for p in pictures))
        self.assertIn("<html", ricochet.report(result).read_text())


class Simulation(KernelsTest):
    def test_steps_as_the_impact_does(self):
        self.scene.set({"output.receiver": [MIC], "time.duration": 5})  # resampling of long sounds takes long
        ricochet.kernels(self.scene, ranks=1)
        result = ricochet.impact(self.scene)
        simulation = ricochet.Simulation(self.scene)
        block = simulation.step_block(500, force=True, displacement=True)
        # Round-off: the two sums add in another order.
        np.testing.assert_allclose(block.total_force, result.total_force[1:], rtol=1e-14)
        rows = np.searchsorted(result.time, result.contact_time) - 1
        np.testing.assert_array_equal(block.force[rows], result.force)
        np.testing.assert_array_equal(simulation.initial_gap - block.displacement[rows], result.gap)
        # The pickups are x, y and z of the receiver. Sums over the modes have another order.
        np.testing.assert_allclose(block.velocity, result.receivers["mic"].velocity[1:], atol=1e-12)
        self.assertAlmostEqual(simulation.energy.total, result.energy["total"][-1], delta=1e-12)
        np.testing.assert_allclose(
            simulation.mean_velocity("resting"), result.bodies["resting"].velocity[-1], atol=1e-12
        )
        self.assertEqual((simulation.steps, simulation.active), (500, 1))
        self.assertAlmostEqual(simulation.time, 5)

    def test_steps_every_scene_of_an_impact(self):
        (self.scene.file.parent / "push.csv").write_text("t, factor\n0, 0\n0.5, 1\n4, 0\n")
        dead = {"body": "resting", "group": "left", "vector": [0.05, 0, 0]}
        load = {**dead, "history": "push.csv"}
        moved = {"body": "resting", "group": "right", "vector": [0.5, 0, 0], "history": "push.csv"}
        strike = {"mallet": "moving", "time": 2}
        for changes in (
            {"contact.scheme": "impulse", "contact.instant": "exact"},
            {"contact.max_pivots": 3},
            {"loads.traction": [load], "output.receiver": [MIC]},
            {"loads.traction": [dead]},
            {"bodies.resting.support": {"right": "xyz"}, "loads.motion": [moved], "output.receiver": [MIC]},
            {"strikes": [strike, {**strike, "time": 4}]},
        ):
            with self.subTest(changes=list(changes)):
                scene = self.scene.changed({"time.duration": 8, **changes})
                ricochet.kernels(scene, ranks=1)
                result = ricochet.impact(scene)
                simulation = ricochet.Simulation(scene)
                block = simulation.step_block(800)
                self.assertGreater(block.total_force.max(), 0)
                np.testing.assert_allclose(block.total_force, result.total_force[1:], rtol=1e-14)
                if "output.receiver" in changes:
                    # A pickup does not hear the static correction, which follows the slope of the history.
                    t = result.time[1:]
                    slope = np.select([t < 0.5 - 1e-9, t < 4 - 1e-9], [2, -1 / 3.5], 0)
                    missing = (result.receivers["mic"].velocity[1:] - block.velocity)[:, 0]
                    self.assertLess(abs(missing[0]), 0.02 * 2 * 0.5)
                    np.testing.assert_allclose(missing, missing[0] / 2 * slope, atol=1e-12)

    def test_steps_one_by_one_as_in_blocks_and_goes_back(self):
        simulation = ricochet.Simulation(self.scene, self.kernels, [ricochet.Pickup("moving", [1, 0, 0])])
        start = simulation.save()
        block = simulation.step_block(50, force=True)
        simulation.restore(start)
        for k in range(50):
            simulation.step()
            np.testing.assert_array_equal(simulation.force, block.force[k])
            np.testing.assert_array_equal(simulation.pickup_velocity, block.velocity[k])
            np.testing.assert_array_equal(simulation.gap, simulation.initial_gap - simulation.displacement)
        with self.assertRaisesRegex(ricochet.InputError, "^Two rods: state: is of another system[^\n]*$"):
            changed = self.scene.changed({"bodies.moving.velocity": [0.9, 0, 0]})
            ricochet.Simulation(changed, self.kernels).restore(start)

    def test_goes_on_in_another_process_from_a_pickled_state(self):
        simulation = ricochet.Simulation(self.scene, self.kernels)
        while simulation.active == 0:
            simulation.step()
        simulation.push_at("moving", 0, [0.02, 0, 0])
        simulation.step_block(37)
        state = pickle.dumps(simulation.save())
        stored = self.folder / "state.pickle"
        stored.write_bytes(state)
        script = (
            "import pickle, sys, ricochet\n"
            "scene = ricochet.Scene(sys.argv[1])\n"
            "scene.set({'modes.count': 30, 'output.view': False})\n"
            "simulation = ricochet.Simulation(scene)\n"
            "simulation.step_block(200)\n"
            "simulation.restore(pickle.load(open(sys.argv[2], 'rb')))\n"
            "block = simulation.step_block(500, force=True)\n"
            "sys.stdout.buffer.write(block.force.tobytes() + simulation.displacement.tobytes())\n"
        )
        command = [sys.executable, "-c", script, self.file, stored]
        other = subprocess.run(command, capture_output=True, check=True)
        block = simulation.step_block(500, force=True)
        self.assertGreater(block.total_force.max(), 0)
        self.assertEqual(other.stdout, block.force.tobytes() + simulation.displacement.tobytes())

        saved = pickle.loads(state)
        self.assertEqual(bytes(pickle.loads(pickle.dumps(saved))), bytes(saved))
        damaged = bytearray(bytes(saved))
        damaged[len(damaged) // 3] ^= 4
        for data, line in ((damaged, "state: its bytes are damaged"), (b"", "state: is not a saved state")):
            with self.assertRaisesRegex(ricochet.InputError, f"two-rods.toml: {line}[^\n]*$"):
                simulation.restore(ricochet.State.from_bytes(data))

    def test_is_pushed_at_points(self):
        apart = self.scene.changed({"bodies.moving.velocity": [-1, 0, 0]})
        simulation = ricochet.Simulation(apart, self.kernels, [ricochet.Pickup("resting", [1, 0, 0])])
        start = simulation.energy.total
        simulation.push_at("resting", 0, [0.5, 0, 0])
        simulation.step_block(100)
        self.assertAlmostEqual(
            simulation.energy.loads, 0.5 * float(simulation.pickup_displacement[0]), delta=1e-12
        )
        self.assertAlmostEqual(
            float(simulation.mean_velocity("resting")[0]),
            0.5 * simulation.time / self.kernels["resting"].mass,
            delta=1e-12,
        )
        self.assertAlmostEqual(simulation.energy.total, start, delta=1e-12)
        simulation.push_at("resting", 0)
        simulation.step_block(100)
        self.assertAlmostEqual(
            float(simulation.mean_velocity("resting")[0]), 0.5 / self.kernels["resting"].mass, delta=1e-12
        )
        for point, force in ((1, [1, 0, 0]), (-1, [1, 0, 0]), ("mic", [1, 0, 0]), (0, [0, 1, 0])):
            with self.assertRaisesRegex(ricochet.InputError, r"^Two rods: push_at\('resting', [^\n]*$"):
                simulation.push_at("resting", point, force)
        with self.assertRaisesRegex(ricochet.InputError, 'no body "x"'):
            simulation.push_at("x", 0, [1, 0, 0])

    def test_calls_back_while_points_touch_and_may_end_a_block_there(self):
        simulation = ricochet.Simulation(self.scene, self.kernels)
        dt, block = 0.01, simulation.step_block(1500)
        seen = []
        simulation = ricochet.Simulation(self.scene, self.kernels)
        simulation.on_contact(lambda time, contacts: seen.append((time, contacts, simulation.steps)))
        simulation.step_block(700)
        while simulation.steps < 1500:
            simulation.step()
        forces = np.zeros(1500)
        for at, contacts, steps in seen:
            self.assertAlmostEqual(at, steps * dt)
            for contact in contacts:
                self.assertEqual((contact.between, contact.point), (("moving", "resting"), 0))
                forces[steps - 1] += contact.force @ [1, 0, 0]
        np.testing.assert_allclose(forces, block.total_force, rtol=1e-14)
        touching = block.total_force > 0
        ends = np.flatnonzero(np.diff(touching.astype(int)) == -1) + 1
        self.assertEqual([steps - 1 for _, contacts, steps in seen if not contacts], ends.tolist())

        first = int(np.argmax(touching))
        simulation = ricochet.Simulation(self.scene, self.kernels)
        simulation.on_contact(lambda *_: False)
        stopped = simulation.step_block(1500, force=True)
        self.assertEqual((simulation.steps, len(stopped.force)), (first + 1, first + 1))
        np.testing.assert_array_equal(stopped.total_force, block.total_force[: first + 1])
        simulation.on_contact(None)
        rest = simulation.step_block(1499 - first).total_force
        np.testing.assert_array_equal(rest, block.total_force[first + 1 :])

        simulation = ricochet.Simulation(self.scene, self.kernels)
        simulation.on_contact(lambda *_: simulation.step())
        with self.assertRaisesRegex(RuntimeError, "stepping this Simulation"):
            simulation.step_block(1500)
        self.assertEqual(simulation.steps, first + 1)
        with self.assertRaisesRegex(RuntimeError, "stepping this Simulation"):
            simulation.step()

    def test_knows_the_coordinates_of_the_modes(self):
        self.scene.set({"output.receiver": [MIC]})
        kernels = ricochet.kernels(self.scene, ranks=1)
        simulation = ricochet.Simulation(self.scene)
        simulation.step_block(900)
        energy = simulation.energy
        bodies = {body: simulation.modal_coordinates(body) for body in kernels}
        kinetic = sum((q.velocity**2).sum() / 2 for q in bodies.values())
        strain = sum(
            ((2 * np.pi * kernels[body].frequency * q.displacement) ** 2).sum() / 2
            for body, q in bodies.items()
        )
        self.assertGreater(strain, 0.01 * kinetic)
        np.testing.assert_allclose([kinetic, strain], [energy.kinetic, energy.strain], rtol=1e-12)
        shape = kernels["resting"].receivers["mic"].shape
        heard = shape @ bodies["resting"].velocity, shape @ bodies["resting"].displacement
        np.testing.assert_allclose(heard[0], simulation.pickup_velocity, atol=1e-13)
        np.testing.assert_allclose(heard[1], simulation.pickup_displacement, atol=1e-13)
        with self.assertRaisesRegex(ricochet.InputError, 'no body "x"'):
            simulation.modal_coordinates("x")

    def test_judges_its_steps_as_an_impact_is_judged(self):
        with warnings.catch_warnings(action="ignore"):
            judged = ricochet.impact(self.scene).warnings
        simulation = ricochet.Simulation(self.scene)
        block = ricochet.Simulation(self.scene).step_block(3000)
        self.assertEqual(simulation.warnings, [])
        simulation.watch()
        self.assertEqual(simulation.warnings, [])
        np.testing.assert_array_equal(simulation.step_block(3000).total_force, block.total_force)
        self.assertTrue(any("approach speed" in line for line in simulation.warnings))
        self.assertEqual(set(simulation.warnings), set(judged))
        # After the touch, nothing is doubtful any more.
        simulation.watch()
        simulation.step_block(100)
        self.assertEqual(simulation.warnings, [])

    def test_is_refused_in_one_line(self):
        for changes, line in (
            ({"contact.scheme": "static"}, "contact.scheme: a Simulation"),
            ({"modes": {"residual_flexibility": True}}, "no settings for accuracy = 0.01 at"),
        ):
            with self.assertRaisesRegex(ricochet.InputError, f"two-rods.toml: {line} [^\n]*$"):
                ricochet.Simulation(self.scene.changed(changes), self.kernels)
        for function in (ricochet.Simulation, ricochet.impact):
            with self.assertRaisesRegex(
                ricochet.InputError, "bodies.moving.angular_velocity: this body cannot"
            ):
                function(self.scene.changed({"bodies.moving.angular_velocity": [0, 0, 1]}))
        with self.assertRaisesRegex(ricochet.InputError, "no kernel for body 'resting'"):
            ricochet.Simulation(self.scene, {"moving": self.kernels["moving"]})
        with self.assertRaisesRegex(ricochet.InputError, "no receiver"):
            ricochet.Simulation(self.scene, pickups=[ricochet.Pickup("moving", [1, 0, 0], receiver="none")])
        with self.assertRaisesRegex(ricochet.InputError, "Call kernels"):
            ricochet.Simulation(self.scene.changed({"modes.count": 7}))

    def test_without_friction_has_no_tangential_force(self):
        simulation = ricochet.Simulation(self.scene)
        block = simulation.step_block(1500, tangential_force=True)
        self.assertEqual(block.tangential_force.shape, (1500, 1, 3))
        self.assertGreater(block.total_force.max(), 0)
        np.testing.assert_array_equal(block.tangential_force, 0)
        np.testing.assert_array_equal(simulation.tangential_force, np.zeros((1, 3)))
        self.assertIsNone(simulation.step_block(1).tangential_force)
        self.assertEqual(simulation.energy.friction, 0)

    def test_is_stepped_by_one_thread_and_read_by_others(self):
        simulation = ricochet.Simulation(self.scene, self.kernels, [ricochet.Pickup("moving", [1, 0, 0])])
        saved = simulation.save()
        alone = simulation.step_block(3000)
        simulation.restore(saved)
        started, ended = threading.Event(), threading.Event()
        read, refused, busy = [], [], "another thread is stepping this Simulation"
        latest = time.monotonic() + 60

        def step():
            started.set()
            try:
                while time.monotonic() < latest and not (blocks and busy in refused):
                    with contextlib.suppress(RuntimeError):  # another thread saves
                        simulation.restore(saved)
                        blocks.append(simulation.step_block(3000).velocity)
            finally:
                ended.set()

        def disturb():
            started.wait()
            while not ended.is_set():
                for change in (
                    simulation.save,
                    lambda: simulation.restore(saved),
                    lambda: simulation.push("moving"),
                ):
                    try:
                        change()
                    except (RuntimeError, ricochet.InputError) as error:
                        refused.append(str(error))
                read.append(simulation.steps)

        blocks = []
        others = [threading.Thread(target=disturb) for _ in range(3)]
        stepping = threading.Thread(target=step)
        for thread in [*others, stepping]:
            thread.start()
        for thread in [stepping, *others]:
            thread.join()
        for block in blocks:
            np.testing.assert_array_equal(block, alone.velocity)
        self.assertIn(busy, refused)
        self.assertTrue(all(steps % 1024 == 0 or steps == 3000 for steps in read))

    def test_is_interrupted_between_blocks(self):
        simulation = ricochet.Simulation(self.scene)
        threading.Timer(0.2, _thread.interrupt_main).start()
        with self.assertRaises(KeyboardInterrupt):
            simulation.step_block(1_000_000_000 // 64)


class SlidingBox(ProgramTest):
    """The box of tests/programs/boxes.py slides on a floor. It is stiff and strongly damped, so that it soon lies still."""

    def setUp(self):
        super().setUp()
        self.write("box.msh", Box().gmsh())
        table = {
            "title": "Slide",
            "bodies": {
                "box": {
                    "mesh": "box.msh",
                    "material": {"density": 2.0, "young": 3e4, "poisson": 0.3},
                    "damping": {"ratio": 0.3},
                    "contact": "foot",
                    "velocity": [1, 0, 0],
                }
            },
            "obstacles": {"floor": {"normal": [0, 0, 1]}},
            "modes": {"count": 20},
            "contact": {"between": ["box", "floor"], "gap": 1e-6, "friction": 0.3},
            "time": {"rate_hz": 4000.0, "duration": 0.1},
            "loads": {"gravity": [0, 0, -9.81]},
        }
        self.scene = ricochet.Scene(table, self.folder)
        self.mass = ricochet.kernels(self.scene, ranks=1)["box"].mass

    def test_is_slowed_by_its_tangential_forces(self):
        simulation = ricochet.Simulation(self.scene, pickups=[])
        block = simulation.step_block(400, force=True, tangential_force=True)
        np.testing.assert_array_equal(simulation.tangential_force, block.tangential_force[-1])
        impulse = block.tangential_force.sum(axis=(0, 1)) / 4000
        self.assertAlmostEqual(simulation.mean_velocity("box")[0], 1 - impulse[0] / self.mass, delta=1e-9)
        # Coulomb: 1 m/s - 0.3 g t. The box is laid down within less than 1 % of this time.
        self.assertAlmostEqual(simulation.mean_velocity("box")[0], 1 - 0.3 * 9.81 * 0.1, delta=0.01)
        size = np.linalg.norm(block.tangential_force, axis=2)
        self.assertLessEqual((size - 0.3 * block.force).max(), 1e-9)
        self.assertGreater(simulation.energy.friction, 0.1)
        result = ricochet.impact(self.scene)
        # Round-off: the two sums add in another order.
        np.testing.assert_allclose(block.total_force, result.total_force[1:], rtol=1e-14)

    def test_follows_the_history_of_an_obstacle(self):
        (self.folder / "pull.csv").write_text("t, factor\n0, 0\n0.05, 1\n")
        changes = {
            "bodies.box.velocity": [0, 0, 0],
            "loads.motion": [{"obstacle": "floor", "vector": [0.05, 0, 0], "history": "pull.csv"}],
        }
        scene = self.scene.changed(changes)
        simulation = ricochet.Simulation(scene, pickups=[])
        block = simulation.step_block(400)
        # The floor pulls at 1 m/s for one half of the time and rests in the other.
        self.assertAlmostEqual(simulation.mean_velocity("box")[0], 0, delta=0.01)
        result = ricochet.impact(scene)
        self.assertGreater(result.bodies["box"].velocity[:, 0].max(), 0.9 * 0.3 * 9.81 * 0.05)
        np.testing.assert_allclose(block.total_force, result.total_force[1:], rtol=1e-14)

    def test_varies_in_a_sweep(self):
        study = ricochet.sweep(self.scene, {"contact.friction": [0.0, 0.2, 0.4]})
        self.assertEqual(len(list(self.scene.out.glob("*.kernel.h5"))), 1)
        heat = study["energy_lost_friction"]
        self.assertTrue(np.isnan(heat[0]))
        self.assertGreater(heat[2], heat[1])
        parts = {"static": 0.3, "dynamic": 0.1, "stribeck_velocity": 0.01}
        study = ricochet.sweep(
            self.scene.changed({"contact.friction": parts}), {"contact.friction.static": [0.1, 0.3]}
        )
        self.assertEqual(list(study.error), ["", ""])
        written = ricochet.Scene(
            self.scene.changed({"contact.friction": parts}).write(self.folder / "copy.toml")
        )
        self.assertEqual(written["contact.friction"], parts)


class Sweep(KernelsTest):
    def test_has_the_figures_of_single_impacts(self):
        study = {"bodies.moving.velocity[0]": [1, 2], "contact.gap": [0.5, -1.0]}
        self.scene["bodies.moving.velocity"] = [3, 0, 0]
        found = ricochet.sweep(self.scene, study, jobs=1, ranks=1)
        np.testing.assert_array_equal(found["contact.gap"], [0.5, -1, 0.5, -1])
        np.testing.assert_array_equal(found.status, [0, 2, 0, 2])
        self.assertIn("contact.gap = -1.0: must not be negative", found.error[1])
        single = ricochet.impact(self.scene.changed({"contact.gap": 0.5, "bodies.moving.velocity[0]": 2}))
        self.assertEqual(found["peak_force_n"][2], single.summary["peak_force_n"])
        self.assertEqual(len(ElementTree.fromstring(found._repr_html_()).findall("tbody/tr")), len(found))

    def test_of_a_study_file_is_that_of_the_command(self):
        path = self.write(
            "rods/study.toml",
            'scene = "two-rods.toml"\n[set]\n"modes.count" = 9\n[grid]\n"time.rate_hz" = [50]\n',
        )
        found = ricochet.sweep(path, jobs=1, ranks=1)
        self.assertEqual(found["modes.moving"][0], 9)
        with self.assertRaisesRegex(ricochet.InputError, "grid"):
            ricochet.sweep(path, {"time.rate_hz": [50]})
        with self.assertRaisesRegex(ricochet.InputError, "unknown key"):
            ricochet.sweep(self.scene, {"time.rate": [50]})
        with self.assertRaisesRegex(ricochet.InputError, "keep: does not go with a study file"):
            ricochet.sweep(path, keep=["force"])
        self.assertEqual(found.histories, [])
        with self.assertRaisesRegex(ricochet.InputError, 'add keep = \\["energy"\\]'):
            found.history(0, "energy.total")

    def test_has_the_histories_and_warnings_of_single_impacts(self):
        self.scene["output.receiver"] = [MIC]
        study = {"contact.gap": [0.5, -1.0, 5.0], "time.duration": [4.0]}
        found = ricochet.sweep(
            self.scene, study, keep=["force", "receivers", "bodies", "energy"], jobs=1, ranks=1
        )
        single = ricochet.impact(self.scene.changed({"contact.gap": 0.5, "time.duration": 4.0}))
        force = found.history(0, "force")
        touching = force.values > 0
        np.testing.assert_array_equal(force.time[touching], single.contact_time)
        np.testing.assert_array_equal(force.values[touching], single.force[:, 0])  # one contact point
        self.assertEqual(force.unit, "N")
        mic = single.receivers["mic"].velocity
        time, values, unit = found.history(-3, "receivers.mic")  # counted from the end
        np.testing.assert_array_equal(time, single.receiver_time)
        np.testing.assert_array_equal(values, mic)
        self.assertEqual(unit, "m/s")
        np.testing.assert_array_equal(found.history(0, "receivers.mic.x").values, mic[:, 0])
        np.testing.assert_array_equal(found.history(0, "bodies.moving.z").time, single.time)
        np.testing.assert_array_equal(found.history(0, "energy.strain").values, single.energy["strain"])
        self.assertEqual(len(found.histories), 1 + 1 + 2 + 8)
        self.assertEqual(found.warnings[0], single.warnings)
        np.testing.assert_array_equal(found["touched"], [1, np.nan, 0])
        self.assertEqual([len(found.history(row, "force").time) > 0 for row in (0, 2)], [True, False])
        for row, name, part in [
            (1, "force", "impact 1 has no records"),
            (0, "forces", 'no record "forces". Did you mean "force"?'),
            (0, "receivers.mic.w", 'Did you mean "receivers.mic"?'),
            (0, "energy.total.x", '"energy.total" has no components'),
        ]:
            with self.assertRaisesRegex(ricochet.InputError, part):
                found.history(row, name)
        with self.assertRaises(IndexError):
            found.history(3, "force")
        again = ricochet.sweep(self.scene, {"contact.gap": [5.0]}, keep=["force"], jobs=1, ranks=1)
        self.assertEqual((len(again), len(found.history(0, "force").time)), (1, len(force.time)))


if __name__ == "__main__":
    unittest.main(warnings="ignore")  # the rods meet at the wave speed, which causes a warning in each run
