# SPDX-License-Identifier: BSD-2-Clause
"""Faults of a sweep: broken studies and journals, damaged kernels, unusable meshes, closed outputs, signals."""

import csv
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import time
import tomllib
import unittest

import h5py

from programs import BIN, DEADLOCK_S, MESHES, Command, ProgramTest, Run

from ricochet.programs import toml
from ricochet.errors import InputError
from ricochet.studies.journal import Journal, row_of
from ricochet.studies.study import Study
from ricochet.studies.workers import in_parallel

STUDY = 'scene = "two-rods.toml"\ntitle = "Rods"\n[set]\n"modes.count" = 5\n"time.rate_hz" = 20.0\n'


class Faults(ProgramTest):
    def setUp(self):
        super().setUp()
        for path in (MESHES / "two-rods").glob("*.*"):
            shutil.copy(path, self.folder)
        self.out = self.folder / "out"

    def study(self, text):
        return self.write("study.toml", STUDY + text)

    def script(self, *words, env=(), **streams):
        """Runs the command, in a process of its own with variables or streams of its own."""
        if not env and not streams:
            return Command(*words)
        return Run(["env", *env, BIN / "ricochet", *words], **streams)

    def sweep(self, *more, **how):
        return self.script("sweep", self.folder / "study.toml", "--ranks", "1", *more, **how)

    def ends(self, done, status, *parts):
        if parts:
            return self.refused(done, *parts, status=status)
        lines = [line for line in (done.err or "").splitlines() if not re.search(r" s +\d+ MiB(  |$)", line)]
        self.assertEqual((done.status, lines), (status, []))  # the log of a stage has times and memory

    def rows(self):
        with open(self.out / "rods.sweep.csv") as file:
            return list(csv.DictReader(file))


class Studies(Faults):
    def test_whatever_a_study_says_it_is_understood_or_refused_in_one_line(self):
        """Texts that are too large for mistakes.toml, which has the others."""
        gap = '[grid]\n"contact.gap" = '
        for text, part in [
            (gap + "{from = 0, to = %s, steps = 3}" % ("1" * 400), "64 bits"),
            (gap + "[%s]" % ("1" * 5000), "not TOML"),
            (gap + "[" * 3000 + "]" * 3000, "nested"),
            (gap + "[" * 60 + "]" * 60, "nested"),
        ]:
            with self.subTest(text=text[:80]), self.assertRaisesRegex(InputError, part):
                Study(self.study(text))
        for text, part in [("title = 5\n", "title"), ('scene = "none.toml"\n', "No such file")]:
            with self.assertRaisesRegex(InputError, part):
                Study(
                    self.write(
                        "study.toml",
                        text + 'scene = "two-rods.toml"\n' * ("scene" not in text) + gap + "[0.0]",
                    )
                )

    def test_draws_between_negative_ends_are_between_them(self):
        settings = Study(
            self.study('[random]\ncount = 50\n"bodies.moving.velocity[0]" = { log_uniform = [-10.0, -1.0] }')
        ).settings
        self.assertTrue(all(-10 <= value <= -1 for setting in settings for value in setting.values()))

    def test_values_reach_programs_as_the_toml_that_they_were(self):
        for value in (
            'é 😀 \x7f "\\ \n\t',
            [{"a b": [1, 2.5], "é": {"x": True}}, {}],
            [[], [1e-300, float("inf")]],
            {'"': "'"},
        ):
            self.assertEqual(tomllib.loads("value = " + toml(value))["value"], value)


class Journals(Faults):
    def test_lines_that_tables_cannot_hold_count_as_none(self):
        good = {
            "key": "k",
            "status": 0,
            "summary": {
                "impulse_ns": 1.0,
                "restitution": None,
                "episodes": [{}],
                "exit_velocity": {"moving": [1.0, 0.0, 0.0]},
                "pairs": [{"force_n": 2.0}],
            },
        }
        self.assertEqual(row_of(json.dumps(good)), good)
        self.assertIsNotNone(row_of(json.dumps({"key": "k", "status": 2, "error": "refused"})))
        wrong = [
            good | {"summary": good["summary"] | {name: value}}
            for name, value in [
                ("episodes", 5),
                ("pairs", 3),
                ("pairs", [3]),
                ("x", 10**400),
                ("a/b", 1),
                (".", 1),
                ("", 1),
                ("a\0", 1),
                ("a\ud800", 1),
                ("exit_velocity", {"a": [[1], [2]]}),
                ("exit_velocity", {"a": ["fast"]}),
            ]
        ]
        wrong += [{"key": "k", "status": 2, "error": error} for error in (5, "a\0", "a\ud800", {})]
        wrong += [good | {"status": status} for status in (300, -1, True, [0], "0")] + [
            good | {"summary": 3},
            good | {"key": [3]},
            3,
            None,
        ]
        for line in [*map(json.dumps, wrong), "[" * 100000, "", "{"]:
            self.assertIsNone(row_of(line), line[:100])

    def test_refusals_are_final_unless_the_next_run_may_end_differently(self):
        refused, done = b'{"status": 2, "error": "no"}', b'{"status": 0, "summary": {}}'
        journal = Journal(self.out / "rods")
        for answer in (refused, refused):
            journal.add("k", answer)
        # The disk may have room again, a kernel may be replaced, and a process may have been killed.
        for name, text in [
            ("disk", "full: choose another --out"),
            ("new", "a.kernel.h5: has format version 99"),
        ]:
            journal.add(name, json.dumps({"status": 2, "error": text}).encode())
        journal.add("died", b'{"status": 1, "error": "ended", "died": true}')
        self.assertEqual(set(journal.rows), {"k", "disk", "new", "died"})  # in the table of this run
        journal.close()
        again = Journal(self.out / "rods")
        self.assertEqual(
            (again.finished("k"), again.refused("k"), again.rows["k"]["error"]), (False, True, "no")
        )
        self.assertEqual(list(again.rows), ["k"])
        again.close()
        retried = Journal(self.out / "rods", retry=True)
        self.assertFalse(retried.refused("k"))
        retried.add("k", done)
        retried.add("k", refused)
        retried.close()
        self.assertTrue(Journal(self.out / "rods", reads_only=True).finished("k"))

    def test_histories_count_only_where_the_journal_has_them(self):
        done, image = b'{"histories": 3, "status": 0, "summary": {}}', b"abc"
        keys = ["%024d" % number for number in range(3)]
        journal = Journal(self.out / "rods", keep=["force"])
        for key in keys:
            journal.add(key, done, image)
        journal.close()

        def finished(*keep):
            journal = Journal(self.out / "rods", reads_only=True, keep=keep)
            return [journal.finished(key) for key in keys]

        self.assertEqual(finished(), [True] * 3)
        self.assertEqual(finished("force"), [True] * 3)
        self.assertEqual(finished("force", "energy"), [False] * 3)
        archive = self.out / "rods.sweep.histories"
        whole = archive.read_bytes()
        for content, there in [
            (whole[:-1], [True, True, False]),
            (whole[:27] + b"\0" * 27 + whole[54:], [True, False, True]),
            (b"", [False] * 3),
        ]:
            archive.write_bytes(content)
            self.assertEqual(finished("force"), there)
        archive.unlink()
        self.assertEqual(finished("force"), [False] * 3)
        line = json.loads((self.out / "rods.sweep.jsonl").read_bytes().splitlines()[0])
        archive.write_bytes(whole)
        for wrong in (
            {"at": -1},
            {"bytes": "3"},
            {"words": ["nonsense"]},
            {"words": [[]]},
            {"words": 5},
            {"more": 1},
        ):
            bad = line | {"kept": line["kept"] | wrong}
            (self.out / "rods.sweep.jsonl").write_text(json.dumps(bad) + "\n")
            self.assertEqual(finished("force"), [False] * 3, wrong)

    def test_histories_of_a_process_that_dies_amid_them_are_asked_for_again(self):
        """A substitute for ricochet-contact sends a part of the histories and dies, and then sends them whole."""
        program = self.write(
            "program",
            f"""#!/usr/bin/python3
import os, pathlib, sys, time
first = pathlib.Path("{self.folder}/died")
for line in sys.stdin.buffer:
    again = first.exists()
    first.touch()
    sys.stdout.buffer.write(b'{{"histories": 200000, "status": 0}}\\n' + b"\\n" * (200000 if again else 70000))
    sys.stdout.buffer.flush()
    if not again:
        os.kill(os.getpid(), 9)
""",
        )
        program.chmod(0o755)
        answers = sorted(in_parallel(1, [str(program)], [{}, {}, {}]))
        self.assertEqual(
            [(index, len(image)) for index, _, image in answers], [(k, 200000) for k in range(3)]
        )
        self.assertEqual({line for _, line, _ in answers}, {b'{"histories": 200000, "status": 0}'})


class Kernels(Faults):
    def test_damaged_kernels_are_computed_again_and_newer_ones_refused(self):
        self.study('[grid]\n"contact.gap" = [0.0, 0.5]')
        self.ends(self.sweep(), 0)
        (path,) = self.out.glob("moving-*.kernel.h5")
        whole = path.read_bytes()
        path.write_bytes(whole[:20000])
        (self.out / "rods.sweep.jsonl").unlink()
        self.ends(self.sweep(), 0)
        self.assertEqual([row["status"] for row in self.rows()], ["0", "0"])
        self.assertEqual(path.stat().st_size, len(whole))
        with h5py.File(path, "r+") as file:
            file.attrs["version"] = 99
        (self.out / "rods.sweep.jsonl").unlink()
        self.ends(self.sweep(), 2, "sweep: ", path.name, "version 99", "newer")

    def test_what_meshes_refuse_is_a_row_at_every_stage(self):
        self.study(
            '[grid]\n"bodies.moving.contact" = ["nope", "right"]\n"bodies.moving.material.young" = [1.0, 2.0]'
        )
        for stage, status in (["--kernels"], 0), (["--part", "1/1"], 0), (["--collect"], 3):
            self.ends(self.sweep(*stage), status)
        self.assertEqual([row["status"] for row in self.rows()], ["2", "2", "0", "0"])
        self.assertIn("nope", self.rows()[1]["error"])

    def test_a_kernel_that_breaks_down_is_a_row_and_others_go_on(self):
        """The checks of meshes by a substitute for ricochet-kernel always succeed."""
        self.write("ricochet-contact", f'#!/bin/sh\nexec {BIN}/ricochet-contact "$@"\n').chmod(0o755)
        self.write(
            "ricochet-kernel",
            f"""#!/bin/sh
case "$*" in
    *--check*) exit 0;;
    *order=2*) echo "a warning" >&2; echo "ricochet-kernel: rank 0: it broke down" >&2; exit 1;;
esac
exec {BIN}/ricochet-kernel "$@"
""",
        ).chmod(0o755)
        self.study('[grid]\n"bodies.moving.order" = [2, 1]\n"contact.gap" = [0.0, 0.5]')
        self.ends(self.sweep(env=[f"RICOCHET_BIN={self.folder}", "RICOCHET_LAUNCHER=env"]), 1)
        self.assertEqual([row["status"] for row in self.rows()], ["1", "1", "0", "0"])
        self.assertEqual(self.rows()[0]["error"], "rank 0: it broke down")

    def test_a_kernel_whose_program_was_ended_is_computed_by_the_next_run(self):
        """mpirun ends with status 1 and without a word if a signal ends it. A substitute does so once."""
        self.write("ricochet-contact", f'#!/bin/sh\nexec {BIN}/ricochet-contact "$@"\n').chmod(0o755)
        ended = self.folder / "ended"
        self.write(
            "ricochet-kernel",
            f'#!/bin/sh\n[ -e {ended} ] && exec {BIN}/ricochet-kernel "$@"\ntouch {ended}\nexit 1\n',
        ).chmod(0o755)
        self.study('[grid]\n"contact.gap" = [0.0, 0.5]')
        how = {"env": [f"RICOCHET_BIN={self.folder}", "RICOCHET_LAUNCHER=env"]}
        self.ends(self.sweep("--kernels", **how), 1, "it gave no reason")
        self.assertEqual((self.out / "rods.sweep.jsonl").read_bytes(), b"")
        self.ends(self.sweep(**how), 0)
        self.assertEqual([row["status"] for row in self.rows()], ["0", "0"])

    def test_what_was_refused_is_tried_once_for_all_rows_and_runs(self):
        """Counts the starts of ricochet-kernel and the requests for impacts. Outputs and placement
        change no kernel; bodies that overlap are refused by the impact."""
        starts, requests = self.folder / "starts", self.folder / "requests"
        starts.touch()
        self.write(
            "ricochet-kernel", f'#!/bin/sh\necho >> {starts}\nexec {BIN}/ricochet-kernel "$@"\n'
        ).chmod(0o755)
        self.write(
            "ricochet-contact",
            f'#!/bin/sh\ncase "$*" in *--batch*) tee -a {requests} | {BIN}/ricochet-contact "$@";;'
            f' *) exec {BIN}/ricochet-contact "$@";; esac\n',
        ).chmod(0o755)
        mesh = '[grid]\n"bodies.moving.contact" = ["nope", "right"]\n"output.every" = [1, 2, 3]\n"bodies.moving.translate[0]" = [-10.0, -9.0]'

        def counts(*more):
            starts.write_text("")
            requests.write_text("")
            done = self.sweep(*more, env=[f"RICOCHET_BIN={self.folder}"])
            self.assertEqual(done.status, 3, done.err)
            asked = [json.loads(line) for line in requests.read_text().splitlines()]
            return starts.read_text().count("\n"), sum("kernels" not in request for request in asked)

        self.study(mesh)
        # Meshes are checked once for each contact group, and then the other kernels are computed.
        self.assertEqual(counts(), (3, 6))
        refused = [row["error"] for row in self.rows() if row["status"] == "2"]
        self.assertEqual(sum("nope" in error for error in refused), 6)
        overlapping = len(refused) - 6
        self.assertEqual(overlapping, 3, refused[-1])
        self.assertEqual(counts(), (0, 0))
        self.assertEqual(counts("--retry"), (1, overlapping))
        (self.folder / "rod.geo").write_text((self.folder / "rod.geo").read_text() + "// changed\n")
        self.assertEqual(counts(), (3, 6))  # a new mesh is tried again


class Ends(Faults):
    def test_one_that_is_told_to_end_does_not_wait_for_its_impacts(self):
        self.study(
            '[list]\n"time.rate_hz" = [20.0, 3e7]\n"modes.count" = [5, 90]'
        )  # the second impact takes minutes
        process = subprocess.Popen(
            [BIN / "ricochet", "sweep", self.folder / "study.toml", "--ranks", "1", "--jobs", "1"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.addCleanup(process.kill)
        journal, before = self.out / "rods.sweep.jsonl", time.monotonic()
        while (not journal.exists() or not journal.stat().st_size) and time.monotonic() < before + DEADLOCK_S:
            time.sleep(0.02)
        process.terminate()
        self.assertIn("resumes the work", process.communicate(timeout=60)[1])
        self.assertEqual(process.returncode, 128 + signal.SIGTERM)
        self.assertEqual([row["status"] for row in self.rows()], ["0", "-1"])

    def test_a_picture_that_cannot_be_drawn_ends_the_sweep_after_its_first_impact(self):
        # The first impact shows which columns there are; the others are not run for a picture that cannot be drawn.
        self.study('[grid]\n"bodies.moving.velocity[0]" = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7]')
        self.ends(self.sweep("--plot", "nonsense", "--jobs", "1"), 2, '"nonsense" is not a column')
        states = [row["status"] for row in self.rows()]
        self.assertEqual((states[0], states[-1]), ("0", "-1"))

    def test_output_that_goes_nowhere_is_said_and_columns_that_are_not_there_are_refused(self):
        self.study(
            '[grid]\n"contact.gap" = [0.0]\n"bodies.moving.velocity[0]" = [inf, 1.0]\n[[set.output.receiver]]\n'
            'name = "end"\nbody = "resting"\nat = [10, 0, 0]'
        )
        self.ends(self.sweep("--plot", "nonsense"), 2, '"nonsense" is not a column', "impulse_ns")
        self.ends(
            self.sweep("--plot", "impulse_ns", "--against", "bodies.moving.velocity[0]", "contact.gap"), 3
        )
        self.ends(self.sweep("--plot", "force"), 2, 'keep has no "force"')
        with open("/dev/full", "w") as full:
            self.ends(self.sweep(stdout=full), 1, "standard output")
            self.ends(
                self.script("batch", self.folder / "study.toml", "--dry-run", stdout=full),
                1,
                "standard output",
            )
        closed = self.script("sweep", self.folder / "study.toml", stderr=None, preexec_fn=lambda: os.close(2))
        self.assertEqual(closed.status, 3)

    def test_words_that_cannot_be_are_refused_in_one_line(self):
        broken = self.write("broken.toml", STUDY + '[grid]\n"a\\nb" = 5')
        study = self.study('[grid]\n"contact.gap" = [0.0]')
        empty = self.folder / "empty"
        empty.mkdir()
        for done, parts in [
            (self.script("batch", study, "--kernel-options", '--comment="a'), ["--kernel-options", "quot"]),
            (self.script("batch", broken), ["broken.toml", '"a b" = 5']),
            (self.script("batch", study, "--out", study), ["study.toml", "File exists"]),
            (
                self.script("batch", "--version", env=[f"RICOCHET_BIN={empty}"]),
                ["ricochet-contact", "no such program"],
            ),
            (self.sweep(env=['RICOCHET_LAUNCHER="']), ["RICOCHET_LAUNCHER", "quot"]),
        ]:
            self.ends(done, 2, *parts)
        for words, part in [(["--ranks", "100000"], "4096"), (["--against", "contact.gap"], "--plot")]:
            done = self.sweep(*words)
            self.assertEqual(done.status, 2)
            self.assertIn(part, done.err)

    def test_names_that_are_not_utf8_are_swept(self):
        folder = pathlib.Path(os.fsdecode(os.fsencode(self.folder) + b"/odd\xff"))
        folder.mkdir()
        for path in [*self.folder.glob("two-rods*"), *self.folder.glob("*.geo")]:
            shutil.copy(path, folder)
        study = folder / os.fsdecode(b"st\xfe.toml")
        study.write_text(STUDY.replace('title = "Rods"\n', "") + '[grid]\n"contact.gap" = [0.0]')
        self.ends(self.script("sweep", study, "--ranks", "1"), 0)
        with h5py.File(
            self.one(folder / "out", "st*.sweep.h5")
        ) as file:  # digits stand for the lost character
            self.assertEqual(list(file["status"]), [0])


if __name__ == "__main__":
    unittest.main()
