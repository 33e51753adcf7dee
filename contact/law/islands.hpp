// SPDX-License-Identifier: BSD-2-Clause
// Islands: bodies that contact joins now, directly or through others. Half-spaces join nothing. An island has
// the number of one of its bodies.
#pragma once

#include <span>
#include <vector>

namespace ricochet::contact {

/// Only the constructor allocates.
class Islands {
 public:
  struct Sides {
    int a, b;  ///< bodies of a pair; b = −1: a half-space
  };

  /// @param pairs  their sides
  Islands(int bodies, std::vector<Sides> pairs);

  int count() const { return static_cast<int>(parent_.size()); }  ///< at most
  int pairs() const { return static_cast<int>(sides_.size()); }

  void separate() noexcept;      ///< makes each body an island
  void join(int pair) noexcept;  ///< joins the islands of its bodies
  void assign() noexcept;        ///< to be called before of(), and after each change
  /// Of a pair; −1: between two islands.
  int of(int pair) const { return of_pair_[pair]; }
  std::span<const int> of_pairs() const { return of_pair_; }
  bool joins(int pair) const noexcept;  ///< whether its bodies are in one island
  bool same(int body, int other) const noexcept { return root(body) == root(other); }
  int of_a(int pair) const noexcept { return root(sides_[pair].a); }
  int of_body(int body) const noexcept { return root(body); }
  bool exists(int island) const { return parent_[island] == island; }

 private:
  int root(int body) const noexcept;

  std::vector<Sides> sides_;
  std::vector<int> parent_;  ///< of bodies, in a forest
  std::vector<int> of_pair_;
};

}  // namespace ricochet::contact
