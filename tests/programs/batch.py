# SPDX-License-Identifier: BSD-2-Clause
"""ricochet batch with a real SLURM. The test starts its controller and one node on the loopback address."""

import csv
import shutil
import unittest

import h5py

import slurm
from programs import BIN, MESHES, ProgramTest, Run

STUDY = """
scene = "two-rods.toml"
title = "Rods"
keep = ["force"]
[set]
"modes.count" = 20
"time.rate_hz" = 20.0
[grid]
"bodies.moving.velocity[0]" = { from = 0.1, to = 2.0, steps = 8 }
"bodies.resting.material.density" = [1.0, 2.0]
"""


class Batch(ProgramTest):
    def setUp(self):
        super().setUp()
        self.enterContext(slurm.node(self.folder / "slurm"))
        place = self.folder / "a user's 50%"  # a path may contain such characters
        shutil.copytree(MESHES / "two-rods", place, ignore=shutil.ignore_patterns("out"))
        self.study = place / "study.toml"
        self.study.write_text(STUDY)
        self.out = place / "out"

    def submit(self, *more):
        """Submits and waits until all jobs have left the queue."""
        done = self.succeed(
            Run([BIN / "ricochet", "batch", self.study, "--ranks", "2", "--parts", "3", *more])
        )
        slurm.until(
            lambda: not Run(["squeue", "-h"]).out.strip(), "jobs stay in the queue:\n" + Run(["squeue"]).out
        )
        return done

    def rows(self):
        with open(self.out / "rods.sweep.csv") as file:
            return list(csv.DictReader(file))

    def logs(self):
        return "\n".join(path.read_text() for path in self.out.glob("*.log"))

    def test_kernels_impacts_and_results_are_those_of_a_sweep(self):
        """Settings that are refused stop no job."""
        self.study.write_text(f'{STUDY}"bodies.moving.contact" = ["right", "nope"]\n')
        self.submit()
        rows = self.rows()
        self.assertEqual([row["status"] for row in rows], ["0", "2"] * 16, self.logs())
        self.assertIn("16 refused or failed", self.logs())
        self.assertEqual(len(list(self.out.glob("*.kernel.h5"))), 3)
        self.assertEqual(len(list(self.out.glob("rods.sweep.*-of-3.jsonl"))), 3)
        with h5py.File(self.out / "rods.sweep.h5") as file:
            self.assertEqual(len(file["histories"]), 16)
            for row, of in zip(rows[::2], file["histories"].values(), strict=True):
                self.assertEqual(of["contact/total_force"][:].max(), float(row["peak_force_n"]))
        dry = self.submit("--retry", "--dry-run", "--ranks", "4000")
        self.assertEqual(dry.err, "")  # they do not share the cores of this machine
        printed = dry.out.splitlines()
        jobs = ("kernels", "impacts", "collect")
        self.assertEqual(printed, [str(self.out.resolve() / f"rods.{job}.sh") for job in jobs])
        words = [path.read_text() for path in sorted(self.out.glob("rods.*.sh"))]
        self.assertEqual(
            [" --retry" in text for text in words], [False, True, True]
        )  # collect, impacts, kernels
        alone = self.folder / "alone"
        self.assertEqual(Run([BIN / "ricochet", "sweep", self.study, "--out", alone]).status, 3)
        with open(alone / "rods.sweep.csv") as file:
            for one, other in zip(rows[::2], list(csv.DictReader(file))[::2], strict=True):
                # Kernels of two ranks and of other runs differ by round-off, which the first impacts amplify.
                self.assertAlmostEqual(float(one["impulse_ns"]), float(other["impulse_ns"]), delta=1e-6)

    def test_jobs_that_were_killed_are_made_up_for_by_submitting_again(self):
        done = self.succeed(Run([BIN / "ricochet", "batch", self.study, "--parts", "2"]))
        impacts = done.out.split("impacts ")[1].split()[0]
        slurm.until(lambda: list(self.out.glob("*.kernel.h5")), "no kernel")
        Run(["scancel", f"{impacts}_2"])
        slurm.until(lambda: not Run(["squeue", "-h"]).out.strip(), "jobs stay in the queue")
        self.assertEqual({row["status"] for row in self.rows()}, {"0", "-1"}, self.logs())
        self.submit()
        self.assertEqual({row["status"] for row in self.rows()}, {"0"}, self.logs())

    def test_without_kernels_the_impacts_are_not_started(self):
        self.study.write_text(STUDY.replace('"modes.count" = 20', '"modes.count" = 2000'))
        self.succeed(Run([BIN / "ricochet", "batch", self.study, "--kernel-options", "'--comment=it fails'"]))
        slurm.until(lambda: not Run(["squeue", "-h"]).out.strip(), "jobs stay in the queue")
        self.assertEqual(list(self.out.glob("rods.impacts.*.log")), [])
        self.assertIn("free displacements", self.logs())


class Unreached(ProgramTest):
    def test_a_slurm_whose_controller_does_not_answer_is_told_in_one_line(self):
        self.write("two-rods.toml", (MESHES / "two-rods/two-rods.toml").read_text())
        study = self.write("study.toml", STUDY)
        for answer in (
            [
                "error: resolve_ctls_from_dns_srv: res_nsearch error: Unknown host",
                "error: fetch_config: DNS SRV lookup failed",
                "error: _establish_config_source: failed to fetch config",
                "fatal: Could not establish a configuration source",
            ],
            ["error: Batch job submission failed: Unable to contact slurm controller (connect failure)"],
        ):
            # Replaces sbatch and prints the errors of Debian 12's sbatch without a slurm.conf,
            # and with one but without slurmctld.
            lines = "".join(f"echo 'sbatch: {line}' >&2\n" for line in answer)
            self.write("sbatch", f"#!/bin/sh\n{lines}exit 1\n").chmod(0o755)
            done = Run(["env", f"PATH={self.folder}:/usr/bin:/bin", BIN / "ricochet", "batch", study])
            self.assertEqual((done.status, done.err.count("\n")), (2, 1), done.err)
            self.assertIn(
                f"no SLURM controller ({answer[0].removeprefix('error: ')}): inspect the jobs with --dry-run",
                done.err,
            )


if __name__ == "__main__":
    unittest.main()
