// SPDX-License-Identifier: BSD-2-Clause
// The names of the dimensions of result files, for readers of netCDF-4 such as xarray
// (docs/formats/result.md).
#pragma once

#include "base/hdf5_writer.hpp"

namespace ricochet::contact {

/// Gives each dataset of a result its dimension scales. Call it after all rows. Throws InputError if the file
/// cannot be written.
/// @param turns  whether rows of contact are ragged, with finite rotations
void name_axes(base::hdf5::Writer& file, bool turns);

/// The same for a motion for ParaView (docs/formats/result.md).
void name_axes_of_motion(base::hdf5::Writer& file);

}  // namespace ricochet::contact
