// SPDX-License-Identifier: BSD-2-Clause
// The modes of a body's skin, for ParaView (FORMAT.md).
#pragma once

#include <filesystem>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// Writes `<stem>.h5` and beside it `<stem>.xdmf`, in which each mode is a field over the skin, named by its
/// number and its frequency in Hz and scaled so that it moves the skin by at most a tenth of its size. Each
/// file is written beside and renamed. Throws InputError when there is no skin, or when the place can't be
/// written.
void write_modes(const Kernel& kernel, const std::filesystem::path& stem);

}  // namespace ricochet::kernels
