# SPDX-License-Identifier: BSD-2-Clause
"""plot, report, surfaces and sweep with unusual files: damaged results, places that cannot be read or written, and titles with
any characters."""

import contextlib
import fcntl
import json
import os
import pathlib
import resource
import shutil
import subprocess
import unittest

import h5py
import numpy as np

from programs import BIN, MESHES, Command, ProgramTest, Run, impact, limited, settings

import ricochet
from ricochet import errors, files

TITLE = "a $x^$ 日本語 😀"  # not a formula, and with characters that no font has
# Waves cross the rods of 10 m in 1 ms: few rows and a short sound.
SETS = [
    "modes.count=10",
    "output.view=true",
    "output.snapshot_every=3",
    "bodies.moving.material.young=1e8",
    "bodies.resting.material.young=1e8",
    "bodies.moving.velocity=[100,0,0]",
    "time.rate_hz=20e3",
    "time.duration=0.004",
    "contact.gap=0.01",
    'output.receiver=[{name="mic",body="resting",at=[10,0,0]}]',
    "title=rods",
]
SCENE = MESHES / "two-rods/two-rods.toml"
OBSTACLE = '[obstacles.floor]\npoint = [0,0,0]\n[contact]\nscheme = "compliant"\n'


@contextlib.contextmanager
def as_nobody():
    """This process may not read protected files."""
    before = os.geteuid()
    os.seteuid(65534 if before == 0 else before)
    try:
        yield
    finally:
        os.seteuid(before)


class Files(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.all = cls.shared_folder()
        impact(SCENE, cls.all, *SETS)

    def setUp(self):
        super().setUp()
        self.folder.chmod(0o755)
        self.out = self.folder / "out"
        shutil.copytree(self.all, self.out)
        self.out.chmod(0o755)
        self.result, self.summary_path = self.out / "rods.result.h5", self.out / "rods.summary.json"

    def drawn(self, name):
        run = self.succeed(Command(name, self.result))
        self.assertEqual(run.err, "")

    def refuses(self, words, name="report"):
        run = Command(name, self.result)
        self.refused(run, words)
        self.assertLess(len(run.err), 500)

    def test_damaged_results_are_refused_in_one_line_or_drawn(self):
        good, summary = self.result.read_bytes(), self.summary_path.read_text()
        foreign = "does not write. Compute it again."

        def attribute(where, name, value):
            return lambda file: file[where].attrs.__setitem__(name, value)

        def cut(rows, *names):
            def change(file):
                for name in names:
                    values = file[name][:rows]
                    del file[name]
                    file[name] = values

            return change

        def all_of(name, value):
            return lambda file: file[name].__setitem__(slice(None), value)

        def scene(text):
            return attribute("/", "scene", text)

        def circle(file):
            del file["bodies"]
            file["bodies"] = h5py.SoftLink("/bodies")

        moving, nan, drawn = "bodies/moving", float("nan"), None
        receiver = [
            "receivers/time",
            *(f"receivers/mic/{of}" for of in ("displacement", "velocity", "acceleration")),
        ]
        cases = {
            "title a number": (attribute("/", "title", 5.0), drawn),
            "scene a number": (attribute("/", "scene", 5.0), drawn),
            "created_by NaN": (attribute("/", "created_by", nan), drawn),
            "version text": (attribute("/", "version", "1"), "has no valid format version"),
            "kernel a number": (attribute(moving, "kernel", 5), drawn),
            "kernel of 300 letters": (attribute(moving, "kernel", 300 * "a"), "cannot be read"),
            "rotation of texts": (attribute(moving, "rotation", np.array(9 * ["a"], dtype="S1")), drawn),
            "rotation NaN": (attribute(moving, "rotation", np.full(9, nan)), drawn),
            "translation inf": (attribute(moving, "translation", np.full(3, np.inf)), drawn),
            "mass a list": (attribute(moving, "mass", [1.0, 2.0]), '"mass"'),
            "mass a text": (attribute(moving, "mass", "1"), drawn),
            "bodies in a circle": (circle, drawn),
            "receivers of one row": (cut(1, *receiver), foreign),
            "receivers of no row": (cut(0, *receiver), foreign),
            "no snapshots": (
                cut(0, "snapshots/time", "snapshots/moving", "snapshots/resting"),
                "snapshots that do not exist",
            ),
            "forces on other candidates": (all_of("static/moving/candidate", 99), "is not the kernel"),
            "forces NaN": (all_of("static/moving/force", nan), "not finite"),
            "gravity a text": (attribute("static/moving", "gravity", "1"), drawn),
            "one row": (cut(1, "time"), "holds nothing but the start"),
            "a shape": (cut(3, "contact/force"), "has shape"),
        }
        for text in (
            "bodies = 5",
            "[contact]\npair = 5",
            "[contact]\nbetween = [[1],[2]]",
            "[obstacles]\na = 5",
            OBSTACLE,
            "[bodies.moving]\nmaterial = 5",
            "[bodies.moving]\nmaterial = 1979-05-27",
            "[time]\nduration = nan",
            "contact = 5",
            "output = 5",
            "[bodies]\nmoving = 5",
            "[output]\nevery = [1979-05-27]",
        ):
            cases[text] = scene(text), foreign
        for name, (change, words) in cases.items():
            self.result.write_bytes(good)
            with h5py.File(self.result, "r+") as file:
                change(file)
            with self.subTest(name):
                if words is None:
                    self.drawn("report")
                else:
                    self.refuses(words)
        self.result.write_bytes(good)
        with h5py.File(self.result, "r+") as file:
            cut(0, "snapshots/time", "snapshots/moving", "snapshots/resting")(file)
            scene("[contact]\nbetween = [[1],[2]]")(file)
        self.refuses(foreign, "plot")
        self.result.write_bytes(good)

        table = json.loads(summary)
        for name, text, words in [
            ("1e999", summary.replace("{", '{"a": 1e999,', 1), "is damaged"),
            ("half a letter", summary.replace("{", '{"a": "\\ud800",', 1), "is damaged"),
            ("deep", 100_000 * "[", "is damaged"),
            ("not UTF-8", None, "is damaged"),
            (
                "sound",
                json.dumps(table | {"sounds": {"mic": 5}}),
                f"summary.json: holds what ricochet-contact {foreign}",
            ),
            ("sounds", json.dumps(table | {"sounds": [5]}), "is not of the run"),
        ]:
            self.summary_path.write_bytes(b"\xff" if text is None else text.encode())
            with self.subTest(name):
                self.refuses(words)

    def test_what_may_not_be_read_is_not_called_missing(self):
        closed = [
            self.result,
            self.summary_path,
            next(self.out.glob("*.wav")),
            next(self.out.glob("*.kernel.h5")),
        ]
        for path in closed:
            mode = path.stat().st_mode
            path.chmod(0)
            with self.subTest(path.name):
                self.reads(path, "report")
            path.chmod(mode)
        self.out.chmod(0)
        self.reads(self.result, "plot")
        self.out.chmod(0o755)

    def reads(self, path, name):
        with as_nobody():
            run = Command(name, self.result)
        self.refused(run, f"{path.name}: cannot be read (Permission denied)")

    def test_a_run_with_only_its_start_is_told_from_bodies_at_rest(self):
        impact(SCENE, self.out, *SETS, "output.every=100000")
        for name in ("plot", "report"):
            self.refuses("output.every is 100000", name)

    def test_pictures_and_pages_of_any_title_are_whole_or_as_they_were(self):
        with h5py.File(self.result, "r+") as file:
            file.attrs["title"] = TITLE
        self.drawn("plot")
        self.drawn("report")
        made = sorted([*self.out.glob("*.png"), *self.out.glob("*.html")])
        self.assertEqual(len(made), 4)
        for path in made:
            path.write_text("earlier")
        drawing = shutil.copy(MESHES / "two-disks/disk.geo", self.folder / "a$b^$日.geo")
        for command in (
            ["plot", self.result],
            ["report", self.result],
            ["surfaces", drawing, "--out", self.out],
        ):
            with limited(resource.RLIMIT_FSIZE, 4096):
                run = Command(*command)
            self.refused(run, "cannot be written (File too large)")
            self.assertEqual(list(self.out.glob("*.partial")), [])
        self.assertEqual({path.read_text() for path in made}, {"earlier"})
        with open("/dev/full", "w") as full:
            run = Run([BIN / "ricochet", *command], stdout=full)
        self.refused(run, status=1)

    def test_the_files_of_runs_at_once_with_one_title_do_not_mix(self):
        speeds = (60, 80, 100)
        for _ in range(3):
            runs = [
                subprocess.Popen(
                    [
                        BIN / "ricochet-contact",
                        SCENE,
                        "--out",
                        self.out,
                        "--quiet",
                        *settings([*SETS, f"bodies.moving.velocity=[{speed},0,0]"]),
                    ],
                    stderr=subprocess.DEVNULL,
                )
                for speed in speeds
            ]
            self.assertEqual([run.wait() for run in runs], [0, 0, 0])
            result = ricochet.Result(self.result)  # refuses a summary of another run
            self.assertEqual(result.run, result.summary["run"])
            speed = result.scene["bodies"]["moving"]["velocity"][0]
            approach = result.summary["episodes"][0]["approach_m_per_s"]
            self.assertAlmostEqual(approach, speed, delta=1e-6 * speed)
            self.assertEqual(list(self.out.glob("*.lock")), [])
            sound = next(self.out.glob("*.wav")).read_bytes()
            self.assertIn(f"; run {result.run}".encode(), sound)

    def test_a_run_waits_while_another_writes_its_files(self):
        before = self.result.read_bytes()
        command = [BIN / "ricochet-contact", SCENE, "--out", self.out, "--quiet"]
        sets = settings([*SETS, "bodies.moving.velocity=[60,0,0]"])
        with open(self.out / "rods.lock", "wb") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            run = subprocess.Popen([*command, *sets], stderr=subprocess.DEVNULL)
            with self.assertRaises(subprocess.TimeoutExpired):  # it takes half a second without the lock
                run.wait(2)
            self.assertEqual(self.result.read_bytes(), before)
        self.assertEqual(run.wait(), 0)
        self.assertNotEqual(self.result.read_bytes(), before)
        self.assertFalse((self.out / "rods.lock").exists())

    def test_sets_of_files_of_different_runs_are_refused(self):
        run = ricochet.Result(self.result).run
        self.assertRegex(run, "^[0-9a-f]{16}$")
        other = self.folder / "other"
        again = impact(SCENE, other, *SETS)
        self.assertEqual(again.run, run)  # equal runs have equal files
        fast = impact(SCENE, other, *SETS, "bodies.moving.velocity=[60,0,0]")
        self.assertNotEqual(fast.run, run)
        words = f"rods.result.h5: is of the run {run}, and rods.summary.json of the run {fast.run}"
        whole = self.summary_path.read_bytes()
        shutil.copy(other / "rods.summary.json", self.summary_path)
        for name in ("plot", "report"):
            self.refuses(words, name)
        with self.assertRaisesRegex(errors.InputError, "Repeat the run"):
            ricochet.Result(self.result)
        self.summary_path.write_bytes(whole)
        self.drawn("report")
        sound = next(self.out.glob("*.wav"))
        shutil.copy(other / sound.name, sound)
        self.refuses(f"{sound.name}: is of the run {fast.run}, and the result of the run {run}")
        # Files of earlier versions have no identifier.
        with h5py.File(self.result, "r+") as file:
            del file.attrs["run"]
        self.drawn("report")

    def test_a_run_that_replaces_the_files_of_another_says_so(self):
        def out_of(*more):
            command = [BIN / "ricochet-contact", SCENE, "--out", self.out, *settings([*SETS, *more])]
            return self.succeed(Run(command)).out

        self.assertNotIn("replaces", out_of())
        line = "rods.result.h5: replaces the files of a run with "
        self.assertIn(line + "other settings; ", out_of("bodies.moving.velocity=[60,0,0]"))
        self.assertIn(line + 'the title "rods"; ', out_of("title=Rods"))

    def test_what_killed_writers_left_goes_and_what_living_ones_write_stays(self):
        left, living, other = (
            self.folder / f"{name}.partial" for name in ("table.csv.1", "table.csv.2", "table.csv.old.1")
        )
        for path in (left, living, other):
            path.write_text("half")
        with open(living, "rb") as file:
            self.assertTrue(files.lock(file))
            files.write(self.folder / "table.csv", b"whole")
        self.assertEqual(
            {path.name for path in self.folder.iterdir()}, {"out", "table.csv", living.name, other.name}
        )
        with self.assertRaisesRegex(OSError, "/dev/null"):  # and it remains a device
            files.write(pathlib.Path("/dev/null"), b"")


if __name__ == "__main__":
    unittest.main()
