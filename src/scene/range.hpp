// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the values that a key accepts.
#pragma once

#include <string>
#include <vector>

namespace ricochet::scene {

/// What values are taken. Bounds are kept as they are written, for people.
struct Range {
  std::string low{}, high{};                 ///< empty: none
  bool low_open = false, high_open = false;  ///< the bound itself is refused
  bool or_zero = false;
  std::vector<std::string> choices{};  ///< of a text: nothing else is taken
  std::string remark{};                ///< behind a refusal

  bool holds(double value) const;
  /// "from 1 to 10", "above 0", "\"double\" or \"single\""; empty when all is taken.
  std::string text() const;
};

}  // namespace ricochet::scene
