// SPDX-License-Identifier: BSD-2-Clause
// Well-formed HDF5 files with unexpected contents: the input determines edits to a valid file.
// These edits do not test HDF5's own decoding. Inputs that start with the HDF5 signature are used
// as files unchanged, which tests the decoding.
#pragma once

#include <filesystem>
#include <functional>

#include "tests/fuzz/input.hpp"

namespace ricochet::fuzz {

/// Writes the file at `path`. If the input is an HDF5 file, it is written unchanged.
/// Otherwise its first byte selects one of `variants`, which the remaining bytes edit.
/// `write` writes a variant and is called once for each.
void make_hdf5(const std::uint8_t* data, std::size_t size, const std::filesystem::path& path,
               unsigned variants,
               const std::function<void(unsigned variant, const std::filesystem::path&)>& write);

}  // namespace ricochet::fuzz
