// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the values that a key accepts.
#pragma once

#include <string>
#include <vector>

namespace ricochet::scene {

/// The accepted values. Bounds are kept as they are written, for messages.
struct Range {
  std::string low{}, high{};                 ///< empty: none
  bool low_open = false, high_open = false;  ///< whether the bound itself is refused
  bool or_zero = false;
  std::vector<std::string> choices{};  ///< of a text: the only accepted ones
  std::string remark{};                ///< appended to a refusal

  bool holds(double value) const;
  /// The range in words, such as "from 1 to 10" or "above 0"; empty if every value is accepted.
  std::string text() const;
};

}  // namespace ricochet::scene
