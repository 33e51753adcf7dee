// SPDX-License-Identifier: BSD-2-Clause
// The loops of look-ahead blocks for the instruction sets of this processor.
#pragma once

#include "contact/stepping/simd_loops.hpp"

namespace ricochet::contact::simd {

/// The instruction sets that this processor has, `count` of them, the widest last.
const InstructionSet* const* available(std::size_t& count) noexcept;
/// The widest.
const InstructionSet& best() noexcept;

}  // namespace ricochet::contact::simd
