// SPDX-License-Identifier: BSD-2-Clause
// The loops of look-ahead blocks for the instruction sets of this processor.
#pragma once

#include <concepts>
#include <span>

#include "contact/simd/loops.hpp"

namespace ricochet::contact::simd {

/// The instruction sets that this processor supports, the widest last.
std::span<const InstructionSet* const> available() noexcept;

template <class T>
const Loops<T>& loops_of(const InstructionSet& set) {
  if constexpr (std::same_as<T, float>)
    return set.in_float;
  else
    return set.in_double;
}

}  // namespace ricochet::contact::simd
