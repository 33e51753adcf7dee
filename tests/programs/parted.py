# SPDX-License-Identifier: BSD-2-Clause
"""duration = "until parted": where a run ends, and that its figures are those of a longer one. Rods with E = ρ = A = L = 1 touch
for 2 L/c = 2 s, up to the period of their highest mode, and exchange their velocities."""

import csv
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

import scenes
from programs import BIN, Command, ProgramTest, Run, impact, kernel

COUNT, RATE, SPEED = 30, 100.0, 0.01
HIGHEST = 2 / COUNT  # period of the highest mode of a free rod, ω = n π c/L [s]
UNTIL = f'time={{rate_hz={RATE},duration="until parted",longest=10}}'
LONG = "time.duration=12"


class Parted(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = tempfile.TemporaryDirectory(prefix="ricochet-")
        cls.addClassCleanup(folder.cleanup)
        cls.out = Path(folder.name)  # of all tests: most of them have the same kernels

    def setUp(self):
        super().setUp()
        self.write("rod.geo", scenes.rod(elements=100))

    def rods(self, more=""):
        text = scenes.two_rods("Rods", f"count = {COUNT}", f"rate_hz = {RATE}\nduration = 12", more=more)
        return self.write("rods.toml", text)

    def ends(self, summary):
        """Checks that a run ended when nothing had touched for a tenth of the time since contact began. The force is a mean over
        up to three steps, so it ends up to two steps after the contact; a step more, as the run ends at a sample.
        """
        pause = summary["duration_s"] - summary["contact_end_s"]
        tenth = 0.1 * (summary["contact_end_s"] - summary["contact_start_s"])
        self.assertGreaterEqual(pause, tenth - 1e-9)
        self.assertLessEqual(pause, tenth + 4 / RATE)

    def test_a_run_ends_soon_after_contact_with_all_rows_and_figures_of_a_longer_one(self):
        scene = self.rods()
        short, whole = (
            impact(scene, self.out, setting, f"title=run {k}") for k, setting in enumerate((UNTIL, LONG))
        )
        found, expected = short.summary, whole.summary
        self.assertAlmostEqual(found["contact_end_s"], 2, delta=HIGHEST)
        self.ends(found)
        self.assertEqual(expected["duration_s"], 12)
        self.assertAlmostEqual(short.time[-1], found["duration_s"], delta=1e-12)
        for key in (
            "restitution",
            "impulse_ns",
            "contact_end_s",
            "exit_velocity",
            "episodes",
            "energy_above_band",
        ):
            self.assertEqual(found[key], expected[key], key)
        rows = len(short.time)
        np.testing.assert_array_equal(short.time, whole.time[:rows])
        np.testing.assert_array_equal(short.force, whole.force)
        for name, body in short.bodies.items():
            np.testing.assert_array_equal(body.velocity, whole.bodies[name].velocity[:rows])
        self.assertFalse(any("still touch" in text for text in found["warnings"]))
        self.assertEqual(short.scene["time"]["duration"], "until parted")
        self.assertEqual(short.scene["time"]["longest"], 10)

    def test_a_run_that_reaches_its_bound_in_contact_is_warned_of_with_the_bound_that_suffices(self):
        scene = self.rods()
        short = impact(scene, self.out, UNTIL, "time.longest=1.5").summary
        self.assertEqual((short["duration_s"], short["contact_end_s"]), (1.5, None))
        (text,) = (text for text in short["warnings"] if "still touch" in text)
        self.assertRegex(text, r"Set time.longest = 2\.[1-3]$")
        enough = impact(scene, self.out, UNTIL, "time.longest=" + text.rpartition(" ")[2]).summary
        self.assertAlmostEqual(enough["duration_s"], short["parted_s"], delta=1.5 / RATE)
        self.assertIsNotNone(enough["restitution"])

    # The rods hand the velocity on, and the second one flies for longer than a tenth of the contact before it meets the third.
    def test_a_row_of_rods_parts_when_the_last_one_has_been_struck(self):
        rod = 'mesh = "rod.geo"\norder = 1\nmaterial = { density = 1.0, young = 1.0, area = 1.0 }\ncontact = ["left", "right"]\n'
        bodies = {
            name: rod + f"translate = [{x}, 0, 0]\nvelocity = [{v}, 0, 0]\n"
            for name, x, v in (("one", 0, SPEED), ("two", 1.0, 0), ("three", 2.03, 0))
        }
        pairs = '[[contact.pair]]\nbetween = ["one", "two"]\n[[contact.pair]]\nbetween = ["two", "three"]\n'
        text = scenes.scene(bodies, f"count = {COUNT}", "", f"rate_hz = {RATE}\nduration = 30")
        text = text.replace('between = ["one", "two", "three"]\n', "direction = [1, 0, 0]\n") + pairs
        result = impact(self.write("row.toml", text), self.out, UNTIL, "time.longest=30")
        found = result.summary
        self.assertEqual(
            [touch["bodies"] for touch in found["touches"]][0 :: len(found["touches"]) - 1],
            [["one", "two"], ["two", "three"]],
        )
        self.assertLess(found["duration_s"], 10)
        # What the modes that are left out would take stays behind: some per cent.
        self.assertAlmostEqual(found["exit_velocity"]["three"][0], SPEED, delta=0.05 * SPEED)

    # It leaves at about 0.01 and comes back after 2 v/g = 400 s.
    def test_a_rod_that_falls_on_a_wall_parts_although_gravity_will_bring_it_back(self):
        body = 'mesh = "rod.geo"\norder = 1\nmaterial = { density = 1.0, young = 1.0, area = 1.0 }\n'
        body += f'contact = "right"\nvelocity = [{SPEED}, 0, 0]'
        text = scenes.scene(
            {"rod": body},
            f"count = {COUNT}",
            "gap = 0.02",
            f"rate_hz = {RATE}\nduration = 1000",
            {"wall": "point = [1.5, 0, 0]\nnormal = [-1, 0, 0]"},
            more="[loads]\ngravity = [5e-5, 0, 0]",
        )
        found = impact(self.write("fall.toml", text), self.out, UNTIL, "time.longest=1000").summary
        self.ends(found)
        start = (np.sqrt(SPEED**2 + 2 * 5e-5 * 0.02) - SPEED) / 5e-5  # the gap closes by v t + g t²/2
        self.assertAlmostEqual(found["contact_start_s"], start, delta=1.5 / RATE)
        self.assertAlmostEqual(found["contact_end_s"], start + 2, delta=HIGHEST + 2 / RATE)
        self.assertGreater(found["restitution"], 0.9)

    def test_no_row_of_a_study_of_speeds_and_losses_lacks_its_restitution(self):
        self.rods()
        gap, speeds = 0.02, [0.0025, 0.04]
        study = self.write(
            "study.toml",
            f'scene = "rods.toml"\ntitle = "Study"\n[set]\n"time.duration" = "until parted"\n"time.longest" = 20\n"contact.gap" = {gap}\n'
            f'[grid]\n"bodies.moving.velocity[0]" = {speeds}\n"bodies.moving.damping.loss_factor" = [0.0, 0.01, 0.1]\n',
        )
        done = self.succeed(Command("sweep", study, "--out", self.out, "--ranks", "1", "--jobs", "1"))
        self.assertNotIn("while the bodies touch", done.out)
        with open(self.out / "study.sweep.csv") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 6)
        for row in rows:
            speed = float(row["bodies.moving.velocity[0]"])
            self.assertAlmostEqual(float(row["contact_start_s"]), gap / speed, delta=1.5 / RATE)
            self.assertGreater(float(row["restitution"]), 0.5)
            self.ends({key: float(row[key]) for key in ("duration_s", "contact_start_s", "contact_end_s")})
        # A loss slows the rebound.
        lossless, lossy = (float(rows[k]["restitution"]) for k in (0, 2))
        self.assertLess(lossy, lossless)

    def test_a_study_names_the_bound_that_lets_its_bodies_part(self):
        self.rods()
        study = self.write(
            "study.toml",
            'scene = "rods.toml"\n[set]\n"time.duration" = "until parted"\n[grid]\n"time.longest" = [1.5, 5.0]\n',
        )
        done = self.succeed(Command("sweep", study, "--out", self.out, "--ranks", "1", "--jobs", "1"))
        self.assertRegex(
            done.out, r"warning: 1 of 2 impacts end while .*: time.longest = 2\.[1-3] lets 1 of them part"
        )

    def test_estimates_of_the_error_end_with_the_contact(self):
        scene = self.rods()
        found = []
        for end in ('duration="until parted",longest=10', "duration=2.4"):
            found.append(impact(scene, self.out, "accuracy=0.05", f"time={{{end}}}"))
        short, given = found
        # Each estimate covers the touch and little more, so both choose steps of the same size, up to one halving.
        rates = [made.scene["time"]["contact_rate_hz"] for made in found]
        self.assertLessEqual(abs(np.log2(rates[0] / rates[1])), 1.1)
        totals = [made.summary["error_estimate"]["total"] for made in found]
        self.assertLess(max(totals), 3 * min(totals))
        self.assertAlmostEqual(short.summary["restitution"], given.summary["restitution"], delta=0.05)

    def test_frames_and_snapshots_are_spread_over_the_run_and_not_over_its_bound(self):
        scene = self.rods(more="[output]\nview = true")
        setting = f'time={{rate_hz={RATE},duration="until parted",longest=100}}'
        out = self.folder / "out"
        self.succeed(kernel(scene, out, setting))
        self.succeed(
            Run([BIN / "ricochet-contact", scene, "--out", out, "--quiet", "--vtk", "--set", setting])
        )
        with h5py.File(self.one(out, "*.motion.h5")) as file:
            (bodies,) = {len(group["position"]) for group in file["bodies"].values()}
        self.assertGreaterEqual(bodies, 200)  # one for each of 220 samples; 5 by the bound
        words = [BIN / "ricochet-contact", scene, "--out", out, "--quiet", "--snapshots-up-to", "1"]
        self.succeed(Run([*words, "--set", setting]))
        with h5py.File(self.one(out, "*.result.h5")) as file:
            self.assertGreaterEqual(len(file["snapshots/time"]), 200)  # one for each sample; one by the bound


if __name__ == "__main__":
    unittest.main()
