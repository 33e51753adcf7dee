// SPDX-License-Identifier: BSD-2-Clause
// Stress at the nodes of a visualisation surface, in the axes of the body: σ = S x. The rows of S are in the
// kernel, and x are all coordinates of the body (body_coordinates.hpp), one column each.
#pragma once

#include <span>
#include <vector>

#include "contact/figures/body_coordinates.hpp"

namespace ricochet::contact {

/// Whether the kernel has such stresses.
inline bool has_surface_stress(const kernels::Kernel& kernel) { return kernel.view && kernel.view->stress; }

class SurfaceStress {
 public:
  /// Of a kernel with stresses, which must outlive this object.
  explicit SurfaceStress(const kernels::Kernel& kernel);

  Eigen::Index nodes() const { return nodes_; }      ///< V
  Eigen::Index columns() const { return columns_; }  ///< C

  /// Sets the coordinates x (C).
  void gather(const BodyCoordinates& at, double* x) const noexcept;

  /// Copies columns of S for some nodes, in double precision, to `out` (6 count, columns), column by column.
  void copy(Eigen::Index first_node, Eigen::Index count, std::span<const Eigen::Index> columns,
            double* out) const noexcept;

  /// von Mises stress at all nodes. (V) [Pa]
  const Eigen::VectorXf& von_mises(const BodyCoordinates& at);

 private:
  /// A response of the kernel (6V, width), row by row.
  struct Part {
    const float* value;
    Eigen::Index width;
    const Vector BodyCoordinates::*of;
  };
  std::vector<Part> parts_;
  Eigen::Index nodes_, columns_ = 0;
  Eigen::VectorXf stress_, von_mises_;
};

}  // namespace ricochet::contact
