// Steps a Model through time: modes exactly, contact forces by one of the schemes. `step` neither throws nor
// allocates.
//
// impulse, step k: free motion from t_{k−1} to t_k; the points with u ≥ g there, to round-off, get impulses P
// that jump q̇ at t_k. As in the source paper the first instant is t_1: what touches at t_0 and approaches is
// met one step later, within Δ times its velocity. R plays no part, for an impulse has no static response.
// Where there are more points than modes P itself is not unique; the one of least norm is taken.
//
// impulse with exact instants: where points that were open at t_{k−1} close within the step, free motion ends
// at the first such instant, impulses follow, and the rest of the step goes on from there. Each point closes
// once a step at most. What touches at t_0 is met there.
//
// compliant: its energy theorem asks for u ≤ g at the start, the static displacement s included. A step that
// max_pivots cut short may end beyond g; from then on g̃ = max(g, u) at a step's start takes the place of g: a
// point beyond g is not let in deeper, and not pushed out, which would do work.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <variant>
#include <vector>

#include "contact/complementarity/complementarity.hpp"
#include "contact/model/model.hpp"
#include "contact/stepping/forced_response.hpp"
#include "contact/stepping/look_ahead_block.hpp"
#include "contact/stepping/propagator.hpp"
#include "contact/stepping/step_system.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

class Integrator {
 public:
  /// Throws InputError: `impulse` with "difference" and ω_max Δ ≥ π; a restitution outside [0, 1]; a
  /// max_pivots below 1.
  /// With `compliant`, modes with ωΔ > π carry no sampled information: they move into R and into the static
  /// displacement, and leave q (their q, q̇ stay 0).
  Integrator(const Model& model, const StepOptions& options);

  /// Advances from t_{k−1} to t_k. A step that fails changes nothing; one at which the state of a block turns
  /// out not to be finite fails with all that are pending.
  StepStatus step() noexcept;

  /// As options.every_state, from the next step on; `rates`: q̇ after each of the steps that the state is
  /// moved through together is for rate().
  void keep(bool every_state, bool rates) noexcept;
  /// Steps whose state is not known yet.
  int pending() const { return pending_; }
  /// Moves the state to the last step. Fails as `step` does.
  StepStatus catch_up() noexcept;
  /// (N) q̇ after the last step but `back`, of those that the state was moved through together last.
  const double* rate(int back) const noexcept;

  const StepOptions& options() const { return options_; }
  std::int64_t steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * options_.step; }

  const Vector& q() const { return q_; }          ///< (N) relative to the lift of moving supports
  const Vector& v() const { return v_; }          ///< (N) q̇
  const Vector& force() const { return force_; }  ///< (m) λ_k [N] over (t_{k−1}, t_k]; impulses as P/Δ
  /// (m) u at t_k, residual included [m]. Within blocks it is computed when asked for.
  const Vector& displacement() const noexcept;
  const Energy& energy() const { return energy_; }
  int active() const { return active_; }  ///< points with λ > 0 in this step
  /// Power through the contact, σ_n u̇_n of (16), mean of the step [W]: compliant −λᵀ(u_k − u_{k−1})/Δ;
  /// impulse −Pᵀ(u̇⁻ + u̇⁺)/(2Δ), the velocities just before and after the impulses.
  double persistency() const { return persistency_; }
  int modes_in_residual() const { return system_->dropped; }  ///< modes moved into R because ωΔ > π
  const SolveStatistics& solver() const { return solver_.statistics(); }
  /// By how far the last step's forces miss complementarity: 0 but for steps that max_pivots cut short.
  /// compliant: u beyond what was to be kept [m]; impulse: approach left (1 + e) v̂ − A P [m/s].
  const SolveResidual& residual() const { return residual_; }

 private:
  /// A sum whose rounding errors are carried along (Neumaier), for ledgers of millions of steps.
  struct Sum {
    double value = 0, carry = 0;
    void add(double x) noexcept;
    double total() const { return value + carry; }
  };

  void free_motion(const Vector& q, const Vector& v, const Drives::Stretch& over) noexcept;
  StepStatus step_compliant() noexcept;
  void make_block();
  template <class T>
  StepStatus step_ahead(Block<T>& block) noexcept;
  template <class T>
  void tell_drives(Block<T>& block) noexcept;
  template <class T>
  StepStatus move_state(Block<T>& block) noexcept;
  void remember() noexcept;
  StepStatus move_under_force(double against_s, double power) noexcept;
  double energy_in_residual(const Vector& force) const noexcept;
  StepStatus step_impulse() noexcept;
  StepStatus step_exact() noexcept;
  static bool has_forces(SolveStatus status) noexcept;
  static StepStatus failure(SolveStatus status) noexcept;
  double first_closing(double from, double to) noexcept;
  double safe_time(double passed) noexcept;
  SolveStatus impulses(const Drives::Stretch& until) noexcept;
  double strike(Drives::Work& spent) noexcept;
  double round_off(Eigen::Index i, double size) const noexcept;
  int push_by(const Vector& lambda) noexcept;
  double damping_work() const noexcept;
  Drives::Work drive_work() noexcept;
  StepStatus commit(double contact_work, double residual, double power, int active,
                    const Drives::Work& work) noexcept;

  StepOptions options_;
  bool keeps_rates_ = false;
  std::shared_ptr<const StepSystem> system_;
  ComplementaritySolver solver_;
  Drives drives_;
  std::variant<std::monostate, Block<double>, Block<float>> block_;

  // state
  std::int64_t steps_ = 0;
  Vector q_, v_, force_;
  mutable Vector u_;
  mutable bool u_is_current_ = true;
  Energy energy_;
  Sum damping_, contact_, driven_;
  Vector s_;  ///< (m) s at t_k
  int active_ = 0;
  double persistency_ = 0;
  SolveResidual residual_;
  int pending_ = 0;  ///< steps of the block that q_, v_, energy_ don't know of
  struct Known {
    Vector force;
    int active = 0;
    double persistency = 0;
    SolveResidual residual;
  } known_;  ///< of the step that they do know, where some may be pending

  // of the step under way: nothing above changes before it is known to succeed
  Drives::Stretch now_, ahead_;  ///< the drives in this step; in the one after it
  Vector g_, dq_, push_;         ///< (N) f − ω²q, q⁺ − q, Bᵀλ
  Vector next_q_, next_v_;       ///< (N)
  Vector work_q_, work_v_;       ///< (N) on the way through the knots of the step
  Vector next_u_, next_force_;   ///< (m)
  Vector rhs_;                   ///< (m) right-hand side, of the touching points alone under `impulse`
  Vector solution_;              ///< (m) likewise
  Eigen::MatrixXd sub_;          ///< (m,m) A of the touching points
  std::vector<int> touching_;    ///< points with u ≥ g at t_k

  // of exact instants
  std::vector<int> open_;       ///< points that may still close in this step
  Vector at_q_, at_v_;          ///< (N) at a knot within the step
  Vector force_at_, slope_at_;  ///< (N) modal force there and its slope
  Vector rate_, bound_;         ///< (m) ṡ; no |ü| is larger
  Vector impulse_;              ///< (m) Σ P of the step
};

}  // namespace ricochet::contact
