// SPDX-License-Identifier: BSD-2-Clause
// The residual flexibility R of the candidates of a surface, in whatever form the kernel holds it.
#pragma once

#include <cstddef>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// A view of R that a surface holds; the surface must outlive it and may not change.
class Flexibility {
 public:
  explicit Flexibility(const Surface& surface);

  bool empty() const { return double_ == nullptr && compact_ == nullptr; }

  /// R_ij of two candidates [m/N]. It equals the transpose of R_ji to the last bit, unless R is in double
  /// precision. Requires that the surface holds R.
  /// @param out  (r,r)
  void block(std::size_t i, std::size_t j, double* out) const noexcept;

  /// x += weight · (a row of R). @param row  r·i + component, @param x  (rM)
  void add_row(std::size_t row, double weight, double* x) const noexcept;

 private:
  const float* near(std::size_t i, std::size_t j) const noexcept;

  std::size_t candidates_, components_;
  const double* double_ = nullptr;
  const CompactFlexibility* compact_ = nullptr;
};

}  // namespace ricochet::kernels
