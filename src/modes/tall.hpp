// SPDX-License-Identifier: BSD-2-Clause
// Products of a tall basis with a block of a few columns, at the speed of the processor.
#pragma once

#include <Eigen/Dense>
#include <span>

namespace ricochet::modes {

/// Loops over some rows of Q and Y for one instruction set.
struct TallLoops {
  using Loop = void(Eigen::Index rows, Eigen::Index columns, const double* q, Eigen::Index stride,
                    const double* in, double* out);
  Eigen::Index width = 0;  ///< columns of Y at a time; 0 stands for BLAS
  Loop *inner = nullptr, *subtract = nullptr;
};

/// The loops that this processor can run, the fastest one last: BLAS, AVX2, AVX-512.
std::span<const TallLoops> tall_loops();

/// Returns Qᵀ Y (k, n) of this rank's rows.
///
/// BLAS is made for products that are wide in all dimensions. With 16 columns, it reaches a third of the
/// speed of a core. These functions read each entry of Q once and use it for 16 columns that stay in
/// registers or cache.
/// @param q  (rows, k)
/// @param y  (rows, n)
Eigen::MatrixXd tall_inner(const Eigen::Ref<const Eigen::MatrixXd>& q,
                           const Eigen::Ref<const Eigen::MatrixXd>& y,
                           const TallLoops& loops = tall_loops().back());

/// Computes Y −= Q C in the same way.
/// @param q  (rows, k)
/// @param c  (k, n)
/// @param y  (rows, n)
void tall_subtract(const Eigen::Ref<const Eigen::MatrixXd>& q, const Eigen::Ref<const Eigen::MatrixXd>& c,
                   Eigen::Ref<Eigen::MatrixXd> y, const TallLoops& loops = tall_loops().back());

}  // namespace ricochet::modes
