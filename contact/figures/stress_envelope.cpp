// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/stress_envelope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "contact/figures/stress_measures.hpp"
#include "contact/simd/dense.hpp"

namespace ricochet::contact {

using Eigen::Index;

namespace {

constexpr Index steps_of_block = 64;
constexpr Index nodes_of_tile = 16;  ///< whose rows of S stay in the cache
/// Share of the bound that the strongest columns have.
constexpr double strong_share = 0.9;

/// Largest factors by which the norm of a part of a stress adds to σ_v and to ½ (σ₁ − σ₃).
const double to_von_mises = std::sqrt(1.5), to_shear = std::sqrt(0.5);

}  // namespace

EnvelopeObserver::EnvelopeObserver(const kernels::Kernel& kernel)
    : stress_(kernel),
      norm_(static_cast<std::size_t>(stress_.nodes() * stress_.columns())),
      largest_(static_cast<std::size_t>(stress_.columns()), 0),
      coordinates_(stress_.columns(), steps_of_block),
      time_(steps_of_block),
      size_(largest_.size()),
      negative_(stress_.columns(), steps_of_block),
      columns_(stress_rows * nodes_of_tile, stress_.columns()),
      values_(stress_rows * nodes_of_tile, steps_of_block) {
  const Index c = stress_.columns();
  for (Index j = 0; j < c; ++j) order_.push_back(j);
  std::vector<double> rows(static_cast<std::size_t>(stress_rows * c));
  for (Index v = 0; v < stress_.nodes(); ++v) {
    stress_.copy(v, 1, order_, rows.data());
    for (Index j = 0; j < c; ++j) {
      const double f = frobenius(&rows[static_cast<std::size_t>(stress_rows * j)]);
      norm_[static_cast<std::size_t>(v * c + j)] = static_cast<float>(f);
      largest_[static_cast<std::size_t>(j)] = std::max(largest_[static_cast<std::size_t>(j)], f);
    }
  }
}

void EnvelopeObserver::observe(double time, const BodyCoordinates& at) noexcept {
  time_[static_cast<std::size_t>(count_)] = time;
  stress_.gather(at, coordinates_.col(count_).data());
  if (++count_ == steps_of_block) finish_block();
}

const StressEnvelope& EnvelopeObserver::envelope() const {
  if (count_ > 0) finish_block();
  return out_;
}

/// Sorts the columns by what they may add at any node, and leaves out those that add nothing.
void EnvelopeObserver::choose_columns() const noexcept {
  for (std::size_t j = 0; j < size_.size(); ++j)
    size_[j] = coordinates_.row(static_cast<Index>(j)).head(count_).cwiseAbs().maxCoeff();
  const auto worth = [&](Index j) {
    return size_[static_cast<std::size_t>(j)] * largest_[static_cast<std::size_t>(j)];
  };
  std::ranges::sort(order_, [&](Index i, Index j) { return worth(i) > worth(j); });
  double total = 0, sum = 0;
  for (used_ = 0; used_ < std::ssize(order_) && worth(order_[static_cast<std::size_t>(used_)]) > 0; ++used_)
    total += worth(order_[static_cast<std::size_t>(used_)]);
  for (strong_ = 0; strong_ < used_ && sum < strong_share * total; ++strong_)
    sum += worth(order_[static_cast<std::size_t>(strong_)]);
  for (Index j = 0; j < used_; ++j)
    negative_.row(j).head(count_) = -coordinates_.row(order_[static_cast<std::size_t>(j)]).head(count_);
}

/// Whether a stress to which a part of norm `rest` is to be added may exceed a largest value so far.
bool EnvelopeObserver::may_grow(Index node, const double* stress, double rest) const noexcept {
  const auto v = static_cast<std::size_t>(node);
  const double equivalent = von_mises(stress);
  return equivalent + to_von_mises * rest > out_.von_mises.value[v] ||
         mean_stress(stress) + equivalent * 2 / 3 + rest > out_.principal.value[v] ||
         equivalent * std::numbers::inv_sqrt3 + to_shear * rest > out_.shear.value[v];
}

void EnvelopeObserver::take(Index node, const double* stress, double time) const noexcept {
  if (!may_grow(node, stress, 0)) return;
  const auto v = static_cast<std::size_t>(node);
  const auto raise = [&](StressEnvelope::Largest& of, double value) {
    if (value > of.value[v]) of.value[v] = value, of.time[v] = time;
  };
  const auto [first, third] = principal(stress);
  raise(out_.von_mises, von_mises(stress));
  raise(out_.principal, first);
  raise(out_.shear, (first - third) / 2);
}

void EnvelopeObserver::finish_block() const noexcept {
  const Index c = stress_.columns(), nodes = stress_.nodes();
  if (out_.von_mises.value.empty())
    for (StressEnvelope::Largest* of : {&out_.von_mises, &out_.principal, &out_.shear}) {
      of->value.assign(static_cast<std::size_t>(nodes), -std::numeric_limits<double>::infinity());
      of->time.assign(static_cast<std::size_t>(nodes), 0);
    }
  choose_columns();
  const auto bound = [&](Index node, Index from) {
    const float* f = &norm_[static_cast<std::size_t>(node * c)];
    double sum = 0;
    for (Index j = from; j < used_; ++j) {
      const auto column = static_cast<std::size_t>(order_[static_cast<std::size_t>(j)]);
      sum += size_[column] * f[column];
    }
    return sum;
  };
  // Adds the part of some columns to the stress of some nodes at all steps.
  const auto add = [&](Index first, Index rows, Index from, Index to) {
    if (from == to) return;
    stress_.copy(
        first, rows / stress_rows,
        std::span(order_).subspan(static_cast<std::size_t>(from), static_cast<std::size_t>(to - from)),
        columns_.data());
    simd::dense().subtract_product(rows, count_, to - from, columns_.data(), rows, &negative_(from, 0),
                                   negative_.rows(), values_.data(), values_.rows());
  };
  const double unstressed[kernels::stress_rows] = {};
  for (Index first = 0; first < nodes; first += nodes_of_tile) {
    const Index count = std::min(nodes_of_tile, nodes - first), rows = stress_rows * count;
    double rest[nodes_of_tile];
    bool grows = false;
    for (Index v = 0; v < count; ++v) {
      rest[v] = bound(first + v, strong_);
      grows = grows || may_grow(first + v, unstressed, bound(first + v, 0));
    }
    if (!grows) continue;
    const auto any = [&](auto&& act) {
      for (Index k = 0; k < count_; ++k)
        for (Index v = 0; v < count; ++v)
          if (act(v, &values_(stress_rows * v, k), k)) return true;
      return false;
    };
    values_.leftCols(count_).setZero();
    add(first, rows, 0, strong_);
    if (!any([&](Index v, const double* s, Index) { return may_grow(first + v, s, rest[v]); })) continue;
    add(first, rows, strong_, used_);
    any([&](Index v, const double* s, Index k) {
      take(first + v, s, time_[static_cast<std::size_t>(k)]);
      return false;
    });
  }
  count_ = 0;
}

}  // namespace ricochet::contact
