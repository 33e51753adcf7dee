# SPDX-License-Identifier: BSD-2-Clause
"""Table kernels as a user runs them: the shipped example compared with d'Alembert's wave solution for two rods, and kernels
sampled from modes compared with modal stepping."""

import subprocess
import unittest

import h5py
import numpy as np

from programs import MESHES, ProgramTest, contact, kernel

ANALYTIC = MESHES / "two-rods-analytic"
SCENE = ANALYTIC / "two-rods-analytic.toml"
IMPULSE = "contact.scheme=impulse"


class AnalyticRods(ProgramTest):
    """Two rods close a gap at v = 1 and remain in contact for 2L/c = 20 under a force of Zv/2 = 1/2."""

    def table(self, *arguments):
        path = self.folder / "rods.table.h5"
        done = subprocess.run(
            ["/usr/bin/python3", ANALYTIC / "table.py", *arguments, path], capture_output=True, text=True
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return path

    def collide(self, table, *sets):
        out = self.folder / "out"
        self.succeed(contact(SCENE, out, f'contact.table="{table}"', *sets))
        (path,) = out.glob("*.result.h5")
        with h5py.File(path) as file:
            result = {}
            file.visititems(
                lambda name, item: result.update({name: item[:]} if isinstance(item, h5py.Dataset) else {})
            )
        return self.summary(out), result

    def test_both_schemes_give_the_exact_impact(self):
        table = self.table()
        # The time of a "compliant" force is the end of its step; an impulse
        # represents the step after its instant.
        for scheme, behind in [("impulse", 0.01), ("compliant", 0.0)]:
            with self.subTest(scheme=scheme):
                summary, result = self.collide(table, f"contact.scheme={scheme}")
                pressure = result["contact/force"] / result["contact/area"]
                np.testing.assert_allclose(pressure, 0.5, rtol=0, atol=1e-10)
                self.assertAlmostEqual(summary["contact_start_s"] + behind, 1, delta=1e-9)
                self.assertAlmostEqual(summary["contact_end_s"] + behind, 21, delta=1e-9)
                self.assertEqual(summary["contact_steps"], 2000)
                np.testing.assert_allclose(summary["exit_velocity"]["moving"], [0, 0, 0], atol=1e-11)
                np.testing.assert_allclose(summary["exit_velocity"]["resting"], [1, 0, 0], atol=1e-11)
                self.assertAlmostEqual(summary["restitution"], 1, delta=1e-11)
                np.testing.assert_allclose(result["contact/gap"], 0, atol=1e-11)
                moving = result["bodies/moving/velocity"][:, 0]
                t = np.clip(result["time"] + behind - 1, 0, 20)
                np.testing.assert_allclose(moving, 1 - t / 20, atol=1e-10)
                # Values that a table does not provide are absent or null.
                self.assertNotIn("energy/total", result)
                self.assertIsNone(summary["energy_drift"])

    def test_other_rods_at_a_rate_that_the_wave_does_not_meet(self):
        # Z = 2·3·0.5 = 3, c = 3, 2L/c = 4/3 or 133.3 steps at 100 Hz: the sampled jump is
        # one step wide, and so is the error.
        table = self.table(
            "--density",
            "2",
            "--young",
            "18",
            "--area",
            "0.5",
            "--length",
            "2",
            "--gap",
            "0.1",
            "--speed",
            "2",
            "--duration",
            "2",
        )
        for scheme in ("impulse", "compliant"):
            with self.subTest(scheme=scheme):
                summary, result = self.collide(table, f"contact.scheme={scheme}", "time.duration=2")
                self.assertAlmostEqual(
                    summary["contact_end_s"] - summary["contact_start_s"], 4 / 3, delta=0.011
                )
                self.assertAlmostEqual(np.median(result["contact/force"]), 3, delta=1e-9)
                self.assertAlmostEqual(summary["impulse_ns"], 4, delta=3 * 0.01)

    def test_needs_no_kernels(self):
        run = self.succeed(kernel(SCENE, self.folder / "kernels", quiet=False))
        self.assertIn("nothing to compute", run.out + run.err)
        self.assertEqual(list(self.folder.glob("kernels/*")), [])

    def test_refusals_are_one_line(self):
        table = self.table("--duration", "5")
        with h5py.File(table) as file:
            self.assertEqual(file["table/velocity"].shape, (501, 1, 1))
        cases = [
            ([], "has samples for 5.01 s"),
            (
                ["time.duration=1", "time.rate_hz=200"],
                "time.rate_hz = 200: the table has a step of 0.01 s. Set 100.",
            ),
            (["time.duration=1", "modes={count=3}"], "is replaced by contact.table"),
            (["time.duration=1", "output.snapshot_every=3"], "has no modal coordinates"),
            (["time.duration=1", "contact.kernel=modes"], 'belongs to kernel = "table"'),
        ]
        for sets, part in cases:
            with self.subTest(part=part):
                run = contact(SCENE, self.folder / "refused", f'contact.table="{table}"', *sets)
                self.assertEqual(run.status, 2)
                self.assertIn(part, run.err)
                self.assertEqual(run.err.count("\n"), 1, run.err)
                self.assertEqual(list(self.folder.glob("refused/*")), [])
        run = contact(SCENE, self.folder / "refused", 'contact.table="nowhere.h5"')
        self.assertEqual((run.status, run.err.count("\n")), (2, 1), run.err)
        self.assertIn("nowhere.h5: there is no such file", run.err)


class ModalRods(ProgramTest):
    def test_sampled_modes_give_what_modes_give(self):
        scene = MESHES / "two-rods" / "two-rods.toml"
        self.succeed(kernel(scene, self.folder))
        for scheme in (["contact.scheme=compliant"], [IMPULSE], [IMPULSE, "contact.admittance=difference"]):
            with self.subTest(scheme=scheme):
                rows = {}
                for kind in ("modes", "table"):
                    self.succeed(
                        contact(scene, self.folder, f"title={kind}", f"contact.kernel={kind}", *scheme)
                    )
                    with h5py.File(self.folder / f"{kind}.result.h5") as file:
                        names = [
                            "contact/time",
                            "contact/force",
                            "contact/gap",
                            "contact/point_a",
                            "bodies/moving/velocity",
                            "bodies/resting/momentum",
                        ]
                        rows[kind] = {name: file[name][:] for name in names}
                for name, values in rows["modes"].items():
                    np.testing.assert_allclose(rows["table"][name], values, rtol=0, atol=1e-9, err_msg=name)


if __name__ == "__main__":
    unittest.main()
