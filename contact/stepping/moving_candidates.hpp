// SPDX-License-Identifier: BSD-2-Clause
// The candidates of a body that turns, in its axes: their elastic displacements, and the blocks Φ c Φᵀ and R
// between those under points that may touch. The blocks are constant: they are gathered once, when a
// candidate joins.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "base/reserved.hpp"
#include "contact/motion/body_surface.hpp"
#include "contact/stepping/step_system.hpp"

namespace ricochet::contact {

/// The blocks (3k,3k) of a symmetric matrix between k candidates. Entries are written once.
class CandidateBlocks {
 public:
  explicit CandidateBlocks(Eigen::Index candidates)
      : entries_(static_cast<std::size_t>(first(candidates, 0))) {}
  /// @param j  at most i
  Eigen::Map<Eigen::Matrix3d> operator()(Eigen::Index i, Eigen::Index j) noexcept {
    return Eigen::Map<Eigen::Matrix3d>(entries_.data() + first(i, j));
  }
  /// Adds a multiple of a block to `out`.
  void add(Eigen::Index i, Eigen::Index j, double weight, Eigen::Matrix3d& out) const noexcept {
    const Eigen::Map<const Eigen::Matrix3d> block(entries_.data() + first(std::max(i, j), std::min(i, j)));
    if (i >= j)
      out += weight * block;
    else
      out += weight * block.transpose();
  }
  /// Makes room for candidates 0 … count − 1.
  void resize(Eigen::Index count) noexcept { entries_.resize(static_cast<std::size_t>(first(count, 0))); }

 private:
  /// Rows of the lower triangle follow each other, so that candidates are added at the end.
  static Eigen::Index first(Eigen::Index i, Eigen::Index j) { return 9 * (i * (i + 1) / 2 + j); }

  base::Reserved<double> entries_;
};

class MovingCandidates {
 public:
  /// Allocates all memory.
  MovingCandidates(const Bodies::Block& block, const BodySurface& shape, const Model& model,
                   const StepSystem& system);

  /// A candidate moves by at most this times (2E)^½ with the energy E of the elastic modes and of R [m/N^½].
  double give(int candidate) const { return give_[static_cast<std::size_t>(candidate)]; }
  double largest_give() const { return largest_give_; }

  /// Displacements (M,3,3) at once under unit accelerations, loads or motions along the axes of the body,
  /// beyond those of the modes; and the vector that acts now, and its change in the step.
  struct StaticResponse {
    const double* to_unit = nullptr;
    Eigen::Vector3d now{0, 0, 0}, change{0, 0, 0};
  };
  std::vector<StaticResponse>& static_responses() { return static_; }

  /// Forgets the displacements that are known.
  void begin() noexcept { ++calls_; }
  /// w = Φq with static displacements [m], computed once after begin(). @param q  (N)
  const Eigen::Vector3d& displacement(int candidate, const Vector& q) noexcept;
  /// Φ Δq with their changes [m], likewise.
  const Eigen::Vector3d& change(int candidate, const Vector& dq) noexcept;
  /// The static part of the change [m].
  Eigen::Vector3d static_change(int candidate) const noexcept {
    return respond(candidate, &StaticResponse::change);
  }

  /// Adds a candidate to those under points that may touch, unless it is one of them.
  void join(int candidate) noexcept;
  /// Keeps those that are marked (M).
  void keep(const std::vector<char>& marks) noexcept;
  /// Adds multiples of the blocks between two that have joined.
  void add_blocks(int i, int j, double weight, Eigen::Matrix3d& in_modes,
                  Eigen::Matrix3d& residual) const noexcept;

  /// A point that moves between candidates: means of what candidates on patches of one size have. R between
  /// the patches themselves would ripple by half.
  struct Patch {
    Eigen::Matrix3d residual;  ///< [m/N], at least that of the mean of the candidates
    double bulge;              ///< [m]
  };
  Patch patch(std::span<const int> candidates, std::span<const double> weights) const noexcept;

  /// Adds Φᵀ f to the modal forces (N). @param force  body axes [N]
  void push(int candidate, const Eigen::Vector3d& force, Vector& modal) const noexcept;

 private:
  /// Values of candidates that are computed when they are asked for.
  struct Lazy {
    std::vector<Eigen::Vector3d> value;  ///< (M) [m]
    std::vector<std::int64_t> call;      ///< (M) for which call it was computed
  };
  const Eigen::Vector3d& of(Lazy& known, int candidate, const Vector& modal,
                            Eigen::Vector3d StaticResponse::*part) noexcept;
  Eigen::Vector3d respond(int candidate, Eigen::Vector3d StaticResponse::*part) const noexcept;
  /// (3,elastic)
  auto shape(int candidate) const {
    return Eigen::Map<const Matrix>(surface_->shape.data() + 3 * candidate * modes_, 3, modes_)
        .rightCols(elastic_);
  }
  bool yields() const { return !surface_->residual_flexibility.empty(); }
  /// (3,3) R between two candidates
  auto flexibility(int i, int j) const {
    const auto M = static_cast<Eigen::Index>(3 * surface_->size());
    return Eigen::Map<const Matrix>(surface_->residual_flexibility.data(), M, M).block<3, 3>(3 * i, 3 * j);
  }

  void make_patches(const BodySurface& shape);
  Eigen::Matrix3d flexibility_of(int candidate) const;

  const kernels::Surface* surface_;
  Eigen::Index modes_, elastic_, first_elastic_;  ///< the elastic ones come last; the first of them in q
  Vector c_, folded_;                             ///< (elastic) of a step; 1/ω² of folded modes, else 0
  bool folds_ = false;
  std::vector<double> give_;  ///< (M) (Σ|φ|²/ω² + tr R)^½
  double largest_give_ = 0;
  std::vector<StaticResponse> static_;
  std::int64_t calls_ = 0;
  Lazy displacement_, change_;
  std::vector<int> joined_, number_of_;  ///< candidates; (M) place among them, or −1
  CandidateBlocks in_modes_, residual_;
  std::vector<Patch> patches_;  ///< (M), or empty if no element is curved
};

}  // namespace ricochet::contact
