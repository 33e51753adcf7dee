# SPDX-License-Identifier: BSD-2-Clause
"""scripts/release in a repository of its own, which holds the files that state the version and a stand-in for scripts/package."""

import hashlib
import shutil
import subprocess
import tarfile
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MADE = ["ricochet_new_amd64.deb", "ricochet-0.2.0-cp311-cp311-linux_x86_64.whl", "ricochet-0.2.0.tar.gz"]
PACKAGE = (
    "#!/bin/sh\nmkdir -p build/packages && cd build/packages && for f in %s; do echo binary > $f; done\n"
)


class Release(unittest.TestCase):
    def setUp(self):
        scope = tempfile.TemporaryDirectory(prefix="ricochet-release-")
        self.addCleanup(scope.cleanup)
        self.root = Path(scope.name)
        for name in (
            "scripts/release",
            "CMakeLists.txt",
            "CITATION.cff",
            "docs/results.md",
            "recipe/recipe.yaml",
        ):
            (self.root / name).parent.mkdir(exist_ok=True)
            shutil.copy2(ROOT / name, self.root / name)
        self.write("scripts/package", PACKAGE % " ".join(MADE)).chmod(0o755)
        self.write(".gitignore", "/build/\n")
        self.write(
            "CHANGELOG.md", "# Changelog\n\n## Unreleased\n\n### Added\n\n- New.\n\n## [0.1.0]\n\nFirst.\n"
        )
        self.git("init", "--quiet")
        self.git("config", "user.name", "a")
        self.git("config", "user.email", "a@example.org")
        self.commit()

    def write(self, name, text):
        path = self.root / name
        path.write_text(text)
        return path

    def git(self, *words):
        return subprocess.run(
            ["git", *words], cwd=self.root, check=True, capture_output=True, text=True
        ).stdout

    def commit(self):
        self.git("add", "-A")
        self.git("commit", "--quiet", "-m", "all")

    def release(self, *words):
        return subprocess.run(
            [self.root / "scripts/release", *words], cwd=self.root, capture_output=True, text=True
        )

    def refused(self, version, reason):
        done = self.release(version)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertIn(reason, done.stderr)
        self.assertEqual(self.git("tag"), "")

    def test_a_dry_run_prints_the_notes_and_changes_nothing(self):
        before = self.git("rev-parse", "HEAD")
        done = self.release("0.2.0", "--dry-run")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertTrue(done.stdout.endswith("\n\n### Added\n\n- New.\n"))
        self.assertEqual((self.git("rev-parse", "HEAD"), self.git("tag", "-l")), (before, ""))
        self.assertEqual(self.git("status", "--porcelain", "--ignored"), "")

    def test_a_release_has_its_version_everywhere_a_tag_with_notes_and_files_with_their_sums(self):
        done = self.release("0.2.0")
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("CMakeLists.txt", "CITATION.cff", "docs/results.md", "recipe/recipe.yaml"):
            text = (self.root / name).read_text()
            self.assertEqual(text, (ROOT / name).read_text().replace("0.1.0", "0.2.0"), name)
        changes = (self.root / "CHANGELOG.md").read_text()
        self.assertIn("## Unreleased\n\n## [0.2.0]\n\n### Added\n\n- New.\n\n## [0.1.0]\n", changes)
        self.assertEqual(self.git("status", "--porcelain"), "")
        self.assertEqual(self.git("log", "-1", "--format=%s"), "Release 0.2.0\n")
        self.assertEqual(
            self.git("tag", "-l", "--format=%(contents)").strip(), "Ricochet 0.2.0\n\n### Added\n\n- New."
        )
        folder = self.root / "build/release/0.2.0"
        sums = dict(reversed(line.split("  ")) for line in (folder / "SHA256SUMS").read_text().splitlines())
        self.assertEqual(set(sums), {"notes.md", "ricochet-0.2.0-all.tar.gz", *MADE})
        for name, digest in sums.items():
            self.assertEqual(hashlib.sha256((folder / name).read_bytes()).hexdigest(), digest)
        with tarfile.open(folder / "ricochet-0.2.0-all.tar.gz") as sources:
            self.assertIn("ricochet-0.2.0/CITATION.cff", sources.getnames())
        # The same command completes a release that was interrupted after its tag.
        shutil.rmtree(folder)
        at = self.git("rev-parse", "HEAD")
        self.assertEqual(self.release("0.2.0").returncode, 0)
        self.assertEqual(self.git("rev-parse", "HEAD"), at)
        self.assertEqual((folder / "notes.md").read_text(), "### Added\n\n- New.\n")

    def test_what_cannot_be_released_is_refused(self):
        self.refused("2", "give three numbers")
        self.refused("0.1.0", "is not above the present version, 0.1.0")
        path = self.write("CITATION.cff", (self.root / "CITATION.cff").read_text() + "\n")
        self.refused("0.2.0", "CITATION.cff: is not committed")
        path.write_text(path.read_text().replace("version: 0.1.0", "version: 0.0.9"))
        self.commit()
        self.refused("0.2.0", "CITATION.cff: states version 0.0.9, and CMakeLists.txt 0.1.0")
        path.write_text(path.read_text().replace("version: 0.0.9", "version: 0.1.0"))
        self.write("CHANGELOG.md", "## Unreleased\n\n## [0.1.0]\n\nFirst.\n")
        self.commit()
        self.refused("0.2.0", 'lists nothing below "## Unreleased"')


if __name__ == "__main__":
    unittest.main()
