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
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contact/bodies/bodies.hpp"
#include "contact/complementarity/patch_spring.hpp"
#include "contact/rows/history.hpp"
#include "contact/rows/rows.hpp"
#include "ricochet/scheme.hpp"

namespace ricochet::contact {

/// A load or a moving support of the scene: `vector` times a history.
struct ForcingRequest {
  std::string body;
  std::string name;                                  ///< of the load, or of the motion, in the kernel
  bool support = false;                              ///< whether it is a moving support
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();  ///< world axes; load: [Pa] or [N], support: [m]
  History history{};
  /// Of a load on a body that turns. No value: those of the body for a traction, of the world for a force.
  std::optional<Axes> axes{};
  std::optional<double> pressure{};  ///< of a load, in place of `vector` [Pa]
};

struct Model : Bodies, Rows {
  /// (n) R_ii of the kernels, and the share of body a in it: under the patches themselves, without folded
  /// modes [m/N].
  Vector patch_flexibility() const {
    if (turns) return patch_R;
    return folded.modes.empty() ? Vector(R.diagonal()) : folded.R;
  }
  Vector patch_flexibility_of_a() const {
    if (turns) return patch_R;  // no patch bulges between two bodies that turn
    return folded.modes.empty() ? Vector(residual_of_a().diagonal()) : folded.R_a;
  }
  /// (m) springs of the points; empty if no point has one.
  std::vector<PatchSpring> springs() const;

  /// A load or a moving support, for a history of value 1. Its modal vectors cover only the modes of `body`.
  struct Forcing {
    std::string name;
    int body = 0;
    int first_mode = 0;  ///< of the body
    bool support = false;
    int entry = 0;                    ///< index of the load, or of the motion, in the kernel
    Eigen::Vector3d vector{0, 0, 0};  ///< world, at t = 0
    Eigen::Vector3d own{0, 0, 0};     ///< the same in the axes of the body
    bool follows = true;              ///< whether it turns with the body; supports do
    History history;
    Vector force;                    ///< (modes) modal force of a load [kg^1/2 m/s²]; 0 for a support
    Vector lift;                     ///< (modes) Γ of a support [kg^1/2 m]; 0 for a load
    Vector displacement;             ///< (n) quasi-static u: residual of a load, Ψ of a support [m]
    Vector displacement_a;           ///< (n) share of body a in displacement
    Eigen::Vector3d total{0, 0, 0};  ///< resultant force of a load [N]; 0 for a support
    /// Resultant force, and moment about the centre, of unit loads along the axes of the body; 0 for a
    /// support.
    Eigen::Matrix3d own_total = Eigen::Matrix3d::Zero(), own_moment = Eigen::Matrix3d::Zero();
    Eigen::Vector3d lift_momentum{0, 0, 0};  ///< ∫ρΨ of a support, of its elastic modes and beyond [kg m]

    /// The vector in the axes of a body with this attitude.
    Eigen::Vector3d along(const Eigen::Quaterniond& attitude) const {
      return follows ? own : Eigen::Vector3d(attitude.conjugate() * vector);
    }
    /// (3,modes) Participation of the modes in unit loads, or Γ of unit motions, along the axes of the body.
    Eigen::Map<const Matrix> participation(const Bodies::Block& block) const {
      const std::vector<double>& values =
          support ? block.kernel->motions[static_cast<std::size_t>(entry)].participation
                  : block.kernel->applied[static_cast<std::size_t>(entry)].participation;
      return {values.data(), 3, block.modes};
    }
  };
  std::vector<Forcing> forcing;

  /// A point of `body` whose motion is recorded. Matrices and vectors are in world axes.
  struct Receiver {
    std::string name;
    int body = 0;
    Axes axes = Axes::world;            ///< along which its motion is recorded
    Eigen::Vector3d point{0, 0, 0};     ///< world, at t = 0 [m]
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

/// Throws InputError if bodies overlap at t = 0 because dead loads deform them.
void refuse_sag(const Model& model);

/// Throws InputError if a body that arrives later would start inside another one, because gravity turns it on
/// its way.
/// @param arrival  of each body [s]; 0: it does not arrive later
void refuse_early_contact(const Model& model, const std::vector<double>& arrival);

/// Places the bodies first. Also throws InputError as `place` does.
inline Model build_model(std::vector<PlacedBody> bodies, const std::vector<Obstacle>& obstacles,
                         const std::vector<PairRequest>& pairs, const Eigen::Vector3d& gravity,
                         const std::vector<ForcingRequest>& forcing = {}) {
  return build_model(place(std::move(bodies), obstacles, pairs), gravity, forcing);
}

}  // namespace ricochet::contact
