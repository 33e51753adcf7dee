// SPDX-License-Identifier: BSD-2-Clause
// The residual flexibility R of a body that turns, in single precision, and compressed if it has many
// candidates.
//
// R decays like 1/r and is not of low rank: neither near blocks alone nor few columns alone represent it. Of
// candidates c that are spread evenly over the surface, R_:c is kept whole,
//   R = G Gᵀ + E,   G = R_:c C⁻ᵀ,   C Cᵀ = R_cc.
// E is the flexibility of the body with the candidates c held. It is 0 at c, and holding them screens one
// candidate from another: E decays within a few spacings of c. Blocks E_ij beyond a radius are left out.
//
// Energy theorem (DESIGN 11): contact adds no energy if R is symmetric and positive semidefinite, whatever
// its entries. Rounding R to single precision changes R_ij by at most u |R_ij|, u = 2⁻²⁴, so that a diagonal
// raised by u Σ_j |R_ij| makes up for it (Gershgorin). G Gᵀ is semidefinite whatever is stored as G. That the
// stored E is definite is proved by its Cholesky factor; if there is none, its diagonal is raised.
// Sources: Nyström's method with a sparse correction (full-scale approximation, Sang & Huang 2012).
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <span>
#include <vector>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

struct Compression {
  std::size_t most_whole = 2000;   ///< candidates up to which R is kept whole
  std::size_t most_global = 2000;  ///< candidates c at most
  double spacing = 1.5;            ///< least distance between two candidates c, in (mean area)^½
  double radius = 16.0 / 3;        ///< within which blocks E_ij are kept, in spacings
};

/// Whether R of so many candidates is compressed.
inline bool is_compressed(std::size_t candidates, const Compression& how = {}) {
  return candidates > how.most_whole;
}

/// Bytes of the compact R, before it exists.
double compact_bytes(std::size_t candidates, const Compression& how = {});
/// Bytes that compressed() needs, with its result.
double compression_bytes(std::size_t candidates, const Compression& how = {});

/// Returns columns of R (3M, number of `columns`) [m/N].
using FlexibilityColumns = std::function<Eigen::MatrixXd(std::span<const Eigen::Index> columns)>;

/// Compresses R of the candidates of a surface. Each column is asked for once.
/// @param advance  called with the number of columns that are done, of all
CompactFlexibility compressed(
    const Surface& surface, const FlexibilityColumns& columns, const Compression& how = {},
    const std::function<void(std::int64_t, std::int64_t)>& advance = [](std::int64_t, std::int64_t) {});

/// Moves R of a surface to its compact form, if it has three components and is not compact.
void make_compact(Surface& surface, const Compression& how = {});

/// Multiplies R.
void scale(CompactFlexibility& flexibility, double factor);

/// R of some of the candidates, in the given order. @param points  distinct
CompactFlexibility restricted(const CompactFlexibility& flexibility, const std::vector<std::int64_t>& points);

/// R += V Vᵀ. @param columns  V (3M,n) [m^1/2 N^-1/2]
void add_square(CompactFlexibility& flexibility, const Eigen::MatrixXd& columns);

/// At least the Frobenius norm of R [m/N].
double norm_bound(const Surface& surface);

}  // namespace ricochet::kernels
