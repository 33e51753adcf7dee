// SPDX-License-Identifier: BSD-2-Clause
// The constants of stepping a Model, shared by a stepper, its blocks and their copies.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <memory>

#include "contact/law/contact_law.hpp"
#include "contact/model/folding.hpp"
#include "ricochet/energy.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

/// Number of frequency bands whose energies bound the motion of the points. More bands give tighter bounds
/// and cost more.
inline constexpr int bands = 16;

/// Constants of modes, (N) each.
struct ModeConstants {
  Vector stiffness, load, q0;        ///< ω²; constant modal force; q at t = 0
  Vector b, c, e, h;                 ///< S, c, S' and S of a step, as in propagator.hpp
  Vector damp_ss, damp_sr, damp_rr;  ///< 2δ∫S², 4δ∫SS', 2δ∫S'²

  /// Sets b to h and the damping of mode n for a step [s].
  void set_step(Eigen::Index n, double omega, double decay, double step) noexcept;

  std::array<Vector*, 10> all() {
    return {&stiffness, &load, &q0, &b, &c, &e, &h, &damp_ss, &damp_sr, &damp_rr};
  }
};

/// Constants of stepping a folded model for a step Δ.
struct StepSystem : ModeConstants {
  std::shared_ptr<const Model> model;
  Vector gap;                               ///< (m) g; impulse: of the means of patches
  std::vector<PatchSpring> springs;         ///< (m), or empty
  Vector norm;                              ///< (m) |B_i|, of the impulse scheme
  bool damped = false, conserving = false;  ///< whether a mode is damped, whether steps are conserving
};

/// The matrices of all rows of a model over a compliant step, for steppers that solve all rows at once.
struct RowMatrices {
  explicit RowMatrices(const StepSystem& system);

  Eigen::MatrixXd M;       ///< (n,n) B c Bᵀ
  Eigen::MatrixXd R;       ///< (n,n) residual flexibility
  Eigen::MatrixXd S;       ///< (n,n) M + R
  Eigen::MatrixXd S_mean;  ///< (n,n) a M + R of conserving steps; empty if steps are not conserving
  StepMatrices all() const { return {.R = R, .S = S, .S_mean = S_mean}; }
};

/// Whether steps of a folded model are conserving. Without R, changes of force cost nothing, and backward
/// Euler is used.
bool conserves(const Model& model, const StepOptions& options);

/// Throws InputError if a folded model cannot be stepped with these options.
std::shared_ptr<const StepSystem> make_step_system(std::shared_ptr<const Model> model,
                                                   const StepOptions& options);

/// Kinetic and strain energy at t = 0 of the modes that the steps sample.
Energy initial_energy(const Model& model);

}  // namespace ricochet::contact
