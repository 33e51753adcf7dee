# SPDX-License-Identifier: BSD-2-Clause
"""A block that turns by any angle, from mesh to files: it falls on a floor with friction. Laws of mechanics, derivatives by finite
differences and rotations of SciPy compare what the result, its receivers, the motion for ParaView and a simulation say of one run."""

import functools
import unittest

import h5py
import numpy as np
import scipy.spatial.distance
from scipy.spatial.transform import Rotation

import ricochet
import scenes
from motion import read_xdmf
from programs import ProgramTest, contact, impact, kernel
from report_test import data_of, unpacked
from ricochet.pictures import figures
from ricochet.pictures.loaded_result import LoadedResult

DENSITY, YOUNG, GRAVITY = 2.0, 1e5, np.array([0.5, 0, -9.81])
RATE = 8000.0  # Hz
STEP = 1 / RATE  # s
EVERY = 20  # samples between frames
START, PLACE, CORNER = [35, -20, 40], [0.2, -0.3, 0.1], np.array([1.1, 0, 0])
TURN = Rotation.from_euler("xyz", START, degrees=True)
BODY = f"""
material = {{ density = {DENSITY}, young = {YOUNG}, poisson = 0.3 }}
damping = {{ ratio = 0.002 }}
rotate_deg = {START}
translate = {PLACE}
velocity = [0.7, 0.2, -1]
angular_velocity = [3, 2, 4]
""".strip()
MORE = f"""
[motion]
rotation = "finite"
[loads]
gravity = {list(GRAVITY)}
[output]
view = true
snapshot_every = 1
vtk_every = {EVERY}
[[output.receiver]]
name = "corner"
body = "block"
at = {list(TURN.apply(CORNER) + PLACE)}
"""
TIME = f"rate_hz = {RATE}\nduration = 0.8"
TEXT = scenes.block_on_floor("Turns", "count = 20", "friction = 0.4", TIME, BODY, MORE)
TEXT = TEXT.replace('contact = "foot"', 'contact = "all"')
# Derivatives at the middle of nine samples: the error is (ωh)⁸/630 of a wave of ω.
STENCIL = np.array([3, -32, 168, -672, 0, 672, -168, 32, -3]) / 840
SINGLE = 1e-6  # some units in the last place of 32-bit numbers, relative to the largest value
ROUND_OFF = 1e-11  # of 6400 steps, relative to the largest value


def rate_of(values, rows):
    """Derivative at rows of values (K,3) at each sample."""
    return sum(c * values[rows + j - 4] for j, c in enumerate(STENCIL)) * RATE


def turn_of(attitude):
    return Rotation.from_quat(np.roll(attitude, -1, axis=-1))


class Turns(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        (cls.made / "block.geo").write_text(scenes.skewed_block(0.8))
        cls.scene, cls.out = cls.made / "turns.toml", cls.made / "out"
        cls.scene.write_text(TEXT)
        cls.result = impact(cls.scene, cls.out)
        cls.body = cls.result.bodies["block"]
        (path,) = cls.out.glob("*.kernel.h5")
        with h5py.File(path) as file:
            cls.centre, cls.inertia = file["body/centre"][:], file["body/inertia"][:]
            cls.node, cls.shape = file["view/node"][:], file["view/shape"][:].astype(float)
            cls.flexibility = file["view/residual_flexibility"][:].astype(float)
            cls.point, cls.trace = file["surface/centroid"][:], file["surface/shape"][:]

    @functools.cached_property
    def flight(self):
        """Samples with free flight in the four samples before and after them and in two more before: forces act for up to two steps
        after the last point has opened."""
        pressed = np.zeros(len(self.result.time), bool)
        pressed[np.searchsorted(self.result.time, self.result.contact_time - STEP / 2)] = True
        rows = np.arange(7, len(pressed) - 4)
        return rows[[not pressed[k - 6 : k + 5].any() for k in rows]]

    @functools.cached_property
    def spin_momentum(self):
        """(K,3) angular momentum about the centre of mass, of the body as if rigid."""
        turn = turn_of(self.body.attitude)
        return turn.apply(turn.inv().apply(self.body.spin) @ self.inertia)

    @functools.cached_property
    def push(self):
        """(k,m,3) force on the block at each point in the rows of contact."""
        return -(self.result.force[:, :, None] * self.result.normal + self.result.tangential_force)

    @functools.cached_property
    def rows(self):
        """(k) samples at the ends of the steps of the rows of contact."""
        return np.searchsorted(self.result.time, self.result.contact_time - STEP / 2)

    @functools.cached_property
    def at_corner(self):
        """The node at the corner."""
        return np.argmin(np.linalg.norm(self.node - CORNER, axis=1))

    @functools.cached_property
    def deformation(self):
        """(K,V,3) displacements in body axes: of the modes, with the static part."""
        result = self.result
        bent = np.einsum("vjn,sn->svj", self.shape, result.snapshots["block"])
        with h5py.File(result.path) as file:
            static = {name: file[f"static/block/{name}"][:] for name in ("snapshot", "candidate", "force")}
        fields = self.flexibility.reshape(*self.flexibility.shape[:2], -1, 3)
        for k, candidate, force in zip(static["snapshot"], static["candidate"], static["force"]):
            bent[int(k)] += fields[:, :, int(candidate)] @ force
        return bent

    @functools.cached_property
    def places(self):
        """(K,V,3) of the nodes."""
        pose = self.result.poses["block"]
        arms = self.node - self.centre + self.deformation
        return pose.position[:, None] + np.einsum("sij,svj->svi", turn_of(pose.attitude).as_matrix(), arms)

    def near(self, found, wanted, share, scale=None):
        """Both agree within a share of the largest wanted value, or of `scale`."""
        scale = np.abs(wanted).max() if scale is None else scale
        np.testing.assert_allclose(found, wanted, rtol=0, atol=share * scale)

    def test_the_run_tumbles_with_touches_that_stick_and_slip_and_with_flights(self):
        turned = (turn_of(self.body.attitude[1:]) * turn_of(self.body.attitude[:-1]).inv()).magnitude().sum()
        self.assertGreater(turned, np.pi / 2)
        self.assertGreaterEqual(len(self.result.summary["touches"]), 2)
        self.assertGreater(len(self.flight), 1000)
        self.assertGreater(len(self.rows), 50)
        self.assertEqual(set(np.unique(self.result.state)), {0, 1, 2})
        self.assertEqual(self.result.summary["rotation"], "finite")

    def test_positions_and_attitudes_are_the_integrals_of_velocity_and_spin(self):
        body = self.body
        # Forces are constant in a step, so the trapezoidal rule is exact.
        moved = STEP * (body.velocity[1:] + body.velocity[:-1]) / 2
        self.near(np.diff(body.position, axis=0), moved, ROUND_OFF)
        self.near(np.linalg.norm(body.attitude, axis=1), 1, 1e-15 * 16)
        turn = turn_of(body.attitude)
        near = {j: turn[self.flight + j] * turn[self.flight].inv() for j in range(-4, 5)}
        spin = sum(c * near[j - 4].as_rotvec() for j, c in enumerate(STENCIL)) * RATE
        self.near(
            spin, body.spin[self.flight], 1e-6
        )  # turns of at most 2e-3 rad in a step of the free rotation
        # In a step with forces, the mean of the spins is off by the second order of the turn.
        turned = (turn[1:] * turn[:-1].inv()).as_rotvec() * RATE
        self.near(turned, (body.spin[1:] + body.spin[:-1]) / 2, 1e-5)

    def test_momentum_changes_by_weight_and_contact(self):
        body = self.body
        self.near(body.momentum, body.mass * body.velocity, ROUND_OFF)
        gained = np.tile(body.mass * GRAVITY * STEP, (len(self.result.time) - 1, 1))
        gained[self.rows - 1] += self.push.sum(axis=1) * STEP
        self.near(np.diff(body.momentum, axis=0), gained, ROUND_OFF)

    def test_the_points_that_press_lie_on_the_floor_and_on_the_block(self):
        contacts = self.result.contacts
        self.assertEqual(set(zip(contacts.a, contacts.b)), {("block", "floor")})
        self.assertTrue(((contacts.force > 0) | (contacts.state > 0)).all())
        np.testing.assert_array_equal(contacts.time, self.result.contact_time[contacts.row])
        np.testing.assert_allclose(contacts.normal, np.tile([0, 0, -1], (len(contacts), 1)), atol=ROUND_OFF)
        self.near(contacts.place[:, 2], contacts.gap, ROUND_OFF, 1)
        self.near(
            contacts.gap[contacts.state > 0], 0, 1e-7, 1
        )  # closed but for the square of the turn in a step
        sample = self.rows[contacts.row]
        modal = np.einsum("ejn,en->ej", self.trace[contacts.point], self.result.snapshots["block"][sample])
        arm = self.point[contacts.point] - self.centre + modal
        on_block = self.body.position[sample] + turn_of(self.body.attitude[sample]).apply(arm)
        self.near(contacts.place[:, :2], on_block[:, :2], ROUND_OFF, 1)
        # The static part moves them along the normal.
        static = self.deformation - np.einsum("vjn,sn->svj", self.shape, self.result.snapshots["block"])
        bound = np.linalg.norm(static, axis=2).max(axis=1)[sample] + ROUND_OFF
        self.assertLess(np.max(np.abs(contacts.place[:, 2] - on_block[:, 2]) / bound), 1)

    def test_the_arrays_by_point_hold_the_points_that_press(self):
        result, contacts = self.result, self.result.contacts
        at = contacts.row, contacts.point
        pressed = np.zeros(result.force.shape, bool)
        pressed[at] = True
        np.testing.assert_array_equal(np.isnan(result.gap), ~pressed)
        for name, others in (("force", 0), ("tangential_force", 0), ("state", 0), ("gap", np.nan)):
            np.testing.assert_array_equal(getattr(result, name)[at], getattr(contacts, name))
            np.testing.assert_array_equal(getattr(result, name)[~pressed], others)
        total = np.zeros(len(result.time))
        total[self.rows] = result.force.sum(axis=1)
        self.near(result.total_force, total, ROUND_OFF)

    def test_angular_momentum_changes_by_contact_alone(self):
        body, own = self.body, self.spin_momentum
        self.near(body.angular_momentum, np.cross(body.position, body.momentum) + own, ROUND_OFF)
        self.near(own[self.flight + 1], own[self.flight], ROUND_OFF)
        # Forces act in the middle of the step at their points, which the modes move.
        arm = self.point - self.centre + np.einsum("mjn,sn->smj", self.trace, self.result.snapshots["block"])
        turn = turn_of(body.attitude)
        half = Rotation.from_rotvec((turn[self.rows] * turn[self.rows - 1].inv()).as_rotvec() / 2)
        between = (half * turn[self.rows - 1]).as_matrix()
        gained = np.zeros_like(own[1:])
        arm = np.einsum("kij,kmj->kmi", between, arm[self.rows - 1])
        gained[self.rows - 1] = np.cross(arm, self.push).sum(axis=1) * STEP
        self.near(np.cumsum(gained, axis=0), own[1:] - own[0], 1e-5)  # the points vibrate within the step

    def test_energy_never_rises_and_holds_that_of_the_rigid_motion(self):
        energy, body = self.result.energy, self.body
        scale = energy["kinetic"].max()
        # What contact has taken it may give back, but never more: no touch begins with less energy than a later moment has.
        flown = self.flight[
            np.searchsorted(self.flight, np.arange(self.flight[0], len(body.velocity)), "right") - 1
        ]
        self.assertLess((energy["total"][self.flight[0] :] - energy["total"][flown]).max(), ROUND_OFF * scale)
        for name in ("damping", "contact", "friction"):
            self.assertGreater(energy[name].min(), -ROUND_OFF * scale)
        self.near(self.result.ledger, self.result.ledger[0], ROUND_OFF, scale)
        rigid = (body.mass * body.velocity**2 + self.spin_momentum * body.spin).sum(axis=1) / 2
        self.assertGreater((energy["kinetic"] - rigid).min(), -ROUND_OFF * scale)
        self.near(rigid[0], energy["kinetic"][0], ROUND_OFF)
        work = body.mass * (body.position - body.position[0]) @ GRAVITY
        self.near(energy["loads"], work, ROUND_OFF)
        self.near((rigid - work)[self.flight + 1], (rigid - work)[self.flight], ROUND_OFF)

    def test_receivers_move_with_their_node(self):
        corner, node = self.result.receivers["corner"], self.at_corner
        self.near(self.node[node], CORNER, ROUND_OFF)
        self.near(corner.point, TURN.apply(CORNER) + PLACE, ROUND_OFF)
        self.near(corner.displacement, self.places[:, node] - corner.point, SINGLE)
        self.near(corner.velocity[self.flight], rate_of(corner.displacement, self.flight), 1e-6)
        self.near(corner.acceleration[self.flight], rate_of(corner.velocity, self.flight), 1e-6)
        arm = turn_of(self.body.attitude).apply(CORNER - self.centre)
        vibration = corner.velocity - self.body.velocity - np.cross(self.body.spin, arm)
        self.assertGreater(np.abs(vibration[self.flight]).max(), 0.1)  # which the derivatives therefore test

    def test_the_motion_for_paraview_has_the_places_of_the_nodes(self):
        film, places = read_xdmf(self.out / "turns.motion.xdmf")["block"], self.places[::EVERY]
        np.testing.assert_allclose(film["time"], self.result.time[::EVERY], rtol=1e-12)
        self.near(film["position"], places, SINGLE)
        turn, deformation = turn_of(self.body.attitude[::EVERY]), self.deformation[::EVERY]
        bent = np.einsum("sij,svj->svi", turn.as_matrix(), deformation)
        self.near(film["deformation"], bent, SINGLE, np.abs(places).max())
        # Apart from its deformation, the block keeps its form.
        apart = scipy.spatial.distance.pdist
        for position, seen, own in zip(film["position"], film["deformation"], deformation):
            self.near(apart(position - seen), apart(self.node), SINGLE)
            self.near(apart(position), apart(self.node + own), SINGLE)
        corner = self.result.receivers["corner"].velocity[::EVERY]
        self.near(film["velocity"][:, self.at_corner], corner, SINGLE)

    def test_a_second_run_finds_when_motions_separate(self):
        self.assertIsNone(self.result.summary["separation_s"])  # it does not turn otherwise yet
        longer = TEXT.replace("duration = 0.8", "duration = 2")

        def run(name, text):
            scene = self.made / f"{name}.toml"
            scene.write_text(text)
            return impact(scene, self.made / name)

        motion = f"velocity = {[1.005 * v for v in (0.7, 0.2, -1)]}\nangular_velocity = {[1.005 * v for v in (3, 2, 4)]}"
        faster = longer.replace("velocity = [0.7, 0.2, -1]\nangular_velocity = [3, 2, 4]", motion)
        faster = faster.replace("duration = 2", f"duration = 2\ncontact_rate_hz = {2 * RATE}")
        alone = run("alone", longer.replace('"finite"', '"finite"\nsecond_run = false'))
        self.assertIsNone(alone.summary["separation_s"])
        one, two = alone.bodies["block"], run("faster", faster).bodies["block"]
        radius = np.linalg.norm(self.point - self.centre, axis=1).max()
        turn = (turn_of(one.attitude) * turn_of(two.attitude).inv()).magnitude()
        apart = np.linalg.norm(one.position - two.position, axis=1) + radius * turn
        # The way of a point that is as far from the centre as any
        speed = np.linalg.norm(one.velocity, axis=1) + radius * np.linalg.norm(one.spin, axis=1)
        result = run("longer", longer)
        rows = np.arange(0, len(apart), 8)[1:]  # both runs are compared at 2000 of 16 000 samples
        separate = (apart[rows] > radius / 2) & (apart[rows] > np.cumsum(speed[rows]) * 8 * STEP / 20)
        np.testing.assert_array_equal(result.bodies["block"].position, one.position)
        found = result.summary["separation_s"]
        self.assertLess(result.summary["touches"][1]["start_s"], found)
        self.assertAlmostEqual(found, result.time[rows[np.argmax(separate)]], delta=1e-9)
        self.assertTrue(any("moves otherwise from t = " in line for line in result.summary["warnings"]))

    def test_a_simulation_takes_the_same_steps_and_repeats_them(self):
        simulation, body = ricochet.Simulation(ricochet.Scene(self.scene)), self.body

        def seen():
            now = simulation.body_motion("block")
            own = now.position, now.attitude, now.spin, now.velocity
            return np.concatenate([*own, simulation.pickup_velocity])

        half = self.rows[len(self.rows) // 2]  # the block touches
        rows = [seen()]
        while simulation.steps < len(body.position) - 1:
            simulation.step()
            rows.append(seen())
            if simulation.steps == half:
                kept = simulation.save()
        rows = np.array(rows)
        np.testing.assert_array_equal(rows[:, :10], np.hstack([body.position, body.attitude, body.spin]))
        self.near(rows[:, 10:13], body.velocity, ROUND_OFF)
        # Pickups leave the static part out, which turns with the block.
        static = self.deformation[:, self.at_corner]
        static = static - self.result.snapshots["block"] @ self.shape[self.at_corner].T
        carried = np.cross(body.spin, turn_of(body.attitude).apply(static))
        self.assertGreater(np.abs(carried).max(), 1e-2)
        self.near(rows[:, 13:] + carried, self.result.receivers["corner"].velocity, SINGLE)
        simulation.restore(kept)
        again = [seen()]
        while simulation.steps < len(rows) - 1:
            simulation.step()
            again.append(seen())
        np.testing.assert_array_equal(again, rows[half:])


class Meeting(ProgramTest):
    """Two blocks that turn meet each other in flight."""

    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        (cls.made / "block.geo").write_text(scenes.skewed_block(0.8))
        common = f'mesh = "block.geo"\norder = 2\ncontact = "all"\nmaterial = {{ density = {DENSITY}, young = {YOUNG}, poisson = 0.3 }}\n'
        bodies = {
            "first": common
            + "rotate_deg = [20, -30, 10]\nvelocity = [2, 0, 0]\nangular_velocity = [3, 2, -4]",
            "second": common + "translate = [1.8, 0.2, 0.1]\nangular_velocity = [-1, 3, 2]",
        }
        more = '[motion]\nrotation = "finite"\n[output]\nview = true\nsnapshot_every = 1'
        text = scenes.scene(
            bodies,
            "count = 20",
            "friction = 0.3",
            f"rate_hz = {RATE}\nduration = 0.6",
            title="Meeting",
            more=more,
        )
        (cls.made / "meeting.toml").write_text(text)
        cls.result = impact(cls.made / "meeting.toml", cls.made / "out")
        cls.rows = np.searchsorted(cls.result.time, cls.result.contact_time - STEP / 2)

    @functools.cached_property
    def impulse(self):
        """(e,3) on the second body"""
        contacts = self.result.contacts
        return STEP * (contacts.force[:, None] * contacts.normal + contacts.tangential_force)

    def gains(self, values):
        """(K−1,3) sums over the points in each step"""
        out = np.zeros((len(self.result.time) - 1, 3))
        np.add.at(out, self.rows[self.result.contacts.row] - 1, values)
        return out

    def test_names_both_and_pushes_them_apart(self):
        contacts = self.result.contacts
        self.assertGreater(len(self.rows), 20)
        self.assertEqual(set(zip(contacts.a, contacts.b)), {("first", "second")})
        np.testing.assert_allclose(np.linalg.norm(contacts.normal, axis=1), 1, rtol=1e-12)
        for name, sign in (("first", -1), ("second", 1)):
            momentum = self.result.bodies[name].momentum
            found, wanted = np.cumsum(sign * self.gains(self.impulse), axis=0), momentum[1:] - momentum[0]
            np.testing.assert_allclose(found, wanted, rtol=0, atol=ROUND_OFF * np.abs(wanted).max())

    def test_places_have_the_arms_of_the_angular_momentum(self):
        contacts = self.result.contacts
        for name, sign, place in (
            ("first", -1, contacts.place),
            ("second", 1, contacts.place + contacts.gap[:, None] * contacts.normal),
        ):
            spin = self.result.bodies[name].angular_momentum
            found = np.cumsum(sign * self.gains(np.cross(place, self.impulse)), axis=0)
            wanted = spin[1:] - spin[0]
            # Forces act in the middle of the step, 6e-5 s before these places, and without the static part.
            np.testing.assert_allclose(found, wanted, rtol=0, atol=5e-3 * np.abs(wanted).max())

    def test_spikes_of_the_page_stand_where_the_bodies_touch(self):
        result, contacts = self.result, self.result.contacts
        motion = data_of(ricochet.report(result, self.made / "page.html"))["motion"]
        points, time = motion["points"], unpacked(motion["time"])
        offset, force = (unpacked(points[name]).astype(float) for name in ("offset", "force"))
        self.assertEqual(points["left_out"], 0)
        seen = 0
        for k, (first, stop) in enumerate(zip(points["first"], points["first"][1:])):
            some = np.flatnonzero(np.abs(contacts.time - time[k]) < STEP / 2)
            self.assertEqual(stop - first, len(some))
            seen += len(some)
            np.testing.assert_allclose(
                force[first:stop], contacts.force[some], atol=1e-4 * contacts.force.max()
            )
            for p, e in zip(range(first, stop), some):
                body, node = points["anchor"][p]
                poses = motion["bodies"][body]["poses"]
                turn = turn_of(unpacked(poses["turn"])[k].astype(float))
                start = unpacked(motion["bodies"][body]["node"])[node] + offset[p]
                found = unpacked(poses["position"])[k] + turn.apply(start - poses["centre"])
                np.testing.assert_allclose(found, contacts.place[e], atol=4 * SINGLE)
        self.assertGreater(seen, 20)

    def test_pictures_show_the_surfaces_where_they_meet(self):
        shown = LoadedResult(self.result.path)
        i = shown.strongest
        place, speed, *_ = shown.along_normal(i)
        (when, first), (_, second) = place["first"], place["second"]
        contacts = self.result.contacts
        here = contacts.point == i
        known = ~np.isnan(first)
        np.testing.assert_array_equal(when[known], contacts.time[here])
        self.assertLess(np.abs(first - second)[known].max(), contacts.gap[here].max() + 1e-12)
        drawn = dict(figures(shown, self.made / "out", lambda _: None))
        self.assertEqual(list(drawn), ["contact", "friction", "snapshots", "energy"])

    def test_a_low_pass_keeps_the_impulse(self):
        shown = LoadedResult(self.result.path, 2000)
        self.assertLess(shown.forces.values.max(), self.result.force.max())
        self.near_sum(shown.force.sum(), self.result.force.sum())
        self.near_sum(shown.forces.values.sum(), self.result.contacts.force.sum())

    def near_sum(self, found, wanted):
        self.assertLess(abs(found / wanted - 1), 0.02)  # the window moves some beyond the last row

    def test_entries_of_points_that_do_not_exist_are_refused(self):
        whole = self.result.path.read_bytes()
        copy = self.folder / "copy.result.h5"
        for name, value in (("point", -1), ("point", 1e9), ("point", 0.5), ("first", 7), ("first", 1e12)):
            copy.write_bytes(whole)
            with h5py.File(copy, "r+") as file:
                file[f"contact/{name}"][1] = value
                if name == "first":
                    file["contact/first"][0] = value
            with self.assertRaisesRegex(ricochet.InputError, "names contact points that do not exist"):
                ricochet.Result(copy).forces


class Refusals(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("block.geo", scenes.skewed_block(0.8))
        self.scene, self.out = self.write("turns.toml", TEXT), self.folder / "out"

    def test_of_damping_of_the_body_as_a_whole(self):
        damped = "bodies.block.damping={rayleigh=[2,0]}"
        self.succeed(kernel(self.scene, self.out, damped))
        words = "bodies.block.damping: damps the motion of the body as a whole", "Leave rayleigh's alpha out"
        self.refused(contact(self.scene, self.out, damped), "turns.toml", *words)
        simulated = ricochet.Scene(self.scene).changed({"bodies.block.damping": {"rayleigh": [2, 0]}})
        with self.assertRaisesRegex(ricochet.InputError, "rayleigh's alpha"):
            ricochet.Simulation(simulated)

    def test_of_a_support_that_leaves_motions(self):
        hinged = 'bodies.block.support.foot="z"'
        self.succeed(kernel(self.scene, self.out, hinged))
        at_rest = "bodies.block.velocity=[0,0,0]", "bodies.block.angular_velocity=[0,0,0]"
        self.refused(contact(self.scene, self.out, hinged, *at_rest), "supports leave it 3 rigid motions")


if __name__ == "__main__":
    unittest.main()
