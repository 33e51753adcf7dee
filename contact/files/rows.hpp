// SPDX-License-Identifier: BSD-2-Clause
// Rows of vectors.
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/hdf5_writer.hpp"

namespace ricochet::contact {

inline void append(base::hdf5::Rows* rows, const Eigen::Ref<const Eigen::VectorXd>& row) {
  rows->append(std::span<const double>(row.data(), static_cast<std::size_t>(row.size())));
}

}  // namespace ricochet::contact
