# SPDX-License-Identifier: BSD-2-Clause
"""A rod falls on a wall several times in one scene. Velocities and times are compared with free fall; one kernel serves all
strikes, and another scene with the rod alone repeats a strike."""

import unittest

import numpy as np

import scenes
from programs import ProgramTest, contact, impact, kernel

# E = ρ = A = 1 and L = 1. Without elastic modes the rod is a mass on the spring of its residual flexibility.
GRAVITY, GAP, STEP = 5e-5, 1e-3, 0.01
TIMES, SPEEDS = [0.0, 30.0, 60.0], [0.01, 0.02, 0.005]
STRIKES = "".join(
    f'[[strikes]]\nmallet = "rod"\ntime = {time}\nspeed = {speed}\n' for time, speed in zip(TIMES, SPEEDS)
)


def scene(strikes, velocity=(0.01, 0, 0)):
    body = (
        'mesh = "rod.geo"\norder = 1\nmaterial = { density = 1.0, young = 1.0, area = 1.0 }\n'
        f'contact = "right"\nvelocity = {list(velocity)}'
    )
    return scenes.scene(
        {"rod": body},
        "count = 1",
        f"gap = {GAP}",
        f"rate_hz = {1 / STEP}\nduration = 80",
        {"wall": "point = [1.5, 0, 0]\nnormal = [-1, 0, 0]"},
        "Strikes",
        f"[loads]\ngravity = [{GRAVITY}, 0, 0]\n{strikes}",
    )


class Strikes(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("rod.geo", scenes.rod())
        self.scene, self.out = self.write("strikes.toml", scene(STRIKES)), self.folder / "out"

    def test_each_strike_has_its_time_and_speed(self):
        result = impact(self.scene, self.out)
        self.one(self.out)
        episodes, time = result.summary["episodes"], result.time
        names = ["rod", "rod.2", "rod.3"]
        velocity = {name: result.bodies[name].velocity[:, 0] for name in names}
        run = self.succeed(contact(self.scene, self.out, quiet=False))
        struck = []
        for name, when, speed in zip(names, TIMES, SPEEDS):
            row = round(when / STEP)
            before = velocity[name][: row + 1]
            np.testing.assert_allclose(before, speed + GRAVITY * (time[: row + 1] - when), rtol=0, atol=1e-12)
            # From the place at `when`, the gap closes by s = v t + g t²/2.
            closing = (np.sqrt(speed**2 + 2 * GRAVITY * GAP) - speed) / GRAVITY
            struck.append((when + closing, speed + GRAVITY * closing))
        self.assertEqual(len(episodes), 3)
        for episode, (start, approach) in zip(episodes, struck):
            self.assertAlmostEqual(episode["start_s"], start, delta=1.5 * STEP)
            self.assertAlmostEqual(episode["approach_m_per_s"], approach, delta=1.1 * GRAVITY * STEP)
            self.assertAlmostEqual(episode["restitution"], 1, delta=0.02)
        self.assertRegex(run.out, r"each episode +1: approach [\d.]+ m/s, restitution [\d.]+; 2: ")

    def test_a_strike_alone_is_the_impact_of_the_body_itself(self):
        alone = self.write("alone.toml", scene('[[strikes]]\nmallet = "rod"\ntime = 0\n'))
        plain = self.write("plain.toml", scene(""))
        found = [impact(file, self.out).summary for file in (plain, alone)]
        for key in ("episodes", "peak_force_n", "impulse_ns", "exit_velocity", "restitution"):
            self.assertEqual(found[0][key], found[1][key])

    def test_a_strike_that_does_not_fit_is_refused_in_one_line(self):
        part = '"rod.3" would start behind the surface that it strikes at 60 s'
        self.succeed(kernel(self.scene, self.out))  # motion matters to the impact only
        self.refused(contact(self.scene, self.out, "loads.gravity=[2e-4,0,0]"), part)


if __name__ == "__main__":
    unittest.main()
