# SPDX-License-Identifier: BSD-2-Clause
"""The dimension scales of results, motions and studies: each dimension of each dataset has a name and a length that agrees, where
netCDF-4 looks for it. With xarray, groups open with these names."""

import importlib.util
import unittest

import h5py
import numpy as np

import scenes
from programs import Command, ProgramTest, impact

OUTPUT = """
[output]
view = true
stress = true
snapshot_every = 10
[[output.receiver]]
name = "mic"
body = "block"
at_body = [0.3, 0.3, 0.3]
[[output.gauge]]
name = "foil"
body = "block"
at_body = [0.5, 0.5, 0.35]
direction = [0, 0, 1]
"""
NO_VALUES = b"This is a netCDF dimension but not a netCDF variable."


def dimensions_of(path):
    """By dataset: the names of the scales of its dimensions. Raises AssertionError where they break a rule of netCDF-4."""
    found = {}

    def visit(name, data):
        if not isinstance(data, h5py.Dataset) or data.attrs.get("CLASS") == b"DIMENSION_SCALE":
            return
        found[name] = [dimension[0].name for dimension in data.dims]
        for dimension, length in zip(data.dims, data.shape):
            (scale,) = dimension.values()
            assert scale.shape == (length,), (name, scale.name)
            assert h5py.h5ds.is_scale(scale.id), (name, scale.name)
            assert data.parent.name.startswith(scale.parent.name), (
                name,
                scale.name,
            )  # in its group or one above
            title = scale.attrs["NAME"]
            assert title == scale.name.rpartition("/")[2].encode() or title.startswith(NO_VALUES), title
        last = [scale.rpartition("/")[2] for scale in found[name]]
        assert len(set(last)) == len(last), (name, last)

    with h5py.File(path) as file:
        file.visititems(visit)
        for group in [file, *(item for item in file.values() if isinstance(item, h5py.Group))]:
            # A name means one length in a group.
            lengths = {}
            for data in group.values():
                if isinstance(data, h5py.Dataset):
                    scales = [d[0] for d in data.dims] if len(data.dims[0]) else [data]
                    for scale in scales:
                        known = lengths.setdefault(scale.name.rpartition("/")[2], scale.name)
                        assert known == scale.name, (known, scale.name)
    return found


def engines():
    """xarray with each of its readers of HDF5; nothing where it is not installed."""
    if importlib.util.find_spec("xarray") is None:
        return
    import xarray

    for engine, module in (("h5netcdf", "h5netcdf"), ("netcdf4", "netCDF4")):
        if importlib.util.find_spec(module):
            yield xarray, engine


class Dimensions(ProgramTest):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"
        self.write("block.geo", scenes.skewed_block(1.2))

    def block(self, more="", output=OUTPUT):
        body = "material = { density = 2.0, young = 3.0, poisson = 0.3 }\nvelocity = [0, 0, -0.5]"
        text = scenes.block_on_floor(
            "Block", "count = 12", "gap = 1e-3", "rate_hz = 400.0\nduration = 0.5", body, output + more
        )
        return impact(self.write("block.toml", text), self.out)

    def test_of_a_result_have_the_names_of_the_format(self):
        result = self.block()
        found = dimensions_of(result.path)
        for name, scales in {
            "contact/force": ["/contact/time", "/candidate"],
            "contact/point_a": ["/candidate", "/component"],
            "contact/persistency": ["/contact/sample"],
            "energy/total": ["/time"],
            "bodies/block/velocity": ["/time", "/component"],
            "receivers/mic/velocity": ["/receivers/time", "/component"],
            "gauges/foil/stress": ["/gauges/time", "/stress_component"],
            "gauges/foil/strain": ["/gauges/time"],
            "snapshots/block": ["/snapshots/time", "/mode_block"],
            "static/block/force": ["/static/block/entry", "/static/block/row"],
            "stress/block/von_mises": ["/node_block"],
        }.items():
            self.assertEqual(found[name], scales, name)
        with h5py.File(result.path) as file:
            self.assertEqual(file["contact/time"].attrs["NAME"], b"time")
            for name in [*found, "time", "contact/time"]:
                attributes = file[name].attrs
                self.assertEqual(attributes.get("units"), attributes.get("unit"), name)
            self.assertEqual(file["component"].id.get_storage_size(), 0)  # nothing is stored but its length
        self.assertGreater(len(result.contact_time), 0)
        self.assert_xarray(result)

    def test_of_a_result_of_a_body_that_turns_follow_its_entries(self):
        result = self.block('[motion]\nrotation = "finite"\n')
        found = dimensions_of(result.path)
        for name, scales in {
            "contact/first": ["/contact/time"],
            "contact/force": ["/contact/entry"],
            "contact/place": ["/contact/entry", "/component"],
            "bodies/block/attitude": ["/time", "/quaternion"],
            "pose/block/position": ["/snapshot", "/component"],
        }.items():
            self.assertEqual(found[name], scales, name)

    def test_of_a_motion_are_nodes_and_components(self):
        result = self.block(output=OUTPUT.replace("view = true", "view = true\nvtk_every = 50"))
        path = result.path.with_name("block.motion.h5")
        found = dimensions_of(path)
        for name, scales in {
            "bodies/block/element": ["/bodies/block/facet", "/bodies/block/corner"],
            "bodies/block/position/000001": ["/bodies/block/node", "/component"],
            "bodies/block/von_mises/000001": ["/bodies/block/node"],
            "contact/1/force/000000": ["/contact/1/candidate"],
            "contact/1/push/000000": ["/contact/1/candidate", "/component"],
        }.items():
            self.assertEqual(found[name], scales, name)
        for xarray, engine in engines():
            with xarray.open_dataset(path, group="bodies/block/velocity", engine=engine) as velocity:
                self.assertEqual(velocity["000002"].dims, ("node", "component"))
                self.assertEqual(velocity["000002"].attrs["units"], "m/s")

    def test_of_a_study_are_its_impacts_and_the_times_of_records(self):
        self.block()  # also writes the scene
        self.write(
            "drops.toml",
            'title = "Drops"\nscene = "block.toml"\nkeep = ["force", "receivers", "acceleration", "gauges", "bodies", "energy"]\n'
            '[grid]\n"bodies.block.velocity[2]" = [-0.5, -1.0]\n"contact.scheme" = ["compliant", "impulse"]\n',
        )
        self.succeed(Command("sweep", self.folder / "drops.toml", "--ranks", "1"))
        path = self.out / "drops.sweep.h5"
        found = dimensions_of(path)
        impact = "/histories/0003/"
        for name, scales in {
            "status": ["/impact"],
            "inputs/contact.scheme": ["/impact"],
            "outputs/peak_force_n": ["/impact"],
            "histories/0003/contact/total_force": [impact + "contact/time"],
            "histories/0003/receivers/mic/velocity": [impact + "receivers/time", impact + "component"],
            "histories/0003/gauges/foil/stress": [impact + "gauges/time", impact + "stress_component"],
            "histories/0003/energy/total": [impact + "time"],
        }.items():
            self.assertEqual(found[name], scales, name)
        with h5py.File(path) as file:
            for name, unit in {
                "inputs/bodies.block.velocity[2]": "m/s",
                "outputs/peak_force_n": "N",
                "outputs/restitution": "1",
                "outputs/real_time_factor": "1",
                "outputs/contact_start_s": "s",
                "outputs/acceleration.mic.peak": "m/s^2",
            }.items():
                self.assertEqual(file[name].attrs["units"], unit, name)
            self.assertNotIn("units", file["inputs/contact.scheme"].attrs)
        for xarray, engine in engines():
            with xarray.open_dataset(path, group="outputs", engine=engine) as outputs:
                self.assertEqual(outputs["peak_force_n"].dims, ("impact",))
            with xarray.open_dataset(path, group="histories/0001/receivers/mic", engine=engine) as mic:
                self.assertEqual(mic["velocity"].dims, ("time", "component"))

    def assert_xarray(self, result):
        """Groups open in xarray, where it is installed."""
        for xarray, engine in engines():
            with xarray.open_dataset(result.path, group="contact", engine=engine) as contact:
                self.assertEqual(contact["force"].dims, ("time", "candidate"))
                np.testing.assert_array_equal(contact["time"], result.contact_time)
                np.testing.assert_array_equal(contact["force"], result.force)
                self.assertEqual(contact["force"].attrs["units"], "N")
                half = contact["force"].sel(time=result.contact_time[-1], method="nearest")
                np.testing.assert_array_equal(half, result.force[-1])
            with xarray.open_dataset(result.path, group="bodies/block", engine=engine) as body:
                self.assertEqual(body["velocity"].dims, ("time", "component"))
            for group in (
                None,
                "energy",
                "snapshots",
                "receivers/mic",
                "gauges/foil",
                "stress/block",
                "static/block",
            ):
                with xarray.open_dataset(result.path, group=group, engine=engine) as data:
                    self.assertGreater(len(data.variables), 0)


if __name__ == "__main__":
    unittest.main()
