// SPDX-License-Identifier: BSD-2-Clause
#include "src/reduction/lift.hpp"

namespace ricochet::reduction {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using modes::Factorisation;
using modes::inner;
using modes::Operators;

/// Returns xᵀy of each column.
VectorXd dots(MPI_Comm comm, const MatrixXd& x, const MatrixXd& y) {
  VectorXd values = x.cwiseProduct(y).colwise().sum().transpose();
  parallel::sum(comm, values);
  return values;
}

/// Returns a/b, or 0 where b is 0.
VectorXd quotients(const VectorXd& a, const VectorXd& b) {
  return (b.array() > 0).select(a.array() / b.array(), 0.0);
}

/// Solves K X = F by conjugate gradients for all columns together; X is M-orthogonal to the rigid modes.
MatrixXd solve_statically(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                          const MatrixXd& force) {
  const auto precondition = [&](const MatrixXd& rest) {
    MatrixXd z = modes::shared_solve(teams, factor, rest);
    z -= operators.rigid * inner(operators.comm, operators.rigid_momentum, z);
    return z;
  };
  // Relative error in the norm of strain energy.
  constexpr double tolerance = 1e-12;
  constexpr int most = 500;
  MatrixXd x = MatrixXd::Zero(force.rows(), force.cols()), rest = force, z = precondition(rest), p = z;
  VectorXd energy = dots(operators.comm, rest, z);
  for (int step = 0; step < most; ++step) {
    const MatrixXd product = operators.stiffness(p);
    const VectorXd alpha = quotients(energy, dots(operators.comm, p, product));
    x += p * alpha.asDiagonal();
    rest -= product * alpha.asDiagonal();
    z = precondition(rest);
    const VectorXd before = energy;
    energy = dots(operators.comm, rest, z);
    const VectorXd whole = dots(operators.comm, force, x);
    const bool done = (energy.array() <= tolerance * tolerance * whole.array().abs()).all();
    if (parallel::of_rank(teams.world(), 0, done)) return x;
    p = z + p * quotients(energy, before).asDiagonal();
  }
  throw SolverError("the static lift of a moving support did not converge: is the mesh distorted?");
}

}  // namespace

Lift static_lift(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                 Factorisation& factor, double sigma) {
  const elasticity::Imposed& imposed = body.imposed;
  Lift lift{imposed.shape, imposed.inertia};
  if (imposed.shape.cols() == 0) return lift;
  const Operators operators(mesh, body);
  factor.factor(sigma);
  const MatrixXd free = solve_statically(teams, operators, factor, imposed.force);
  lift.shape += free;
  lift.inertia += operators.mass(free);
  const MatrixXd rigid = inner(mesh.comm, operators.rigid, lift.inertia);
  lift.shape -= operators.rigid * rigid;
  lift.inertia -= operators.rigid_momentum * rigid;
  return lift;
}

}  // namespace ricochet::reduction
