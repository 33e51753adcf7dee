# SPDX-License-Identifier: BSD-2-Clause
"""What scripts/setup installs on a minimal Debian 12, as apt simulates it: the packages and the size that the page on installing
states, within the limits for a first use."""

import os
import re
import subprocess
import unittest

from programs import SOURCE, ProgramTest


def run(*words, **more):
    return subprocess.run(words, capture_output=True, text=True, check=True, **more).stdout


def is_bookworm():
    """Whether apt knows the packages of Debian 12."""
    try:
        return "n=bookworm," in run("apt-cache", "policy")
    except (OSError, subprocess.CalledProcessError):
        return False


@unittest.skipUnless(is_bookworm(), "apt has no lists of Debian 12: apt-get update")
class FirstUse(ProgramTest):
    def asked_for(self, *options):
        """The packages that scripts/setup asks for where none is installed."""
        self.write("dpkg-query", "#!/bin/sh\nexit 1\n").chmod(0o755)
        self.write("apt-get", f'#!/bin/sh\necho "$@" >> {self.folder}/asked\n').chmod(0o755)
        self.write("sudo", '#!/bin/sh\nexec "$@"\n').chmod(0o755)
        path = f"{self.folder}:{os.environ['PATH']}"
        run(SOURCE / "scripts/setup", *options, env=os.environ | {"PATH": path})
        words = (self.folder / "asked").read_text().splitlines()[-1].split()
        return [word for word in words[1:] if not word.startswith("-")]

    def installed(self, packages):
        """The packages that are there after these are installed on nothing."""
        status = self.write("status", "")
        options = ["-s", "-o", f"Dir::State::status={status}", "--no-install-recommends"]
        done = run("/usr/bin/apt-get", *options, "install", *packages)
        return set(re.findall(r"^Inst (\S+)", done, re.MULTILINE))

    def added(self, *options):
        """Number and size [GB] of the packages beyond a minimal system with certificates."""
        listed = run("dpkg-query", "-W", "-f", "${Package} ${Essential} ${Priority}\n").splitlines()
        minimal = [row.split()[0] for row in listed if " yes " in row or row.endswith(" required")]
        minimal += ["apt", "ca-certificates"]
        new = self.installed([*minimal, *self.asked_for(*options)]) - self.installed(minimal)
        shown = run("apt-cache", "show", "--no-all-versions", *sorted(new))
        sizes = dict(
            re.findall(r"^Package: (\S+)$.*?^Installed-Size: (\d+)$", shown, re.MULTILINE | re.DOTALL)
        )
        return len(new), sum(map(int, sizes.values())) * 1024e-9

    def test_needs_as_few_packages_as_the_page_on_installing_says(self):
        page = (SOURCE / "docs/installation.md").read_text()
        for options in ([], ["--develop"]):
            name = re.escape(" ".join(["scripts/setup", *options]))
            row = re.search(rf"^\| \[?`{name}`\]?\S* \| yes \| (\d+) \| ([\d.]+) GB \|$", page, re.MULTILINE)
            count, size = self.added(*options)
            # Security updates change some packages a little.
            self.assertLessEqual(abs(count - int(row[1])), 2, (options, count))
            self.assertLessEqual(abs(size - float(row[2])), 0.02, (options, size))
            if not options:
                self.assertLess(count, 430)
                self.assertLess(size, 1.77)


if __name__ == "__main__":
    unittest.main()
