// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/residual.hpp"

#include <algorithm>

namespace ricochet::modes {

namespace {

/// Number of columns that a team solves together: several right-hand-side blocks of MUMPS.
constexpr Eigen::Index columns_at_once = 256;

}  // namespace

Eigen::MatrixXd residual_response(const parallel::Teams& teams, const mesh::Mesh& mesh,
                                  const elasticity::Body& body, Factorisation& factor, const ModeSet& modes,
                                  const Eigen::MatrixXd& loads, Eigen::Index seen, Rows* field) {
  // No mode outside the set lies below the cut, so each term of the series is smaller than the previous one
  // by the factor |σ|/(λ_cut + |σ|).
  constexpr double tolerance = 1e-12;
  const double sigma = modes.static_shift, ratio = -sigma / modes.cut;
  factor.factor(sigma);
  const BlockProduct mass(body.mass);
  // Kept modes φ respond to the part of a load along M φ, which for exact modes equals K φ/λ. For Ritz
  // vectors, K φ/λ makes the rest of the load orthogonal to them, and R the static flexibility minus theirs.
  Eigen::MatrixXd inertia = mass(modes.shape);
  // Scale of the response. Without it, the tolerance would refer to the little that remains if the vectors
  // contain the static responses.
  double flexibility = 0;
  if (!modes.exact) {
    const Eigen::MatrixXd force = BlockProduct(body.stiffness)(modes.shape);
    Eigen::VectorXd inverse = Eigen::VectorXd::Zero(force.cols());
    for (Eigen::Index j = 0; j < force.cols(); ++j) {
      const double omega =
          modes.angular_frequency[static_cast<std::size_t>(modes.index[static_cast<std::size_t>(j)])];
      if (omega == 0) continue;
      inverse[j] = 1 / (omega * omega);
      inertia.col(j) = force.col(j) * inverse[j];
    }
    const Eigen::MatrixXd trace = inner(mesh.comm, loads.leftCols(seen), modes.shape);
    flexibility = (trace.cwiseAbs2() * inverse).maxCoeff();
    parallel::sum(teams.peers(), &flexibility, 1);
  }
  const auto over_teams = [&](Eigen::MatrixXd part) {
    parallel::sum(teams.peers(), part);
    return part;
  };
  // P f = f − M Φ Φᵀ f removes the kept modes from a load, and Pᵀ u = u − Φ (MΦ)ᵀ u removes them from a
  // displacement. Each team holds some of the modes.
  const auto respond_to = [&](const Eigen::Ref<const Eigen::MatrixXd>& force) -> Eigen::MatrixXd {
    const Eigen::MatrixXd rest = force - over_teams(inertia * inner(mesh.comm, modes.shape, force));
    const Eigen::MatrixXd u = shared_solve(teams, factor, rest);
    return u - over_teams(modes.shape * inner(mesh.comm, inertia, u));
  };
  // Solves for some columns at a time, because the intermediate fields of all columns would be several times
  // as large as the loads.
  const Eigen::Index width = columns_at_once * teams.count();
  const auto respond = [&](const Eigen::MatrixXd& force) {
    Eigen::MatrixXd out(force.rows(), force.cols());
    for (Eigen::Index from = 0; from < force.cols(); from += width) {
      const Eigen::Index columns = std::min(width, force.cols() - from);
      out.middleCols(from, columns) = respond_to(force.middleCols(from, columns));
    }
    return out;
  };
  // Term k is (−σ)^k Cᵀ X_k with X_k = ((K − σM)⁻¹ M)^k (K − σM)⁻¹ P L. The operator is symmetric and L
  // begins with C; therefore Cᵀ X_{i+j+1} = X_iᵀ M X_j over the leading columns, and two solves give four
  // terms. The field Σ (−σ)^k X_k has half as many terms, so its tolerance is the square root.
  Eigen::MatrixXd x = respond(loads);
  double weight_of_x = 1;
  if (field != nullptr) field->value = x(field->row, Eigen::all);
  Eigen::MatrixXd response = inner(mesh.comm, loads.leftCols(seen), x);
  double weight = 1;
  const auto add = [&](const Eigen::MatrixXd& momentum, const Eigen::MatrixXd& shape) {
    weight *= -sigma;
    const Eigen::MatrixXd term = weight * inner(mesh.comm, momentum.leftCols(seen), shape);
    response += term;
    return ratio * term.cwiseAbs().maxCoeff() <=
           tolerance * std::max(response.cwiseAbs().maxCoeff(), flexibility);
  };
  for (int k = 0; k < 10; ++k) {
    const Eigen::MatrixXd momentum = mass(x);
    if (add(momentum, x)) break;
    x = respond(momentum);
    weight_of_x *= -sigma;
    if (field != nullptr) field->value += weight_of_x * x(field->row, Eigen::all);
    if (add(momentum, x)) break;
  }
  return response;
}

}  // namespace ricochet::modes
