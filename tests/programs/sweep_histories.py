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

from programs import contact
from sweep import KEEP, SweepTest, force_of

from ricochet.studies import chart, history_chart


class Histories(SweepTest):
    def test_histories_are_those_of_the_program_alone(self):
        """To the last bit, for impacts of different steps and lengths."""
        study = self.study(
            'keep = ["force", "receivers", "acceleration", "bodies", "energy"]\n[set]\n"modes.count" = 20\n'
            + "".join(f'"bodies.{body}.material.young" = 100.0\n' for body in ("moving", "resting"))
            + '"output.receiver" = [{ name = "end", body = "resting", at = [10, 0, 0] }]\n'
            '[list]\n"time.rate_hz" = [200.0, 100.0, 200.0]\n"time.duration" = [3.0, 2.5, 0.2]\n'
            '"output.every" = [1, 3, 1]\n"time.contact_rate_hz" = [400.0, 100.0, 200.0]\n"contact.gap" = [0.5, 0.0, 5.0]'
        )
        done = self.succeed(self.sweep(study, "--plot", "receivers.end.x"))
        self.assertIn('1 of 3 impacts touched nothing (column "touched")', done.out)
        self.assertTrue((self.out / "rods.receivers.end.x.png").is_file())
        self.assertEqual([row["touched"] for row in self.rows()], ["1", "1", "0"])
        self.assertEqual(self.rows()[2]["restitution"], "nan")
        same = ["time", "receivers/time", "receivers/end/velocity", "receivers/end/acceleration"]
        same += [f"bodies/{name}/velocity" for name in ("moving", "resting")]
        same += [
            f"energy/{term}" for term in ("total", "kinetic", "strain", "residual", "damping", "contact")
        ]
        with h5py.File(self.out / "rods.sweep.h5") as file:
            for k, row in enumerate(self.rows()):
                sets = ["modes.count=20", "title=alone"]
                sets += [f"bodies.{body}.material.young=100.0" for body in ("moving", "resting")]
                sets += ['output.receiver=[{ name = "end", body = "resting", at = [10, 0, 0] }]']
                sets += [
                    f"{key}={row[key]}"
                    for key in (
                        "time.rate_hz",
                        "time.duration",
                        "output.every",
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

    def test_records_and_columns_with_one_first_word_are_both_drawn(self):
        """acceleration.end.peak is a column, and acceleration.end.x a record."""
        study = self.study(
            'keep = ["acceleration"]\n[set]\n"modes.count" = 20\n"time.rate_hz" = 20.0\n"time.duration" = 2.5\n'
            '"output.receiver" = [{ name = "end", body = "resting", at = [10, 0, 0] }]\n'
            '[grid]\n"contact.gap" = [0.0, 0.5]'
        )
        self.succeed(self.sweep(study))
        drawn = {
            "acceleration.end.peak": "largest acceleration of end (m/s²)",
            "acceleration.end.x": "acceleration of end, x (m/s²)",
        }
        for name, label in drawn.items():
            with self.subTest(name), mock.patch.object(
                history_chart, "save_picture"
            ) as record, mock.patch.object(chart, "save_picture") as column:
                self.succeed(self.sweep(study, "--collect", "--plot", name))
                (saved,) = [*record.call_args_list, *column.call_args_list]
                self.assertEqual(saved.args[0].axes[0].get_ylabel(), label)

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

    def test_receivers_that_do_not_exist_are_refused_before_anything_is_computed(self):
        done = self.sweep(self.study('keep = ["receivers"]\n[grid]\n"contact.gap" = [0.0]'))
        self.refused(done, "output.receiver: is missing")
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
