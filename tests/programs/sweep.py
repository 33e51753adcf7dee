# SPDX-License-Identifier: BSD-2-Clause
"""ricochet sweep: the settings of a study, shared kernels, restarts after a kill without loss, outputs, and refused input."""

import csv
import itertools
import json
import math
import os
import re
import shutil
import signal
import subprocess
import time
import unittest
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import h5py
import numpy as np

from programs import BIN, MESHES, Command, ProgramTest, Run, contact, kernel

import ricochet
from ricochet import scene_keys
from ricochet.studies import chart
from ricochet.studies.study import Study
from ricochet.studies.table import Table


class SweepTest(ProgramTest):
    def setUp(self):
        super().setUp()
        for path in (MESHES / "two-rods").glob("*.*"):
            shutil.copy(path, self.folder)
        self.out = self.folder / "out"

    def study(self, text, scene="two-rods.toml"):
        return self.write("study.toml", f'scene = "{scene}"\ntitle = "Rods"\n{text}')

    def sweep(self, study, *more):
        return Command("sweep", study, "--ranks", "1", *more)

    def sweep_by(self, programs, study, *more):
        """The sweep with substitutes for the programs in this folder."""
        return Run(
            ["env", f"RICOCHET_BIN={programs}", BIN / "ricochet", "sweep", study, "--ranks", "1", *more]
        )

    def rows(self):
        with open(self.out / "rods.sweep.csv") as file:
            return list(csv.DictReader(file))


GRID = """
[set]
"modes.count" = 20
"time.rate_hz" = 20.0
[grid.bodies.moving]
"velocity[0]" = [0.5, 1.0]
"material.young" = { from = 1.0, to = 4.0, steps = 2 }
[random]
count = 3
"contact.gap" = { uniform = [0.0, 0.1] }
"""


KEEP = 'keep = ["force"]\n'


def force_of(file, row):
    """Times and values of the total force of a row."""
    contact = file["histories"][row]["contact"]
    return np.array([contact["time"], contact["total_force"]])


class Studies(SweepTest):
    def settings(self, text):
        return Study(self.study(text)).settings

    def test_a_grid_holds_each_combination_once_and_draws_repeat_with_the_seed(self):
        settings = self.settings(GRID)
        self.assertEqual(settings, self.settings(GRID))
        self.assertEqual(len(settings), 2 * 2 * 3)
        pairs = [(s["bodies.moving.velocity[0]"], s["bodies.moving.material.young"]) for s in settings[::3]]
        self.assertEqual(pairs, list(itertools.product([0.5, 1.0], [1.0, 4.0])))
        self.assertTrue(all(0 <= s["contact.gap"] <= 0.1 for s in settings))
        self.assertNotEqual(
            settings[0]["contact.gap"],
            self.settings(GRID.replace("count = 3", "count = 3\nseed = 7"))[0]["contact.gap"],
        )

    def test_lists_are_walked_through_together_and_ranges_by_ratio(self):
        settings = self.settings(
            '[list]\n"time.rate_hz" = { from = 1.0, to = 100.0, steps = 3, scale = "log" }\n'
            '"contact.scheme" = ["compliant", "impulse", "impulse"]'
        )
        np.testing.assert_allclose([s["time.rate_hz"] for s in settings], [1, 10, 100], rtol=1e-14)
        self.assertEqual([s["contact.scheme"] for s in settings], ["compliant", "impulse", "impulse"])


class Pictures(unittest.TestCase):
    def drawn(self, inputs, output, against, rows):
        """The matplotlib axes of a picture of a table."""
        table = SimpleNamespace(title="t", inputs=inputs, column=lambda name: (inputs | {output: rows})[name])
        with mock.patch.object(chart, "save_picture") as saved:
            units = scene_keys.units(Run([BIN / "ricochet-contact", "--keys"]).out)
            chart.draw(table, output, against, Path("picture.png"), units)
        return saved.call_args.args[0].axes[0]

    def test_over_one_input_each_value_of_the_others_has_a_line_and_labels_have_units(self):
        speed, metal = [1.0, 2.0, 1.0, 2.0, 1.0, 2.0], [2700.0, 2700.0, 7850.0, 7850.0, 11340.0, 11340.0]
        force = [3.0, 6.0, 5.0, 10.0, 4.0, 8.0]
        ax = self.drawn(
            {
                "bodies.b.velocity[0]": speed,
                "bodies.b.material.density": metal,
                "bodies.b.material.young": [-m for m in metal],
            },
            "peak_force_n",
            ["bodies.b.velocity[0]"],
            force,
        )
        self.assertEqual((ax.get_xlabel(), ax.get_ylabel()), ("velocity of b, x (m/s)", "peak force (N)"))
        self.assertEqual([list(line.get_ydata()) for line in ax.lines], [[3, 6], [5, 10], [4, 8]])
        self.assertEqual(ax.get_title(loc="left"), "t")  # in the style of all pictures
        self.assertFalse(ax.spines["top"].get_visible())
        legend = ax.get_legend()
        self.assertEqual(legend.get_title().get_text(), "density of b (kg/m³)")
        self.assertEqual([part.get_text() for part in legend.get_texts()], ["2700", "7850", "11340"])

    def test_over_a_speed_axes_are_logarithmic_and_estimated_errors_are_bars(self):
        """The absolute value of a component, or the length of a vector; other inputs remain lines."""
        fall = [-1.0, -4.0, -16.0, -64.0] * 2
        inputs = {
            "bodies.b.velocity[1]": fall,
            "bodies.b.velocity": [[3 * v, 0.0, 4 * v] for v in fall],
        }
        table = Table.__new__(Table)
        table.title = "t"
        table.outputs = {
            "restitution": [0.5] * 8,
            "error_estimate.quantities.rebound.total": [0.01] * 8,
            "peak_force_n": [10.0] * 8,
            "error_estimate.quantities.peak_force.total": [0.02] * 8,
        }
        units = scene_keys.units(Run([BIN / "ricochet-contact", "--keys"]).out)
        for name, label, speeds, output, error in (
            (
                "bodies.b.velocity[1]",
                "|velocity of b, y| (m/s)",
                [1, 4, 16, 64],
                "restitution",
                0.01 * 2**0.5,
            ),
            ("bodies.b.velocity", "|velocity of b| (m/s)", [5, 20, 80, 320], "peak_force_n", 0.2),
        ):
            table.inputs = {name: inputs[name], "contact.gap": [0.0] * 4 + [1.0] * 4}
            with mock.patch.object(chart, "save_picture") as saved:
                chart.draw(table, output, [f"abs({name})"], Path("picture.png"), units)
            (ax,) = saved.call_args.args[0].axes
            self.assertEqual((ax.get_xlabel(), ax.get_xscale()), (label, "log"))
            self.assertEqual(ax.lines[0].get_xdata().tolist(), speeds)
            bars = [bar for bar in ax.collections if len(bar.get_segments()) == 4]
            self.assertEqual(len(bars), 2)
            for (_, low), (_, high) in bars[0].get_segments():
                self.assertAlmostEqual(high - low, 2 * error, delta=1e-12)
        with self.assertRaisesRegex(ricochet.InputError, "neither a number nor a vector"):
            table.inputs = {"body": ["a"]}
            table.column("abs(body)")

    def test_units_are_those_of_the_reference(self):
        units = scene_keys.units(Run([BIN / "ricochet-contact", "--keys"]).out)
        for key, unit in {
            "bodies.b.velocity[0]": "m/s",
            "bodies.b.material.steel.young": "Pa",
            "contact.gap": "m",
            "time.duration": "s",
            "loads.point[0].vector[1]": "N",
            "bodies.b.geometry.radius": "",
            "accuracy": "",
            "modes.up_to_hz": "Hz",
        }.items():
            self.assertEqual(scene_keys.unit(key, units), unit, key)

    def test_keys_have_words(self):
        for key, words in {
            "bodies.b.velocity[0]": "velocity of b, x",
            "bodies.b.material.steel.young": "Young's modulus of b",
            "bodies.b.damping.loss_factor": "loss factor of damping of b",
            "bodies.b.geometry.radius": "radius of b",
            "contact.gap": "gap",
            "contact.pair[1].gap": "gap of pair 2",
            "loads.point[0].vector[1]": "vector of point 1, y",
            "loads.gravity[2]": "gravity, z",
            "time.contact_rate_hz": "rate of contact steps",
        }.items():
            self.assertEqual(scene_keys.words(key), words, key)

    def test_over_two_inputs_each_pair_that_was_run_has_a_cell_with_its_values_as_labels(self):
        x, y = [1.0, 10.0, 11.0] * 2, ["a"] * 3 + ["b"] * 3
        ax = self.drawn({"x": x, "y": y, "z": [0] * 6}, "restitution", ["x", "y"], [1, 2, 3, 4, 5, math.nan])
        np.testing.assert_equal(np.ma.filled(ax.images[0].get_array(), np.nan), [[1, 2, 3], [4, 5, np.nan]])
        self.assertEqual([part.get_text() for part in ax.get_xticklabels()], ["1", "10", "11"])
        self.assertEqual([part.get_text() for part in ax.get_yticklabels()], ["a", "b"])
        draws = {"x": list(np.random.default_rng(1).uniform(size=40)), "y": [1.0, 2.0] * 20}
        drawn = self.drawn(draws, "restitution", ["x", "y"], list(range(40)))
        self.assertEqual(
            (len(drawn.images), len(drawn.collections)), (0, 1)
        )  # random draws are shown as points
        draws["y"] = list(range(40))
        (line,) = self.drawn(draws, "restitution", ["x"], list(range(40))).lines
        self.assertEqual(line.get_linestyle(), "None")  # y varies as well


class Sweeps(SweepTest):
    # Equal rods of length 10 with c = 1 part at 2 L/c = 20 s. The duration that is named adds a tenth of this, and is rounded up to
    # two digits. 0.5 s: a tail of the wave that 20 modes smear.
    def test_impacts_that_end_in_contact_are_counted_with_the_duration_that_suffices(self):
        study = self.study('[set]\n"modes.count" = 20\n[grid]\n"time.duration" = [15.0, 30.0]\n')
        done = self.succeed(self.sweep(study))
        found = re.search(
            r"warning: 1 of 2 impacts end while the bodies touch, .*: time.duration = (\d+) lets 1 of them part",
            done.out,
        )
        self.assertTrue(found, done.out)
        self.assertGreaterEqual(int(found[1]), 20)
        self.assertLessEqual(int(found[1]), 23)
        short, enough = self.rows()
        self.assertEqual(short["restitution"], "nan")
        self.assertIn(f"Set time.duration = {found[1]}", short["warning_texts"])
        self.assertNotIn("still touch", enough["warning_texts"])
        self.assertAlmostEqual(float(short["parted_s"]), 22, delta=0.5)
        study.write_text(study.read_text().replace("15.0", found[1]))
        again = self.succeed(self.sweep(study))
        self.assertNotIn("while the bodies touch", again.out)
        self.assertEqual(self.rows()[0]["restitution"], self.rows()[1]["restitution"])

    def check_log(self, log, stage):
        """The log of a batch job states time and memory of each part of the kernels, and of its stage as a whole. Returns the
        number of processes side by side."""
        *parts, last = log.splitlines()
        found = re.fullmatch(
            stage + r" +(\d+\.\d\d) s +(\d+) MiB  in total: (\d+), and (\d+) x (\d+) of the largest program",
            last,
        )
        self.assertIsNotNone(found, last)
        total, own, count, other = map(int, found.groups()[1:])
        self.assertAlmostEqual(total, own + count * other, delta=1 + count)  # each is rounded
        self.assertTrue(all(re.search(r" [\d.]+ s +\d+ MiB(  |$)", line) for line in parts), log)
        if stage == "kernels":
            whole = [line for line in parts if line.startswith("total ")]
            self.assertEqual(
                len(whole), 1
            )  # for "resting" and one of "moving", from which the other is derived
            self.assertEqual(
                sum("MiB needed of" in line for line in parts), 4
            )  # before and after the inertia counts
            largest = max(int(line.split(" MiB")[0].split()[-1]) for line in whole)
            self.assertGreaterEqual(other, largest - 1)
            self.assertLess(float(whole[0].split(" s ")[0].split()[-1]), float(found[1]))
        return count

    def test_each_impact_is_that_of_the_program_alone_and_kernels_are_shared(self):
        study = self.study(GRID)
        done = self.succeed(self.sweep(study, "--kernels"))
        self.assertEqual(done.out, "3 kernels, all computed\n")
        self.check_log(done.err, "kernels")
        for before in ("", " before"):
            done = self.succeed(self.sweep(study, "--part", "2/3", "--jobs", "3"))
            self.assertEqual(done.out, f"part 2/3: 4 impacts, all done{before}\n")
            self.assertEqual(self.check_log(done.err, "impacts 2/3"), 3)
        for before in ("", ", all done before"):
            done = self.succeed(self.sweep(study, "--plot", "impulse_ns"))
            self.assertEqual(done.out.splitlines()[0], f"12 impacts{before}")
        rows = self.rows()
        self.assertEqual(len(rows), 12)
        self.assertEqual(len(list(self.out.glob("*.kernel.h5"))), 3)  # two of "moving", one of "resting"
        self.assertTrue((self.out / "rods.impulse_ns.png").is_file())
        for row in (rows[0], rows[-1]):
            sets = ["modes.count=20", "time.rate_hz=20.0", "title=alone"]
            sets += [
                f"{key}={row[key]}"
                for key in ("bodies.moving.velocity[0]", "bodies.moving.material.young", "contact.gap")
            ]
            self.succeed(contact(self.folder / "two-rods.toml", self.out, *sets))
            summary = json.loads((self.out / "alone.summary.json").read_text())
            self.assertEqual(float(row["impulse_ns"]), summary["impulse_ns"])
            self.assertEqual(float(row["exit_velocity.moving.x"]), summary["exit_velocity"]["moving"][0])
        with h5py.File(self.out / "rods.sweep.h5") as file:
            self.assertEqual(list(file["outputs/impulse_ns"][:]), [float(row["impulse_ns"]) for row in rows])
            self.assertEqual(list(file["inputs/contact.gap"][:]), [float(row["contact.gap"]) for row in rows])
            self.assertTrue((file["status"][:] == 0).all())

    def test_after_kills_nothing_finished_is_run_again_and_nothing_is_lost(self):
        study = self.study(KEEP + GRID.replace("count = 3", "count = 20"))
        journal, before = self.out / "rods.sweep.jsonl", b""
        for enough in (5, 30):
            process = subprocess.Popen(
                [BIN / "ricochet", "sweep", study, "--ranks", "1"],
                stdout=subprocess.DEVNULL,
                start_new_session=True,
                env=os.environ | {"RICOCHET_BIN": str(BIN)},
            )
            while process.poll() is None and (
                not journal.exists() or journal.read_bytes().count(b"\n") < enough
            ):
                time.sleep(0.01)
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            found = journal.read_bytes()
            self.assertTrue(found.startswith(before))
            before = found[: found.rfind(b"\n") + 1]
        self.succeed(self.sweep(study))
        found = journal.read_bytes()
        self.assertTrue(found.startswith(before))
        keys = [json.loads(line)["key"] for line in found.splitlines()]
        self.assertEqual((len(keys), len(set(keys))), (80, 80))
        self.assertEqual([row["status"] for row in self.rows()], ["0"] * 80)
        self.succeed(self.sweep(study))
        self.assertEqual(journal.read_bytes(), found)
        alone = self.folder / "alone"
        self.succeed(self.sweep(study, "--out", alone))
        with h5py.File(self.out / "rods.sweep.h5") as one, h5py.File(alone / "rods.sweep.h5") as other:
            self.assertEqual(len(one["histories"]), 80)
            for row in one["histories"]:
                np.testing.assert_array_equal(force_of(one, row), force_of(other, row))

    def test_impacts_whose_process_is_killed_are_run_again(self):
        """The sweep itself continues, as it does if memory runs out or if processes of a job are terminated."""
        study = self.study(
            GRID.replace("count = 3", "count = 10")
        )  # 40 impacts, so that each of two processes dies more than once
        self.succeed(self.sweep(study, "--kernels"))
        victims = self.folder / "victims"
        victims.mkdir()
        # Replaces ricochet-contact. Each process dies at its tenth impact, half
        # of them in the middle of the answer.
        (victims / "ricochet-contact").write_text(
            f"""#!/usr/bin/python3
import os, subprocess, sys
real = subprocess.Popen(["{BIN}/ricochet-contact", *sys.argv[1:]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
if "--batch" not in sys.argv:
    print(real.communicate()[0], end="")
    sys.exit(real.returncode)
impacts = 0
for line in sys.stdin:
    real.stdin.write(line)
    real.stdin.flush()
    answer = real.stdout.readline()
    impacts += '"kernels": true' not in line
    if impacts == 10:
        sys.stdout.write(answer[:20] * (os.getpid() % 2))
        sys.stdout.flush()
        os.kill(os.getpid(), 9)
    print(answer, end="", flush=True)
"""
        )
        (victims / "ricochet-contact").chmod(0o755)
        self.succeed(self.sweep_by(victims, study))
        self.assertEqual(
            {row["status"] for row in self.rows()}, {"0"}
        )  # the sweep asks again, and new processes answer
        always = (victims / "ricochet-contact").read_text().replace("impacts == 10", "impacts > 0")
        (victims / "ricochet-contact").write_text(always)
        (self.out / "rods.sweep.jsonl").unlink()
        self.assertEqual(self.sweep_by(victims, study).status, 1)
        self.assertEqual({row["status"] for row in self.rows()}, {"1"})
        self.assertEqual((self.out / "rods.sweep.jsonl").read_text(), "")
        self.succeed(self.sweep(study))
        self.assertEqual({row["status"] for row in self.rows()}, {"0"})

    def test_kernels_that_follow_from_others_are_not_computed(self):
        """Six Young's moduli and six dampings: ricochet-kernel runs once per mesh, not once per body."""
        starts = self.folder / "starts"
        for program in ("ricochet-contact", "ricochet-kernel"):
            counted = f"echo >> {starts}\n" if program.endswith("kernel") else ""
            self.write(program, f'#!/bin/sh\n{counted}exec {BIN}/{program} "$@"\n').chmod(0o755)
        text = (
            '[set]\n"modes.count" = 20\n"time.rate_hz" = 20.0\n[random]\ncount = 6\n'
            '"bodies.moving.material.young" = { log_uniform = [1.0, 4.0] }\n"bodies.moving.damping.ratio" = { uniform = [0.01, 0.1] }'
        )
        self.succeed(self.sweep_by(self.folder, self.study(text)))
        self.assertEqual(starts.read_text().count("\n"), 1)
        self.assertEqual(len(list(self.out.glob("moving-*.kernel.h5"))), 6)
        self.assertEqual({row["status"] for row in self.rows()}, {"0"})
        last = self.rows()[-1]
        sets = [
            f"{key}={last[key]}" for key in ("bodies.moving.material.young", "bodies.moving.damping.ratio")
        ]
        sets += ["modes.count=20", "time.rate_hz=20.0", "title=alone"]
        self.succeed(kernel(self.folder / "two-rods.toml", self.folder / "alone", *sets, ranks=1))
        self.succeed(contact(self.folder / "two-rods.toml", self.folder / "alone", *sets))
        # Derived or computed, eigenvectors are accurate to round-off divided by the gap between frequencies.
        self.assertAlmostEqual(
            float(last["impulse_ns"]) / self.summary(self.folder / "alone")["impulse_ns"], 1, delta=1e-7
        )

    def test_bodies_at_rest_and_table_kernels_are_swept_too(self):
        rod = (
            f'[bodies.rod]\nmesh = "{MESHES}/two-rods/rod.geo"\norder = 1\nmaterial = {{ density = 1, young = 1, area = 1 }}\n'
            'contact = "left"\n[obstacles.wall]\nnormal = [1, 0, 0]\n[modes]\ncount = 3\n'
            '[contact]\nbetween = ["rod", "wall"]\nscheme = "static"\n[loads]\ngravity = [-1, 0, 0]\n'
        )
        self.write("rod.toml", rod)
        keep = 'keep = ["force", "bodies", "energy"]\n'
        text = '[grid]\n"loads.gravity[0]" = [-1e-3, -2e-3]'
        self.succeed(self.sweep(self.study(keep + text, "rod.toml")))
        with h5py.File(self.out / "rods.sweep.h5") as file:  # no velocities at rest
            self.assertEqual(sorted(file["histories/0001"]), ["contact", "energy", "time"])
            np.testing.assert_allclose(force_of(file, "0001"), [[0], [2e-2]], rtol=1e-9)
            np.testing.assert_array_equal(file["histories/0001/time"], [0])
        for row in self.rows():  # the weight: 10 kg times gravity
            self.assertAlmostEqual(
                float(row["pairs.0.force_n"]) / (-10 * float(row["loads.gravity[0]"])), 1, delta=1e-9
            )
        text = (
            '[set]\n"modes.count" = 20\n"time.rate_hz" = 20.0\n[grid]\n"contact.kernel" = ["modes", "table"]'
        )
        self.succeed(self.sweep(self.study(keep + text)))
        modes, table = self.rows()
        with h5py.File(self.out / "rods.sweep.h5") as file:  # table kernels know no energies
            self.assertEqual(sorted(file["histories/0001"]), ["bodies", "component", "contact", "time"])
            one, other = (file[f"histories/000{k}"] for k in (0, 1))
            np.testing.assert_array_equal(one["time"], other["time"])
            for name in ("bodies/moving/velocity", "bodies/resting/velocity"):  # summed in another order
                np.testing.assert_allclose(one[name], other[name], atol=1e-9)
        for name in ("impulse_ns", "exit_velocity.resting.x", "modes.moving"):  # summed in another order
            self.assertAlmostEqual(
                float(table[name]), float(modes[name]), delta=1e-9 * abs(float(modes[name]))
            )

    def test_a_history_that_changed_is_another_impact(self):
        """The identity of an impact includes the files that it reads besides kernels."""
        text = (self.folder / "two-rods.toml").read_text()
        self.write(
            "pushed.toml",
            text
            + '\n[[loads.point]]\nname = "push"\nbody = "resting"\nat = [10, 0, 0]\nvector = [1e-3, 0, 0]\n'
            'history = "push.csv"\n',
        )
        study = self.study(
            '[set]\n"modes.count" = 5\n"time.rate_hz" = 20.0\n[grid]\n"contact.gap" = [0.0]', "pushed.toml"
        )
        found, before = [], None
        for history in ("0, 0\n30, 1\n", "0, 0\n30, 20\n", "0, 0\n30, 20\n"):
            if history != before:
                self.write("push.csv", history)
            before = history
            self.succeed(self.sweep(study))
            found.append(
                (
                    self.rows()[0]["exit_velocity.resting.x"],
                    len((self.out / "rods.sweep.jsonl").read_text().splitlines()),
                )
            )
        self.assertNotEqual(found[0][0], found[1][0])
        self.assertEqual([lines for _, lines in found], [1, 2, 2])

    def test_settings_that_are_refused_are_rows_that_say_why(self):
        text = GRID.replace("[0.5, 1.0]", "[0.5, inf]")
        done = self.sweep(self.study(text))
        self.assertEqual((done.status, done.err), (3, ""))
        self.assertIn("6 refused or failed", done.out)
        status = [(row["bodies.moving.velocity[0]"], row["status"], row["error"]) for row in self.rows()]
        self.assertEqual({entry[:2] for entry in status}, {("0.5", "0"), ("inf", "2")})
        self.assertIn("bodies.moving.velocity", status[-1][2])

    def test_a_study_none_of_whose_settings_can_run_is_refused_before_anything_is_computed(self):
        self.refused(self.sweep(self.study('[grid]\n"bodies.moving.mass" = [1, 2]')), "mass")
        self.assertEqual(list(self.out.glob("*.kernel.h5")), [])


if __name__ == "__main__":
    unittest.main()
