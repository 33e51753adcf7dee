// SPDX-License-Identifier: BSD-2-Clause
// Two or more bodies and the pairs of surfaces that may touch, as one constant modal system.
//
// Modes of all bodies are stacked in q (N); paired candidates of all pairs are stacked in i (m).
//   u = B q + s − R p     relative displacement, of a minus b
//   s                     static correction of the loads, plus the static lift of moving supports
//   p                     forces on b, and −p on a [N]; modal force of contact −Bᵀ p
// Rows of u and p: first the m normal ones, along n_i. There u_i ≤ g_i (impenetrability), u grows when a gap
// closes, and p_i = λ_i ≥ 0 is the compressive force. Each point with friction has two more rows, along its
// tangents, of the tangential displacement w and force τ. Without friction, n = m.
//
// u includes the springs of points (patch_spring.hpp): in normal rows, u = B q + s − R p − s(λ). The current
// gap is then g − u everywhere, and s(λ) belongs to the residual displacement, as R p does.
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contact/complementarity/patch_spring.hpp"
#include "contact/model/history.hpp"
#include "contact/pairing/placement.hpp"
#include "contact/pairing/types.hpp"
#include "ricochet/kernel.hpp"

namespace ricochet::contact {

/// P (n, cM) of one body, with u = Σ_bodies P · (displacement of its candidates in its own frame).
using Selection = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// A load or a moving support of the scene: `vector` times a history.
struct ForcingRequest {
  std::string body;
  std::string name;                                  ///< of the load, or of the motion, in the kernel
  bool support = false;                              ///< whether it is a moving support
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();  ///< world axes; load: [Pa] or [N], support: [m]
  History history{};
};

struct Model {
  // modes (N)
  Vector omega, decay;  ///< [rad/s], [1/s]
  Vector load;          ///< constant modal force, of gravity, f_n [kg^1/2 m/s²]
  Vector q0;            ///< initial modal displacement: static under dead loads, and rigid [kg^1/2 m]
  Vector v0;            ///< initial modal velocity, of the rigid modes [kg^1/2 m/s]
  // contact points (m) and their rows (n)
  Matrix B;  ///< (n,N) [kg^-1/2]
  Matrix R;  ///< (n,n) [m/N]; zero if the kernels contain none
  bool has_residual = false;
  Vector gap;  ///< (m) g [m]
  /// (m) b, by which the patches of a pair bulge beyond their means [m]; empty: 0. A point with b > 0 has a
  /// spring if it has residual flexibility; build_model adds the bulges of other points to their gaps.
  Vector bulge;
  Vector static_displacement;  ///< (n) constant part of s, due to gravity [m]
  Matrix R_a{};     ///< (n,n) share of body a of each row in R [m/N]; empty if no pair has a second body
  Vector static_a;  ///< (n) share of body a in static_displacement [m]
  Vector area;      ///< (m) [m²]
  Matrix point_a, point_b, normal;  ///< (m,3) world
  /// (m) how many smooth faces of a body meet at the point: 1 within a face, 2 on a crease, more at a corner.
  std::vector<int> faces{};

  /// A point with friction.
  struct FrictionPoint {
    int point = 0;       ///< its normal row
    int tangential = 0;  ///< the first of its two tangential rows
    Friction law;
  };
  std::vector<FrictionPoint> friction{};  ///< (f) in the order of their points
  Matrix tangent{};                       ///< (2f,3) of each tangential row, world

  const Matrix& residual_of_a() const { return R_a.size() > 0 ? R_a : R; }  ///< R_a
  Eigen::Index points() const { return gap.size(); }                        ///< m
  Eigen::Index rows() const { return B.rows(); }                            ///< n = m + 2 f
  /// (n) R_ii of the kernels, and the share of body a in it: under the patches themselves, without folded
  /// modes [m/N].
  Vector patch_flexibility() const { return folded.modes.empty() ? Vector(R.diagonal()) : folded.R; }
  Vector patch_flexibility_of_a() const {
    return folded.modes.empty() ? Vector(residual_of_a().diagonal()) : folded.R_a;
  }
  /// (m) springs of the points; empty if no point has one.
  std::vector<PatchSpring> springs() const;

  /// The tangential motion of a half-space.
  struct Belt {
    std::string obstacle;
    Vector slide;     ///< (n) its displacement along the rows for a history of value 1 [m]; 0 in normal rows
    History history;  ///< 0 at t = 0
  };
  std::vector<Belt> belts{};

  struct BodyBlock {
    std::string name;
    int first_mode = 0, modes = 0;
    double mass = 0;
    Eigen::Vector3d centre;                                     ///< world, initial [m]
    Eigen::Matrix3d inertia;                                    ///< world, about the centre [kg m²]
    Eigen::Matrix<double, 3, Eigen::Dynamic> momentum;          ///< (3,modes) world: p = momentum · q̇
    Eigen::Matrix<double, 3, Eigen::Dynamic> angular_momentum;  ///< (3,modes) world, about the world's origin
    bool supported = false;
    Eigen::Vector3d weight;  ///< m g [N]
    const kernels::Kernel* kernel = nullptr;
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
    Selection selection;  ///< (n, cM)
    /// (n, rM) the same for static corrections, whose components are those of Surface::residual_components
    Selection static_selection;
  };
  std::vector<BodyBlock> bodies;

  struct PairBlock {
    int first_point = 0, points = 0, unpaired = 0;
    int a = 0, b = -1;                    ///< indices of the bodies; b = −1 for a half-space
    std::optional<double> reach;          ///< [m] set if points beyond it were dropped
    std::string obstacle{};               ///< name of the half-space, if b = −1
    int first_tangential = -1;            ///< with friction: the first of the 2 · points tangential rows
    double initial_gap = 0;               ///< g of the closest pair [m]
    std::optional<TrueDistance> apart{};  ///< of the surfaces, at the start
    /// x (n) at the rows of this pair, and 0 elsewhere.
    Vector part_of(const Vector& x) const;
  };
  std::vector<PairBlock> pairs;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();

  /// A load or a moving support, for a history of value 1. Its modal vectors cover only the modes of `body`.
  struct Forcing {
    std::string name;
    int body = 0;
    int first_mode = 0;  ///< of the body
    bool support = false;
    int entry = 0;                    ///< index of the load, or of the motion, in the kernel
    Eigen::Vector3d vector{0, 0, 0};  ///< world
    History history;
    Vector force;                    ///< (modes) modal force of a load [kg^1/2 m/s²]; 0 for a support
    Vector lift;                     ///< (modes) Γ of a support [kg^1/2 m]; 0 for a load
    Vector displacement;             ///< (n) quasi-static u: residual of a load, Ψ of a support [m]
    Vector displacement_a;           ///< (n) share of body a in displacement
    Eigen::Vector3d total{0, 0, 0};  ///< resultant force of a load [N]; 0 for a support
    Eigen::Vector3d lift_momentum{0, 0, 0};  ///< ∫ρΨ of a support, of its elastic modes and beyond [kg m]
  };
  std::vector<Forcing> forcing;

  /// A point of `body` whose motion is recorded, in world axes.
  struct Receiver {
    std::string name;
    int body = 0;
    Eigen::Vector3d point{0, 0, 0};     ///< [m]
    Matrix shape;                       ///< (3,modes) [kg^-1/2]
    Matrix flexibility;                 ///< (3,n) static correction for unit forces p [m/N]
    Eigen::Vector3d constant{0, 0, 0};  ///< static correction for gravity [m]
    Matrix forcing;                     ///< (3,forcings) static correction of loads, Ψ of supports [m]
  };
  std::vector<Receiver> receivers;

  /// Modes that respond at once, which fold() has moved into the other members. Their B, load, q0, v0 and
  /// forces of loads are 0; the lift of supports keeps them.
  struct Folded {
    std::vector<int> modes{};  ///< ascending
    Matrix B{};                ///< (n,modes) [kg^-1/2]
    Vector load{};             ///< (modes) [kg^1/2 m/s²]
    Matrix force{};            ///< (modes,forcings) of loads with a history of value 1
    Vector R{}, R_a{};         ///< (n) diagonals of R and R_a without these modes
  } folded{};

  /// Force of a pair on its body b [N]. @param force  (n)
  Eigen::Vector3d resultant(const PairBlock& pair, const Vector& force) const;
  /// The part of it due to friction [N].
  Eigen::Vector3d friction_resultant(const PairBlock& pair, const Vector& force) const;
  /// (n) u at t = 0: of the modes, of the static correction and of supports [m].
  Vector initial_displacement() const;
  /// (N) q̇ at t = 0, relative to the lift of moving supports.
  Vector initial_rates() const;
  /// Momentum of a body at t [kg m/s]. @param v  (N) modal rates relative to the supports
  Eigen::Vector3d momentum(int body, const Vector& v, double t) const;
  /// Angular momentum of a body about the world's origin, carried by its modes [kg m²/s]. @param v  as above
  Eigen::Vector3d angular_momentum(int body, const Vector& v, double t) const;
};

/// Stacks placed bodies and their pairs, in their order.
///
/// Elastic modes start at rest under gravity and dead loads, q0_n = f_n/ω_n². With the static correction, a
/// supported body so starts in its static equilibrium. Elastic modes carry no momentum, so for a body that
/// can move rigidly this is the equilibrium with the inertia of its rigid acceleration (inertia relief): a
/// free body falls without strain. A body with an initial displacement starts away from its place, at which
/// its pairs are found. Throws InputError if a kernel omits a paired candidate or lacks a load or
/// motion, if a support would jump or makes bodies overlap at the start, or if a pair has friction and a
/// kernel lacks the tangential components.
Model build_model(const Placement& placement, const Eigen::Vector3d& gravity,
                  const std::vector<ForcingRequest>& forcing = {});

/// A pointer to a model that outlives it.
inline std::shared_ptr<const Model> borrowed(const Model& model) {
  return {std::shared_ptr<const Model>(), &model};
}

/// Adds the bulges to the gaps, which then are those between the means of patches, for laws without springs
/// (impulses, tables).
void use_mean_gaps(Model& model);

/// Sets a half-space in tangential motion: its displacement is `vector` [m], world axes, times a history.
/// Does nothing unless a pair with friction names the half-space. Throws InputError if the vector is not
/// tangential to the half-space, or if the history jumps at its first knot.
void add_belt(Model& model, const std::string& obstacle, const Eigen::Vector3d& vector, History history);

/// Two unit tangents (2,3) of a unit normal, orthogonal to each other.
Eigen::Matrix<double, 2, 3> tangents_of(const Eigen::Vector3d& normal);

/// Throws InputError if bodies overlap at t = 0 because dead loads deform them.
void refuse_sag(const Model& model);

/// Throws InputError if a body that arrives later would start inside another one, because gravity turns it on
/// its way.
/// @param arrival  of each body [s]; 0: it does not arrive later
void refuse_early_contact(const Model& model, const std::vector<double>& arrival);

/// Places the bodies first. Also throws InputError as `place` does.
inline Model build_model(std::vector<PlacedBody> bodies, const std::vector<HalfSpace>& obstacles,
                         const std::vector<PairRequest>& pairs, const Eigen::Vector3d& gravity,
                         const std::vector<ForcingRequest>& forcing = {}) {
  return build_model(place(std::move(bodies), obstacles, pairs), gravity, forcing);
}

}  // namespace ricochet::contact
