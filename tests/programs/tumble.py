# SPDX-License-Identifier: BSD-2-Clause
"""Pictures and pages of a body with finite rotations: poses are added to the result of a part dropped on a floor, and where its
nodes then are is computed with the rotations of SciPy. `tumble.py --keep FOLDER` keeps pictures of the page."""

import functools
import unittest

import h5py
import matplotlib
import numpy as np
from page_test import PageTest
from page_view import DROP
from report_test import KEEP
from scipy.spatial.transform import Rotation

import ricochet
from ricochet.errors import InputError
from ricochet.pictures import figures
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.moving_surfaces import moving_surfaces
from ricochet.pictures.snapshots import drawn_path, touched
from ricochet.pictures.style import STYLE

QUARTER = 25  # snapshot at which the body has turned by 90° about y
SINGLE = 1e-6  # some units in the last place of 32-bit numbers, relative to the largest coordinate


def quaternions(rotations):
    """(s,4) w, x, y, z, every third with the other sign, which means the same rotation"""
    sign = np.where(np.arange(len(rotations)) % 3 == 0, -1, 1)
    return sign[:, None] * np.roll(rotations.as_quat(), 1, axis=1)


def tumbling(share, start):
    """Rotations at shares (s) of the run: one and a half turns about y, while the body rocks about x."""
    rock = Rotation.from_euler("x", 0.6 * np.sin(6 * np.pi * share))
    return Rotation.from_euler("y", 3 * np.pi * share) * rock * start


def path_of(share, start):
    """(s,3) centre of mass [m] at shares of the run: a throw of 0.3 m along x and 0.15 m up."""
    return start + np.stack([0.3 * share, 0 * share, 0.6 * share * (1 - share)], axis=1)


def make_tumble(result, kernel):
    """Adds poses to the file of a run of a free body and removes its rigid motion, and its contact for a while."""
    with h5py.File(result, "r+") as file, h5py.File(kernel) as of_body:
        body, snapshots = file["bodies/bracket"], file["snapshots"]
        start = Rotation.from_matrix(body.attrs["rotation"].reshape(3, 3))
        centre = start.apply(of_body["body/centre"][:]) + body.attrs["translation"]
        time, end = file["time"][:], file["time"][-1]
        for group, when in (("pose/bracket", snapshots["time"][:]), ("bodies/bracket", time)):
            file.require_group(group)["position"] = path_of(when / end, centre)
            file[group]["attitude"] = quaternions(tumbling(when / end, start))
        body["spin"] = np.tile([0, 3 * np.pi / end, 0], (len(time), 1))
        snapshots["bracket"][:, of_body["modes/angular_frequency"][:] == 0] = 0
        contact, rows = file["contact"], file["contact/time"][:]
        for name, data in contact.items():
            if data.shape[0] == len(rows):
                values = data[(rows < 0.1 * end) | (rows > 0.4 * end)]
                del contact[name]
                contact[name] = values


class Tumble(PageTest):
    SCENE, SETS = "bracket", DROP

    @classmethod
    def write_page(cls):
        (kernel,) = cls.out.glob("bracket-*.kernel.h5")
        make_tumble(cls.result, kernel)
        return super().write_page()

    @functools.cached_property
    def exact(self):
        """Times (s); centre (s,3) and rotation (s) of the body; arms (V,3) from the centre of mass to its nodes and displacements
        (s,V,3) of the nodes by deformation, both in its own axes."""
        with h5py.File(self.result) as file:
            pose = file["pose/bracket"]
            q, time = file["snapshots/bracket"][:], file["snapshots/time"][:]
            static = {name: data[:] for name, data in file["static/bracket"].items()}
            with h5py.File(self.out / file["bodies/bracket"].attrs["kernel"].decode()) as kernel:
                arm = kernel["view/node"][:] - kernel["body/centre"][:]
                fields = kernel["view/residual_flexibility"][:].astype(float)
                bent = np.einsum("vjn,sn->svj", kernel["view/shape"][:].astype(float), q)
            for k, candidate, force in zip(static["snapshot"], static["candidate"], static["force"]):
                bent[int(k)] += fields.reshape(*fields.shape[:3], -1)[:, :, int(candidate)] @ force
            turn = Rotation.from_quat(np.roll(pose["attitude"][:], -1, axis=1))
            return time, pose["position"][:], turn, arm, bent

    def place(self, k, amplify):
        _, position, turn, arm, bent = self.exact
        return position[k] + turn[k].apply(arm + amplify * bent[k])

    def surfaces(self):
        surfaces, _ = moving_surfaces(LoadedResult(self.result), self.out)
        return surfaces

    def drawn(self, k, f, amplify):
        """(V,3) places on the page."""
        place = self.browser.evaluate(
            f"shown.motion.placeBodies({k}, {f}, {amplify}), [...shown.motion.bodies[0].place]"
        )
        return np.reshape(place, (-1, 3))

    def test_a_quarter_turn_takes_each_node_where_it_belongs_and_keeps_the_form(self):
        surface, (_, position, _, arm, _) = self.surfaces()["bracket"], self.exact
        start = self.place(0, 0) - position[0]
        turned = position[QUARTER] + np.stack([start[:, 2], start[:, 1], -start[:, 0]], axis=1)
        size = np.linalg.norm(np.ptp(arm, axis=0))
        self.opened_at(900, 600)
        for found in (surface.at(QUARTER, 0), self.drawn(QUARTER, 0, 0)):
            np.testing.assert_allclose(found, turned, rtol=0, atol=SINGLE * np.abs(turned).max())
            some = found[:: len(found) // 50]
            apart = np.linalg.norm(some[:, None] - some, axis=2)
            wanted = np.linalg.norm((arm[:: len(arm) // 50])[:, None] - arm[:: len(arm) // 50], axis=2)
            np.testing.assert_allclose(apart, wanted, rtol=0, atol=SINGLE * size)

    def test_deformation_is_amplified_in_the_axes_of_the_body(self):
        surface, (time, _, turn, _, bent) = self.surfaces()["bracket"], self.exact
        largest, missed = np.linalg.norm(bent, axis=2).max(), self.data["motion"]["missed"]
        self.opened_at(900, 600)
        for k in (0, 11, QUARTER, 90, len(time) - 1):
            for amplify in (1, 100):
                exact = self.place(k, amplify)
                bound = SINGLE + 1e-4 * amplify * largest
                np.testing.assert_allclose(surface.at(k, amplify), exact, rtol=0, atol=bound)
                bound += amplify * largest * (missed + 1e-3)  # 15 bits of each of a few shapes
                np.testing.assert_allclose(self.drawn(k, 0, amplify), exact, rtol=0, atol=bound)
        self.assertLess(
            10 * bound, amplify * np.abs(bent[QUARTER] - turn[QUARTER].apply(bent[QUARTER])).max()
        )

    def test_between_moments_the_body_turns_evenly_and_the_speed_is_that_of_its_nodes(self):
        time, position, turn, arm, bent = self.exact
        self.opened_at(900, 600)
        k, f, dt = 41, 0.3, time[42] - time[41]  # the signs of the two quaternions differ
        spin = (turn[k + 1] * turn[k].inv()).as_rotvec()
        now = Rotation.from_rotvec(f * spin) * turn[k]
        exact = position[k] + f * (position[k + 1] - position[k]) + now.apply(arm)
        np.testing.assert_allclose(self.drawn(k, f, 0), exact, rtol=0, atol=SINGLE * np.abs(exact).max())
        arms = now.apply(arm)
        velocity = (position[k + 1] - position[k] + np.cross(spin, arms)) / dt
        velocity += now.apply((bent[k + 1] - bent[k]) / dt)
        moved = self.place(k, 1) - self.place(0, 1)
        wanted = {"speed": velocity, "displacement": moved, "deformation": bent[k]}
        for (colour, values), share in zip(wanted.items(), (f, 0, 0)):
            found = self.browser.evaluate(
                f"""(() => {{ const {{motion}} = shown; motion.colour = "{colour}";
              motion.measure(motion.bodies[0], {k}, {share}, {dt}); return [...motion.bodies[0].value]; }})()"""
            )
            size = np.linalg.norm(values, axis=1)
            np.testing.assert_allclose(found, size, rtol=0, atol=2e-3 * size.max(), err_msg=colour)

    def test_forces_stay_at_the_points_that_they_press_on(self):
        result, (time, position, turn, *_) = LoadedResult(self.result), self.exact
        k = int(np.argmin(np.abs(time - 0.45 * time[-1])))  # of the second touch
        row = int(np.argmin(np.abs(result.contact_time - time[k])))
        pressed = np.flatnonzero(result.force[row])
        self.assertGreater(len(pressed), 0)
        start = Rotation.from_matrix(result.bodies["bracket"].rotation)
        exact = position[k] + (turn[k] * start.inv()).apply(result.point_a[pressed] - position[0])
        carried = touched(result, self.surfaces(), k, result.episodes[0])
        away = np.linalg.norm(carried[:, None] - exact, axis=2).min(axis=0)
        self.assertLess(away.max(), SINGLE)
        self.opened_at(900, 600)
        self.drawn(k, 0, 0)
        for offset in (0, 0.01):  # of points from their nodes [m]
            spikes = self.browser.evaluate(
                f"""shown.motion.points.offset = shown.motion.points.offset.map(x => x + {offset}),
              shown.motion.makeSpikes({k}), [...shown.motion.spikes.place]"""
            )
            base = np.reshape(spikes, (-1, 2, 5, 3))[:, 0, :4].mean(axis=1)
            aside = (turn[k] * start.inv()).apply(np.full(3, offset))
            np.testing.assert_allclose(base, exact + aside, rtol=0, atol=SINGLE)

    def test_the_body_stays_in_the_picture_while_it_tumbles(self):
        time = self.exact[0]
        self.opened_at(900, 600)
        self.assertTrue(
            self.browser.evaluate("shown.motion.obstacles[0].visible = false, shown.motion.turning")
        )
        for part in ("contact", "whole"):
            self.browser.evaluate(
                f"""(() => {{ const part = document.querySelector('[aria-label="Part of the run"]');
              part.value = "{part}"; part.dispatchEvent(new Event("change")); }})()"""
            )
            window, low, high = self.browser.evaluate(
                "[shown.window, shown.motion.box.low, shown.motion.box.high]"
            )
            during = np.flatnonzero((time >= window[0] - 1e-9) & (time <= window[1] - 1e-9))
            places = np.concatenate([self.place(k, 0) for k in during])
            self.assertTrue(
                (places > np.array(low) - SINGLE).all() and (places < np.array(high) + SINGLE).all()
            )
            for k in during[::15]:
                self.browser.evaluate(f"shown.motion.arrows = false, shown.time = {time[k]}, shown.show()")
                seen = self.pixels()[..., 3] > 0
                self.assertGreater(seen.mean(), 2e-3, (part, k))
                self.assertFalse(seen[[0, -1]].any() or seen[:, [0, -1]].any(), (part, k))
        self.assertIn("even turns", self.browser.evaluate("shown.remark.textContent"))

    def test_the_page_shows_the_tumble(self):
        time = self.exact[0]
        self.opened_at(1280, 900)
        self.keep("tumble")
        for k in (0, QUARTER, 75, 110, 150):
            self.browser.evaluate(f"shown.time = {time[k]}, shown.show()")
            self.keep(f"tumble-{k}")
        self.assertLess(self.path.stat().st_size, 1 << 20)

    def test_pictures_are_taken_after_equal_motions(self):
        history, surfaces = LoadedResult(self.result), self.surfaces()
        some = np.array([0, 3, QUARTER, 70, 150])
        path, places = drawn_path(surfaces, some, 0), [self.place(k, 0) for k in some]
        for one in range(len(some)):
            for other in range(one):
                apart = np.sqrt(((places[one] - places[other]) ** 2).sum(axis=1).mean())
                self.assertAlmostEqual(np.linalg.norm(path[one] - path[other]), apart, delta=SINGLE)
        with matplotlib.rc_context(STYLE):
            figure = dict(figures(history, self.out, lambda _: None))["snapshots"]
        pictures = [ax for ax in figure.axes if not ax.axison]  # the panels of forces have axes
        self.assertEqual(len(pictures), 9)
        if KEEP:
            KEEP.mkdir(parents=True, exist_ok=True)
            figure.savefig(KEEP / "tumble-snapshots.png", dpi=100)

    def test_results_have_the_poses(self):
        result = ricochet.Result(self.result)
        time, position, turn, *_ = self.exact
        body, pose = result.bodies["bracket"], result.poses["bracket"]
        self.assertTrue(body.has_pose)
        shapes = [data.shape for data in (body.position, body.attitude, body.spin)]
        self.assertEqual(shapes, [(len(result.time), 3), (len(result.time), 4), (len(result.time), 3)])
        np.testing.assert_array_equal(pose.position, position)
        np.testing.assert_allclose(np.abs(np.sum(pose.attitude * quaternions(turn), axis=1)), 1, rtol=1e-12)
        every = round(len(result.time) / len(time))
        np.testing.assert_allclose(body.position[::every], pose.position, atol=1e-12)


class Linear(PageTest):
    SCENE, SETS = "bracket", [*DROP, "time.duration=2e-5"]

    def test_rotations_have_no_poses(self):
        result = ricochet.Result(self.result)
        body = result.bodies["bracket"]
        self.assertEqual((body.has_pose, result.poses), (False, {}))
        for name in ("position", "attitude", "spin"):
            with self.assertRaisesRegex(InputError, f'has no {name}.*motion.rotation = "finite"'):
                getattr(body, name)
        self.assertNotIn("poses", self.data["motion"]["bodies"][0])

    def test_attitudes_that_are_no_rotations_are_refused_in_one_line(self):
        with h5py.File(self.result, "r+") as file:
            count = len(file["snapshots/time"])
            file["pose/bracket/position"] = np.zeros((count, 3))
            file["pose/bracket/attitude"] = np.full((count, 4), 0.6)
        with self.assertRaisesRegex(InputError, '"/pose/bracket/attitude" holds other than unit quaternions'):
            moving_surfaces(LoadedResult(self.result), self.out)
        with h5py.File(self.result, "r+") as file:
            del file["pose"]


if __name__ == "__main__":
    unittest.main()
