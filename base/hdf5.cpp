// SPDX-License-Identifier: BSD-2-Clause
#include "base/hdf5.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "base/hdf5_internal.hpp"

namespace ricochet::base::hdf5 {

std::string to_string(const Shape& shape) {
  std::vector<std::string> parts;
  for (const std::size_t length : shape) parts.push_back(length == any ? "*" : std::to_string(length));
  return fmt::format("({})", fmt::join(parts, ", "));
}

void Id::reset() noexcept {
  if (raw_ < 0) return;
  silence();
  H5Idec_ref(raw_);
  raw_ = -1;
}

}  // namespace ricochet::base::hdf5
