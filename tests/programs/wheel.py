# SPDX-License-Identifier: BSD-2-Clause
"""The wheel that pip makes of python/: installed into a folder of its own, it strikes the bell of the package, needs nothing of MPI,
PETSc or gmsh, and says what to install for kernels. The source distribution contains all that a wheel is compiled from."""

import csv
import os
import re
import subprocess
import sys
import tarfile
import tomllib
import unittest
import zipfile
from base64 import urlsafe_b64encode
from hashlib import sha256

from programs import BIN, SOURCE, ProgramTest, Run

sys.path.append(str(SOURCE / "python/backend"))
import ricochet_backend  # noqa: E402

BUILD = {"build-dir": str(BIN.parent)}
BARRED = ("mpi", "petsc", "slepc", "gmsh", "mumps", "metis", "blas")  # in names of libraries


class Wheel(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.shared_folder()
        build = f"build-dir={BIN.parent}"
        cls.pip(
            *("wheel", "--no-build-isolation", "-w", cls.folder, "--config-settings", build),
            SOURCE / "python",
        )
        (cls.wheel,) = cls.folder.glob("*.whl")
        cls.site = cls.folder / "site"
        cls.pip("install", "--target", cls.site, cls.wheel)

    @staticmethod
    def pip(command, *words):
        always = ["--quiet", "--no-deps", "--no-index"]
        environment = os.environ | {"PIP_ROOT_USER_ACTION": "ignore", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
        subprocess.run(
            ["/usr/bin/python3", "-m", "pip", command, *always, *words], check=True, env=environment
        )

    def call(self, *words):
        """Runs a console script of the wheel as a user does, without anything that points to the tree."""
        found = {
            name: value for name, value in os.environ.items() if not name.startswith(("RICOCHET", "PYTHON"))
        }
        found |= {"PATH": f"{self.site / 'bin'}:/usr/bin:/bin", "PYTHONPATH": str(self.site)}
        return Run([self.site / "bin" / words[0], *words[1:]], env=found, cwd=self.where)

    def setUp(self):
        super().setUp()
        self.where = self.folder

    def test_the_bell_of_the_package_is_struck_and_becomes_a_page_to_play(self):
        self.succeed(self.call("ricochet", "example", "bell"))
        self.refused(self.call("ricochet", "example", "bell"), "bell: is there already")
        kernels = {path.name for path in (self.where / "bell/out").iterdir()}
        done = self.call("ricochet", "run", "bell/bell.toml", "--set", "time.duration=0.05")
        self.assertEqual(done.status, 0, done.err)
        self.assertNotIn("warning: ", done.err)
        out = self.where / "bell/out"
        self.assertEqual({path.name for path in out.glob("*.kernel.h5")}, kernels)  # none was missing
        page = self.where / "bell.html"
        self.succeed(self.call("ricochet", "export", "--web", "bell/bell.toml", "-o", page))
        self.assertTrue(re.search('"wasm": ?"AGFzb', page.read_text()), "there is no player in the page")
        self.succeed(
            self.call("ricochet", "export", "--lv2", "bell/bell.toml", "-o", self.where / "bell.lv2")
        )
        self.assertEqual((self.where / "bell.lv2/instrument.so").read_bytes()[:4], b"\x7fELF")
        (kernel,) = out.glob("mallet-*.kernel.h5")
        self.succeed(self.call("ricochet-recast", kernel, "--scale-factor", "2"))

    def test_what_needs_ricochet_kernel_says_what_to_install(self):
        self.succeed(self.call("ricochet", "example", "bell", "--out", "other"))
        scene = "other/bell.toml"
        self.write("study.toml", f'scene = "{scene}"\n[grid]\n"modes.up_to_hz" = [5000, 6000]\n')
        for words in (
            ("kernel", scene),
            ("run", scene, "--set", "modes.up_to_hz=5000"),
            ("modes", scene),
            ("tradeoff", scene),
            ("sweep", "study.toml"),
        ):
            with self.subTest(verb=words[0]):
                self.refused(self.call("ricochet", *words), "Install the Debian package ricochet")

    def test_no_file_is_linked_with_mpi_petsc_or_gmsh(self):
        files = [p for p in self.site.rglob("*") if p.is_file() and p.read_bytes()[:4] == b"\x7fELF"]
        self.assertEqual(len(files), 4, files)  # extension module, plug-in, two programs
        for path in files:
            needed = subprocess.run(["ldd", path], check=True, capture_output=True, text=True).stdout
            names = [line.split()[0] for line in needed.splitlines()]
            self.assertEqual([name for name in names if any(word in name for word in BARRED)], [], path)

    def test_the_record_lists_each_file_with_its_hash(self):
        with zipfile.ZipFile(self.wheel) as archive:
            (record,) = (name for name in archive.namelist() if name.endswith(".dist-info/RECORD"))
            rows = {
                name: (digest, size)
                for name, digest, size in csv.reader(archive.read(record).decode().split())
            }
            self.assertEqual(set(rows), set(archive.namelist()))
            self.assertEqual(rows.pop(record), ("", ""))
            for name, (digest, size) in rows.items():
                data = archive.read(name)
                found = urlsafe_b64encode(sha256(data).digest()).decode().rstrip("=")
                self.assertEqual((digest, size), (f"sha256={found}", str(len(data))), name)

    def test_a_source_distribution_has_all_sources_and_is_a_project_of_its_own(self):
        name = ricochet_backend.build_sdist(str(self.folder))
        with tarfile.open(self.folder / name) as archive:
            archive.extractall(self.folder)  # our own
        top = self.folder / name.removesuffix(".tar.gz")
        project = tomllib.loads((top / "pyproject.toml").read_text())["build-system"]
        (backend,) = project["backend-path"]
        self.assertTrue((top / backend / f"{project['build-backend']}.py").is_file())
        built = self.folder / "build"
        words = [f"-DRICOCHET_{option}={value}" for option, value in ricochet_backend.OPTIONS.items()]
        subprocess.run(
            ["cmake", "-G", "Ninja", "-S", top, "-B", built, *words], check=True, stdout=subprocess.DEVNULL
        )
        # Ninja refuses a source that is missing. Headers are found in the compile commands of the checkout alone.
        plan = Run(["ninja", "-C", built, "-n", *ricochet_backend.TARGETS])
        self.assertEqual(plan.status, 0, plan.out + plan.err)
        for folder in ("base", "contact", "kernels", "include", "player", "src", "python", "lv2"):
            for header in (SOURCE / folder).rglob("*.hpp"):
                self.assertTrue((top / header.relative_to(SOURCE)).is_file(), header)
        # From an unpacked distribution without git, the same files make the same distribution.
        again = self.folder / "again"
        again.mkdir()
        made = f"import ricochet_backend as b; b.build_sdist({str(again)!r})"
        environment = os.environ | {"PYTHONPATH": str(top / backend)}
        subprocess.run(["/usr/bin/python3", "-B", "-c", made], check=True, env=environment)
        with tarfile.open(self.folder / name) as one, tarfile.open(again / name) as other:
            self.assertEqual(sorted(one.getnames()), sorted(other.getnames()))

    def test_tools_that_are_here_are_not_asked_of_pypi(self):
        self.assertEqual(ricochet_backend.get_requires_for_build_wheel({"build-dir": "/nowhere"}), [])
        path = os.environ["PATH"]
        self.addCleanup(os.environ.__setitem__, "PATH", path)
        os.environ["PATH"] = "/nowhere"
        asked = ricochet_backend.get_requires_for_build_wheel({"build-dir": "/nowhere"})
        self.assertEqual([name.partition(">")[0] for name in asked], ["cmake", "ninja", "pybind11"])
        self.assertEqual(ricochet_backend.get_requires_for_build_wheel(BUILD), [])  # compiled already


if __name__ == "__main__":
    unittest.main()
