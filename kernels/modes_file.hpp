// SPDX-License-Identifier: BSD-2-Clause
// The modes on the visualisation surface of a body, for ParaView (docs/formats/kernel.md).
#pragma once

#include <filesystem>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// Writes `<stem>.h5` and, beside it, `<stem>.xdmf`, in which each mode is a field on the visualisation
/// surface. A field is named by the number of the mode and its frequency in Hz, and is scaled so that the
/// largest displacement is a tenth of the body's size. Each file is written under a temporary name and
/// renamed. Throws InputError if the kernel has no visualisation surface, or if the place cannot be written.
void write_modes(const Kernel& kernel, const std::filesystem::path& stem);

}  // namespace ricochet::kernels
