# SPDX-License-Identifier: BSD-2-Clause
"""ricochet kernel --plan: what a job needs before it runs, beside what the run says and needs."""

import re
import shlex
import unittest

from boxes import Box
from memory import SCENE  # and no server: a fork of it shares memory with it
from programs import ProgramTest, kernel

MANY = SCENE.replace("count = 20", "count = 330").replace("gap =", "reach = 0.02\ngap =")
BODIES = {"plate": ((1.0, 0.8, 0.06), (15, 14, 2)), "block": ((1.0, 0.9, 0.8), (9, 8, 8))}


class Plan(ProgramTest):
    def scene_of(self, body):
        size, cells = BODIES[body]
        self.write("box.msh", Box(size=size, cells=cells).gmsh())
        self.out = self.folder / f"out of {body}"
        return self.write("a plan.toml", MANY)

    def plan(self, scene, *sets, ranks=1):
        done = self.succeed(kernel(scene, self.out, *sets, ranks=ranks, more=["--plan"]))
        rows = [line.split() for line in done.out.splitlines() if re.match(r" +\d+ ", line)]
        return done.out, {int(row[0]): row for row in rows}

    def test_states_what_the_run_on_one_and_two_ranks_then_says_and_needs(self):
        for body, numbers in (("plate", (1, 2)), ("block", (2,))):
            with self.subTest(body):
                scene = self.scene_of(body)
                text, rows = self.plan(scene)
                self.assertEqual(list(rows)[:3], [1, 2, 4], text)
                self.assertFalse(self.out.exists() and list(self.out.iterdir()), "a plan leaves files")
                self.assertRegex(text, r"box: \d+ unknowns, 330 modes; measured: \S+ s for a factorisation")
                for ranks in numbers:
                    done = self.succeed(kernel(scene, self.out / str(ranks), quiet=False, ranks=ranks))
                    stated = re.search(
                        r"(\d+) MiB needed of \d+ a rank; (\d+) slices? planned, \S+ \S+\n", done.err
                    )
                    met = re.search(r"count proved; (\d+) of (\d+) MiB planned, .+ s of .+ s\n", done.err)
                    self.assertEqual(rows[ranks][1:3], [str(ranks), stated[2]], done.err)
                    self.assertEqual(met[2], stated[1], done.err)
                    # The documentation states a quarter; ranks of mpirun start with other buffers.
                    for reached in float(stated[1]), float(met[1]):
                        self.assertLess(abs(float(rows[ranks][3]) / reached - 1), 0.25, text + done.err)

    def test_ends_with_a_job_for_slurm_that_asks_for_the_same_kernels(self):
        scene = self.scene_of("block")
        text, rows = self.plan(
            scene, "modes.count=30", "bodies.box.material={ density = 2, young = 3, poisson = 0.2 }"
        )
        words = shlex.split(text.splitlines()[-1])
        self.assertEqual(words[0], "sbatch")
        options = dict(word.removeprefix("--").split("=", 1) for word in words[1:])
        ranks = int(options["ntasks"])
        self.assertGreater(int(options["mem-per-cpu"].removesuffix("M")), float(rows[ranks][3]))
        self.assertLess(int(options["mem-per-cpu"].removesuffix("M")), 1.4 * float(rows[ranks][3]) + 50)
        self.assertRegex(options["time"], r"^\d\d:\d\d:00$")
        wanted = ["ricochet", "kernel", "-n", str(ranks), str(scene), "--set", "modes.count=30", "--set"]
        wanted += ["bodies.box.material={ density = 2, young = 3, poisson = 0.2 }", "--out", str(self.out)]
        self.assertEqual(shlex.split(options["wrap"]), wanted)

    def test_has_no_work_if_the_kernel_is_there_and_no_plan_of_a_search_for_settings(self):
        scene = self.scene_of("block")
        self.succeed(kernel(scene, self.out, "modes.count=20"))
        text, _ = self.plan(scene, "modes.count=20")
        self.assertEqual(text, "every kernel is there or can be derived: nothing to compute\n")
        for more, answer in (
            ("accuracy=0.01", "accuracy = 0.01: its settings are found"),
            ("modes.solver=subspace", "can be planned"),
        ):
            refused = kernel(scene, self.out, more, more=["--plan"])
            self.assertEqual((refused.status, refused.err.count("\n")), (2, 1), refused.err)
            self.assertIn(answer, refused.err)


if __name__ == "__main__":
    unittest.main()
