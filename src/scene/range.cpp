// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/range.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace ricochet::scene {

namespace {

double value_of(const std::string& bound) { return std::strtod(bound.c_str(), nullptr); }

/// The choices as "a, b or c".
std::string either(const std::vector<std::string>& choices) {
  std::string text;
  for (std::size_t k = 0; k < choices.size(); ++k)
    text += fmt::format("{}\"{}\"", k == 0 ? "" : k + 1 < choices.size() ? ", " : " or ", choices[k]);
  return text;
}

}  // namespace

bool Range::holds(double value) const {
  if (or_zero && value == 0) return true;
  if (!low.empty() && (low_open ? value <= value_of(low) : value < value_of(low))) return false;
  return high.empty() || (high_open ? value < value_of(high) : value <= value_of(high));
}

std::string Range::text() const {
  if (!choices.empty() && low.empty()) return either(choices);
  std::string text = or_zero ? "0 or " : "";
  if (low_open && high_open) return text + fmt::format("above {} and below {}", low, high);
  if (!low.empty() && !high.empty())
    return text + fmt::format("from {} to {}", low, high) +
           (choices.empty() ? "" : ", or " + either(choices));
  if (!low.empty())
    return text + (low_open ? "above " : "at least ") + low +
           (choices.empty() ? "" : ", or " + either(choices));
  return "";
}

}  // namespace ricochet::scene
