// SPDX-License-Identifier: BSD-2-Clause
#include "contact/law/islands.hpp"

#include <numeric>
#include <utility>

namespace ricochet::contact {

Islands::Islands(int bodies, std::vector<Sides> pairs)
    : sides_(std::move(pairs)), parent_(bodies), of_pair_(sides_.size()) {
  separate();
  assign();
}

int Islands::root(int body) const noexcept {
  while (parent_[body] != body) body = parent_[body];
  return body;
}

void Islands::separate() noexcept { std::iota(parent_.begin(), parent_.end(), 0); }

void Islands::join(int pair) noexcept {
  if (const auto [a, b] = sides_[pair]; b >= 0) parent_[root(b)] = root(a);
}

bool Islands::joins(int pair) const noexcept {
  const auto [a, b] = sides_[pair];
  return b < 0 || root(a) == root(b);
}

void Islands::assign() noexcept {
  for (int pair = 0; pair < pairs(); ++pair) of_pair_[pair] = joins(pair) ? of_a(pair) : -1;
}

}  // namespace ricochet::contact
