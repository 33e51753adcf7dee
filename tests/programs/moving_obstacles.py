# SPDX-License-Identifier: BSD-2-Clause
"""Obstacles of every shape that move, where results, pages, films and pictures show them. The oracle is the closed form of the motion,
p + v t + R(ω t) (x − p), with the rotations of SciPy. `moving_obstacles.py --keep FOLDER` keeps pictures of the page."""

import unittest

import h5py
import numpy as np
from scipy.spatial.transform import Rotation

import report_test
import scenes
from dimensions import dimensions_of
from glb_reader import Glb
from obstacles import box_facets, write_stl
from page_test import PageTest
from programs import Command, impact
from report_test import unpacked

from ricochet.pictures.loaded_result import LoadedResult
from ricochet.pictures.moving_surfaces import moving_surfaces
from ricochet.pictures.normal_axis import normal_axis
from ricochet.pictures.obstacles import shown_obstacles
from ricochet.pictures.snapshots import snapshots_picture

SINGLE = 1e-6  # some units in the last place of 32-bit numbers of about 4
END = 0.6
# Sizes, point [m], rotation at the start [degrees], velocity [m/s] and angular velocity [rad/s].
SHAPES = {
    "paddle": ('shape = "box"\nsize = [2.4, 2.4, 0.2]', (0.5, 0.6, -0.12), 0, (0, 0, 0.05), (0, 0, 3)),
    "ball": ('shape = "sphere"\nradius = 0.25', (2.4, 0, 0.4), 0, (0, 1, 0), (1, 2, 0)),
    "roller": (
        'shape = "cylinder"\nradius = 0.2\nlength = 0.8',
        (2.4, 1.4, 0.3),
        (90, 0, 0),
        (-1, 0, 0),
        (0, 5, 0),
    ),
    "pill": (
        'shape = "capsule"\nradius = 0.15\nlength = 0.4',
        (0.5, 2.6, 0.3),
        (0, 40, 0),
        (0, 0, 0),
        (0, 0, -9),
    ),
    "cone": (
        'shape = "cone"\nradius = 0.3\nlength = 0.6',
        (-1.4, 0.6, 0.3),
        (0, 90, 0),
        (0, 0, 1),
        (0, 0, 4),
    ),
    "ring": ('shape = "torus"\nradius = 0.3\nradius_small = 0.1', (-1.4, 2, 0.3), 0, (0.5, 0, 0), (6, 0, 0)),
    "tool": ('surface = "box.stl"', (0.5, -1.2, 0.3), (0, 0, 30), (0, -0.5, 0), (0, 7, 0)),
    "drum": ('shape = "sphere"\nside = "inside"\nradius = 6', (0.5, 0.6, 0.3), 0, (0, 0, 0.1), (0, 0, 1)),
    "still": ('shape = "sphere"\nradius = 0.2', (2.4, 2.6, 0.3), 0, (0, 0, 0), (0, 0, 0)),
    "floor": ("normal = [0, 0, 2]", (0.5, 0.6, -1), 0, (0.7, 0, -0.3), (0, 0, 0)),
}


def table_of(shape, point, rotation, velocity, spin):
    turned = [] if rotation == 0 else [f"rotate_deg = {list(rotation)}"]
    return "\n".join(
        [
            shape,
            f"point = {list(point)}",
            *turned,
            f"velocity = {list(velocity)}",
            f"angular_velocity = {list(spin)}",
        ]
    ).replace("\nangular_velocity = [0, 0, 0]", "")


def moved(name, places, t):
    """Where points (n,3) of an obstacle at t = 0 are at t; a half-space moves along its normal alone."""
    _, point, _, velocity, spin = SHAPES[name]
    if name == "floor":
        velocity = (0, 0, velocity[2])
    turn = Rotation.from_rotvec(np.array(spin) * t)
    return np.array(point) + np.array(velocity) * t + turn.apply(places - np.array(point))


class MovingObstacles(PageTest):
    """A block hovers until a paddle comes up and strikes it, among obstacles of all other shapes."""

    @classmethod
    def setUpClass(cls):
        cls.browser = report_test.shared_browser()
        cls.made = cls.shared_folder()
        (cls.made / "block.geo").write_text(scenes.skewed_block(1.2))
        write_stl(cls.made / "box.stl", box_facets((0.3, 0.4, 0.5)))
        block = 'mesh = "block.geo"\norder = 2\ncontact = "foot"\nmaterial = { density = 2.0, young = 30.0, poisson = 0.3 }'
        text = scenes.scene(
            {"block": block},
            "count = 10",
            "",
            f"rate_hz = 100\nduration = {END}",
            {name: table_of(*what) for name, what in SHAPES.items()},
            "Paddle",
            '[motion]\nrotation = "finite"\nsecond_run = false\n[output]\nview = true\nsnapshot_every = 2\n',
        )
        between = ", ".join(f'"{name}"' for name in ("block", *SHAPES))
        cls.scene = cls.made / "paddle.toml"
        cls.scene.write_text(text.replace(f"between = [{between}]", 'between = "all"'))
        cls.out = cls.made / "out"
        cls.ran = impact(cls.scene, cls.out)
        cls.result = cls.ran.path
        cls.path, cls.data = cls.write_page()

    def shown(self):
        """By name, as pictures show them."""
        return shown_obstacles(self.ran._file, self.ran.scene, np.zeros(3), np.ones(3))

    def test_the_result_has_their_poses_at_its_rows_and_at_its_snapshots(self):
        self.assertEqual(set(self.ran.obstacles), set(SHAPES) - {"still"})
        self.assertGreater(self.ran.summary["impulse_ns"], 0)
        scales = dimensions_of(self.result)
        with h5py.File(self.result) as file:
            for number, group in file["obstacles"].items():
                name = group.attrs["name"].decode()
                if name == "still":
                    self.assertNotIn("position", group)
                    continue
                _, point, rotation, _, spin = SHAPES[name]
                start = Rotation.from_euler("xyz", rotation or [0, 0, 0], degrees=True)
                for rows, below, time, scale in (
                    (61, "", self.ran.time, "/time"),
                    (31, "pose/", self.ran.snapshots["time"], "/snapshot"),
                ):
                    position, attitude = group[f"{below}position"][:], group[f"{below}attitude"][:]
                    self.assertEqual(
                        (len(time), position.shape, attitude.shape), (rows, (rows, 3), (rows, 4))
                    )
                    origin = group.attrs["translation"] if name == "floor" else np.array(point)
                    exact = np.array([moved(name, origin, t) for t in time]).reshape(-1, 3)
                    np.testing.assert_allclose(position, exact, rtol=0, atol=1e-12, err_msg=name)
                    turn = Rotation.from_quat(np.roll(attitude, -1, axis=1))
                    away = turn * (Rotation.from_rotvec(np.outer(time, spin)) * start).inv()
                    self.assertLess(away.magnitude().max(), 1e-12, name)
                    where = f"obstacles/{number}/{below}"
                    self.assertEqual(scales[f"{where}position"], [scale, "/component"])
                    self.assertEqual(scales[f"{where}attitude"], [scale, "/quaternion"])
                self.assertEqual("node" in group, name != "floor")
        rows = self.ran.obstacles["ball"]
        np.testing.assert_allclose(rows.position[-1], [2.4, END, 0.4], atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(rows.attitude, axis=1), 1, atol=1e-12)

    def test_the_film_shows_each_at_its_place(self):
        path = self.made / "paddle.glb"
        self.succeed(Command("export", self.result, "--gltf", path))
        film, time = Glb(path), self.ran.snapshots["time"]
        for name in SHAPES:
            number = film.number(name)
            (part,) = film.meshes[film.nodes[number]["mesh"]]["primitives"]
            own = film.array(part["attributes"]["POSITION"]).astype(float)
            at = film.extras["seconds_per_second"] * time
            turn = Rotation.from_quat(film.at(number, "rotation", at, [0, 0, 0, 1]))
            shift = film.at(number, "translation", at, None)
            found = np.array([turn[k].apply(own) + shift[k] for k in range(len(time))])
            for k, t in enumerate(time):
                np.testing.assert_allclose(
                    found[k], moved(name, found[0], t), rtol=0, atol=10 * SINGLE, err_msg=name
                )
            material = film.json["materials"][part["material"]]
            self.assertEqual(
                (material["alphaMode"], material["pbrMetallicRoughness"]["baseColorFactor"][3]),
                ("BLEND", 0.3),
            )
            self.assertEqual((number, "translation") in film.samplers, name not in ("still", "pill"))

    def test_the_page_shows_each_at_its_place_around_the_body(self):
        self.opened_at(1280, 800)
        self.keep("moving-obstacles-1280")
        start = {one["name"]: unpacked(one["node"]).astype(float) for one in self.data["motion"]["obstacles"]}
        self.assertEqual(set(start), set(SHAPES))
        for t in (0.1, 0.31, END):  # between two snapshots as well, because these motions are even
            found = dict(
                self.browser.evaluate(
                    f"shown.time = {t}, shown.show(), shown.motion.obstacles.map(one => [one.name, [...one.place]])"
                )
            )
            for name, place in found.items():
                exact = moved(name, start[name], t)
                place = np.reshape(place, (-1, 3))
                np.testing.assert_allclose(place, exact, rtol=0, atol=10 * SINGLE, err_msg=name)
        # The view is that of the body, however large an obstacle is.
        low, high = self.browser.evaluate("[shown.motion.box.low, shown.motion.box.high]")
        self.assertLess(np.max(np.array(high) - low), 3)

    def test_pictures_show_each_at_the_places_of_the_closed_form(self):
        time = self.ran.snapshots["time"]
        for name, obstacle in self.shown().items():
            for k in (0, 17, len(time) - 1):
                exact = moved(name, obstacle.at(0), time[k])
                np.testing.assert_allclose(obstacle.at(k), exact, rtol=0, atol=1e-12, err_msg=name)
        picture = snapshots_picture(
            LoadedResult(self.result), *moving_surfaces(LoadedResult(self.result), self.out)
        )
        behind = [
            ax.collections[0]
            for ax in picture.axes
            if len(ax.collections) > 1 and ax.collections[0].zorder == 0
        ]
        self.assertGreater(len(behind), 1)
        before, after = (
            np.concatenate([path.vertices for path in behind[cell].get_paths()]) for cell in (0, -1)
        )
        self.assertFalse(before.shape == after.shape and np.allclose(before, after))
        if report_test.KEEP:
            picture.savefig(report_test.KEEP / "moving-obstacles-snapshots.png")

    def test_places_start_where_the_surface_of_one_that_moves_was(self):
        masses = {"block": 1.0}
        for name, zero in (("still", "the still"), ("paddle", "where the surface of the paddle was")):
            axis = normal_axis(("block", name), np.array([0, 0, -1.0]), self.ran.scene, masses)
            self.assertEqual((axis.zero, axis.position), (zero, f"distance from the {name}"))
        scene = {"obstacles": {"belt": {"normal": [0, 0, 1], "velocity": [1, 0, 0]}}}
        self.assertEqual(
            normal_axis(("block", "belt"), np.array([0, 0, -1.0]), scene, masses).zero, "the belt"
        )


if __name__ == "__main__":
    unittest.main()
