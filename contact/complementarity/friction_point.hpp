// SPDX-License-Identifier: BSD-2-Clause
// Coulomb's law at one point, solved exactly: all p with w = S p − r that satisfy it.
//
//   open    p = 0,   w_n ≥ 0
//   stick   w = 0,   |p_t| ≤ μ p_n
//   slip    p_t = −μ p_n t,   w_t = |w_t| t,   w_n = 0,   |t| = 1
//
// Without p_n, the angle of t is a root of a trigonometric polynomial of degree 2, so that at most 4
// directions are possible. If S_nn ≤ μ |S_nt|, friction may turn the effect of p_n on w_n, and several
// solutions may exist although S is definite.
#pragma once

#include <Eigen/Dense>
#include <array>

namespace ricochet::contact {

enum class ContactState : unsigned char { open, stick, slip };

struct FrictionPoint {
  Eigen::Matrix3d S;  ///< symmetric, rows: normal, two tangents
  Eigen::Vector3d r;
  double coefficient = 0;  ///< μ > 0

  struct Solution {
    Eigen::Vector3d p;
    ContactState state;
    Eigen::Vector2d direction;  ///< t of slip, otherwise 0
  };
  static constexpr int most = 6;
  struct Solutions {
    std::array<Solution, most> at;
    int count = 0;
  };

  /// Whether p_n may reduce w_n in a direction of slip.
  bool may_be_ambiguous() const { return !(S(0, 0) > coefficient * S.col(0).tail<2>().norm()); }

  /// All solutions. @param all  false: may end with the first one
  Solutions solve(bool all) const noexcept;

 private:
  void add_slip(double angle, Solutions& found) const noexcept;
  void add_slips(bool all, Solutions& found) const noexcept;
};

}  // namespace ricochet::contact
