# SPDX-License-Identifier: BSD-2-Clause
"""Every line of the table of extremes passes."""

import unittest

from programs import SOURCE, Run


class Extremes(unittest.TestCase):
    def test_every_case_is_within_its_bound(self):
        run = Run([SOURCE / "scripts" / "verify", "--extremes", "--check", "--jobs", "2"], timeout=None)
        print(run.out)
        self.assertEqual(run.status, 0, run.out + run.err)


if __name__ == "__main__":
    unittest.main()
