// SPDX-License-Identifier: BSD-2-Clause
// The model of bodies that turn after some have been removed and others added.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// Parts of a model that are those of an earlier one, in the same order.
struct Correspondence {
  /// Consecutive entries that have moved.
  struct Run {
    Eigen::Index from, to, size;
  };
  std::vector<int> body, pair;  ///< number in the earlier model of each body and pair, or −1
  std::vector<Run> modes, points, rows, friction;  ///< of N, m, n and f entries

  /// Where each of `size` entries of the earlier model is now, or −1.
  static std::vector<int> places(const std::vector<Run>& runs, Eigen::Index size);
};

/// Copies the rows of vectors and matrices that have moved.
template <class Values>
void carry(const Values& earlier, Values& now, const std::vector<Correspondence::Run>& runs) {
  for (const auto& [from, to, size] : runs) now.middleRows(to, size) = earlier.middleRows(from, size);
}
template <class T>
void carry(const std::vector<T>& earlier, std::vector<T>& now, const std::vector<Correspondence::Run>& runs) {
  for (const auto& [from, to, size] : runs) std::copy_n(earlier.begin() + from, size, now.begin() + to);
}

struct ChangedModel {
  Model model;
  Correspondence from;
};

/// Returns a model without belts and receivers: the bodies of `earlier` that are kept, with their loads and
/// the pairs between them, and then new bodies with new pairs. What was initial in `earlier` stays so.
/// @param earlier  of bodies that turn  @param kept  ascending numbers of its bodies
/// @param added  if given: the kept bodies at their present places, then the new ones, and the new pairs.
/// Throws InputError as build_rows and build_bodies do.
ChangedModel change(const Model& earlier, std::span<const int> kept, const Placement* added);

}  // namespace ricochet::contact
