// SPDX-License-Identifier: BSD-2-Clause
// The rows of contact between placed bodies: paired candidates of all pairs (m), then two rows for each point
// with friction (model.hpp). They are constant while the bodies keep their frames and their pairs. If bodies
// turn, the rows have no matrices here: contact/stepping/moving_points.hpp computes those of a step.
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contact/bodies/bodies.hpp"
#include "contact/pairing/placement.hpp"
#include "contact/rows/driven_motion.hpp"
#include "contact/rows/history.hpp"

namespace ricochet::contact {

/// P (n, cM) of one body, with u = Σ_bodies P · (displacement of its candidates in its own frame).
using Selection = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Where the rows act, in world axes.
struct RowFrames {
  Matrix point_a, point_b, normal;  ///< (m,3) x̂_i and y_i [m], n_i
  Matrix tangent{};                 ///< (2f,3) of each tangential row
};

struct Rows : RowFrames {
  bool turns = false;  ///< whether bodies turn: B, R and R_a are then empty
  Matrix B;            ///< (n,N) [kg^-1/2]
  Matrix R;            ///< (n,n) [m/N]; zero if the kernels contain none
  bool has_residual = true;
  Vector gap;  ///< (m) g [m]
  /// (m) b, by which the patches of a pair bulge beyond their means [m]; empty: 0. A point with b > 0 has a
  /// spring if it has residual flexibility; the bulges of other points belong to their gaps.
  Vector bulge;
  Vector static_displacement;  ///< (n) constant part of s, due to gravity [m]
  Matrix R_a{};      ///< (n,n) share of body a of each row in R [m/N]; empty if no pair has a second body
  Vector static_a;   ///< (n) share of body a in static_displacement [m]
  Vector patch_R{};  ///< (n) if bodies turn: R_ii of points that bulge, at the start [m/N]
  Vector area;       ///< (m) [m²]
  /// (m) how many smooth faces of a body meet at the point: 1 within a face, 2 on a crease, more at a corner.
  std::vector<int> faces{};
  /// (m) if bodies turn: the candidate, of a or of b, at whose place the point is; of creases and summits,
  /// one beside it.
  std::vector<int> candidate{};

  /// A point with friction.
  struct FrictionPoint {
    int point = 0;       ///< its normal row
    int tangential = 0;  ///< the first of its two tangential rows
    Friction law;
  };
  std::vector<FrictionPoint> friction{};  ///< (f) in the order of their points

  const Matrix& residual_of_a() const { return R_a.size() > 0 ? R_a : R; }   ///< R_a
  Eigen::Index points() const { return gap.size(); }                         ///< m
  Eigen::Index rows() const { return points() + 2 * std::ssize(friction); }  ///< n

  /// The tangential motion of a half-space.
  struct Belt {
    std::string obstacle;
    Vector slide;     ///< (n) its displacement along the rows for a history of value 1 [m]; 0 in normal rows
    History history;  ///< 0 at t = 0
  };
  std::vector<Belt> belts{};

  struct PairBlock {
    int first_point = 0, points = 0, unpaired = 0;
    int a = 0, b = -1;                        ///< indices of the bodies; b = −1 for an obstacle
    std::optional<double> reach;              ///< [m] set if points beyond it were dropped
    std::string obstacle{};                   ///< its name, if b = −1
    std::shared_ptr<const Obstacle> solid{};  ///< the obstacle, unless it is a half-space
    /// Of the obstacle, and of a half-space along its normal alone; null if it does not move.
    std::shared_ptr<const DrivenMotion> driven{};
    int first_tangential = -1;  ///< with friction: the first of the 2 · points tangential rows
    double initial_gap = 0;     ///< g of the closest pair [m]
    /// Of bodies that turn: the first points are candidates of a, the next ones candidates of b. Then come
    /// points for creases that cross, and the last ones are for summits of curved surfaces.
    int candidates_of_a = 0, candidates_of_b = 0, summits = 0;
    std::optional<TrueDistance> apart{};  ///< of the surfaces, at the start
    bool is_half_space() const { return b < 0 && !solid; }
    int candidates() const { return candidates_of_a + candidates_of_b; }
    int first_summit() const { return first_point + points - summits; }
    bool is_summit(int point) const { return point >= first_summit(); }
    /// x (n) at the rows of this pair, and 0 elsewhere.
    Vector part_of(const Vector& x) const;
  };
  std::vector<PairBlock> pairs;

  /// Of each body, its part in the rows: for modes, and for static corrections, whose components are those of
  /// Surface::residual_components. They have no rows if bodies turn.
  std::vector<Selection> selection{}, static_selection{};
  /// Scratch of fill(): (n) body a of each row; a row of R of one body at its candidates.
  std::vector<int> body_a{};
  Vector yielded{};

  /// Force of a pair on its body b [N]. @param force  (n) @param frames  of the rows, which move if bodies
  /// turn
  Eigen::Vector3d resultant(const PairBlock& pair, const Vector& force, const RowFrames& frames) const;
  /// The part of it due to friction [N].
  Eigen::Vector3d friction_resultant(const PairBlock& pair, const Vector& force,
                                     const RowFrames& frames) const;
};

/// Lists the rows of pairs, and fills them. Throws InputError if a kernel omits a paired candidate, or if a
/// pair has friction and a kernel lacks the tangential components.
Rows build_rows(const Placement& placement, const Bodies& bodies);

/// Computes B, R and the static displacements from the selections and from the kernels of the bodies. Does
/// not allocate. O(n N) + O(n (c M + n)) for R.
void fill(Rows& rows, const Bodies& bodies) noexcept;

/// Adds the bulges to the gaps, which then are those between the means of patches, for laws without springs
/// (impulses, tables).
void use_mean_gaps(Rows& rows);

/// Sets a half-space in tangential motion: its displacement is the part of `vector` [m], world axes, along
/// its surface, times a history. Does nothing unless a pair with friction names the half-space. Throws
/// InputError if the history jumps at its first knot.
void add_belt(Rows& rows, const std::string& obstacle, const Eigen::Vector3d& vector, History history);

/// Two unit tangents (2,3) of a unit normal, orthogonal to each other.
Eigen::Matrix<double, 2, 3> tangents_of(const Eigen::Vector3d& normal);

}  // namespace ricochet::contact
