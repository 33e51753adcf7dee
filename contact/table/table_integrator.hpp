// Steps the contact forces of a Table through time: the source paper's formulation, in which the motion of
// the contact points is a convolution with the forces that were. `step` neither throws nor allocates.
//
// impulse, step k: û_k = ũ_k − Σ_{l≥1} N_l P_{k−l}; on the points with û ≥ g, to round-off,
//   0 ≤ P ⟂ A P − (1 + e) v̂ ≥ 0
//   "jump":        A = Ṅ_0,    v̂ = ũ̇_k − Σ_{l≥1} Ṅ_l P_{k−l}
//   "difference":  the same with (N_{l+1} − N_l)/Δ for Ṅ_l and (ũ_{k+1} − ũ_k)/Δ for ũ̇_k
// As in the source paper the first instant is t_1.
//
// compliant, step k: 0 ≤ λ ⟂ S_0 λ − (û − g) ≥ 0,  û = ũ_k − Σ_{l≥1} S_l λ_{k−l},  over all points.
//
// With kernels from modes both are Integrator's schemes, to round-off. The energy of the bodies is not known
// here, and whether a step can gain some is up to the table.
#pragma once

#include <Eigen/Dense>
#include <limits>
#include <string>
#include <vector>

#include "contact/complementarity/complementarity.hpp"
#include "contact/table/convolution.hpp"
#include "contact/stepping/integrator.hpp"
#include "contact/table/table.hpp"

namespace ricochet::contact {

class TableIntegrator {
 public:
  /// Without end: the tail is known.
  static constexpr std::int64_t endless = std::numeric_limits<std::int64_t>::max();

  /// @param table  valid; not needed afterwards but for `table.bodies` and `table.gap`, which are copied
  /// @param convolution  its `tail` is the table's, whatever is given
  /// Throws InputError when the table lacks what the scheme needs, has another step than `options`, or its
  /// lag 0 (A or S_0) is not symmetric and positive semidefinite; when restitution is outside [0, 1].
  TableIntegrator(const Table& table, const StepOptions& options, ConvolutionOptions convolution = {});

  /// Steps that the table has kernels and free motion for.
  std::int64_t available() const { return available_; }

  /// Advances from t_{k−1} to t_k. `table_ended` when k is beyond `available`; the state then stays.
  StepStatus step() noexcept;

  Scheme scheme() const { return options_.scheme; }
  std::int64_t steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * options_.step; }
  const Vector& force() const { return force_; }     ///< (m) λ_k [N] over (t_{k−1}, t_k]; impulses as P/Δ
  const Vector& displacement() const { return u_; }  ///< (m) u at t_k [m], before its impulses
  const Vector& gap() const { return gap_; }         ///< (m) g [m]
  int active() const { return active_; }             ///< points with λ > 0 in this step
  /// Mean power through the contact of the step [W], −λᵀ(u_k − u_{k−1})/Δ; of `compliant` alone, else 0.
  double persistency() const { return persistency_; }
  /// (3,bodies) mass-mean velocity of table.bodies at t_k, after its impulses [m/s].
  const Eigen::Matrix3Xd& velocities() const { return velocity_; }
  const std::vector<FreeBody>& bodies() const { return bodies_; }
  const SolveStatistics& solver() const { return solver_.statistics(); }

 private:
  void free_motion(std::int64_t k, Vector& u) const noexcept;
  void free_rate(std::int64_t k, Vector& v) const noexcept;
  SolveStatus compliant() noexcept;
  SolveStatus impulses() noexcept;
  void push_bodies() noexcept;

  StepOptions options_;
  std::int64_t available_ = endless, steps_ = 0;
  std::vector<double> free_, free_velocity_;    ///< (K,m), (·,m)
  Vector rigid_velocity_, rigid_acceleration_;  ///< (m) of ũ, where there is no `free_`
  Vector gap_;
  Eigen::MatrixXd S_;  ///< (m,m) S_0 or A
  std::vector<FreeBody> bodies_;
  ComplementaritySolver solver_;
  Convolution convolution_;  ///< compliant: S (m rows); impulse: N and Ṅ (2m rows)

  Vector u_, force_;
  int active_ = 0;
  double persistency_ = 0;
  Eigen::Matrix3Xd velocity_;

  // of the step under way
  Vector next_u_, next_force_, rhs_, solution_, rate_;
  Eigen::MatrixXd sub_;
  std::vector<int> touching_;
};

}  // namespace ricochet::contact
