# SPDX-License-Identifier: BSD-2-Clause
"""Histories of a sweep: those of the program alone, only where they are missing, in parts, and as pictures."""

import json
import os
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import h5py
import numpy as np

from programs import MESHES, contact
from sweep import KEEP, SweepTest, force_of

from ricochet.studies import chart, histories, history_chart

FOIL = '[{ name = "foil", body = "resting", at = [5, 0, 0], direction = [1, 0, 0] }]'


def equivalent(stress):
    """The von Mises stress of rows xx, yy, zz, yz, xz, xy: √(3/2 s:s) with the deviator s."""
    tensor = stress[:, [[0, 5, 4], [5, 1, 3], [4, 3, 2]]]
    deviator = tensor - np.trace(tensor, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    return np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2)))


class Histories(SweepTest):
    def test_histories_are_those_of_the_program_alone(self):
        """To the last bit, for impacts of different steps and lengths."""
        study = self.study(
            'keep = ["force", "receivers", "acceleration", "gauges", "bodies", "energy"]\n[set]\n"modes.count" = 20\n'
            + "".join(f'"bodies.{body}.material.young" = 100.0\n' for body in ("moving", "resting"))
            + '"output.receiver" = [{ name = "end", body = "resting", at = [10, 0, 0] }]\n'
            + f'"output.gauge" = {FOIL}\n'
            '[list]\n"time.rate_hz" = [200.0, 100.0, 200.0]\n"time.duration" = [3.0, 2.5, 0.2]\n'
            '"output.every" = [1, 3, 1]\n"output.receivers_rate_hz" = [50.0, 100.0, 200.0]\n"time.contact_rate_hz" = [400.0, 100.0, 200.0]\n"contact.gap" = [0.5, 0.0, 5.0]'
        )
        done = self.succeed(self.sweep(study, "--plot", "receivers.end.x"))
        self.assertIn('1 of 3 impacts touched nothing (column "touched")', done.out)
        self.assertTrue((self.out / "rods.receivers.end.x.png").is_file())
        self.assertEqual([row["touched"] for row in self.rows()], ["1", "1", "0"])
        self.assertEqual(self.rows()[2]["restitution"], "nan")
        same = ["time", "receivers/time", "receivers/end/velocity", "receivers/end/acceleration"]
        same += ["gauges/time", "gauges/foil/stress", "gauges/foil/strain"]
        same += [f"bodies/{name}/velocity" for name in ("moving", "resting")]
        same += [
            f"energy/{term}" for term in ("total", "kinetic", "strain", "residual", "damping", "contact")
        ]
        with h5py.File(self.out / "rods.sweep.h5") as file:
            for k, row in enumerate(self.rows()):
                sets = ["modes.count=20", "title=alone"]
                sets += [f"bodies.{body}.material.young=100.0" for body in ("moving", "resting")]
                sets += ['output.receiver=[{ name = "end", body = "resting", at = [10, 0, 0] }]']
                sets += [f"output.gauge={FOIL}"]
                sets += [
                    f"{key}={row[key]}"
                    for key in (
                        "time.rate_hz",
                        "time.duration",
                        "output.every",
                        "output.receivers_rate_hz",
                        "time.contact_rate_hz",
                        "contact.gap",
                    )
                ]
                self.succeed(contact(self.folder / "two-rods.toml", self.out, *sets))
                kept = file[f"histories/{k:04}"]
                with h5py.File(self.out / "alone.result.h5") as alone:
                    for name in same:
                        np.testing.assert_array_equal(kept[name], alone[name], name)
                        self.assertEqual(kept[name].attrs["unit"], alone[name].attrs["unit"])
                    self.assertEqual(dict(kept["receivers/end"].attrs)["body"], b"resting")
                    time, force = force_of(file, f"{k:04}")
                    np.testing.assert_array_equal(time[force > 0], alone["contact/time"])
                    # One contact point; the force is 0 a row before and after each time of contact.
                    np.testing.assert_array_equal(force[force > 0], alone["contact/force"][:, 0])
                    step = alone["contact"].attrs["step"]
                    stress, strain = alone["gauges/foil/stress"][:], alone["gauges/foil/strain"][:]
                    gauge_time = alone["gauges/time"][:]
                self.check_gauge(row, gauge_time, stress, strain)
                figures = json.loads((self.out / "alone.summary.json").read_text())["acceleration"]["end"]
                self.assertEqual(float(row["acceleration.end.peak"]), figures["peak_m_per_s2"])
                self.assertEqual(row["acceleration.end.cfc_60"], "nan")  # 200 samples per second
                if k < 2:
                    self.assertEqual((force[0], force[-1]), (0, 0))
                    np.testing.assert_allclose(np.diff(time), step, rtol=1e-9)  # times are rounded
                else:
                    self.assertEqual(len(force), 0)
            warned = file["warning_texts"].asstr()[:]
        summary = json.loads((self.out / "alone.summary.json").read_text())
        self.assertEqual(warned[2].splitlines(), summary["warnings"])
        self.assertIn("nothing touched", warned[2])
        self.assertEqual(self.rows()[2]["warning_texts"], " | ".join(summary["warnings"]))

    def check_gauge(self, row, time, stress, strain):
        """The columns of the gauge are the largest values of all steps, which are the rows of impacts that have one for each."""
        columns = {name: float(row[f"gauges.foil.{name}"]) for name in ("von_mises_pa", "strain_peak")}
        for (name, column), rows in zip(columns.items(), (equivalent(stress), np.abs(strain))):
            if float(row["time.contact_rate_hz"]) > float(row["output.receivers_rate_hz"]):
                continue
            self.assertAlmostEqual(column, rows.max(), delta=1e-12 * rows.max(initial=1e-3))  # round-off
            when = {"von_mises_pa": "von_mises_time_s", "strain_peak": "strain_time_s"}[name]
            self.assertAlmostEqual(float(row[f"gauges.foil.{when}"]), time[rows.argmax()], delta=1e-9)
        # σ = E ε in a rod, with E = 100 Pa; round-off of the static part.
        self.assertAlmostEqual(columns["von_mises_pa"], 100 * columns["strain_peak"], delta=1e-9)
        self.assertEqual(
            float(row["stress.resting.von_mises_pa"]), columns["von_mises_pa"]
        )  # of the only gauge

    def test_records_and_columns_with_one_first_word_are_both_drawn(self):
        """acceleration.end.peak and gauges.foil.strain_peak are columns, acceleration.end.x and gauges.foil.strain records."""
        study = self.study(
            'keep = ["acceleration", "gauges"]\n[set]\n"modes.count" = 20\n"time.rate_hz" = 20.0\n"time.duration" = 2.5\n'
            '"output.receiver" = [{ name = "end", body = "resting", at = [10, 0, 0] }]\n'
            f'"output.gauge" = {FOIL}\n[grid]\n"contact.gap" = [0.0, 0.5]'
        )
        self.succeed(self.sweep(study))
        drawn = {
            "acceleration.end.peak": "largest acceleration of end (m/s²)",
            "acceleration.end.x": "acceleration of end, x (m/s²)",
            "gauges.foil.von_mises_pa": "largest von Mises stress of foil (Pa)",
            "gauges.foil.von_mises": "von Mises stress of foil (Pa)",
            "gauges.foil.strain_peak": "largest strain of foil",
            "gauges.foil.strain": "strain of foil",
            "gauges.foil.stress.xx": "stress of foil, xx (Pa)",
            "stress.resting.von_mises_pa": "largest von Mises stress of resting (Pa)",
        }
        for name, label in drawn.items():
            with self.subTest(name), mock.patch.object(
                history_chart, "save_picture"
            ) as record, mock.patch.object(chart, "save_picture") as column:
                self.succeed(self.sweep(study, "--collect", "--plot", name))
                (saved,) = [*record.call_args_list, *column.call_args_list]
                self.assertEqual(saved.args[0].axes[0].get_ylabel(), label)
        with h5py.File(self.out / "rods.sweep.h5") as file:
            found = histories.read(file, 0, "gauges.foil.von_mises")
            stress = file["histories/0000/gauges/foil/stress"][:]
        np.testing.assert_allclose(
            found.values, equivalent(stress), rtol=0, atol=1e-12 * np.abs(stress).max()
        )
        for name, answer in {
            "gauges.foil.stress": "has 6 components: draw one of gauges.foil.stress.xx, gauges.foil.stress.yy",
            "gauges.foil.stress.x": '"gauges.foil.stress" has no .x: give .xx, .yy, .zz, .yz, .xz, .xy',
            "gauges.foil.strain.xx": '"gauges.foil.strain" has no components: leave .xx out',
            "gauges.foil.von_mise": 'Did you mean "gauges.foil.von_mises"?',
        }.items():
            self.refused(self.sweep(study, "--collect", "--plot", name), answer)

    def test_gauges_of_bodies_at_rest_have_a_row_for_each_equilibrium(self):
        """A rod of 10 kg and 1 m² that stands on its end: σ = −ρ g (10 m − 2.5 m) at a quarter of its length."""
        self.write(
            "rod.toml",
            f'[bodies.rod]\nmesh = "{MESHES}/two-rods/rod.geo"\norder = 1\nmaterial = {{ density = 1, young = 1, area = 1 }}\n'
            'contact = "left"\n[obstacles.wall]\nnormal = [1, 0, 0]\n[modes]\ncount = 3\n'
            '[contact]\nbetween = ["rod", "wall"]\nscheme = "static"\n'
            '[[output.gauge]]\nname = "low"\nbody = "rod"\nat = [2.5, 0, 0]\n',
        )
        text = 'keep = ["gauges"]\n[grid]\n"loads.gravity" = [[-1e-3, 0, 0], [-2e-3, 0, 0]]'
        self.succeed(self.sweep(self.study(text, "rod.toml")))
        with h5py.File(self.out / "rods.sweep.h5") as file:
            for row, gravity in enumerate((1e-3, 2e-3)):
                group = file[f"histories/{row:04}/gauges"]
                self.assertEqual((group["time"].shape, group["low/stress"].shape), ((1,), (1, 6)))
                # Elements of order 1 have the stress of their middle; the mesh is even, and 2.5 m is at a node.
                self.assertAlmostEqual(group["low/stress"][0, 0] / (-7.5 * gravity), 1, delta=1e-6)
                self.assertEqual(
                    float(self.rows()[row]["gauges.low.von_mises_pa"]), abs(group["low/stress"][0, 0])
                )
                self.assertEqual(self.rows()[row]["gauges.low.strain_peak"], "nan")  # it has no direction

    def test_only_impacts_without_histories_are_run_for_them(self):
        text = '[set]\n"modes.count" = 5\n"time.rate_hz" = 20.0\n[grid]\n"contact.gap" = [0.0, 0.5]'
        journal = self.out / "rods.sweep.jsonl"

        def runs_after(text, *more):
            done = self.succeed(self.sweep(self.study(text), *more))
            return done.out.count("all done before"), journal.read_bytes().count(b"\n")

        self.assertEqual(runs_after(text), (0, 2))
        self.assertEqual(runs_after(KEEP + text), (0, 4))
        self.assertEqual(runs_after(KEEP + text.replace("0.5]", "0.5, 0.7]")), (0, 5))
        before = os.stat(self.out / "rods.sweep.h5")
        self.assertEqual(runs_after(KEEP + text.replace("0.5]", "0.5, 0.7]")), (1, 5))
        self.assertEqual(os.stat(self.out / "rods.sweep.h5").st_ino, before.st_ino)  # not copied for nothing
        self.assertEqual(runs_after(text), (1, 5))
        with h5py.File(self.out / "rods.sweep.h5") as file:
            self.assertNotIn("histories", file)
        more = KEEP.replace('"force"', '"force", "bodies"')
        self.assertEqual(runs_after(more + text), (0, 7))
        self.assertEqual(runs_after(KEEP + text), (1, 7))
        with h5py.File(self.out / "rods.sweep.h5") as file:
            self.assertEqual(sorted(file["histories/0001"]), ["contact"])
        archive = self.out / "rods.sweep.histories"
        content = bytearray(archive.read_bytes())
        content[-100] ^= 1
        archive.write_bytes(content)
        self.refused(self.sweep(self.study(more + text)), "rods.sweep.histories: is damaged. Remove it")
        archive.unlink()
        self.assertEqual(runs_after(more + text), (0, 9))

    def test_parts_keep_histories_of_their_own_which_are_collected(self):
        study = self.study(
            KEEP + '[set]\n"modes.count" = 5\n[grid]\n"contact.gap" = [0.0, 0.1, 0.2, 0.3, 0.4]'
        )
        self.succeed(self.sweep(study, "--kernels"))
        self.succeed(self.sweep(study, "--part", "2/2"))
        waiting = self.sweep(study, "--collect")
        self.assertEqual((waiting.status, waiting.out.splitlines()[0]), (3, "5 impacts, 3 not run yet"))
        with h5py.File(self.out / "rods.sweep.h5") as file:
            self.assertEqual(sorted(file["histories"]), ["0001", "0003"])
            first = force_of(file, "0001")
        self.succeed(self.sweep(study, "--part", "1/2"))
        self.succeed(self.sweep(study, "--collect", "--plot", "force"))
        with h5py.File(self.out / "rods.sweep.h5") as file:
            self.assertEqual(len(file["histories"]), 5)
            np.testing.assert_array_equal(force_of(file, "0001"), first)

    def test_receivers_and_gauges_that_do_not_exist_are_refused_before_anything_is_computed(self):
        done = self.sweep(self.study('keep = ["receivers"]\n[grid]\n"contact.gap" = [0.0]'))
        self.refused(done, "output.receiver: is missing")
        done = self.sweep(self.study('keep = ["gauges"]\n[grid]\n"contact.gap" = [0.0]'))
        self.refused(done, 'output.gauge: is missing: keep = ["gauges"] needs a [[output.gauge]]')
        self.assertEqual(list(self.out.glob("*.kernel.h5")), [])


class Pictures(unittest.TestCase):
    def drawn(self, values):
        """The matplotlib axes of the histories of impacts, each 0, 1, … at 0, 1 and 2 ms."""
        table = SimpleNamespace(title="t", column={"contact.gap": values}.get)
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(
            history_chart, "save_picture"
        ) as saved:
            path = Path(folder) / "t.sweep.h5"
            with h5py.File(path, "w") as file:
                file.create_group("histories").attrs["digits"] = 4
                for row in range(1, len(values)):  # the first one was refused
                    file[f"histories/{row:04}/contact/time"] = [0.0, 1e-3, 2e-3]
                    file[f"histories/{row:04}/contact/total_force"] = [0.0, row, 0.0]
                    file[f"histories/{row:04}/contact/total_force"].attrs["unit"] = "N"
            units = {"contact.gap": "m"}
            history_chart.draw(table, path, "force", "contact.gap", Path("picture.png"), units)
        return saved.call_args.args[0]

    def test_each_impact_is_a_line_in_the_colour_of_its_value(self):
        figure = self.drawn([1.0, 2.0, 3.0, 2.0])
        (ax,) = figure.axes
        self.assertEqual((ax.get_xlabel(), ax.get_ylabel()), ("time (ms)", "contact force (N)"))
        lines = {line.get_ydata()[1]: line for line in ax.lines}
        self.assertEqual(sorted(lines), [1, 2, 3])
        self.assertEqual(list(lines[1].get_xdata()), [0, 1, 2])
        self.assertEqual(lines[1].get_color(), lines[3].get_color())
        self.assertNotEqual(lines[1].get_color(), lines[2].get_color())
        legend = ax.get_legend()
        self.assertEqual(legend.get_title().get_text(), "gap (m)")
        self.assertEqual([part.get_text() for part in legend.get_texts()], ["2", "3"])
        handle = legend.get_lines()[0]
        self.assertEqual(handle.get_color(), lines[1].get_color())

    def test_many_values_have_a_colour_bar_and_of_many_impacts_some_are_drawn(self):
        figure = self.drawn([float(k) for k in range(1002)])
        ax, bar = figure.axes
        self.assertEqual((len(ax.lines), bar.get_ylabel()), (334, "gap (m)"))
        self.assertEqual(ax.get_title(loc="left"), "t (334 of 1001 impacts)")


if __name__ == "__main__":
    unittest.main()
