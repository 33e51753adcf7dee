# SPDX-License-Identifier: BSD-2-Clause
"""plot, report, surfaces and sweep with unusual files: damaged results, places that cannot be read or written, and titles with
any characters."""

import contextlib
import gc
import io
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

from programs import BIN, MESHES, SOURCE, ProgramTest, Run, contact, settings

from ricochet import cli, files

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


def as_nobody(command):
    """Runs the command as a user who may not read protected files."""
    lead = ["setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups"] if os.geteuid() == 0 else []
    with tempfile.TemporaryDirectory() as home:  # matplotlib prints a warning without a home folder
        pathlib.Path(home).chmod(0o777)
        return subprocess.run(
            [*lead, *map(str, command)],
            capture_output=True,
            text=True,
            check=False,
            env=os.environ | {"MPLCONFIGDIR": home},
        )


class Files(ProgramTest):
    @classmethod
    def setUpClass(cls):
        scope = tempfile.TemporaryDirectory(prefix="ricochet-files-")
        cls.addClassCleanup(scope.cleanup)
        cls.all = pathlib.Path(scope.name)
        for run in (
            Run([BIN / "ricochet-kernel", SCENE, "--out", cls.all, "--quiet", *settings(SETS)]),
            contact(SCENE, cls.all, *SETS),
        ):
            assert run.status == 0, run.err

    def setUp(self):
        super().setUp()
        self.folder.chmod(0o755)
        self.out = self.folder / "out"
        shutil.copytree(self.all, self.out)
        self.out.chmod(0o755)
        self.result, self.summary_path = self.out / "rods.result.h5", self.out / "rods.summary.json"

    def done(self, name, *arguments):
        """Returns the status and the output on stderr."""
        said = io.StringIO()
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
            status = cli.main([name, str(self.result), *map(str, arguments)])
        gc.collect()  # closes the files
        return status, said.getvalue()

    def refused(self, words, name="report"):
        status, said = self.done(name)
        self.assertEqual((status, said.count("\n"), "Traceback" in said), (2, 1, False), said)
        self.assertIn(words, said)
        self.assertLess(len(said), 500)

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
                    self.assertEqual(self.done("report"), (0, ""))
                else:
                    self.refused(words)
        self.result.write_bytes(good)
        with h5py.File(self.result, "r+") as file:
            cut(0, "snapshots/time", "snapshots/moving", "snapshots/resting")(file)
            scene("[contact]\nbetween = [[1],[2]]")(file)
        self.refused(foreign, "plot")
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
                self.refused(words)

    def test_what_may_not_be_read_is_not_called_missing(self):
        if as_nobody(["test", "-x", BIN / "ricochet"]).returncode:
            self.skipTest(f"another user can't read {SOURCE}")
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
        done = as_nobody([BIN / "ricochet", name, self.result])
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertIn(f"{path.name}: cannot be read (Permission denied)", done.stderr)

    def test_a_run_with_only_its_start_is_told_from_bodies_at_rest(self):
        self.succeed(contact(SCENE, self.out, *SETS, "output.every=100000"))
        for name in ("plot", "report"):
            self.refused("output.every is 100000", name)

    def test_pictures_and_pages_of_any_title_are_whole_or_as_they_were(self):
        with h5py.File(self.result, "r+") as file:
            file.attrs["title"] = TITLE
        self.assertEqual(self.done("plot"), (0, ""))
        self.assertEqual(self.done("report"), (0, ""))
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
            command = [BIN / "ricochet", *command]
            run = Run(["prlimit", "--fsize=4096", *command])
            self.assertEqual((run.status, run.err.count("\n")), (2, 1), run.err)
            self.assertIn("cannot be written (File too large)", run.err)
            self.assertEqual(list(self.out.glob("*.partial")), [])
        self.assertEqual({path.read_text() for path in made}, {"earlier"})
        full = subprocess.run(
            f"exec '{command[0]}' surfaces '{drawing}' --out '{self.out}' > /dev/full",
            shell=True,
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual((full.returncode, full.stderr.count("\n")), (1, 1), full.stderr)

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
