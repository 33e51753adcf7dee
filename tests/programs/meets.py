# SPDX-License-Identifier: BSD-2-Clause
"""Bodies that turn by any angle and meet, from mesh to files: a brick strikes a beam that stands on a floor, and a clamped beam. Laws of
mechanics, and the geometry of boxes, judge what the results say."""

import pickle
import subprocess
import sys
import tomllib
import unittest

import numpy as np
from scipy.spatial.transform import Rotation

import ricochet
from programs import ProgramTest, impact

DENSITY, GRAVITY = 1200.0, 9.81
SIZES = {"brick": np.array([0.05, 0.03, 0.02]), "beam": np.array([0.12, 0.03, 0.03])}
MATERIAL = f"material = {{ young = 2e8, poisson = 0.35, density = {DENSITY} }}\ndamping = {{ ratio = 0.02 }}"
BODY = """
[bodies.{name}]
mesh = "{name}.geo"
contact = "all"
order = 1
{material}
"""
SCENE = (
    BODY.format(name="beam", material=MATERIAL)
    + "translate = [0, 0, 0.0151]\n"
    + BODY.format(name="brick", material=MATERIAL)
    + """rotate_deg = [25, 35, 10]
translate = [0.02, 0.004, 0.07]
velocity = [0, 0, -1.5]
angular_velocity = [0, 10, 20]
[obstacles.floor]
normal = [0, 0, 1]
[contact]
between = "all"
friction = 0.3
[modes]
up_to_hz = 8000
[motion]
rotation = "finite"
[time]
rate_hz = 48000
duration = 0.08
"""
)
BALL = """SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 0.01};
Mesh.MeshSizeMax = 0.004;
Physical Volume("ball") = {1};
"""
BALLS = """
[bodies.upper]
mesh = "ball.geo"
contact = "all"
order = 2
material = { young = 1e7, poisson = 0.45, density = 1100 }
translate = [0, 0, 0.01]
velocity = [0, 0, -1]
[obstacles.wall]
normal = [0, 0, 1]
[contact]
between = ["upper", "wall"]
[modes]
count = 20
[motion]
rotation = "finite"
[time]
rate_hz = 48000
duration = 2e-3
"""
# All bits of what a program can read of a simulation
SEEN = """
def seen(simulation):
    values = [simulation.force, simulation.displacement, simulation.tangential_force]
    for name in simulation.bodies:
        values += vars(simulation.body_motion(name)).values()
        values += vars(simulation.modal_coordinates(name)).values()
    return [value.tobytes() for value in values], simulation.bodies, simulation.time, vars(simulation.energy)
"""
ROUND_OFF = 1e-11  # of 4000 steps, relative to the largest value


def geometry(size):
    """A box about the origin. Its end is a physical surface."""
    x, y, z = size
    return f"""SetFactory("OpenCASCADE");
Box(1) = {{{-x / 2}, {-y / 2}, {-z / 2}, {x}, {y}, {z}}};
Mesh.MeshSizeMax = {min(size)};
Physical Volume("body") = {{1}};
Physical Surface("end") = {{1}};
"""


def inside(result, one, other, frame):
    """How deep the corners of one box are within the other one."""
    body, there = result.bodies[one], result.bodies[other]
    corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T * SIZES[one] / 2
    world = Rotation.from_quat(np.roll(body.attitude[frame], -1)).apply(corners) + body.position[frame]
    own = Rotation.from_quat(np.roll(there.attitude[frame], -1)).inv().apply(world - there.position[frame])
    return np.max(np.min(SIZES[other] / 2 - np.abs(own), axis=1))


class Meets(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        for name, size in SIZES.items():
            (cls.made / f"{name}.geo").write_text(geometry(size))
        cls.scene, cls.out = cls.made / "meets.toml", cls.made / "out"
        cls.scene.write_text(SCENE)

    def test_of_two_bodies_keeps_their_momentum_and_their_shapes_apart(self):
        apart = ["bodies.beam.translate=[0,0,0]", 'contact.pair=[{between=["beam","floor"],touch=false},'
                 '{between=["brick","floor"],touch=false}]']  # fmt: skip
        result = impact(self.scene, self.out, *apart)
        momentum = sum(body.momentum for body in result.bodies.values())
        spin = sum(body.angular_momentum for body in result.bodies.values())
        largest = np.max(np.abs(result.bodies["brick"].momentum))
        self.assertLess(np.max(np.abs(momentum - momentum[0])), ROUND_OFF * largest)
        self.assertLess(np.max(np.abs(spin - spin[0])), ROUND_OFF * np.max(np.abs(spin)))
        change = np.linalg.norm(result.bodies["brick"].momentum[-1] - result.bodies["brick"].momentum[0])
        self.assertGreater(change, 0.1 * largest)
        (touch, *_) = result.summary["touches"]
        self.assertEqual(set(touch["bodies"]), {"beam", "brick"})
        # An impact of some newtons presses corners by micrometres; unnoticed bodies would overlap by millimetres.
        deepest = max(
            inside(result, *pair, frame)
            for pair in (("brick", "beam"), ("beam", "brick"))
            for frame in range(0, len(result.time), 20)
        )
        self.assertLess(deepest, 2e-4)
        self.assertLess(result.summary["energy_drift"], 1e-10)

    def test_of_equal_balls_is_that_of_a_ball_and_a_wall(self):
        (self.made / "ball.geo").write_text(BALL)
        keys = tomllib.loads(BALLS)
        wall = impact(ricochet.Scene(keys, self.made), self.out).summary
        lower = {"rotate_deg": [0, 180, 0], "translate": [0, 0, -0.01], "velocity": [0, 0, 1]}
        keys["bodies"]["lower"] = keys["bodies"]["upper"] | lower
        keys["contact"]["between"] = ["upper", "lower"]
        both = impact(ricochet.Scene(keys, self.made), self.out).summary
        # Patches are as large as the contact: 2.9 % here, and 12 % if they do not yield by their bulges between two bodies.
        self.assertAlmostEqual(both["peak_force_n"] / wall["peak_force_n"], 1, delta=0.05)
        self.assertAlmostEqual(both["impulse_ns"] / wall["impulse_ns"], 1, delta=0.01)

    def test_of_a_brick_that_falls_on_a_beam_on_the_floor(self):
        result = impact(self.scene, self.out, f"loads.gravity=[0,0,{-GRAVITY}]", "time.duration=0.06")
        pairs = {frozenset(touch["bodies"]) for touch in result.summary["touches"]}
        self.assertLessEqual({frozenset(("beam", "floor")), frozenset(("beam", "brick"))}, pairs)
        lowest = min(np.min(body.position[:, 2]) for body in result.bodies.values())
        self.assertGreater(lowest, 0.0095)  # half of the thinnest side, but for its compression
        energy = result.energy
        total = energy["total"] + energy["damping"] + energy["contact"] + energy["friction"]
        scale = np.max(np.abs(energy["kinetic"]))
        self.assertLess(np.ptp(total), ROUND_OFF * scale)
        self.assertGreaterEqual(np.min(energy["contact"]), -ROUND_OFF * scale)

    def test_of_a_clamped_beam_holds_what_strikes_it(self):
        held = ['bodies.beam.support.end="xyz"', 'contact.pair=[{between=["beam","floor"],touch=false},'
                '{between=["brick","floor"],touch=false}]']  # fmt: skip
        result = impact(self.scene, self.out, *held)
        beam, brick = result.bodies["beam"], result.bodies["brick"]
        self.assertEqual(np.ptp(beam.position, axis=0).tolist(), [0, 0, 0])
        # What the brick loses passes through the support, or stays in the beam.
        taken = np.sum(beam.reaction, axis=0) * (result.time[1] - result.time[0])
        lost = brick.momentum[0] - brick.momentum[-1]
        balance = lost + taken - (beam.momentum[-1] - beam.momentum[0])
        self.assertLess(np.linalg.norm(balance), 1e-9 * np.linalg.norm(lost))

    def test_of_a_simulation_names_what_touches(self):
        scene = ricochet.Scene(self.scene).changed({"loads.gravity": [0, 0, -GRAVITY]})
        ricochet.kernels(scene, 1, self.out)
        simulation = ricochet.Simulation(scene)
        mass = {name: DENSITY * np.prod(size) for name, size in SIZES.items()}
        pushed, met = {name: np.zeros(3) for name in SIZES}, set()
        for _ in range(2000):
            simulation.step()
            for contact in simulation.contacts:
                met.add(frozenset(contact.between))
                self.assertGreater(contact.force @ contact.normal, 0)
                first, second = contact.between
                pushed[first] -= contact.force / 48000
                if second != "floor":
                    pushed[second] += contact.force / 48000
                else:
                    self.assertLess(abs(contact.place[2]), 1e-4)
        self.assertEqual(met, {frozenset(("beam", "floor")), frozenset(("beam", "brick"))})
        start = {"beam": np.zeros(3), "brick": np.array([0, 0, -1.5])}
        for name in SIZES:
            gained = (
                simulation.mean_velocity(name) - start[name] - np.array([0, 0, -GRAVITY]) * simulation.time
            )
            self.assertLess(np.linalg.norm(mass[name] * gained - pushed[name]), 1e-3 * mass[name])

    def simulation(self):
        scene = ricochet.Scene(self.scene).changed({"loads.gravity": [0, 0, -GRAVITY]})
        ricochet.kernels(scene, 1, self.out)
        return ricochet.Simulation(scene)

    def test_of_a_simulation_that_is_restored_has_the_forces_of_its_state(self):
        simulation = self.simulation()
        while not np.any(simulation.force):
            simulation.step()
        state = simulation.save()
        first = simulation.step_block(60, force=True).force
        simulation.step_block(1000)
        simulation.restore(state)
        np.testing.assert_array_equal(simulation.step_block(60, force=True).force, first)

    def test_of_a_simulation_changes_its_bodies(self):
        simulation = self.simulation()
        simulation.step_block(480)
        energy = simulation.energy
        balance = energy.total + energy.damping + energy.contact + energy.friction
        before = simulation.body_motion("brick")
        simulation.remove("beam")
        self.assertEqual(simulation.bodies, ["brick"])
        fresh = {"velocity": [0.5, 0, -2], "spin": [4, 0, 3], "attitude": [0.8, 0, 0.6, 0]}
        simulation.add("second", "brick", [0.3, 0, 0.05], **fresh)
        simulation.add(
            "beam", "brick", [0, 0, 0.5], friction={"static": 0.4, "dynamic": 0.1, "stribeck_velocity": 0.01}
        )
        self.assertEqual(simulation.bodies, ["brick", "second", "beam"])
        motion = simulation.body_motion("second")
        np.testing.assert_allclose(motion.position, [0.3, 0, 0.05], atol=1e-15)
        for name, value in fresh.items():
            np.testing.assert_allclose(getattr(motion, name), value, atol=1e-13)
        # Where the beam was, the brick falls on: to round-off.
        simulation.step_block(240)
        time = 240 / 48000
        fallen = before.position + before.velocity * time - np.array([0, 0, GRAVITY * time**2 / 2])
        np.testing.assert_allclose(simulation.body_motion("brick").position, fallen, atol=1e-12)
        touched = set()
        for _ in range(6000):
            simulation.step()
            touched |= {contact.between for contact in simulation.contacts}
        self.assertLessEqual({("brick", "floor"), ("second", "floor")}, touched)
        self.assertLessEqual(touched, {("brick", "floor"), ("second", "floor"), ("brick", "second")})
        energy = simulation.energy
        now = energy.total + energy.damping + energy.contact + energy.friction
        self.assertLess(abs(now - balance), ROUND_OFF * energy.kinetic)
        mass = DENSITY * np.prod(SIZES["brick"])
        self.assertLess(energy.added, mass * (0.5**2 + 2**2))  # the beam has taken its share away
        self.assertGreater(energy.friction, 0)
        self.assertEqual(len(simulation.step_block(3, force=True).force[0]), len(simulation.area))

    def test_of_a_simulation_keeps_no_memory_of_bodies_that_are_gone(self):
        simulation = self.simulation()
        pages, brick = [], simulation.kernels["brick"]
        for k in range(1100):
            simulation.remove(simulation.bodies[-1])
            simulation.add(f"brick {k}", brick, [0.2, 0, 0.1], velocity=[0, 0, 1])
            if k % 100 == 99:
                simulation.step_block(4)
                with open("/proc/self/statm") as memory:
                    pages.append(int(memory.read().split()[1]))
        self.assertLess(pages[-1] - pages[0], 256)  # 1 MB, of Python

    def test_of_a_simulation_refuses_mistakes_with_bodies(self):
        simulation = self.simulation()
        state = simulation.save()
        mistakes = {
            "the name is taken": lambda: simulation.add("beam", "brick", [0, 0, 1]),
            "bodies.floor: the name is taken": lambda: simulation.add("floor", "brick", [0, 0, 1]),
            "they overlap by 0.005 m": lambda: simulation.add("low", "brick", [1, 0, 0.005]),
            "there is no body 'none' whose kernel": lambda: simulation.add("new", "none", [0, 0, 1]),
            'there is no body "none": there are "beam", "brick"': lambda: simulation.remove("none"),
            'there is no body "x"': lambda: simulation.body_motion("x"),
            'no body "y"': lambda: simulation.mean_velocity("y"),
            'no body "z"': lambda: simulation.push("z"),
        }
        for message, mistake in mistakes.items():
            with self.assertRaises(ricochet.InputError) as refused:
                mistake()
            self.assertIn(message, str(refused.exception))
            self.assertNotIn("\n", str(refused.exception))
        self.assertEqual(simulation.bodies, ["beam", "brick"])
        simulation.restore(state)
        simulation.remove("brick")
        with self.assertRaisesRegex(ricochet.InputError, "state: is of another system"):
            simulation.restore(state)

    # Forces, bodies that come and go, and contact with friction: the calls of a live loop, with the step before
    # which each was made. Another process makes them again, and goes on from a state of the first one.
    def test_of_a_recorded_loop_are_the_same_in_another_process_to_the_last_bit(self):
        simulation = self.simulation()
        record = []

        def do(call, *arguments):
            record.append((simulation.steps, call, arguments))
            getattr(simulation, call)(*arguments)

        do("push_at", "brick", 0, [0.2, 0.1, 0])
        simulation.step_block(400)
        do("push_at", "brick", 0)
        do("push", "beam", [0, 0.3, 0], [0, 0, 0.01])
        do("add", "third", "brick", [0.3, 0, 0.0102])
        simulation.step_block(301)
        do("push_at", "third", 5, [0.05, 0, 0])
        do("remove", "beam")
        simulation.step()
        do("add", "fourth", "brick", [-0.2, 0, 0.05])
        touching = simulation.step_block(700).total_force
        state = simulation.save()
        simulation.step_block(300)
        stored = self.folder / "loop.pickle"
        stored.write_bytes(pickle.dumps((record, simulation.steps, state)))
        script = (
            SEEN
            + f"""
import pickle, sys, ricochet
record, last, state = pickle.load(open(sys.argv[1], "rb"))
scene = ricochet.Scene(sys.argv[2]).changed({{"loads.gravity": [0, 0, -{GRAVITY}]}})
simulation = ricochet.Simulation(scene, ricochet.kernels(scene, 1, sys.argv[3]))
for step, call, arguments in record:
    simulation.step_block(step - simulation.steps)
    getattr(simulation, call)(*arguments)
simulation.step_block(last - simulation.steps)
replayed = seen(simulation)
simulation.restore(state)
simulation.step_block(last - simulation.steps)
pickle.dump((replayed, seen(simulation)), sys.stdout.buffer)
"""
        )
        command = [sys.executable, "-c", script, stored, self.scene, self.out]
        other = subprocess.run(command, capture_output=True, check=True)
        replayed, restored = pickle.loads(other.stdout)
        self.assertGreater(touching.max(), 0)
        own = {}
        exec(SEEN, own)
        self.assertEqual(replayed, own["seen"](simulation))
        self.assertEqual(restored, replayed)

    def test_of_bodies_that_overlap_is_refused_with_the_depth(self):
        scene = ricochet.Scene(self.scene).changed({"bodies.brick.translate": [0.02, 0.004, 0.035]})
        with self.assertRaisesRegex(ricochet.InputError, "overlap by"):
            ricochet.kernels(scene, 1, self.out)
            ricochet.Simulation(scene)


if __name__ == "__main__":
    unittest.main()
