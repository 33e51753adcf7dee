# SPDX-License-Identifier: BSD-2-Clause
"""Every line of the table of extremes passes."""

import subprocess
import unittest

from programs import SOURCE


class Extremes(unittest.TestCase):
    def test_every_case_is_within_its_bound(self):
        done = subprocess.run(
            [SOURCE / "scripts" / "verify", "--extremes", "--check", "--jobs", "2"],
            capture_output=True,
            text=True,
        )
        print(done.stdout)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
