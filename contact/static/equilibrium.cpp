// SPDX-License-Identifier: BSD-2-Clause
#include "contact/static/equilibrium.hpp"

#include <cmath>

#include "base/format.hpp"
#include "contact/complementarity/complementarity.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double balanced = 1e-11;  // imbalance of the exact solver: round-off of sums over many points
constexpr double held = 1e-8;       // share of a body's load that may remain unbalanced because of round-off
constexpr double unfelt = 1e-12;    // a rigid mode moves no point if it moves all by less than this share
constexpr double first_spring = 10, softest_spring = 1e7;  // times S₀'s norm; the first keeps most digits
constexpr int most_rounds = 100;  // each reduces the imbalance by a factor of four, or softens the springs

struct Parts {
  MatrixXd S;                       ///< (m,m) S₀
  Vector closing;                   ///< (m) û − g
  std::vector<Eigen::Index> rigid;  ///< (r) modes with ω = 0
  MatrixXd B;                       ///< (m,r) B_r
  Vector f;                         ///< (r) f_r
};

Parts parts_of(const Model& model) {
  Parts out;
  Vector flexibility = Vector::Zero(model.omega.size());
  for (Eigen::Index n = 0; n < model.omega.size(); ++n)
    if (model.omega(n) == 0)
      out.rigid.push_back(n);
    else
      flexibility(n) = 1 / (model.omega(n) * model.omega(n));
  out.S = model.B * flexibility.asDiagonal() * model.B.transpose() + model.R;
  out.closing = model.static_displacement - model.gap;
  out.closing += model.B * flexibility.cwiseProduct(model.load);
  out.B = model.B(Eigen::all, out.rigid);
  out.f = model.load(out.rigid);
  return out;
}

/// Minimises ½ λᵀ S λ − rᵀ λ over λ ≥ 0, repeatedly.
class Minimiser {
 public:
  Minimiser(const Model& model, const EquilibriumOptions& options)
      : options_(options), area_(model.area), exact_(static_cast<int>(model.gap.size())) {}

  void solve(const MatrixXd& S, const Vector& r, Vector& lambda) {
    if (options_.solver == EquilibriumOptions::Solver::uzawa) return uzawa(S, r, lambda);
    ++iterations_;
    const SolveStatus status = exact_.solve(S, r, lambda);
    if (status == SolveStatus::no_solution)
      throw InputError(
          "contact: no contact forces keep the bodies apart, as there are more contact points than their "
          "modes can move. Set modes.residual_flexibility = true, or fewer candidates (contact.spacing).");
    if (status == SolveStatus::not_finite) throw SolverError("contact: the static problem is not finite");
  }

  std::int64_t iterations() const { return iterations_; }

 private:
  /// p ← max(0, p̄ + τ (r − S λ̄)), λ = A p, starting from the given λ, with τ = 1/‖A S‖_∞. p̄ extrapolates p
  /// by Nesterov's rule (1983) and is restarted whenever it overshoots (O'Donoghue & Candès 2015). Without
  /// extrapolation, p̄ = p, about eighty times as many iterations are needed.
  void uzawa(const MatrixXd& S, const Vector& r, Vector& lambda) {
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
  ComplementaritySolver exact_;
  std::int64_t iterations_ = 0;
};

/// Throws InputError unless the minimum of |f_r − B_rᵀ λ|² over λ ≥ 0 is 0.
void check_held(const Model& model, const Parts& parts) {
  if (parts.f.isZero(0)) return;
  ComplementaritySolver solver(static_cast<int>(parts.B.rows()));
  Vector lambda(parts.B.rows());
  if (solver.solve(parts.B * parts.B.transpose(), parts.B * parts.f, lambda) == SolveStatus::not_finite)
    throw SolverError("contact: the static problem is not finite");
  const Vector left = parts.f - parts.B.transpose() * lambda;
  const Vector sum = parts.f.cwiseAbs() + parts.B.cwiseAbs().transpose() * lambda;
  for (const Model::BodyBlock& body : model.bodies) {
    Vector rest = Vector::Zero(body.modes), magnitude = rest;
    for (std::size_t k = 0; k < parts.rigid.size(); ++k) {
      const Eigen::Index n = parts.rigid[k] - body.first_mode;
      if (n < 0 || n >= body.modes) continue;
      rest(n) = left(k);
      magnitude(n) = sum(k);
    }
    if (rest.norm() <= held * magnitude.norm()) continue;
    const Vector3d force = body.momentum * rest;
    const Vector3d moment = body.angular_momentum * rest - body.centre.cross(force);
    throw InputError(base::format(
        "bodies.{}: no contact forces hold it at rest: a force of [{:.4g}, {:.4g}, {:.4g}] N and a moment of "
        "[{:.4g}, {:.4g}, {:.4g}] N m about its centre stay unbalanced. Place it so that what it touches "
        "carries it (without friction), turn loads.gravity, or give it a support.",
        body.name, force.x(), force.y(), force.z(), moment.x(), moment.y(), moment.z()));
  }
}

/// Flexibility D_n of a spring on each rigid coordinate, such that B_n D_n B_nᵀ has `share` times the norm of
/// S₀.
Vector springs(const Parts& parts, double share) {
  Vector out = Vector::Zero(parts.B.cols());
  if (parts.B.size() == 0) return out;
  const double norm = parts.S.cwiseAbs().rowwise().sum().maxCoeff();
  const double strongest = parts.B.cwiseAbs().maxCoeff();
  for (Eigen::Index n = 0; n < out.size(); ++n) {
    const double largest = parts.B.col(n).cwiseAbs().maxCoeff();
    if (largest > unfelt * strongest) out(n) = share * norm / (largest * parts.B.col(n).cwiseAbs().sum());
  }
  return out;
}

/// Computes λ and the rigid coordinates ρ. Returns the remaining imbalance.
double balance(const Parts& parts, Minimiser& minimiser, double tolerance, Vector& lambda, Vector& rho) {
  if (parts.rigid.empty()) {
    minimiser.solve(parts.S, parts.closing, lambda);
    return 0;
  }
  double share = first_spring, before = 1;
  Vector D = springs(parts, share);
  MatrixXd S = parts.S + parts.B * D.asDiagonal() * parts.B.transpose();
  for (int round = 0; round < most_rounds; ++round) {
    minimiser.solve(S, parts.closing + parts.B * (rho + D.cwiseProduct(parts.f)), lambda);
    const Vector left = parts.f - parts.B.transpose() * lambda;
    const double sum = (parts.f.cwiseAbs() + parts.B.cwiseAbs().transpose() * lambda).maxCoeff();
    rho += D.cwiseProduct(left);
    const double imbalance = sum > 0 ? left.cwiseAbs().maxCoeff() / sum : 0;
    if (imbalance <= tolerance) return imbalance;
    if (imbalance > before / 4 && share < softest_spring) {
      S += parts.B * (9 * D).asDiagonal() * parts.B.transpose();
      D *= 10;
      share *= 10;
    }
    before = imbalance;
  }
  throw SolverError(base::format("contact: the bodies' weights stay unbalanced by {:.2g} after {} rounds",
                                 before, most_rounds));
}

}  // namespace

Equilibrium find_equilibrium(const Model& model, const EquilibriumOptions& options) {
  const Parts parts = parts_of(model);
  check_held(model, parts);
  Minimiser minimiser(model, options);
  // λ of Uzawa's iteration is accurate to its tolerance, and a sum over points has no more digits.
  const double tolerance =
      options.solver == EquilibriumOptions::Solver::exact ? balanced : 100 * options.uzawa_tolerance;

  Equilibrium out;
  out.force.setZero(model.gap.size());
  Vector rho = Vector::Zero(parts.f.size());
  out.imbalance = balance(parts, minimiser, tolerance, out.force, rho);
  out.iterations = minimiser.iterations();
  out.active = static_cast<int>((out.force.array() > 0).count());

  const Vector f = model.load - model.B.transpose() * out.force;
  out.q = (model.omega.array() > 0).select(f.array() / model.omega.array().square(), 0.0);
  out.q(parts.rigid) = rho;
  out.displacement = model.B * out.q + model.static_displacement - model.R * out.force;
  out.energy.strain = 0.5 * (model.omega.array() * out.q.array()).square().sum();
  out.energy.residual = 0.5 * out.force.dot(model.R * out.force);
  out.energy.loads = model.load.dot(out.q);
  return out;
}

}  // namespace ricochet::contact
