# SPDX-License-Identifier: BSD-2-Clause
"""Error estimates of the impacts of rods and a bouncing bar in scripts/verify --estimates, compared with
closed forms: nine of ten true errors are at most three estimates, and seven are at least a tenth. The other
cases of that command, compared with finer runs, take minutes."""

import unittest

from programs import SOURCE, ProgramTest, Run


class Estimates(ProgramTest):
    def test_hold_for_rods_and_the_bouncing_bar(self):
        words = ["--estimates", "--only", "rod", "bar", "--check", "--out", self.folder]
        run = self.succeed(Run([SOURCE / "scripts" / "verify", *words], timeout=None))
        print(run.out)
        self.assertEqual(sum("rod" in line or "bar" in line for line in run.out.splitlines()), 23)


if __name__ == "__main__":
    unittest.main()
