# SPDX-License-Identifier: BSD-2-Clause
"""Films of runs as binary glTF. The files are decoded by glb_reader.py, and compared with the result and its
kernels, which are read with h5py; rotations are those of SciPy. If the npm package gltf-validator is installed, Khronos's own
validator reads them, too."""

import json
import shutil
import subprocess
import unittest
from unittest import mock

import h5py
import numpy as np
import scenes
from glb_reader import Glb
from programs import Command, ProgramTest, contact, kernel
from scipy.spatial.transform import Rotation

SINGLE = 1e-6  # some units in the last place of 32-bit numbers
VALIDATOR = """
const validator = require("gltf-validator"), fs = require("fs");
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])), {maxIssues: 20})
  .then(report => console.log(JSON.stringify(report.issues)));
"""


def response(file, kernel, body, of="/view"):
    """(s,V,c) displacement, or stress, at the snapshots by elastic modes and static response, and by rigid modes."""
    shape, q = kernel[f"{of}/shape"][:].astype(float), file[f"snapshots/{body}"][:]
    rigid = kernel["modes/angular_frequency"][:] == 0
    elastic = np.einsum("vcn,sn->svc", shape[:, :, ~rigid], q[:, ~rigid])
    static = file[f"static/{body}"]
    flexibility = kernel[f"{of}/residual_flexibility"][:].astype(float)
    forces = static["force"][:]
    flexibility = flexibility.reshape(*flexibility.shape[:2], -1, forces.shape[1])
    for row, candidate, force in zip(
        static["snapshot"][:].astype(int), static["candidate"][:].astype(int), forces
    ):
        elastic[row] += flexibility[:, :, candidate] @ force
    return elastic, np.einsum("vcn,sn->svc", shape[:, :, rigid], q[:, rigid])


def exact_places(path, body, magnify):
    """(s) times and (s,V,3) places of the nodes of the visualisation surface, from the files of a run, and the displacement that is
    magnified."""
    with h5py.File(path) as file:
        group = file[f"bodies/{body}"].attrs
        with h5py.File(path.parent / group["kernel"].decode()) as kernel:
            elastic, rigid = response(file, kernel, body)
            node, centre = kernel["view/node"][:], kernel["body/centre"][:]
        moved = node + rigid + magnify * elastic
        if f"pose/{body}" in file:
            pose = file[f"pose/{body}"]
            turn = Rotation.from_quat(np.roll(pose["attitude"][:], -1, axis=1)).as_matrix()
            places = np.einsum("sij,svj->svi", turn, moved - centre) + pose["position"][:][:, None]
        else:
            places = moved @ group["rotation"].reshape(3, 3).T + group["translation"]
        return file["snapshots/time"][:], places, elastic


def exact_forces(path):
    """(s) times, and for each snapshot the sum of the forces on the block [N], and their number, from the rows of the contact."""
    with h5py.File(path) as file:
        time, rows, contact = file["snapshots/time"][:], file["contact/time"][:], file["contact"]
        forces = [[] for _ in time]
        at = {round(float(t), 9): k for k, t in enumerate(time)}
        for k, row in enumerate(rows):
            if (snapshot := at.get(round(float(row), 9))) is None:
                continue
            if "first" in contact:
                first = contact["first"][:].astype(int).tolist() + [len(contact["force"])]
                some = slice(first[k], first[k + 1])
                size, normal = contact["force"][some], contact["normal_now"][some]
                tangential = contact["tangential_force"][some]
            else:
                some = np.flatnonzero(contact["force"][k])
                size, normal = contact["force"][k][some], contact["normal"][some]
                tangential = contact["tangential_force"][k][some]
            forces[snapshot] = -(size[:, None] * normal + tangential)[size > 0]
    return time, [np.reshape(one, (-1, 3)) for one in forces]


def is_between(found, exact, error):
    """Whether the largest distance of places is within the error that the film states, but for roundings."""
    return np.linalg.norm(found - exact, axis=2).max() <= error + SINGLE * np.abs(exact).max()


class Films(ProgramTest):
    """A block that slides over a floor with friction, under linear and finite rotations."""

    @classmethod
    def setUpClass(cls):
        cls.out = cls.shared_folder()
        (cls.out / "block.geo").write_text(scenes.skewed_block(0.5))
        body = "material = { density = 2.0, young = 3.0, poisson = 0.3 }\nvelocity = [0.002, 0, -0.02]\nrotate_deg = [10, 0, 90]"
        more = "[output]\nview = true\nstress = true\nsnapshot_every = 5\n"
        floor = "gap = 1e-4\nfriction = 0.3"
        scene = scenes.block_on_floor(
            "Slide", "count = 20", floor, "rate_hz = 400\nduration = 2.0", body, more
        )
        cls.scene = cls.out / "slide.toml"
        cls.scene.write_text(scene)
        assert kernel(cls.scene, cls.out).status == 0
        cls.results = {}
        for rotation in ("linear", "finite"):
            done = contact(cls.scene, cls.out, f"motion.rotation={rotation}", f"title={rotation}")
            assert done.status == 0, done.err
            cls.results[rotation] = cls.out / f"{rotation}.result.h5"

    def film(self, result, *more):
        """The film of a result with these options, and what the command prints."""
        path = self.folder / "film.glb"
        done = self.succeed(Command("export", result, "--gltf", path, *more))
        self.assertEqual(done.out.splitlines()[0], str(path))
        return Glb(path), done

    def test_places_are_those_of_the_snapshots_within_the_stated_error(self):
        for (rotation, result), magnify in zip(self.results.items(), (3.0, 1.0)):
            film, done = self.film(result, "--magnify", magnify, "--slow", 4)
            extras = film.extras
            self.assertEqual((extras["magnification"], extras["seconds_per_second"]), (magnify, 4))
            time, exact, _ = exact_places(result, "block", magnify)
            found = film.places("block", 4 * time)
            error = extras["error_m"]["block"]
            self.assertTrue(is_between(found, exact, error), rotation)
            # The error is small, and stated: some of the shapes are needed.
            deformed = exact - exact_places(result, "block", 0.0)[1]
            self.assertLess(error, 0.02 * np.linalg.norm(deformed, axis=2).max())
            self.assertRegex(done.out, r"shapes: \d+, which miss at most")
            self.assertFalse(is_between(exact_places(result, "block", 0.0)[1], exact, error))
            turns = (film.number("block"), "rotation") in film.samplers
            self.assertEqual(turns, rotation == "finite")

    def test_fewer_shapes_have_a_larger_error_which_is_true_and_warned_of(self):
        result = self.results["linear"]
        film, done = self.film(result, "--magnify", 100, "--targets", 1)
        time, exact, _ = exact_places(result, "block", 100)
        found = film.places("block", time * film.extras["seconds_per_second"])
        largest = np.linalg.norm(found - exact, axis=2).max()
        self.assertAlmostEqual(film.extras["error_m"]["block"] / largest, 1, delta=1e-3)  # single precision
        self.assertIn("warning: the shapes of block miss up to", done.err)
        self.assertEqual(len(film.meshes[film.nodes[film.number("block")]["mesh"]]["weights"]), 1)

    def test_the_film_lasts_up_to_ten_seconds_and_the_floor_is_below(self):
        film, done = self.film(self.results["finite"])
        self.assertEqual(film.extras["seconds_per_second"], 5)  # 2 s
        self.assertIn("10 s, 5 times as slow as the run, 161 snapshots", done.out)
        up = Rotation.from_quat(film.nodes[0]["rotation"]).apply([0, 0, 1])  # the normal of the floor
        np.testing.assert_allclose(up, [0, 1, 0], atol=1e-6)
        floor = film.nodes[film.number("floor")]
        self.assertAlmostEqual(floor["translation"][2], 0, delta=1e-7)

    def test_arrows_are_proportional_to_the_forces_and_vanish_with_them(self):
        for rotation, result in self.results.items():
            film, _ = self.film(result, "--magnify", 1)
            arrows = [k for k, node in enumerate(film.nodes) if node["name"].startswith("force on block")]
            time, exact = exact_forces(result)
            self.assertGreater(sum(map(len, exact)), 20)
            at = time * film.extras["seconds_per_second"]
            sizes = np.stack([film.at(k, "scale", at, [1, 1, 1])[:, 0] for k in arrows], axis=1)
            turns = [Rotation.from_quat(film.at(k, "rotation", at, [0, 0, 0, 1])) for k in arrows]
            vectors = sizes[:, :, None] * np.stack([turn.apply([0, 1, 0]) for turn in turns], axis=1)
            largest = max(np.linalg.norm(one, axis=1).max() for one in exact if len(one))
            for found, forces in zip(film.extras["newton_per_metre"] * vectors, exact):
                some = found[np.linalg.norm(found, axis=1) > SINGLE * largest]
                self.assertEqual(len(some), len(forces), rotation)
                order, other = (one[np.lexsort(np.round(one / largest, 4).T)] for one in (some, forces))
                np.testing.assert_allclose(order, other, atol=10 * SINGLE * largest)
            # They stand where the block touches the floor. With linear rotations, a point moves with the nearest vertex, while
            # the block tilts by 0.02; patches reach as far as 0.15 from their node.
            k = int(sizes.sum(axis=1).argmax())
            for number, size in zip(arrows, sizes[k]):
                if size > 0:
                    height = abs(film.at(number, "translation", at[[k]], None)[0, 2])
                    self.assertLess(height, 4e-3 if rotation == "linear" else 10 * SINGLE)

    def test_colours_are_those_of_the_field_at_each_snapshot(self):
        result = self.results["finite"]
        time, places, elastic = exact_places(result, "block", 1.0)
        with h5py.File(result) as file, h5py.File(self.one(self.out)) as of_body:
            stress = response(file, of_body, "block", "/view/stress")[0]
            largest_stress = file["stress/block/von_mises"][:]
        tensor = stress[..., [[0, 5, 4], [5, 1, 3], [4, 3, 2]]]
        deviator = tensor - np.trace(tensor, axis1=2, axis2=3)[..., None, None] / 3 * np.eye(3)
        before, after = np.r_[0, : len(time) - 1], np.r_[1 : len(time), len(time) - 1]
        between = (time[after] - time[before])[:, None]
        exact = {
            "motion": np.linalg.norm(elastic, axis=2),
            "speed": np.linalg.norm(places[after] - places[before], axis=2) / between,
            "stress": np.sqrt(1.5 * (deviator**2).sum(axis=(2, 3))),
        }
        units = {"motion": "m", "speed": "m/s", "stress": "Pa"}
        for what, field in exact.items():
            film, done = self.film(result, "--colour", what, "--targets", 40)
            scale = film.extras["colour"]
            self.assertEqual((scale["unit"], scale["range"][0]), (units[what], 0))
            top = scale["range"][1]
            low, high = map(np.array, scale["linear_rgb"])
            number, at = film.number("block"), time * film.extras["seconds_per_second"]
            share = (film.fields(number, "COLOR_0", at) - low) @ (high - low) / ((high - low) @ (high - low))
            error = scale["error"]["block"]
            self.assertLess(error, 0.05 * top)
            # Fields of kernels with stress are in single precision.
            largest = np.abs(top * share - np.minimum(field, top)).max()
            self.assertAlmostEqual(largest / error, 1, delta=0.01, msg=what)
            mesh = film.meshes[film.nodes[number]["mesh"]]
            colour = film.array(mesh["primitives"][0]["attributes"]["COLOR_0"])
            at_most = largest_stress if what == "stress" else field.max(axis=0)
            start = (colour - low) @ (high - low) / ((high - low) @ (high - low))
            np.testing.assert_allclose(start, np.minimum(at_most / top, 1), atol=1e-4, err_msg=what)
            self.assertRegex(done.out, r"fields of colour: \d+, which miss at most")
            # Shapes remain as they are.
            self.assertTrue(
                is_between(
                    film.places("block", at),
                    exact_places(result, "block", film.extras["magnification"])[1],
                    film.extras["error_m"]["block"],
                )
            )

    def test_bodies_at_rest_have_the_snapshot_of_their_equilibrium(self):
        more = "[loads]\ngravity = [0, 0, -0.01]\n[output]\nview = true\nsnapshot_every = 1\n"
        text = scenes.block_on_floor("Rest", "count = 6", 'scheme = "static"', "duration = 1.0", "", more)
        shutil.copy(self.out / "block.geo", self.folder)
        scene = self.write("rest.toml", text)
        self.succeed(kernel(scene, self.folder))
        self.succeed(contact(scene, self.folder))
        result = self.folder / "rest.result.h5"
        film, done = self.film(result, "--magnify", 10)
        self.assertIn("one snapshot, without motion", done.out)
        self.assertNotIn("animations", film.json)
        with h5py.File(self.one(self.folder)) as file:
            node = file["view/node"][:]
        # The block, whose height is 0.7, is pressed by 2 · 0.01 · 0.7 / 2 Pa in the mean, with E = 3 Pa.
        moved = film.places("block", [0])[0][:, 2] - node[:, 2]
        foot, top = (np.abs(node[:, 2] - height) < 1e-6 for height in (0, 0.7))
        lower = moved[foot].mean() - moved[top].mean()
        self.assertAlmostEqual(lower / (10 * 0.7 * 0.007 / 3), 1, delta=0.1)  # a mean over a rough foot
        self.refused(
            Command("export", result, "--gltf", "--colour", "speed"), "has one snapshot", "needs two"
        )

    def test_a_body_that_flies_without_deformation_needs_no_shapes(self):
        self.succeed(
            contact(
                self.scene,
                self.out,
                "motion.rotation=finite",
                "contact.gap=1",
                "time.duration=0.5",
                "title=miss",
            )
        )
        film, done = self.film(self.out / "miss.result.h5", "--colour", "speed")
        self.assertIn("none, as no snapshot has a contact force", done.out)
        self.assertEqual([node["name"] for node in film.nodes], ["miss", "floor", "block"])
        number = film.number("block")
        self.assertNotIn("targets", film.meshes[film.nodes[number]["mesh"]]["primitives"][0])
        speed = np.hypot(0.002, 0.02)
        self.assertAlmostEqual(film.extras["colour"]["range"][1] / speed, 1, delta=1e-9)
        shift = film.samplers[number, "translation"][1]
        np.testing.assert_allclose(shift[-1] - shift[0], 0.5 * np.array([0.002, 0, -0.02]), atol=SINGLE)

    def test_long_runs_have_some_snapshots_and_the_strongest_points_arrows(self):
        """Of 161 snapshots every fourth one, and of 7 points 3."""
        with mock.patch("ricochet.films.film.MOMENTS", 50), mock.patch("ricochet.films.arrows.MOST", 3):
            film, done = self.film(self.results["finite"], "--magnify", 1)
        self.assertIn("41 of 161 snapshots", done.out)
        time, exact, _ = exact_places(self.results["finite"], "block", 1.0)
        shown = film.samplers[film.number("block"), "translation"][0] / film.extras["seconds_per_second"]
        np.testing.assert_allclose(shown, time[::4], atol=1e-6)
        found = film.places("block", time[::4] * film.extras["seconds_per_second"])
        self.assertTrue(is_between(found, exact[::4], film.extras["error_m"]["block"]))
        with h5py.File(self.results["finite"]) as file:
            point, force = file["contact/point"][:].astype(int), file["contact/force"][:]
        impulse = np.bincount(point, force)
        strongest = np.sort(np.argsort(impulse)[-3:])
        names = sorted(node["name"] for node in film.nodes if "force" in node["name"])
        self.assertEqual(names, sorted(f"force on block at point {k}" for k in strongest))
        share = 100 * (1 - impulse[strongest].sum() / impulse.sum())
        self.assertIn(f"points without one have {share:.2g} % of the impulse", done.out)

    def test_rods_are_tubes_around_their_nodes(self):
        (self.folder / "rod.geo").write_text(scenes.rod(1, 20))
        text = scenes.two_rods(
            "Rods",
            "count = 20",
            "rate_hz = 200\nduration = 2.5",
            more="[output]\nview = true\nsnapshot_every = 5\n",
        )
        scene = self.write("rods.toml", text)
        self.succeed(kernel(scene, self.folder))
        self.succeed(contact(scene, self.folder))
        result = self.folder / "rods.result.h5"
        film, _ = self.film(result, "--targets", 30, "--magnify", 2)
        for name in ("moving", "resting"):
            time, exact, _ = exact_places(result, name, 2)
            found = film.places(name, time * film.extras["seconds_per_second"])
            rings = found.reshape(len(time), exact.shape[1], -1, 3)
            self.assertTrue(is_between(rings.mean(axis=2), exact, film.extras["error_m"][name]))
            radius = np.linalg.norm((rings - rings.mean(axis=2, keepdims=True))[..., 1:], axis=3)
            np.testing.assert_allclose(radius, np.sqrt(1 / np.pi), rtol=SINGLE)  # of 1 m²
        glass = {
            made["name"]: made["pbrMetallicRoughness"]["baseColorFactor"][3]
            for made in film.json["materials"]
        }
        self.assertEqual(glass, {"moving": 0.6, "resting": 0.6, "force": 1})  # arrows are inside of the rods
        self.assertGreater(np.ptp(found[:, 0, 0]), 0.005)  # the second rod is pushed away

    def test_files_name_their_run_and_pass_the_validator_of_khronos(self):
        film, _ = self.film(self.results["finite"], "--colour", "stress")
        with h5py.File(self.results["finite"]) as file:
            self.assertEqual(film.extras["run"], file.attrs["run"].decode())
        self.assertEqual(film.extras["title"], "finite")
        self.assertRegex(film.json["asset"]["generator"], r"^Ricochet \d+\.\d+")
        node = shutil.which("node")
        there = (
            node
            and subprocess.run([node, "-e", 'require("gltf-validator")'], capture_output=True).returncode == 0
        )
        if not there:
            self.skipTest("npm's gltf-validator is not installed")
        done = subprocess.run(
            [node, "-e", VALIDATOR, self.folder / "film.glb"], capture_output=True, text=True
        )
        issues = json.loads(done.stdout)
        self.assertEqual((issues["numErrors"], issues["numWarnings"]), (0, 0), issues["messages"])

    def test_a_result_without_what_a_film_shows_is_refused_in_one_line(self):
        self.succeed(contact(self.scene, self.out, "output.snapshot_every=0", "title=still"))
        still = self.out / "still.result.h5"
        self.refused(Command("export", still, "--gltf"), "has no snapshots (set [output] snapshot_every)")
        self.assertFalse((self.out / "still.glb").exists())
        with h5py.File(self.out / "plain.result.h5", "w") as plain, h5py.File(self.results["linear"]) as file:
            plain.attrs.update(file.attrs)
            for name in file:
                if name != "stress":
                    file.copy(name, plain)
        shutil.copy(self.out / "linear.summary.json", self.out / "plain.summary.json")
        self.refused(
            Command("export", self.out / "plain.result.h5", "--gltf", "--colour", "stress"),
            "has no stress of the surface of block",
            "set output.stress = true",
        )
        self.refused(Command("export", self.scene, "--gltf"), "is a scene", "name its result")
        self.refused(
            Command("export", self.results["linear"], "--gltf", "--colour", "sound"),
            "invalid choice: 'sound'",
        )
        self.refused(Command("export", "--gltf"), "FILE")

    def test_without_a_name_the_film_is_beside_the_result(self):
        done = self.succeed(Command("export", "--gltf", self.results["linear"]))
        self.assertEqual(done.out.splitlines()[0], str(self.out / "linear.glb"))
        Glb(self.out / "linear.glb")


if __name__ == "__main__":
    unittest.main()
