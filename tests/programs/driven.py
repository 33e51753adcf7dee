# SPDX-License-Identifier: BSD-2-Clause
"""A rod whose foot is moved and whose tip is loaded, from mesh to sound. The motion of a receiver in the middle is compared
with the waves on the rod (c = 1, L = 10). Bad histories are refused and leave nothing."""

import shutil
import struct
import unittest

import numpy as np

from programs import MESHES, ProgramTest, contact, impact, kernel

SPEED, BLOW, MIDDLE, LENGTH = 0.02, 0.01, 5.0, 10.0
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


def waves(times):
    """Displacement in the middle: V (t − x)₊ from the foot and F t from the tip, where h rises to 1 within 2 s. Waves are
    reflected with the same sign at the free tip and with the opposite sign at the foot."""

    def ramp(t):  # ∫ h dt
        return np.where(t > 2, t - 1, np.where(t > 0, t * t / 4, 0))

    out = np.zeros_like(times)
    for echo in range(3):
        later = times - 2 * LENGTH * echo
        out += (
            (-1) ** echo
            * SPEED
            * (np.maximum(later - MIDDLE, 0) + np.maximum(later - 2 * LENGTH + MIDDLE, 0))
        )
        out += (-1) ** echo * BLOW * (ramp(later - LENGTH + MIDDLE) - ramp(later - LENGTH - MIDDLE))
    return out


class Driven(ProgramTest):
    def setUp(self):
        super().setUp()
        shutil.copy(MESHES / "two-rods" / "rod.geo", self.folder)
        self.scene = self.write("shaken.toml", SCENE)
        self.write("foot.csv", "0,0\n100,10\n")
        self.write("blow.csv", "t,factor\n0,0\n2,1\n")
        self.out = self.folder / "out"
        self.succeed(kernel(self.scene, self.out, ranks=2))

    def test_receivers_see_the_waves_and_sound_like_them(self):
        result = impact(self.scene, self.out)
        times, mic, summary = result.receiver_time, result.receivers["mic"], result.summary
        self.assertEqual((len(result.time), len(times)), (141, 1401))
        # 60 modes blur a front of speed 0.02 over 2L/60; the tolerance is a third of their product.
        np.testing.assert_allclose(mic.displacement[:, 0], waves(times), rtol=0, atol=2e-3)
        self.assertLess(summary["energy_drift"], 1e-12)
        sound = summary["sounds"]["mic"]
        fastest = abs(mic.velocity[:, 0]).max()
        self.assertAlmostEqual(sound["full_scale_m_per_s"], fastest, delta=0.02 * fastest)
        data = (self.out / sound["file"]).read_bytes()
        kind, channels, rate = struct.unpack_from("<HHI", data, data.index(b"fmt ") + 8)
        self.assertEqual((kind, channels, rate), (3, 3, 48000))  # 3: float

    def test_bad_histories_are_refused_in_one_line_and_leave_nothing(self):
        for text, part in [
            ("0,0\n0,1\n", "blow.csv:2: t = 0 s comes after 0 s"),
            ("0,zero\n", "blow.csv:1: "),
        ]:
            self.write("blow.csv", text)
            self.refused(contact(self.scene, self.out), part)
        self.write("blow.csv", "0,0\n2,1\n")
        self.write("foot.csv", "1,0.5\n2,1\n")
        self.refused(contact(self.scene, self.out), "would jump")
        self.assertEqual([path.suffixes[-2:] for path in self.out.iterdir()], [[".kernel", ".h5"]])


if __name__ == "__main__":
    unittest.main()
