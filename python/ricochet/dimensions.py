# SPDX-License-Identifier: BSD-2-Clause
"""Names of the dimensions of HDF5 datasets where netCDF-4 looks for them, so that xarray opens a group with
these names (docs/formats/result.md)."""
from collections.abc import Sequence

import h5py

from ricochet.arrays import Array


def scale(group: h5py.Group, name: str, values: Array) -> h5py.Dataset:
    """A dimension scale with values."""
    data = group.create_dataset(name, data=values)
    data.make_scale(name)
    return data


def of_length(group: h5py.Group, name: str, length: int) -> h5py.Dataset:
    """The dimension scale of this name in a group, which is created if there is none: nothing is stored but its
    length."""
    if name not in group:
        data = group.create_dataset(name, (length,), dtype=">f4")
        data.make_scale(f"This is a netCDF dimension but not a netCDF variable.{length:>10}")
    return group[name]


def name(data: h5py.Dataset, scales: Sequence[h5py.Dataset], unit: str = "") -> None:
    """Names the dimensions of a dataset by scales. `unit` is the unit that files state, and `units` the name that
    netCDF has for it; none if it is empty."""
    for dimension, of_dimension in zip(data.dims, scales, strict=True):
        dimension.attach_scale(of_dimension)
    if unit:
        data.attrs["unit"] = data.attrs["units"] = unit
