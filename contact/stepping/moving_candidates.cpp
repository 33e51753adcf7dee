// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/moving_candidates.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <numbers>

namespace ricochet::contact {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// The number of entries of a row that ends with a cache line.
std::size_t padded(std::size_t entries) {
  constexpr std::size_t line = 8;
  return (entries + line - 1) / line * line;
}

}  // namespace

MovingCandidates::MovingCandidates(const Bodies::Block& block, const BodySurface& on, const Model& model,
                                   const StepSystem& system)
    : surface_(&block.kernel->surface),
      flexibility_(*surface_),
      modes_(block.modes),
      elastic_(block.modes - block.frame_modes()),
      first_elastic_(block.first_mode + block.frame_modes()),
      c_(system.c.segment(first_elastic_, elastic_)),
      folded_(Vector::Zero(elastic_)),
      of_modes_(surface_->size()),
      residual_(surface_->size()),
      rows_(3 * surface_->size() * padded(static_cast<std::size_t>(elastic_))),
      width_(padded(static_cast<std::size_t>(elastic_))),
      products_(6 * surface_->size()) {
  const std::size_t M = surface_->size();
  const auto omega = model.omega.segment(first_elastic_, elastic_).transpose().array();
  for (const int n : model.folded.modes)
    if (const Index own = n - first_elastic_; own >= 0 && own < elastic_) {
      folded_(own) = 1 / (model.omega(n) * model.omega(n));
      folds_ = true;
    }
  for (int i = 0; i < static_cast<int>(M); ++i) {
    double give = (shape(i).colwise().squaredNorm().array() / omega.square()).sum();
    own_patches_.push_back({has_residual() ? flexibility(i, i) : Matrix3d::Zero(),
                            surface_->bulge.empty() ? 0 : surface_->bulge[static_cast<std::size_t>(i)]});
    give += own_patches_.back().residual.trace();
    give_.push_back(std::sqrt(give));
    largest_give_ = std::max(largest_give_, give_.back());
  }
  if (const std::vector<double>& settling = block.kernel->loads.body_force_residual;
      block.supported && !settling.empty())
    static_.push_back({settling.data(), block.rotation.transpose() * model.gravity});
  for (Lazy* known : {&displacement_, &change_}) {
    known->value.assign(M, Vector3d::Zero());
    known->call.assign(M, -1);
  }
  expected_.setZero(elastic_);
  number_of_.assign(M, -1);
  joined_.reserve(M);
  if (on.surface().corners == 3) make_patches(on);
}

/// R of a candidate, with folded modes.
Matrix3d MovingCandidates::flexibility_of(int candidate) const {
  const Matrix own = shape(candidate);
  return own * folded_.asDiagonal() * own.transpose() +
         own_patches_[static_cast<std::size_t>(candidate)].residual;
}

/// R of a patch of the radius a is about α + c/a. The fit of c takes all patches to the smallest radius; what
/// remains is smoothed over neighbours, and raised until it is nowhere below R of the candidates: a point
/// that moves adds the difference as a spring of its own. Creases, where R is larger, are kept apart from
/// faces.
void MovingCandidates::make_patches(const BodySurface& on) {
  const std::size_t M = surface_->size();
  std::vector<Matrix3d> own(M);
  std::vector<double> inverse(M);  // of a
  double largest = 0, mean = 0, square = 0, product = 0;
  for (std::size_t i = 0; i < M; ++i) {
    own[i] = flexibility_of(static_cast<int>(i));
    inverse[i] = std::sqrt(std::numbers::pi / surface_->area[i]);
    largest = std::max(largest, inverse[i]);
    mean += inverse[i] / static_cast<double>(M);
  }
  for (std::size_t i = 0; i < M; ++i) {
    square += (inverse[i] - mean) * (inverse[i] - mean);
    product += (inverse[i] - mean) * own[i].trace() / 3;
  }
  const double slope = square > 1e-6 * largest * largest ? std::max(product / square, 0.0) : 0;
  const auto even = [&](std::size_t i) -> Matrix3d {
    return own[i] + slope * (largest - inverse[i]) * Matrix3d::Identity();
  };
  const std::vector<std::int8_t>& on_crease = on.surface().on_crease;
  std::array<double, 2> missing{};  // in faces, on creases
  for (std::size_t i = 0; i < M; ++i) {
    Matrix3d sum = Matrix3d::Zero();
    double weights = 0;
    const auto add = [&](std::size_t j) {
      const double way = (on.surface().node[i] - on.surface().node[j]).norm() /
                         (1.5 * on.element_size(static_cast<int>(i))),
                   weight = std::exp(-way * way);
      sum += weight * even(j);
      weights += weight;
    };
    add(i);
    for (const int j : on.around(static_cast<int>(i)))
      if (on_crease[static_cast<std::size_t>(j)] == on_crease[i]) add(static_cast<std::size_t>(j));
    const double share = inverse[i] / largest;  // a_min/a_i
    patches_.push_back({sum / weights, own_patches_[i].bulge * share * share});
    double& most = missing[static_cast<std::size_t>(on_crease[i])];
    most = std::max(
        most,
        Eigen::SelfAdjointEigenSolver<Matrix3d>(own[i] - patches_[i].residual).eigenvalues().maxCoeff());
  }
  for (std::size_t i = 0; i < M; ++i)
    patches_[i].residual += missing[static_cast<std::size_t>(on_crease[i])] * Matrix3d::Identity();
}

MovingCandidates::Patch MovingCandidates::mean_of(const std::vector<Patch>& patches,
                                                  std::span<const int> candidates,
                                                  std::span<const double> weights) noexcept {
  Patch out{Matrix3d::Zero(), 0};
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Patch& one = patches[static_cast<std::size_t>(candidates[k])];
    out.residual += weights[k] * one.residual;
    out.bulge += weights[k] * one.bulge;
  }
  return out;
}

Vector3d MovingCandidates::respond(int candidate, Vector3d StaticResponse::*part) const noexcept {
  Vector3d out = Vector3d::Zero();
  for (const StaticResponse& one : static_)
    out += Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(one.to_unit + 9 * candidate) *
           (one.*part);
  return out;
}

void MovingCandidates::expect(const Vector& dq) noexcept {
  expects_ = static_.empty() && fills_cache();
  if (!expects_) return;
  expected_ = dq.segment(first_elastic_, elastic_);
  ++change_.calls;
}

void MovingCandidates::begin_changes(const Vector& dq) noexcept {
  if (expects_ && dq.segment(first_elastic_, elastic_) == expected_) return;
  expects_ = false;
  ++change_.calls;
}

/// Those that have joined are computed together, displacements with the changes that are expected.
const Vector3d& MovingCandidates::of(Lazy& known, int candidate, const Vector& modal,
                                     Vector3d StaticResponse::*part) noexcept {
  const auto i = static_cast<std::size_t>(candidate);
  if (known.call[i] == known.calls) return known.value[i];
  const auto own = modal.segment(first_elastic_, elastic_);
  const auto set = [&](Lazy& to, int number, const Vector3d& value) {
    to.call[static_cast<std::size_t>(number)] = to.calls;
    to.value[static_cast<std::size_t>(number)] = value;
    if (!static_.empty()) to.value[static_cast<std::size_t>(number)] += respond(number, part);
  };
  if (number_of_[i] < 0) {
    set(known, candidate, shape(candidate) * own);
    return known.value[i];
  }
  const std::size_t rows = 3 * joined_.size(), n = static_cast<std::size_t>(elastic_);
  const bool both = &known == &displacement_ && expects_;
  const std::array<const double*, 2> x{own.data(), expected_.data()};
  const std::array<double*, 2> products{products_.data(), products_.data() + rows};
  if (both)
    simd::dense().two_row_products(rows, n, rows_.data(), width_, x.data(), products.data());
  else
    simd::dense().row_products(rows, n, rows_.data(), width_, x[0], products[0]);
  for (std::size_t k = 0; k < joined_.size(); ++k) {
    set(known, joined_[k], Eigen::Map<const Vector3d>(products[0] + 3 * k));
    if (both) set(change_, joined_[k], Eigen::Map<const Vector3d>(products[1] + 3 * k));
  }
  return known.value[i];
}

const Vector3d& MovingCandidates::displacement(int candidate, const Vector& q) noexcept {
  return of(displacement_, candidate, q, &StaticResponse::now);
}

const Vector3d& MovingCandidates::change(int candidate, const Vector& dq) noexcept {
  return of(change_, candidate, dq, &StaticResponse::change);
}

void MovingCandidates::join(int candidate) noexcept {
  if (number_of_[static_cast<std::size_t>(candidate)] >= 0) return;
  const std::size_t s = joined_.size();
  number_of_[static_cast<std::size_t>(candidate)] = static_cast<int>(s);
  joined_.push_back(candidate);
  of_modes_.resize(s + 1);
  if (yields()) residual_.resize(s + 1);
  rows_.resize(3 * (s + 1) * width_);
  const auto own = shape(candidate);
  for (int axis = 0; axis < 3; ++axis) {
    double* const row = rows_.data() + (3 * s + static_cast<std::size_t>(axis)) * width_;
    std::fill_n(row, width_, 0.0);
    Eigen::Map<Vector>(row, elastic_) = own.row(axis);
  }
  // Φ d Φᵀ, entry by entry: a product of matrices would allocate.
  const auto block = [&](const auto& diagonal, const auto& other) {
    Matrix3d out;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out(i, j) = own.row(i).cwiseProduct(diagonal.transpose()).dot(other.row(j));
    return out;
  };
  for (std::size_t t = 0; t <= s; ++t) {
    const int other = joined_[t];
    of_modes_(s, t) = block(c_, shape(other));
    of_modes_(t, s) = of_modes_(s, t).transpose();
    if (!yields()) continue;
    Matrix3d yielding = has_residual() ? flexibility(candidate, other) : Matrix3d::Zero();
    if (folds_) yielding += block(folded_, shape(other));
    residual_(s, t) = yielding;
    residual_(t, s) = yielding.transpose();
  }
}

/// Blocks move towards the front, in their order, so that none is overwritten before it has moved.
void MovingCandidates::keep(const std::vector<char>& marks) noexcept {
  const auto stays = [&](int candidate) { return marks[static_cast<std::size_t>(candidate)] != 0; };
  if (std::all_of(joined_.begin(), joined_.end(), stays)) return;
  std::size_t kept = 0;
  for (std::size_t s = 0; s < joined_.size(); ++s) {
    if (!stays(joined_[s])) continue;
    std::copy_n(rows_.data() + 3 * s * width_, 3 * width_, rows_.data() + 3 * kept * width_);
    std::size_t row = 0;
    for (std::size_t t = 0; t < joined_.size(); ++t) {
      if (!stays(joined_[t])) continue;
      of_modes_(row, kept) = of_modes_(t, s);
      if (yields()) residual_(row, kept) = residual_(t, s);
      ++row;
    }
    ++kept;
  }
  std::erase_if(joined_, [&](int candidate) {
    if (!stays(candidate)) number_of_[static_cast<std::size_t>(candidate)] = -1;
    return !stays(candidate);
  });
  for (std::size_t s = 0; s < joined_.size(); ++s)
    number_of_[static_cast<std::size_t>(joined_[s])] = static_cast<int>(s);
}

}  // namespace ricochet::contact
