# SPDX-License-Identifier: BSD-2-Clause
"""ricochet tradeoff: its runs, its report, and the continuation of an interrupted run."""

import csv
import json
import math
import os
import signal
import subprocess
import time
import unittest

from programs import BIN, MESHES, ProgramTest, Run

SCENE = MESHES / "two-rods" / "two-rods.toml"
AXES = [
    "--counts",
    "10",
    "40",
    "--rates",
    "0.5",
    "2",
    "--schemes",
    "compliant",
    "jump",
    "--precisions",
    "double",
    "--tolerances",
    "1e-8",
    "--accuracies",
    "1e-1",
    "--repeats",
    "1",
    "--ranks",
    "1",
]


class TradeOff(ProgramTest):
    def command(self, *more):
        return [BIN / "ricochet", "tradeoff", SCENE, "--out", self.folder, *AXES, *more]

    def lines(self):
        file = self.folder / "runs.jsonl"
        return file.read_text().splitlines() if file.exists() else []

    def points(self):
        with open(self.folder / "tradeoff.csv") as file:
            return list(csv.DictReader(file))

    def test_errors_are_those_against_the_reference_and_nothing_beats_the_front(self):
        done = Run(self.command())
        self.succeed(done)
        points = self.points()
        self.assertEqual(len(points), 2 * 2 * 2 * 2 + 1)  # modes × R × steps × schemes, and the accuracy
        self.assertTrue((self.folder / "tradeoff.png").is_file())
        self.assertIn("Cheapest for an error of 0.01", done.out)
        floor = float(done.out.split("reference itself is about ")[1].split()[0])
        front = [point for point in points if point["pareto"] == "True"]

        def cost(point):
            return float(point["kernel_s"]) + float(point["impact_s"])

        def error(point):
            return max(float(point["error"]), floor)

        (chosen,) = [point for point in points if point["basis"] == "accuracy"]
        self.assertLess(float(chosen["error"]), 0.1)
        self.assertEqual(chosen["rate_hz"], "")  # no step was given
        self.assertTrue(front)
        for point in front:
            better = [p for p in points if cost(p) < cost(point) and error(p) < error(point)]
            self.assertEqual(better, [])
        # Two equal rods exchange velocities: with gaps and many modes, the entire speed is passed on.
        best = min(points, key=error)
        self.assertLess(float(best["error"]), 1e-2)

    def test_after_a_kill_only_what_is_missing_is_run(self):
        process = subprocess.Popen(
            [str(word) for word in self.command()],
            stdout=subprocess.DEVNULL,
            start_new_session=True,
            env=os.environ | {"RICOCHET_BIN": str(BIN)},
        )
        while process.poll() is None and len(self.lines()) < 6:
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        before = self.lines()
        with open(self.folder / "runs.jsonl", "a") as file:
            file.write('{"key": "half a li')
        self.succeed(Run(self.command()))
        after = self.lines()
        self.assertEqual(after[: len(before)], before)
        keys = [json.loads(line)["key"] for line in after]
        self.assertEqual(len(keys), len(set(keys)))
        self.succeed(Run(self.command()))
        self.assertEqual(self.lines(), after)

    def test_a_setting_that_is_refused_is_a_row_that_says_so(self):
        self.succeed(
            Run(
                self.command("--counts", "40", "--schemes", "compliant", "difference", "--rates", "0.01", "2")
            )
        )
        refused = [point for point in self.points() if point["refused"]]
        # The central difference is unstable at 1 step per second, because
        # the highest modes are too fast for it.
        self.assertEqual({(point["scheme"], point["rate_hz"]) for point in refused}, {("difference", "1.0")})
        self.assertTrue(all(math.isinf(float(point["error"])) for point in refused))


if __name__ == "__main__":
    unittest.main()
