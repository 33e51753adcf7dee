// SPDX-License-Identifier: BSD-2-Clause
// The candidates of a body that turns, in its axes: their elastic displacements, and the blocks Φ c Φᵀ and R
// between those under points that may touch. The blocks are constant: they are gathered once, when a
// candidate joins.
#pragma once

#include <span>
#include <vector>

#include "base/reserved.hpp"
#include "contact/motion/body_surface.hpp"
#include "contact/simd/dense.hpp"
#include "contact/stepping/step_system.hpp"
#include "kernels/flexibility.hpp"

namespace ricochet::contact {

/// A symmetric matrix (3k,3k) of blocks between k candidates, whose number may change without allocation.
class CandidateMatrix {
 public:
  using Block = Eigen::Map<Eigen::Matrix3d, 0, Eigen::OuterStride<>>;
  /// @param candidates  capacity
  explicit CandidateMatrix(std::size_t candidates)
      : stride_(padded(3 * candidates)), entries_(3 * candidates * stride_) {}
  Block operator()(std::size_t i, std::size_t j) noexcept {
    return Block(entries_.data() + 3 * j * stride_ + 3 * i,
                 Eigen::OuterStride<>(static_cast<Eigen::Index>(stride_)));
  }
  /// Σ weight_j weight_k of blocks between some candidates.
  Eigen::Matrix3d mean(std::span<const std::size_t> at, std::span<const double> weight) noexcept {
    Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
    for (std::size_t j = 0; j < at.size(); ++j)
      for (std::size_t k = 0; k < at.size(); ++k) out += weight[j] * weight[k] * (*this)(at[j], at[k]);
    return out;
  }
  const double* data() const noexcept { return entries_.data(); }
  std::size_t stride() const { return stride_; }  ///< distance of columns, which begin at cache lines
  /// Makes room for candidates 0 … count − 1; blocks keep their places.
  void resize(std::size_t count) noexcept { entries_.resize(3 * count * stride_); }
  /// Of candidates 0 … count − 1.
  void archive(auto& a, std::size_t count) {
    if (3 * count * stride_ > entries_.capacity()) return a.fail();
    resize(count);
    for (std::size_t j = 0; j < 3 * count; ++j) a.entries(entries_.data() + j * stride_, 3 * count);
  }

 private:
  /// Of an odd number of cache lines: columns do not compete for the same places in the cache.
  static std::size_t padded(std::size_t rows) {
    constexpr std::size_t line = 8;
    return ((rows + line - 1) / line | 1) * line;
  }

  std::size_t stride_;
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
    void archive(auto& a) { a(now, change); }
  };
  std::vector<StaticResponse>& static_responses() { return static_; }

  /// Forgets the displacements that are known.
  void begin_displacements() noexcept { ++displacement_.calls; }
  /// Forgets the changes that are known, unless they are those that were expected. @param dq  (N)
  void begin_changes(const Vector& dq) noexcept;
  /// Whether the shapes of those that have joined exceed the nearest cache, so that one pass over them is
  /// worth while.
  bool fills_cache() const noexcept { return 3 * joined_.size() * width_ * sizeof(double) > nearest_cache; }
  /// Expects changes: they are computed with the displacements, in one pass over the shapes. @param dq  (N)
  void expect(const Vector& dq) noexcept;
  /// w = Φq with static displacements [m], computed once after begin_displacements(). @param q  (N)
  const Eigen::Vector3d& displacement(int candidate, const Vector& q) noexcept;
  /// Φ Δq with their changes [m], computed once after begin_changes(). @param dq  (N)
  const Eigen::Vector3d& change(int candidate, const Vector& dq) noexcept;
  /// The static part of the change [m].
  Eigen::Vector3d static_change(int candidate) const noexcept {
    return respond(candidate, &StaticResponse::change);
  }

  /// Adds a candidate to those under points that may touch, unless it is one of them.
  void join(int candidate) noexcept;
  /// Keeps those that are marked (M).
  void keep(const std::vector<char>& marks) noexcept;
  int joined() const { return static_cast<int>(joined_.size()); }  ///< their number
  /// Place of a candidate among those that have joined.
  int place_of(int candidate) const { return number_of_[static_cast<std::size_t>(candidate)]; }
  int at_place(std::size_t place) const { return joined_[place]; }  ///< candidate
  const CandidateMatrix& of_modes() const { return of_modes_; }     ///< Φ c Φᵀ, by place
  CandidateMatrix& residual() { return residual_; }  ///< R_body, by place; undefined if it is 0
  const CandidateMatrix& residual() const { return residual_; }
  bool yields() const { return folds_ || has_residual(); }  ///< whether R_body is not 0

  struct Patch {
    Eigen::Matrix3d residual;  ///< [m/N]
    double bulge;              ///< [m]; below 0 where the surface is hollow
  };
  /// Means of what candidates have, without folded modes.
  Patch own_patch(std::span<const int> candidates, std::span<const double> weights) const noexcept {
    return mean_of(own_patches_, candidates, weights);
  }
  /// That of a point that moves between candidates: means of what candidates on patches of one size have, at
  /// least R of the mean of the candidates. R between the patches themselves would ripple by half.
  Patch patch(std::span<const int> candidates, std::span<const double> weights) const noexcept {
    return mean_of(patches_, candidates, weights);
  }

  /// Adds Φᵀ f to the modal forces (N). @param forces  (joined,3) by place, body axes [N]
  void push(const double* forces, Vector& modal) const noexcept {
    simd::dense().add_rows(3 * joined_.size(), static_cast<std::size_t>(elastic_), rows_.data(), width_,
                           forces, modal.data() + first_elastic_);
  }
  bool has_static() const { return !static_.empty(); }  ///< whether there are static responses

  /// The blocks depend to the last bit on the order in which candidates have joined.
  void archive(auto& a) {
    a(static_, joined_, number_of_, rows_);
    of_modes_.archive(a, joined_.size());
    if (yields()) residual_.archive(a, joined_.size());
    if (!a.reads()) return;
    begin_displacements();
    expects_ = false;
    ++change_.calls;
  }

 private:
  static constexpr std::size_t nearest_cache = 48 << 10;  ///< of usual processors [B]

  /// Values of candidates that are computed when they are asked for.
  struct Lazy {
    std::vector<Eigen::Vector3d> value;  ///< (M) [m]
    std::vector<std::int64_t> call;      ///< (M) for which call it was computed
    std::int64_t calls = 0;
  };
  const Eigen::Vector3d& of(Lazy& known, int candidate, const Vector& modal,
                            Eigen::Vector3d StaticResponse::*part) noexcept;
  Eigen::Vector3d respond(int candidate, Eigen::Vector3d StaticResponse::*part) const noexcept;
  /// (3,elastic)
  auto shape(int candidate) const {
    return Eigen::Map<const Matrix>(surface_->shape.data() + 3 * candidate * modes_, 3, modes_)
        .rightCols(elastic_);
  }
  bool has_residual() const { return !flexibility_.empty(); }
  /// R between two candidates
  Eigen::Matrix3d flexibility(int i, int j) const noexcept {
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> out;
    flexibility_.block(static_cast<std::size_t>(i), static_cast<std::size_t>(j), out.data());
    return out;
  }

  static Patch mean_of(const std::vector<Patch>& patches, std::span<const int> candidates,
                       std::span<const double> weights) noexcept;
  void make_patches(const BodySurface& shape);
  Eigen::Matrix3d flexibility_of(int candidate) const;

  const kernels::Surface* surface_;
  kernels::Flexibility flexibility_;              ///< R
  Eigen::Index modes_, elastic_, first_elastic_;  ///< the elastic ones come last; the first of them in q
  Vector c_, folded_;                             ///< (elastic) of a step; 1/ω² of folded modes, else 0
  bool folds_ = false;
  std::vector<double> give_;  ///< (M) (Σ|φ|²/ω² + tr R)^½
  double largest_give_ = 0;
  std::vector<StaticResponse> static_;
  Lazy displacement_, change_;
  Vector expected_;  ///< (elastic) Δq of the changes that are known with the displacements
  bool expects_ = false;
  std::vector<int> joined_, number_of_;  ///< candidates; (M) place among them, or −1
  CandidateMatrix of_modes_, residual_;
  /// Φ of those that have joined (joined,3,width), with rows that begin at cache lines: passes over them are
  /// bound by the cache.
  base::Reserved<double> rows_;
  std::size_t width_;
  base::AlignedVector<double> products_;  ///< (2,M,3) scratch
  std::vector<Patch> own_patches_;        ///< (M)
  std::vector<Patch> patches_;            ///< (M) of one size, or empty without triangles
};

}  // namespace ricochet::contact
