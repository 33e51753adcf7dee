#include "src/modes/modes.hpp"

namespace ricochet::modes {

Eigen::MatrixXd residual_response(const parallel::Teams& teams, const mesh::Mesh& mesh,
                                  const elasticity::Body& body, Factorisation& factor, const ModeSet& modes,
                                  const Eigen::MatrixXd& loads, Eigen::Index seen) {
  // No mode left out lies below the cut: the series converges by |σ|/(λ_cut + |σ|) < ratio a term. The shift
  // is far enough from zero for rigid motions, which P removes, to be harmless.
  constexpr double ratio = 1e-3, tolerance = 1e-12;
  const double sigma = -ratio * modes.cut;
  factor.factor(sigma);
  const BlockProduct mass(body.mass);
  const Eigen::MatrixXd inertia = mass(modes.shape);
  const auto over_teams = [&](Eigen::MatrixXd part) {
    parallel::sum(teams.peers(), part.data(), static_cast<std::size_t>(part.size()));
    return part;
  };
  // P f = f − M Φ Φᵀ f removes the kept modes from a load, Pᵀ u = u − Φ (MΦ)ᵀ u from a displacement; each
  // team knows some of the modes and solves for some of the columns.
  const auto respond = [&](const Eigen::MatrixXd& force) -> Eigen::MatrixXd {
    const Eigen::MatrixXd rest = force - over_teams(inertia * inner(mesh.comm, modes.shape, force));
    const Eigen::Index first = rest.cols() * teams.mine() / teams.count(),
                       behind = rest.cols() * (teams.mine() + 1) / teams.count();
    Eigen::MatrixXd part = Eigen::MatrixXd::Zero(rest.rows(), rest.cols());
    part.middleCols(first, behind - first) = factor.solve(rest.middleCols(first, behind - first));
    const Eigen::MatrixXd u = over_teams(std::move(part));
    return u - over_teams(modes.shape * inner(mesh.comm, inertia, u));
  };
  // Term k is (−σ)^k Cᵀ X_k with X_k = ((K − σM)⁻¹ M)^k (K − σM)⁻¹ P L. As the operator is symmetric and L
  // begins with C, Cᵀ X_{i+j+1} = X_iᵀ M X_j over the leading columns: two solves give four terms.
  Eigen::MatrixXd x = respond(loads);
  Eigen::MatrixXd response = inner(mesh.comm, loads.leftCols(seen), x);
  double weight = 1;
  const auto add = [&](const Eigen::MatrixXd& momentum, const Eigen::MatrixXd& shape) {
    weight *= -sigma;
    const Eigen::MatrixXd term = weight * inner(mesh.comm, momentum.leftCols(seen), shape);
    response += term;
    return ratio * term.cwiseAbs().maxCoeff() <= tolerance * response.cwiseAbs().maxCoeff();
  };
  for (int k = 0; k < 10; ++k) {
    const Eigen::MatrixXd momentum = mass(x);
    if (add(momentum, x)) break;
    x = respond(momentum);
    if (add(momentum, x)) break;
  }
  return response;
}

}  // namespace ricochet::modes
