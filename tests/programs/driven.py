# SPDX-License-Identifier: BSD-2-Clause
"""A rod whose foot is moved and whose tip is loaded, from mesh to sound. tests/contact and the manual compare such motion with waves."""

import shutil
import struct
import unittest

from programs import MESHES, ProgramTest, impact, kernel

SCENE = """
title = "Shaken"
[bodies.bar]
mesh = "rod.geo"
order = 1
material = { density = 1.0, young = 1.0, area = 1.0 }
contact = "right"
support = { left = "x" }
[obstacles.wall]
point = [15, 0, 0]
normal = [-1, 0, 0]
[modes]
count = 60
[contact]
between = ["bar", "wall"]
[time]
rate_hz = 50.0
duration = 28.0
[[loads.motion]]
body = "bar"
group = "left"
vector = [0.2, 0, 0]
history = "foot.csv"
[[loads.point]]
body = "bar"
at = [10, 0, 0]
vector = [0.01, 0, 0]
history = "blow.csv"
[output]
every = 10
[[output.receiver]]
name = "mic"
body = "bar"
at = [5.0, 0, 0]
"""


class Driven(ProgramTest):
    def setUp(self):
        super().setUp()
        shutil.copy(MESHES / "two-rods" / "rod.geo", self.folder)
        self.scene = self.write("shaken.toml", SCENE)
        self.write("foot.csv", "0,0\n100,10\n")
        self.write("blow.csv", "t,factor\n0,0\n2,1\n")
        self.out = self.folder / "out"
        self.succeed(kernel(self.scene, self.out, ranks=2))

    def test_receivers_see_waves_arrive_and_sound_like_them(self):
        result = impact(self.scene, self.out)
        times, mic, summary = result.receiver_time, result.receivers["mic"], result.summary
        self.assertEqual((len(result.time), len(times)), (141, 1401))
        # The foot goes at 0.02 from t = 0, and the tip, loaded by 0.01, at 0.01 from t = 2: both waves reach the middle, at 5.
        self.assertLess(abs(mic.displacement[times < 4, 0]).max(), 2e-3)
        self.assertAlmostEqual(mic.velocity[(times > 8) & (times < 14), 0].mean(), 0.03, delta=2e-3)
        self.assertLess(summary["energy_drift"], 1e-12)
        sound = summary["sounds"]["mic"]
        fastest = abs(mic.velocity[:, 0]).max()
        self.assertAlmostEqual(sound["full_scale_m_per_s"], fastest, delta=0.02 * fastest)
        data = (self.out / sound["file"]).read_bytes()
        kind, channels, rate = struct.unpack_from("<HHI", data, data.index(b"fmt ") + 8)
        self.assertEqual((kind, channels, rate), (3, 3, 48000))  # 3: float


if __name__ == "__main__":
    unittest.main()
