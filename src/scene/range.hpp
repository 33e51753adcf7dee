// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the values that a key accepts.
#pragma once

#include <string>
#include <vector>

namespace ricochet::scene {

/// The accepted values. Bounds are stored as text, so that messages print them as written.
struct Range {
  std::string low{}, high{};                 ///< empty: no bound
  bool low_open = false, high_open = false;  ///< whether the bound itself is refused
  bool or_zero = false;
  std::vector<std::string> choices{};  ///< the accepted strings, instead of or besides numbers; empty: any
  std::string remark{};                ///< appended to the error message

  bool holds(double value) const;
  /// The range in words, such as "from 1 to 10" or "above 0"; empty if every value is accepted.
  std::string text() const;
};

}  // namespace ricochet::scene
