// SPDX-License-Identifier: BSD-2-Clause
// HDF5 files that are well formed but not what they should be: edits to a good one, as an input says.
//
// The library's own decoding is left alone by these; inputs that begin with HDF5's signature are files as
// they stand, and try that.
#pragma once

#include <filesystem>
#include <functional>

#include "tests/fuzz/input.hpp"

namespace ricochet::fuzz {

/// The file at `path`: the input itself if it is an HDF5 file, else the one of `variants` that its first byte
/// names, edited by what is left of it. `write` writes a variant, once each.
void make_hdf5(const std::uint8_t* data, std::size_t size, const std::filesystem::path& path,
               unsigned variants,
               const std::function<void(unsigned variant, const std::filesystem::path&)>& write);

}  // namespace ricochet::fuzz
