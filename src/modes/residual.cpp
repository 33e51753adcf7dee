#include <algorithm>

#include "src/modes/modes.hpp"

namespace ricochet::modes {

Eigen::MatrixXd residual_response(const mesh::Mesh& mesh, const elasticity::Body& body, const ModeSet& modes,
                                  const Eigen::MatrixXd& seen, const Eigen::MatrixXd& loads) {
  // No mode left out lies below the cut, so that the series converges by |σ|/(λ_cut + |σ|), here 1/101 a
  // term; the shift is far enough from zero for rigid motions, which P removes, to be harmless.
  const double sigma = -0.01 * modes.cut;
  const Factorisation factor(body.stiffness, body.mass, sigma);
  const Eigen::MatrixXd inertia = multiply(body.mass, modes.shape);
  // P f = f − M Φ Φᵀ f removes the kept modes from a load, Pᵀ u = u − Φ (MΦ)ᵀ u from a displacement.
  const auto project_load = [&](const Eigen::MatrixXd& f) -> Eigen::MatrixXd {
    return f - inertia * inner(mesh.comm, modes.shape, f);
  };
  const auto project_shape = [&](const Eigen::MatrixXd& u) -> Eigen::MatrixXd {
    return u - modes.shape * inner(mesh.comm, inertia, u);
  };

  Eigen::MatrixXd term = project_shape(factor.solve(project_load(loads)));
  Eigen::MatrixXd response = inner(mesh.comm, seen, term);
  for (int k = 0; k < 50; ++k) {
    term = -sigma * project_shape(factor.solve(multiply(body.mass, term)));
    const Eigen::MatrixXd change = inner(mesh.comm, seen, term);
    response += change;
    if (change.cwiseAbs().maxCoeff() <= 1e-12 * response.cwiseAbs().maxCoeff()) break;
  }
  return response;
}

}  // namespace ricochet::modes
