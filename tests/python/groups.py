# SPDX-License-Identifier: BSD-2-Clause
"""Settings of a study with accuracy: which rows share them, and which errors the rows get.

A stand-in answers in place of the programs. Settings chosen at a speed w and a damping c have the error
a/5 (w/v + v/w)² (1 + c) at a speed v: least at v = w, and above the accuracy a beyond v/w = 1.6.
"""
import contextlib
import json
import math
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

from ricochet import programs
from ricochet.studies import groups
from ricochet.studies.groups import MOST, Groups

ACCURACY = 0.01


def error(chosen_at, speed, damping):
    return 0.2 * ACCURACY * (chosen_at / speed + speed / chosen_at) ** 2 * (1 + damping)


class Programs:
    """Kernels of a study, in a folder: counts what it is asked for."""

    def __init__(self, folder, study, least=0.0, few=0.0):
        self.folder, self.study, self.least, self.few = folder, study, least, few
        self.ranks, self.names, self.loops, self.impacts = 1, set(), [], []

    def kernel_command(self, scene, words, ranks):
        return words

    def start(self, words):
        """Chooses settings."""
        values = dict(word.split("=", 1) for word in words if "=" in str(word))
        (self.folder / values["settings"]).write_text(values["speed"])
        self.loops.append(float(values["speed"]))
        return values

    def refusal(self, values):
        fails = float(values["speed"]) < self.least
        return {"status": 2, "error": "a bad mesh"} if fails else None

    def meshes(self, row):
        return ""

    def ask(self, requests):
        for index, request in enumerate(requests):
            values = dict(word.split("=", 1) for word in request["set"])
            if request.get("kernels"):
                answer = {"status": 0, "kernels": [{"file": "a.kernel.h5", "there": True}]}
            else:
                speed, damping = float(values["speed"]), float(values["damping"])
                chosen_at = float((self.folder / values["settings"]).read_text())
                total = error(chosen_at, speed, damping)
                self.impacts.append((speed, damping))
                estimate = {"quantity": "impulse", "total": total}
                summary = {
                    "error_estimate": estimate,
                    "warnings": [],
                    "max_active": 9 if speed > self.few * chosen_at else 3,
                }
                answer = {
                    "status": 0,
                    "summary": summary,
                    "meets": total <= ACCURACY,
                    "chosen": [f"at={chosen_at}", f"time.contact_rate_hz={1000 * speed}"],
                }
            yield index, json.dumps(answer).encode(), b""


class Journal:
    def __init__(self):
        self.rows = {}

    def add(self, key, line, image=b""):
        self.rows[key] = json.loads(line)

    def refused(self, key):
        return self.rows.get(key, {"status": 0})["status"] != 0


class GroupsTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.journal = Journal()

    def settle(self, settings, reads=False, least=0.0, few=0.0):
        study = SimpleNamespace(settings=settings, fixed={}, scene="scene.toml", keep=[])
        self.keys = [f"{k:08x}" for k in range(len(settings))]
        self.programs = Programs(self.folder, study, least, few)
        self.groups = Groups(study, self.programs, self.journal, self.keys, reads)
        with contextlib.ExitStack() as stack:
            for name in ("kernel_command", "start", "refusal"):
                stack.enter_context(mock.patch.object(programs, name, getattr(self.programs, name)))
            self.groups.settle("ball-0123.settings.toml", range(len(settings)))
        return self.groups

    def outcome(self, row):
        """The speed for which the settings of a row were chosen, and its error."""
        served = self.groups.served.get(row)
        if served:
            return float(served.chosen[0][3:]), served.estimate
        answer = self.journal.rows[self.keys[row]]
        return float(answer["chosen"][0][3:]), answer["summary"]["error_estimate"]

    @staticmethod
    def grid(speeds, dampings=(1e-3, 2e-3, 5e-3)):
        return [{"speed": v, "damping": c} for v in speeds for c in dampings]

    def test_all_rows_meet_the_accuracy_and_few_are_estimated(self):
        settings = self.grid([0.1 * 10 ** (k / 99) for k in range(100)])
        self.settle(settings)
        for row, setting in enumerate(settings):
            chosen_at, estimate = self.outcome(row)
            true = error(chosen_at, setting["speed"], setting["damping"])
            self.assertLessEqual(true, 1.001 * ACCURACY, setting)
            # The error grows by 10 % over the speeds of a box.
            self.assertAlmostEqual(estimate["total"] / true, 1, delta=0.1)
        # (w/v + v/w)² = 5 at v/w = 1.618: a decade has log 10/(2 log 1.618) = 2.4 such intervals. Chosen in
        # the middle of what is left, they do not fit without a gap.
        self.assertGreaterEqual(len(self.programs.loops), 3)
        self.assertLessEqual(len(self.programs.loops), 6)
        self.assertLess(len(self.programs.impacts), len(settings) / 2)
        self.assertEqual(
            self.groups.estimated
            + len([s for s in self.groups.served.values() if "interpolated" in s.estimate]),
            len(settings),
        )

    def test_one_of_so_many_rows_is_estimated(self):
        settings = self.grid([1 + 0.0005 * k for k in range(200)], [0.1])
        self.settle(settings)
        self.assertEqual(len(self.programs.loops), 1)
        between = sum("interpolated" in s.estimate for s in self.groups.served.values())
        # Boxes of 25 to 50 rows have three estimates each.
        self.assertGreaterEqual(len(settings) - between, 3 * len(settings) / MOST)
        self.assertLessEqual(len(settings) - between, 8 * len(settings) / MOST)

    def test_rows_between_take_the_shortest_steps_of_their_neighbours(self):
        settings = self.grid([1 + 0.01 * k for k in range(20)], [0.1])
        self.settle(settings)
        for row, served in self.groups.served.items():
            rate = float(served.chosen[1].partition("=")[2])
            self.assertGreaterEqual(rate, 1000 * settings[row]["speed"])

    def test_nothing_is_chosen_or_estimated_twice(self):
        settings = self.grid([0.1 * 10 ** (k / 29) for k in range(30)])
        self.settle(settings)
        first = {row: self.outcome(row) for row in range(len(settings))}
        self.settle(settings, reads=True)
        self.assertEqual(self.programs.loops, [])
        self.assertEqual(self.programs.impacts, [])
        self.assertEqual({row: self.outcome(row) for row in range(len(settings))}, first)

    def test_refused_rows_are_not_tried_again(self):
        self.settle(self.grid([1, 2, 3]), least=10)
        self.settle(self.grid([1, 2, 3]), least=10)
        self.assertEqual(self.programs.loops, [])
        self.assertEqual(len(self.groups.refused), 9)

    def test_parts_need_settings(self):
        with self.assertRaisesRegex(Exception, "run ricochet sweep --kernels"):
            self.settle(self.grid([1, 2]), reads=True)

    def test_an_accuracy_that_cannot_be_met_is_a_warning_and_no_loop_for_each_row(self):
        settings = self.grid([1 + 0.01 * k for k in range(40)], [0.5, 0.55])  # error at least 1.2 × accuracy
        self.settle(settings)
        self.assertLessEqual(len(self.programs.loops), 4)
        warned = [row for row, served in self.groups.served.items() if served.warning]
        self.assertEqual(len(warned), len(self.groups.served))
        answer = {"status": 0, "summary": {"warnings": []}}
        self.groups.served[warned[0]].complete(answer)
        self.assertIn("interpolated between impacts that miss the accuracy", answer["summary"]["warnings"][0])

    def test_rows_that_fail_alike_fail_once(self):
        self.settle(self.grid([1, 2, 3]), least=10)
        self.assertEqual(len(self.programs.loops), 1)
        self.assertEqual(len(self.groups.refused), 9)

    def test_rows_with_fewer_pressed_points_get_settings_of_their_own(self):
        settings = self.grid([1 + 0.01 * k for k in range(30)], [0.1])
        self.settle(settings, few=0.95)
        for row, setting in enumerate(settings):
            self.assertGreater(setting["speed"], 0.95 * self.outcome(row)[0])
        # Chosen in the middle, at 1.14 or 1.15, they serve from 1.09 on; then, at 1.04, from 0.99 on.
        self.assertEqual(len(self.programs.loops), 2)

    def test_texts_are_not_neighbours(self):
        rows = groups.by_text([{"x": 1, "s": "a"}, {"x": 2, "s": "b"}, {"x": 3, "s": "a"}], range(3))
        self.assertEqual(sorted(rows), [[0, 2], [1]])

    def test_values_of_one_sign_are_measured_by_their_ratio(self):
        places = groups.places_of([{"v": [0, 0, -1.0]}, {"v": [0, 0, -10.0]}, {"v": [0, 0, -100.0]}])
        self.assertEqual([round(float(p[0]), 9) for p in places], [0, 0.5, 1])
        self.assertTrue(math.isclose(groups.places_of([{"x": -1.0}, {"x": 1.0}, {"x": 0.0}])[2][0], 0.5))


if __name__ == "__main__":
    unittest.main()
