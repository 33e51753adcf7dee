# SPDX-License-Identifier: BSD-2-Clause
"""Programs under adverse conditions: signals, full disks, read-only folders, ranks that die and malicious files. Inputs are
checked before anything that takes long."""

import json
import os
import resource
import signal
import subprocess
import unittest

import h5py
import numpy as np

from programs import (
    BIN,
    SOURCE,
    Command,
    Run,
    contact,
    displacement_kernel,
    impact,
    kernel,
    limited,
    settings,
)
from robust_test import Robust

from ricochet.errors import InputError
from ricochet.pictures.loaded_result import LoadedResult

# Two slices per body, in some tenths of a second.
SLICED = ["bodies.a.mesh=long.geo", "bodies.b.mesh=long.geo", "modes.count=300"]
STUDY = """
scene = "scene.toml"
title = "Many"
[grid]
"bodies.a.velocity[0]" = { from = 0.1, to = 1.0, steps = 40 }
"""


class Signals(Robust):
    ENDLESS = ["time.rate_hz=1e6", "time.duration=900", "output.every=1000000"]

    def run_that_writes(self):
        process = self.start(
            BIN / "ricochet-contact", self.scene, "--out", self.out, "--quiet", *settings(self.ENDLESS)
        )
        partial = self.out / f"errors.result.h5.{process.pid}.partial"

        def has_content():  # the first files of that name only test whether there is space
            try:
                return partial.stat().st_size > 0
            except FileNotFoundError:
                return False

        self.until(has_content)
        return process

    def test_a_run_that_is_told_to_end_leaves_nothing_and_says_by_what_it_ended(self):
        self.kernels()
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            process = self.run_that_writes()
            process.send_signal(number)
            self.assertEqual(process.wait(60), -number)
            self.assertEqual(self.left(), [])
        self.assertEqual(list(self.out.glob("errors.*")), [])

    def test_a_rank_that_dies_ends_the_job_and_the_next_goes_on_from_its_slices(self):
        command = [
            "mpirun",
            "--allow-run-as-root",
            "--oversubscribe",
            "-n",
            "2",
            BIN / "ricochet-kernel",
            self.scene,
            "--out",
            self.out,
            *settings(SLICED),
        ]
        process = self.start(*command)
        self.until(lambda: list(self.out.glob("*.slices/slice-*.h5")) or list(self.out.glob("a-*.kernel.h5")))
        ranks = subprocess.run(
            ["pgrep", "-P", str(process.pid)], capture_output=True, text=True
        ).stdout.split()
        self.assertEqual(len(ranks), 2)
        os.kill(int(ranks[1]), signal.SIGKILL)
        said = process.communicate(timeout=60)[1]
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("signal 9", said)
        before = {path: path.stat().st_mtime_ns for path in self.out.glob("*.slices/slice-*.h5")}
        kernels = len(list(self.out.glob("*.kernel.h5")))
        run = self.succeed(kernel(self.scene, self.out, *SLICED, ranks=2, quiet=False))
        if kernels == 0:
            self.assertIn(f"{len(before)} of ", run.err)
        self.assertEqual(
            (len(list(self.out.glob("*.kernel.h5"))), list(self.out.glob("*.slices")), self.left()),
            (2, [], []),
        )


class Places(Robust):
    @unittest.skipUnless(os.geteuid() == 0, "mounts")
    def test_what_does_not_fit_is_refused_before_the_first_step(self):
        self.out.mkdir()
        mounted = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", "size=1m", "none", self.out], capture_output=True
        )
        if mounted.returncode != 0:
            self.skipTest("this machine does not let mount")
        self.addCleanup(subprocess.run, ["umount", self.out])
        self.kernels()
        self.refused(
            contact(self.scene, self.out, "time.rate_hz=1e5"), "errors.result.h5", "MB are needed", "are free"
        )
        long = kernel(
            self.scene,
            self.out,
            "bodies.a.mesh=long.geo",
            "bodies.b.mesh=long.geo",
            "modes.count=400",
            ranks=2,
        )
        self.refused(long, ".slices/plan.h5", "MB are needed")
        self.assertEqual(self.left(), [])
        subprocess.run(["mount", "-o", "remount,ro", self.out], check=True)
        self.refused(contact(self.scene, self.out), "errors.result.h5", "Read-only")
        self.refused(kernel(self.scene, self.out, "modes.count=7", ranks=1), "out/a-", "Read-only")
        self.succeed(kernel(self.scene, self.out, ranks=1))  # all kernels exist, so nothing is written

    def test_output_that_goes_nowhere_is_no_success(self):
        for option in ("--dry-run", "--batch"):
            with open("/dev/full", "w") as full:
                run = Run([BIN / "ricochet-contact", self.scene, option], input="{}\n{}\n", stdout=full)
            self.refused(run, "standard output", status=1)

    def test_requests_that_are_none_are_answered_and_the_next_ones_too(self):
        requests = [
            "[",
            "5",
            '{"set": ' + 10**6 * "[" + 10**6 * "]" + "}",
            '{"set": [5]}',
            '{"set": ["modes.cuont=3"]}',
            "{}",
        ]
        command = [BIN / "ricochet-contact", self.scene, "--batch", "--out", self.out]
        done = self.succeed(Run(command, input="\n".join(requests)))
        answers = [json.loads(line) for line in done.out.splitlines()]
        self.assertEqual([answer["status"] for answer in answers], [2] * 6)
        for answer, word in zip(
            answers, ("JSON object", "JSON object", "nested", "list of texts", "cuont", "no kernel")
        ):
            self.assertIn(word, answer["error"])


class Early(Robust):
    def test_the_last_body_is_checked_before_the_first_is_computed(self):
        for fault, *fragments in (
            ["bodies.b.contact=nowhere", "rod.geo", "nowhere"],
            ["bodies.b.order=0", "bodies.b.order"],
            ["bodies.b.mesh=none.geo", "none.geo"],
            ['output.receiver=[{name="far",body="b",at=[0,9,0]}]', "far", "off bodies.b"],
        ):
            self.refused(self.check("--set", fault), *fragments)
            self.assertEqual(list(self.out.glob("*")) if self.out.exists() else [], [])
        self.refused(kernel(self.scene, self.out, fault), *fragments)
        self.refused(self.check("--set", "modes.count=100"), "modes.count = 100")

    def check(self, *more):
        return Run([BIN / "ricochet-kernel", self.scene, "--out", self.out, "--quiet", "--check", *more])

    def test_a_check_computes_nothing(self):
        self.assertEqual(self.succeed(self.check()).out, "")
        self.assertFalse(self.out.exists())

    def test_histories_are_read_before_the_kernels_are_computed(self):
        load = 'loads.point=[{name="p",body="b",at=[1,0,0],vector=[1,0,0],history="h.csv"}]'
        self.refused(kernel(self.scene, self.out, load, ranks=1), "h.csv", "no such file")
        self.write("h.csv", "0, 1\n0, 2\n")
        self.refused(kernel(self.scene, self.out, load, ranks=1), "h.csv:2", "ascend")
        self.assertFalse(self.out.exists())


class Files(Robust):
    def test_slices_that_are_damaged_or_made_to_harm_are_computed_again(self):
        self.succeed(kernel(self.scene, self.folder / "whole", *SLICED, ranks=1))
        process = self.start(
            BIN / "ricochet-kernel", self.scene, "--out", self.out, "--quiet", *settings(SLICED)
        )
        self.until(lambda: list(self.out.glob("*.slices/slice-*.h5")) or list(self.out.glob("a-*.kernel.h5")))
        process.kill()
        process.wait()
        harm = [
            lambda f: f["lambda"].__setitem__(3, np.nan),
            lambda f: f["slice"].__setitem__(1, 1e300),
            lambda f: f["shape"].__setitem__((0, 0), np.inf),
            lambda f: f["lambda"].__setitem__(0, f["lambda"][-1] * 2),
        ]
        for number, path in enumerate(sorted(self.out.glob("*.slices/slice-*.h5"))):
            with h5py.File(path, "r+") as file:
                harm[number % len(harm)](file)
        for path in self.out.glob("*.slices/plan.h5"):
            with h5py.File(path, "r+") as file:
                file["tasks"][0, 0] = np.nan
        self.succeed(kernel(self.scene, self.out, *SLICED, ranks=1))
        times = np.linspace(0, 3, 20)
        for path in self.out.glob("*.kernel.h5"):
            one, other = displacement_kernel(self.folder / "whole" / path.name, times), displacement_kernel(
                path, times
            )
            self.assertLess(np.abs(one - other).max(), 1e-8 * np.abs(one).max())

    def test_memory_is_not_taken_on_the_word_of_a_file_or_scene(self):
        self.kernels()
        path = self.one(self.out, "a-*.kernel.h5")
        whole = path.read_bytes()
        command = [BIN / "ricochet-contact", self.scene, "--out", self.out, "--quiet"]
        with h5py.File(path, "r+") as file:
            del file["surface/shape"]
            file.create_dataset("surface/shape", shape=(1, 10**15), chunks=(1, 1000), dtype="f8")
        self.refused(self.limited(resource.RLIMIT_AS, 2 * 10**9, *command), path.name, "/surface/shape")
        path.write_bytes(whole)
        sound = [
            'output.receiver=[{name="r",body="b",at=[1,0,0]}]',
            "time.rate_hz=48000",
            "time.duration=6000",
        ]
        self.succeed(kernel(self.scene, self.out, *sound, ranks=1))
        run = self.limited(resource.RLIMIT_AS, 2 * 10**9, *command, *settings(sound))
        # The run fails for memory or for disk space, whichever is exhausted first.
        self.assertRegex(run.err, "not enough memory|MB are needed")
        self.assertIn(run.status, (1, 2))
        self.assertEqual(run.err.count("\n"), 1)

    def test_results_made_to_harm_are_refused_by_what_draws_them(self):
        self.kernels()
        path = impact(self.scene, self.out).path
        whole = path.read_bytes()
        LoadedResult(path)
        for name in ("time", "energy/kinetic", "contact/time", "contact/force", "bodies/a/velocity"):
            for value in (
                np.float64(1),
                np.array([b"x"] * 101),
                np.full(101, np.nan),
                np.zeros((101, 7, 2)),
                np.zeros(101, dtype=[("a", "f8"), ("b", "f8")]),
                h5py.ExternalLink("/dev/zero", "/x"),
                h5py.SoftLink("/" + name),
                "group",
            ):
                path.write_bytes(whole)
                with h5py.File(path, "r+") as file:
                    del file[name]
                    file.create_group(name) if isinstance(value, str) else file.__setitem__(name, value)
                with self.subTest(name=name, value=str(value)[:30]), self.assertRaises(InputError) as caught:
                    LoadedResult(path)
                self.assertEqual(str(caught.exception).count("\n"), 0)


class Sweeps(Robust):
    def words(self):
        return ["sweep", self.study, "--ranks", "1", "--jobs", "1", "--out", self.out]

    def sweep(self, *more):
        return Command(*self.words(), *more)

    def test_one_that_is_told_to_end_has_its_tables_written_and_two_at_once_are_refused(self):
        self.study = self.write("study.toml", STUDY + '[set]\n"time.rate_hz" = 4e5\n')
        first = self.start(BIN / "ricochet", *self.words())
        journal = self.out / "many.sweep.jsonl"
        self.until(lambda: journal.exists() and journal.stat().st_size)
        self.refused(self.sweep(), "many.sweep.jsonl", "another sweep")
        first.terminate()
        self.assertIn("the same command resumes", first.communicate(timeout=60)[1])
        self.assertEqual(first.returncode, 128 + signal.SIGTERM)
        with h5py.File(self.out / "many.sweep.h5") as file:
            status = file["status"][:]
        self.assertEqual(len(status), 40)
        self.assertEqual((status == 0).sum(), journal.read_bytes().count(b"\n"))
        self.assertLess((status == 0).sum(), 40)

    def test_a_full_disk_is_said_in_one_line_and_the_next_run_goes_on(self):
        # Within the journal or the tables; within the histories, and within the file that collects them.
        for keep, limits in ("", (1000, 8_000, 30_000)), ('keep = ["force"]\n', (60_000, 150_000)):
            self.study = self.write("study.toml", keep + STUDY)
            self.succeed(self.sweep("--kernels"))
            for limit in limits:
                with limited(resource.RLIMIT_FSIZE, limit):
                    run = self.sweep()
                self.refused(run, "sweep: ", "File too large")
                self.assertEqual(self.left(), [])
            self.succeed(self.sweep())
            with h5py.File(self.out / "many.sweep.h5") as file:
                self.assertTrue((file["status"][:] == 0).all())
                self.assertEqual(len(file.get("histories", ())), 40 * bool(keep))

    def test_lines_of_the_journal_that_a_disk_spoilt_are_run_again(self):
        self.study = self.write("study.toml", STUDY)
        self.succeed(self.sweep())
        journal = self.out / "many.sweep.jsonl"
        lines = journal.read_bytes().splitlines(keepends=True)
        lines[3], lines[5], lines[7], lines[9] = (
            b"\0" * 60 + b"\n",
            b'{"key": 3, "status": 0}\n',
            b"[]\n",
            b"\xff\xfe{\n",
        )
        journal.write_bytes(b"".join(lines) + b'{"key": "half')
        self.succeed(self.sweep())
        with h5py.File(self.out / "many.sweep.h5") as file:
            self.assertTrue((file["status"][:] == 0).all())
        keys = [json.loads(line)["key"] for line in journal.read_bytes().splitlines()[10:]]
        self.assertEqual(len(keys), 34)


class Kills(unittest.TestCase):
    def test_programs_killed_at_random_moments_leave_nothing_partial_and_go_on(self):
        words = ["--kills", "--count", "5", "--seed", "3", "--only", "ricochet-contact"]
        run = Run([SOURCE / "scripts/verify", *words])
        self.assertEqual(run.status, 0, run.out + run.err)


if __name__ == "__main__":
    unittest.main()
