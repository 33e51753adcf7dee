// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/flexibility.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace ricochet::kernels {

Flexibility::Flexibility(const Surface& surface)
    : candidates_(surface.size()), components_(static_cast<std::size_t>(surface.residual_components())) {
  if (surface.compact)
    compact_ = &*surface.compact;
  else if (!surface.residual_flexibility.empty())
    double_ = surface.residual_flexibility.data();
}

/// E_ij of candidates i ≤ j; null if it is 0.
const float* Flexibility::near(std::size_t i, std::size_t j) const noexcept {
  const auto from = compact_->near_candidate.begin() + compact_->near_first[i],
             to = compact_->near_candidate.begin() + compact_->near_first[i + 1],
             found = std::lower_bound(from, to, static_cast<std::int64_t>(j));
  if (found == to || *found != static_cast<std::int64_t>(j)) return nullptr;
  return compact_->near_block.data() + 9 * (found - compact_->near_candidate.begin());
}

void Flexibility::block(std::size_t i, std::size_t j, double* out) const noexcept {
  const std::size_t r = components_, width = r * candidates_;
  const auto copy = [&](const auto* from) {
    for (std::size_t a = 0; a < r; ++a)
      for (std::size_t b = 0; b < r; ++b) out[r * a + b] = from[(r * i + a) * width + r * j + b];
  };
  if (compact_ == nullptr) return copy(double_);
  if (!compact_->compressed()) return copy(compact_->whole.data());
  // In double precision: sums in single precision would not be semidefinite.
  const auto k = static_cast<std::size_t>(compact_->columns);
  const float *one = compact_->global.data() + 3 * i * k, *other = compact_->global.data() + 3 * j * k;
  constexpr std::size_t lanes = 4;  // partial sums, which the compiler can keep in one register
  std::array<std::array<double, lanes>, 9> part{};
  const auto add_products = [&](std::size_t s, std::size_t count) {
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        for (std::size_t l = 0; l < count; ++l)
          part[3 * a + b][l] +=
              static_cast<double>(one[a * k + s + l]) * static_cast<double>(other[b * k + s + l]);
  };
  std::size_t s = 0;
  for (; s + lanes <= k; s += lanes) add_products(s, lanes);
  add_products(s, k - s);
  std::array<double, 9> sum{};
  for (std::size_t e = 0; e < 9; ++e)
    for (const double one_lane : part[e]) sum[e] += one_lane;
  if (const float* own = near(std::min(i, j), std::max(i, j)))
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) sum[3 * a + b] += own[i <= j ? 3 * a + b : 3 * b + a];
  std::ranges::copy(sum, out);
}

void Flexibility::add_row(std::size_t row, double weight, double* x) const noexcept {
  const std::size_t width = components_ * candidates_;
  const auto add = [&](const auto* from) {
    for (std::size_t c = 0; c < width; ++c) x[c] += weight * from[row * width + c];
  };
  if (compact_ == nullptr) return add(double_);
  if (!compact_->compressed()) return add(compact_->whole.data());
  std::array<double, 9> own{};
  for (std::size_t j = 0; j < candidates_; ++j) {
    block(row / 3, j, own.data());
    for (std::size_t b = 0; b < 3; ++b) x[3 * j + b] += weight * own[row % 3 * 3 + b];
  }
}

}  // namespace ricochet::kernels
