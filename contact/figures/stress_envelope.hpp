// SPDX-License-Identifier: BSD-2-Clause
// The largest stresses of a whole run at the nodes of a visualisation surface, over all steps, none of which
// is stored.
//
// Steps are gathered in blocks, and σ = S x of a block is a product of matrices. Most of it is left out where
// bounds show that no value grows: what a column j of S adds to a node is at most its Frobenius norm f_j
// times max |x_j| in the block (stress_measures.hpp). The strongest columns are multiplied first; the others
// follow only for nodes whose value may still exceed the largest one so far. The result is that of all steps.
#pragma once

#include <vector>

#include "contact/figures/surface_stress.hpp"

namespace ricochet::contact {

/// Largest values by node, and when they first occur.
struct StressEnvelope {
  struct Largest {
    std::vector<double> value, time;  ///< (V) [Pa], (V) [s]
  };
  Largest von_mises, principal, shear;  ///< σ_v, σ₁ and ½ (σ₁ − σ₃)
};

class EnvelopeObserver {
 public:
  /// Of a kernel with stresses of its surface, which must outlive this object.
  explicit EnvelopeObserver(const kernels::Kernel& kernel);

  /// Takes the state after a step at `time` [s]. Does not allocate.
  void observe(double time, const BodyCoordinates& at) noexcept;

  /// Of all states so far; empty before the first one.
  const StressEnvelope& envelope() const;

 private:
  void finish_block() const noexcept;
  void choose_columns() const noexcept;
  bool may_grow(Eigen::Index node, const double* stress, double rest) const noexcept;
  void take(Eigen::Index node, const double* stress, double time) const noexcept;

  SurfaceStress stress_;
  std::vector<float> norm_;      ///< (V,C) Frobenius norms f of the columns of S
  std::vector<double> largest_;  ///< (C) the largest over the nodes
  // The steps of the block that is not finished. Asking for the result finishes it.
  mutable Eigen::MatrixXd coordinates_;  ///< (C, steps of a block)
  mutable std::vector<double> time_;
  mutable Eigen::Index count_ = 0;
  mutable StressEnvelope out_;
  // Scratch.
  mutable std::vector<Eigen::Index> order_;  ///< columns, the strongest first
  mutable Eigen::Index strong_ = 0, used_ = 0;
  mutable std::vector<double> size_;          ///< (C) max |x|
  mutable Eigen::MatrixXd negative_;          ///< −x of them, in this order
  mutable Eigen::MatrixXd columns_, values_;  ///< of a tile: columns of S, and S x
};

}  // namespace ricochet::contact
