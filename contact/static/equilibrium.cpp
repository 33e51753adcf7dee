// SPDX-License-Identifier: BSD-2-Clause
#include "contact/static/equilibrium.hpp"

#include <cmath>

#include "base/format.hpp"
#include "contact/complementarity/contact_solver.hpp"
#include "contact/static/balance.hpp"
#include "contact/static/load_path.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::MatrixXd;

// times most_imbalance: check_balance measures it at other forces, body by body
constexpr double stalled_factor = 10;
constexpr double inexact = 1e-9;  // violation of Coulomb's law, relative, that an answer may have
constexpr double unfelt = 1e-12;  // a rigid mode moves no point if it moves all by less than this share
constexpr double first_spring = 10, softest_spring = 1e7;  // times S₀'s norm; the first keeps most digits
constexpr int most_rounds = 100;  // each reduces the imbalance by a factor of four, or softens the springs

/// The model without its loads.
struct Statics {
  RigidModes rigid;
  Vector flexibility;  ///< (N) 1/ω²; 0 for rigid modes
  MatrixXd S;          ///< (n,n) S₀

  explicit Statics(const Model& model) : rigid(model), flexibility(Vector::Zero(model.omega.size())) {
    for (Eigen::Index n = 0; n < model.omega.size(); ++n)
      if (model.omega(n) > 0) flexibility(n) = 1 / (model.omega(n) * model.omega(n));
    S = model.B * flexibility.asDiagonal() * model.B.transpose() + model.R;
  }
};

/// Minimises ½ λᵀ S λ − rᵀ λ over λ ≥ 0, or solves Coulomb's law, repeatedly.
class ForceSolver {
 public:
  ForceSolver(const Model& model, const EquilibriumOptions& options)
      : options_(options),
        area_(model.area),
        springs_(model.springs()),
        exact_(static_cast<int>(model.rows()), {}, !model.friction.empty(), !springs_.empty()),
        newton_(springs_.empty() ? 0 : static_cast<int>(model.rows()), {}) {
    for (const Model::FrictionPoint& point : model.friction)
      contacts_.push_back({point.point, point.tangential, point.law.static_coefficient});
  }

  void solve(const MatrixXd& S, const Vector& r, Vector& lambda) {
    if (options_.solver == EquilibriumOptions::Solver::uzawa) return uzawa_with_springs(S, r, lambda);
    ++iterations_;
    const SolveStatus status = exact_.solve(S, r, springs_, contacts_, lambda);
    if (status == SolveStatus::no_solution)
      throw InputError(
          "contact: no contact forces keep the bodies apart, as there are more contact points than their "
          "modes can move. Set modes.residual_flexibility = true, or fewer candidates (contact.spacing).");
    if (status == SolveStatus::not_finite) throw SolverError("contact: the static problem is not finite");
    const SolveResidual& residual = exact_.residual();
    if (status == SolveStatus::limited && residual.violation > inexact * residual.scale)
      throw SolverError(base::format(
          "contact: no friction forces found: the best ones violate Coulomb's law by {:.2g}. Lower "
          "contact.friction, or choose other contact points (contact.spacing).",
          residual.violation / residual.scale));
  }

  const std::vector<PatchSpring>& springs() const { return springs_; }
  std::int64_t iterations() const { return iterations_; }
  bool several() const { return exact_.friction().several(); }
  std::span<const ContactState> states() const { return exact_.friction().states(); }

 private:
  void uzawa_with_springs(const MatrixXd& S, const Vector& r, Vector& lambda) {
    if (springs_.empty()) return uzawa(S, r, lambda);
    const auto linear = [&](const Symmetric& matrix, const Eigen::Ref<const Vector>& right, bool /*renewed*/,
                            Eigen::Ref<Vector> forces) {
      uzawa(matrix, right, forces);
      return SolveStatus::solved;
    };
    newton_.solve(S, r, springs_, lambda, linear);
  }

  /// p ← max(0, p̄ + τ (r − S λ̄)), λ = A p, starting from the given λ, with τ = 1/‖A S‖_∞. p̄ extrapolates p
  /// by Nesterov's rule (1983) and is restarted whenever it overshoots (O'Donoghue & Candès 2015). Without
  /// extrapolation, p̄ = p, about eighty times as many iterations are needed.
  void uzawa(const MatrixXd& S, const Eigen::Ref<const Vector>& r, Eigen::Ref<Vector> lambda) {
    const double closing = r.size() > 0 ? r.maxCoeff() : 0;
    if (!(closing > 0)) {
      lambda.setZero();
      return;
    }
    const double bound = (area_.asDiagonal() * S.cwiseAbs()).rowwise().sum().maxCoeff();
    if (!std::isfinite(bound)) throw SolverError("contact: the static problem is not finite");
    const Vector step = area_ / bound;
    Vector ahead = lambda;
    for (double t = 1;; ++iterations_) {
      const Vector next = (ahead - step.cwiseProduct(S * ahead - r)).cwiseMax(0);
      const Vector open = (ahead - next).cwiseQuotient(step);  // S λ̄ − r at pressed points
      const double error = open.cwiseAbs().maxCoeff() / closing;
      const Vector move = next - lambda;
      lambda = next;
      if (error <= options_.uzawa_tolerance) return;
      if (iterations_ >= options_.uzawa_iterations)
        throw SolverError(base::format(
            "contact.solver = \"uzawa\": gaps of the points that press are still {:.2g} of what they closed "
            "after {} iterations. Use solver = \"exact\".",
            error, options_.uzawa_iterations));
      const double after = open.dot(move) > 0 ? 1 : (1 + std::sqrt(1 + 4 * t * t)) / 2;
      ahead = after > 1 ? Vector(next + (t - 1) / after * move) : next;
      t = after;
    }
  }

  EquilibriumOptions options_;
  Vector area_;
  std::vector<PatchSpring> springs_;
  ContactSolver exact_;
  SpringNewton newton_;  ///< of Uzawa's problems
  std::vector<FrictionContact> contacts_;
  std::int64_t iterations_ = 0;
};

/// The springs that hold the rigid coordinates, and the balance of forces with them. Throws InputError if
/// forces stay unbalanced.
class Balance {
 public:
  /// @param stalled  imbalance that is accepted if another round does not halve it
  Balance(const Model& model, const Statics& statics, ForceSolver& solver, double tolerance, double stalled)
      : model_(model),
        statics_(statics),
        B_(statics.rigid.B),
        solver_(solver),
        tolerance_(tolerance),
        stalled_(stalled),
        S_(statics.S) {
    if (B_.cols() == 0) return;
    D_ = springs(first_spring);
    S_ += B_ * D_.asDiagonal() * B_.transpose();
  }

  /// Computes p and the rigid coordinates ρ, beginning from those given. Returns the remaining imbalance.
  /// @param r  (n) û − g, and û − w − belt in tangential rows   @param f  (r) f_r
  double solve(const Vector& r, const Vector& f, Vector& p, Vector& rho) {
    if (B_.cols() == 0) {
      solver_.solve(S_, r, p);
      return 0;
    }
    double before = 1;
    Vector left;
    for (int round = 0; round < most_rounds; ++round) {
      solver_.solve(S_, r + B_ * (rho + D_.cwiseProduct(f)), p);
      left = f - B_.transpose() * p;
      const double sum = (f.cwiseAbs() + B_.cwiseAbs().transpose() * p.cwiseAbs()).maxCoeff();
      rho += D_.cwiseProduct(left);
      const double imbalance = sum > 0 ? left.cwiseAbs().maxCoeff() / sum : 0;
      if (imbalance <= tolerance_ || (imbalance <= stalled_ && imbalance > before / 2)) return imbalance;
      if (imbalance > before / 4 && share_ < softest_spring) {
        S_ += B_ * (9 * D_).asDiagonal() * B_.transpose();
        D_ *= 10;
        share_ *= 10;
      }
      before = imbalance;
    }
    refuse_unbalanced(model_, statics_.rigid, left);
  }

 private:
  /// Flexibility D_n of a spring on each rigid coordinate, such that B_n D_n B_nᵀ has `share` times the norm
  /// of S₀.
  Vector springs(double share) const {
    Vector out = Vector::Zero(B_.cols());
    if (B_.size() == 0) return out;
    const double norm = statics_.S.cwiseAbs().rowwise().sum().maxCoeff();
    const double strongest = B_.cwiseAbs().maxCoeff();
    for (Eigen::Index n = 0; n < out.size(); ++n) {
      const double largest = B_.col(n).cwiseAbs().maxCoeff();
      if (largest > unfelt * strongest) out(n) = share * norm / (largest * B_.col(n).cwiseAbs().sum());
    }
    return out;
  }

  const Model& model_;
  const Statics& statics_;
  const MatrixXd& B_;
  ForceSolver& solver_;
  double tolerance_, stalled_;
  double share_ = first_spring;
  Vector D_;
  MatrixXd S_;  ///< (n,n) S₀ + B_r D B_rᵀ
};

/// Bodies at rest along the path of their loads.
class Rest {
 public:
  Rest(const Model& model, const EquilibriumOptions& options)
      : model_(model),
        statics_(model),
        solver_(model, options),
        // λ of Uzawa's iteration is accurate to its tolerance, and a sum over points has no more digits.
        balance_(model, statics_, solver_,
                 options.solver == EquilibriumOptions::Solver::exact ? most_imbalance(false)
                                                                     : 100 * options.uzawa_tolerance,
                 model.friction.empty() ? stalled_factor * most_imbalance(false) : most_imbalance(true)),
        rho_(Vector::Zero(std::ssize(statics_.rigid.mode))) {
    now_.q.setZero(model.omega.size());
    now_.force.setZero(model.rows());
  }

  void check(const LoadCase& loads) const {
    check_balance(model_, statics_.rigid, loads.load(statics_.rigid.mode));
  }

  void begin(const LoadCase& loads) { now_.displacement = loads.s; }

  /// Finds the equilibrium under `loads`. @param slip  (n) tangential displacement from which slip counts
  void settle(const LoadCase& loads, const Vector& slip) {
    const Eigen::Index m = model_.points();
    const std::vector<Eigen::Index>& rigid = statics_.rigid.mode;
    Vector r = loads.s;
    r.head(m) -= model_.gap;
    r.tail(r.size() - m) -= slip.tail(r.size() - m);
    r += model_.B * statics_.flexibility.cwiseProduct(loads.load);
    now_.time = loads.time;
    now_.imbalance = balance_.solve(r, loads.load(rigid), now_.force, rho_);

    const Vector f = loads.load - model_.B.transpose() * now_.force;
    now_.q = (model_.omega.array() > 0).select(f.array() / model_.omega.array().square(), 0.0);
    now_.q(rigid) = rho_;
    now_.displacement = model_.B * now_.q + loads.s - model_.R * now_.force;
    yield(solver_.springs(), now_.force, now_.displacement);
  }

  /// An increment from `from` to `to` with slip, and its work.
  void slide(const LoadCase& from, const LoadCase& to) {
    const Vector q = now_.q, p = now_.force, u = now_.displacement, belt = to.belt - from.belt;
    settle(to, u + belt);
    const Eigen::Index m = model_.points(), t = model_.rows() - m;
    ++now_.increments;
    now_.ambiguous += solver_.several();
    const Vector mean = 0.5 * (now_.force + p), moved = now_.displacement - u;
    const auto slip = (moved - belt).tail(t);
    Energy& energy = now_.energy;
    energy.loads += 0.5 * (from.load + to.load).dot(now_.q - q) + mean.dot(to.s - from.s) - mean.dot(belt);
    energy.friction += now_.force.tail(t).dot(slip);
    energy.contact += mean.head(m).dot(moved.head(m)) - 0.5 * (now_.force - p).tail(t).dot(slip) +
                      work_of(solver_.springs(), p, now_.force, mean).removed;
  }

  Equilibrium result() {
    Equilibrium out = now_;
    out.iterations = solver_.iterations();
    out.active = static_cast<int>((out.force.head(model_.points()).array() > 0).count());
    out.states.assign(solver_.states().begin(), solver_.states().end());
    out.energy.strain = 0.5 * (model_.omega.array() * out.q.array()).square().sum();
    out.energy.residual = 0.5 * out.force.dot(model_.R * out.force) + energy_of(solver_.springs(), out.force);
    return out;
  }

 private:
  const Model& model_;
  Statics statics_;
  ForceSolver solver_;
  Balance balance_;
  Vector rho_;  ///< (r)
  Equilibrium now_;
};

void refuse(const Model& model, const EquilibriumOptions& options) {
  if (!model.friction.empty() && options.solver == EquilibriumOptions::Solver::uzawa)
    throw InputError(
        "contact.solver = \"uzawa\": has no friction. Use solver = \"exact\", or leave contact.friction "
        "out.");
}

}  // namespace

Equilibrium find_equilibrium(const Model& model, const EquilibriumOptions& options,
                             const std::function<void(const Equilibrium&)>& at_knot) {
  refuse(model, options);
  const std::vector<LoadCase> path = load_path(model);
  Rest rest(model, options);
  if (model.friction.empty()) {
    rest.check(path.back());
    rest.settle(path.back(), Vector::Zero(model.rows()));
    Equilibrium out = rest.result();
    out.energy.loads = path.back().load.dot(out.q);
    if (at_knot) at_knot(out);
    return out;
  }
  for (std::size_t k = 1; k < path.size(); ++k) rest.check(path[k]);
  rest.begin(path.front());
  for (std::size_t k = 1; k < path.size(); ++k) {
    LoadCase from = path[k - 1];
    for (int part = 1; part <= options.increments; ++part) {
      LoadCase to = between(path[k - 1], path[k], static_cast<double>(part) / options.increments);
      rest.slide(from, to);
      from = std::move(to);
    }
    const bool jumps = k + 1 < path.size() && path[k + 1].time == path[k].time;
    if (at_knot && !jumps) at_knot(rest.result());
  }
  return rest.result();
}

}  // namespace ricochet::contact
