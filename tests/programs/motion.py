# SPDX-License-Identifier: BSD-2-Clause
"""The files for ParaView: the motion of bodies and the forces between them, read according to XDMF and compared with the result
file, with receivers at nodes of the surface and with free flight; modes of a rod compared with cosines. If ParaView is
installed (scripts/setup --peers), its own reader must return the same data."""

import functools
import json
import shutil
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

import h5py
import numpy as np

import ricochet
from programs import BIN, MESHES, ProgramTest, Run, contact, impact, kernel, settings

SINGLE = 1e-6  # some units in the last place of 32-bit numbers, relative to the largest value
BLOCK = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Mesh.MeshSizeMin = 0.9; Mesh.MeshSizeMax = 0.9;
Physical Volume("block") = {1};
Physical Surface("bottom") = {5}; Physical Surface("top") = {6}; Physical Surface("side") = {1};
"""
# With few modes, the static part of the truncated modes is large.
BLOCKS = """
title = "Blocks"
[bodies.striker]
mesh = "block.geo"
order = 2
rotate_deg = [0, 0, 30]
translate = [0.3, 0.1, 1.02]
material = { density = 1, young = 1e3, poisson = 0.3 }
velocity = [0, 0, -2]
contact = "bottom"
[bodies.base]
mesh = "block.geo"
order = 2
material = { density = 1, young = 1e3, poisson = 0.3 }
contact = "top"
support = { bottom = "xyz" }
[modes]
count = 9
[contact]
between = ["striker", "base"]
[motion]
rotation = "linear"
[time]
rate_hz = 2000
duration = 0.08
[loads]
gravity = [1, 0, -9.81]
[[loads.motion]]
body = "base"
group = "bottom"
vector = [0.01, 0, 0.02]
history = "ramp.csv"
[[loads.traction]]
body = "base"
group = "side"
vector = [3, 0, 1]
history = "ramp.csv"
[output]
vtk_every = 5
[[output.receiver]]
name = "heel"
body = "striker"
at = [0.3, 0.1, 1.02]
[[output.receiver]]
name = "brow"
body = "striker"
at = [0.3, 0.1, 2.02]
[[output.receiver]]
name = "shoulder"
body = "base"
at = [1, 1, 1]
[[output.receiver]]
name = "foot"
body = "base"
at = [1, 0, 0]
"""
THROUGH_PARAVIEW = """
import json, sys
from paraview import servermanager
from paraview.simple import XDMFReader
from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet
reader = XDMFReader(FileNames=[sys.argv[1]])
reader.UpdatePipelineInformation()
found = []
for t in list(reader.TimestepValues or [0.0]):
    reader.UpdatePipeline(t)
    data = servermanager.Fetch(reader)
    blocks = {}
    visit = data.NewIterator() if hasattr(data, "NewIterator") else None
    leaves = [("", data)] if visit is None else []
    while visit is not None and not visit.IsDoneWithTraversal():
        name = visit.GetCurrentMetaData().Get(vtkCompositeDataSet.NAME())
        leaves.append((name, visit.GetCurrentDataObject()))
        visit.GoToNextItem()
    for name, grid in leaves:
        fields = grid.GetPointData()
        arrays = [fields.GetArray(i) for i in range(fields.GetNumberOfArrays())]
        last = grid.GetNumberOfPoints() - 1
        blocks[name] = {"cells": grid.GetNumberOfCells(), "last": grid.GetPoint(last),
                        "fields": {a.GetName(): a.GetTuple(last) for a in arrays}}
    found.append({"time": t, "blocks": blocks})
json.dump(found, open(sys.argv[2], "w"))
"""


def frame_of(grid, stored):
    """Element, position and fields of an XDMF grid, out of the stored datasets by file and name."""

    def item(parent):
        (data,) = parent.findall("DataItem")
        values = stored(*data.text.split(":"))
        assert data.get("Format") == "HDF" and values.itemsize == int(data.get("Precision"))
        assert values.dtype.kind == {"Float": "f", "Int": "i"}[data.get("NumberType")]
        assert values.shape == tuple(int(n) for n in data.get("Dimensions").split())
        return values

    topology = grid.find("Topology")
    frame = {"element": item(topology), "position": item(grid.find("Geometry"))}
    corners = {"Polyvertex": 1, "Polyline": 2, "Triangle": 3}[topology.get("TopologyType")]
    assert frame["element"].shape == (int(topology.get("NumberOfElements")), corners)
    assert 0 <= frame["element"].min() and frame["element"].max() < len(frame["position"])
    for attribute in grid.findall("Attribute"):
        frame[attribute.get("Name")] = item(attribute)
    return frame


def read_xdmf(path):
    """Grids by name. A film has its times and its fields, each stacked over the frames."""
    out, opened = {}, functools.cache(lambda file: h5py.File(path.parent / file))
    stored = functools.cache(lambda file, name: opened(file)[name][:])
    for grid in ElementTree.parse(path).find("Domain").findall("Grid"):
        if grid.get("GridType") != "Collection":
            out[grid.get("Name")] = frame_of(grid, stored)
            continue
        frames = [frame_of(one, stored) for one in grid.findall("Grid")]
        times = [float(one.find("Time").get("Value")) for one in grid.findall("Grid")]
        out[grid.get("Name")] = {"time": np.array(times)} | {
            name: np.stack([f[name] for f in frames]) for name in frames[0]
        }
    return out


class Motion(ProgramTest):
    def assert_close(self, found, expected, scale):
        np.testing.assert_allclose(found, expected, rtol=0, atol=SINGLE * scale)

    def vtk(self, scene, *sets):
        words = ["--out", self.folder / "out", "--quiet", "--vtk", *settings(sets)]
        return Run([BIN / "ricochet-contact", scene, *words])

    def through_paraview(self, path):
        script, found = self.write("read.py", THROUGH_PARAVIEW), self.folder / "seen.json"
        subprocess.run(["pvbatch", script, path, found], check=True, capture_output=True, timeout=240)
        return json.loads(found.read_text())

    def rods(self, *sets):
        shutil.copytree(
            MESHES / "two-rods", self.folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("out")
        )
        scene, sets = self.folder / "two-rods.toml", (
            "modes.count=6",
            "contact.gap=0.5",
            "time.duration=4",
            *sets,
        )
        self.succeed(kernel(scene, self.folder / "out", *sets, ranks=1))
        return scene, sets

    def blocks(self):
        self.write("block.geo", BLOCK)
        self.write("ramp.csv", "0,0\n0.03,1\n0.05,0.5\n")
        return self.write("blocks.toml", BLOCKS)

    def test_rods_fly_freely_then_touch_where_the_result_says(self):
        # Turned by a right angle, so that the rods lie along y.
        turned = [f"bodies.{name}.rotate_deg=[0,0,90]" for name in ("moving", "resting")]
        scene, sets = self.rods(
            *turned,
            "bodies.moving.translate=[0,-10,0]",
            "bodies.moving.velocity=[0,1,0]",
            "contact.direction=[0,1,0]",
        )
        self.succeed(self.vtk(scene, *sets, "output.vtk_every=20"))
        film = read_xdmf(self.folder / "out" / "two-rods.motion.xdmf")
        self.assertEqual(list(film), ["moving", "resting", "moving on resting"])
        moving, resting, met = film.values()
        time = moving["time"]
        np.testing.assert_allclose(time, 0.2 * np.arange(21), rtol=1e-15)

        flight = time < 0.5
        start = np.linspace(0, 10, moving["position"].shape[1])
        order = np.argsort(moving["position"][0, :, 1])
        for t, place in zip(time[flight], moving["position"][flight][:, order]):
            self.assert_close(place[:, 1], start - 10.5 + t, 10)
            self.assert_close(place[:, [0, 2]], 0, 10)
        self.assert_close(moving["velocity"][flight] - [0, 1, 0], 0, 1)
        self.assertLess(abs(moving["deformation"][flight]).max(), SINGLE)

        result = ricochet.Result(self.folder / "out" / "two-rods.result.h5")
        rows = np.searchsorted(result.contact_time, time[~flight] - 1e-9)
        force, gap, area = result.force[rows], result.gap[rows], result.area
        with h5py.File(result.path) as file:
            displacement = file["contact/displacement_a"][:][rows, 0]
        self.assertGreater(force.min(), 0.1)
        np.testing.assert_array_equal(met["force"][~flight], force)
        np.testing.assert_array_equal(met["gap"][~flight], gap)
        np.testing.assert_allclose((met["pressure"] * area).sum(axis=1), met["force"].sum(axis=1), rtol=1e-15)
        np.testing.assert_allclose(met["push"][:, 0], met["force"] * [0, -1, 0], rtol=1e-15)
        # The surface ends at the contact points, including the static response of all modes beyond the six.
        end, other = np.argmax(moving["position"][0, :, 1]), np.argmin(resting["position"][0, :, 1])
        self.assert_close(moving["position"][~flight, end, 1], displacement - 0.5, 10)
        self.assert_close(met["position"][:, 0], moving["position"][:, end], 10)
        self.assert_close(
            resting["position"][~flight, other, 1] - moving["position"][~flight, end, 1], gap[:, 0], 10
        )

    def test_the_skin_moves_like_receivers_on_it(self):
        scene, out = self.blocks(), self.folder / "out"
        # Modes above half of the lower rate are quasi-static. Under impulses there is no static response.
        for setting in ("time.rate_hz=2000", "time.rate_hz=25", "contact.scheme=impulse"):
            result = impact(scene, out, setting, "output.vtk_every=1")
            film = read_xdmf(out / "blocks.motion.xdmf")
            self.assertGreater(film["striker on base"]["force"].max(), 0)
            with h5py.File(result.path) as file:
                for name, receiver in file["receivers"].items():
                    if name == "time":
                        continue
                    skin = film[receiver.attrs["body"].decode()]
                    away = np.linalg.norm(
                        (skin["position"] - skin["deformation"])[0] - receiver.attrs["point"], axis=1
                    )
                    node = away.argmin()
                    self.assertLess(away[node], 1e-6)
                    moved, velocity = receiver["displacement"][:], receiver["velocity"][:]
                    # 5: the field of the static part is summed to 1e-6.
                    self.assert_close(skin["position"][:, node] - receiver.attrs["point"], moved, 5 * 2)
                    self.assert_close(skin["velocity"][:, node], velocity, 5 * abs(velocity).max())
        grid = film["striker on base"]
        self.assertEqual(grid["element"].shape[2], 3)  # pressure on triangles

    def test_modes_of_a_rod_are_cosines_named_by_their_frequencies(self):
        self.rods()
        (path,) = (self.folder / "out").glob("moving-*.kernel.h5")
        self.succeed(Run([BIN / "ricochet-recast", path, "--vtk", "--young-factor", 4]))
        (light,) = (self.folder / "out").glob("moving-*.modes.xdmf")
        self.assertEqual(len(list((self.folder / "out").glob("moving-*.kernel.h5"))), 1)
        grid = read_xdmf(light)["moving"]
        x, shapes = grid["position"][:, 0], [name for name in grid if name.startswith("mode")]
        self.assertEqual(shapes[0], "mode 1: 0 Hz")
        for n, name in enumerate(shapes):
            frequency = float(name.split(":")[1].split()[0])
            self.assertAlmostEqual(frequency, 2 * n / 20, delta=0.01 * n / 10)  # c = 2; 100 linear elements
            form = grid[name][:, 0] / grid[name][x.argmin(), 0]
            np.testing.assert_allclose(form, np.cos(n * np.pi * x / 10), atol=1e-5)
            self.assertAlmostEqual(abs(grid[name]).max(), 1, delta=1e-6)  # a tenth of the length

    def test_what_has_no_skin_is_refused_in_one_line_and_leaves_nothing(self):
        scene = self.blocks()
        plain, table = ("output.vtk_every=0", "output.view=false"), (
            "output.vtk_every=0",
            "contact.kernel=table",
        )
        for run, part in [
            (
                self.vtk(scene, *plain),
                "output.view = false: --vtk draws the visualisation surface of each body",
            ),
            (
                self.vtk(scene, "loads={}", "output={}", *table[1:]),
                'contact.kernel = "table" gives no motion',
            ),
            (
                contact(scene, self.folder / "out", "output.view=false"),
                "vtk_every needs the visualisation surfaces",
            ),
            (Run([BIN / "ricochet-contact", "--vtk", "--batch", scene]), "--vtk excludes --batch"),
        ]:
            self.refused(run, part)
        self.assertFalse((self.folder / "out").exists())
        scene, sets = self.rods()
        (path,) = (self.folder / "out").glob("moving-*.kernel.h5")
        with h5py.File(path, "r+") as file:
            del file["view"]
        for run in (self.vtk(scene, *sets), Run([BIN / "ricochet-recast", path, "--vtk"])):
            self.refused(run)
            self.assertRegex(run.err, "has no (visualisation surface|skin|view)")
        self.assertEqual({path.suffixes[-2] for path in (self.folder / "out").iterdir()}, {".kernel"})

    @unittest.skipUnless(shutil.which("pvbatch"), "ParaView is not installed")
    def test_paraview_sees_what_xdmf_says(self):
        scene, sets = self.rods()
        self.succeed(self.vtk(scene, *sets))
        path = self.folder / "out" / "two-rods.motion.xdmf"
        film, seen = read_xdmf(path), self.through_paraview(path)
        np.testing.assert_allclose([frame["time"] for frame in seen], film["moving"]["time"], rtol=1e-12)
        for k, frame in enumerate(seen):
            self.assertEqual(list(frame["blocks"]), list(film))
            for name, block in frame["blocks"].items():
                self.assertEqual(block["cells"], film[name]["element"].shape[1])
                np.testing.assert_array_equal(block["last"], film[name]["position"][k, -1])
                for field, value in block["fields"].items():
                    np.testing.assert_array_equal(value, np.atleast_1d(film[name][field][k, -1]))
                self.assertEqual(set(film[name]) - {"time", "element", "position"}, set(block["fields"]))
        (stored,) = (self.folder / "out").glob("moving-*.kernel.h5")
        self.succeed(Run([BIN / "ricochet-recast", stored, "--vtk"]))
        (light,) = (self.folder / "out").glob("*.modes.xdmf")
        (still,) = self.through_paraview(light)
        (block,) = still["blocks"].values()
        for field, value in block["fields"].items():
            np.testing.assert_array_equal(value, read_xdmf(light)["moving"][field][-1])
        self.assertEqual(len(block["fields"]), 6)


if __name__ == "__main__":
    unittest.main()
