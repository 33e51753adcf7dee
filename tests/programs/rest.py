# SPDX-License-Identifier: BSD-2-Clause
"""The shell of a phone, dropped on a floor with friction, comes to rest: its damping and friction leave no other end. Motions
separate after the first touches, so that falls that buzz on by a flaw need not do so in every build: this test cannot find each."""

import unittest
from pathlib import Path

from programs import ProgramTest, impact

import ricochet

SCENE = Path(__file__).resolve().parents[2] / "meshes/phone/phone.toml"
FALL = 0.45  # s, from the start to the first blow


class Rest(ProgramTest):
    def test_of_a_shell_that_falls_on_its_rim(self):
        made = self.shared_folder()
        for angles in [15, 60, 0], [20, 40, 0]:
            scene = ricochet.Scene(SCENE).changed(
                {
                    "title": f"Rest {angles[0]}",
                    "bodies.shell.rotate_deg": angles,
                    "bodies.shell.translate": [0, 0, 1.12],
                    "motion.second_run": False,
                    "time.duration": FALL + 1.3,
                }
            )
            result = impact(scene, made / "out")
            kinetic = result.energy["kinetic"]
            last = kinetic[result.time > result.time[-1] - 0.05]
            with self.subTest(angles=angles):
                self.assertGreater(kinetic.max(), 0.2)  # J, of the fall
                # What is left is vibration that nothing feeds: a loss factor of 0.03 takes a tenth of it in 4 ms.
                self.assertLess(last.max(), 1e-8)
                self.assertGreater(last.max(), 0)


if __name__ == "__main__":
    unittest.main()
