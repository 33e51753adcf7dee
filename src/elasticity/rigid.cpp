#include <cmath>

#include "src/elasticity/assemble.hpp"

namespace ricochet::elasticity {

namespace {

/// Rigid motion `coefficient` (translation, rotation about the centre of mass) at a local node, component c.
double motion(const mesh::Mesh& mesh, const Body& body, const Eigen::Matrix<double, 6, 1>& coefficient,
              std::size_t node, int c) {
  const Eigen::Vector3d x(mesh.position[3 * node] - body.centre[0],
                          mesh.position[3 * node + 1] - body.centre[1],
                          mesh.position[3 * node + 2] - body.centre[2]);
  const Eigen::Vector3d u = coefficient.head<3>() + coefficient.tail<3>().cross(x);
  if (mesh.dim == 3) return u[c];
  return u.dot(Eigen::Vector3d(mesh.axis[0], mesh.axis[1], mesh.axis[2]));
}

}  // namespace

Eigen::MatrixXd rigid_modes(const mesh::Mesh& mesh, const Body& body) {
  const int c = mesh.components();
  const Eigen::Map<const Eigen::Matrix3d> inertia(body.inertia.data());
  // Unit kinetic energy each, M-orthogonal when the body is free: translations, then turns about the
  // principal axes.
  std::vector<Eigen::Matrix<double, 6, 1>> candidates;
  const double translation = 1 / std::sqrt(body.total_mass);
  if (mesh.dim == 1) {
    Eigen::Matrix<double, 6, 1> along = Eigen::Matrix<double, 6, 1>::Zero();
    for (int k = 0; k < 3; ++k) along[k] = mesh.axis[k] * translation;
    candidates.push_back(along);
  } else {
    for (int k = 0; k < 3; ++k) candidates.push_back(Eigen::Matrix<double, 6, 1>::Unit(k) * translation);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(inertia);
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d axis = principal.eigenvectors().col(k);
      Eigen::Index largest = 0;
      axis.cwiseAbs().maxCoeff(&largest);
      if (axis[largest] < 0) axis = -axis;
      Eigen::Matrix<double, 6, 1> turn = Eigen::Matrix<double, 6, 1>::Zero();
      turn.tail<3>() = axis / std::sqrt(principal.eigenvalues()[k]);
      candidates.push_back(turn);
    }
  }
  const auto r = static_cast<Eigen::Index>(candidates.size());

  // What the supports see of each motion: G = Σ over held components; its null space stays rigid.
  Eigen::MatrixXd seen = Eigen::MatrixXd::Zero(r, r);
  Eigen::MatrixXd values(body.local_rows, r);
  for (std::size_t i = 0; i < mesh.node.size(); ++i) {
    const std::int64_t row = mesh.node[i] - mesh.first_node;
    if (row < 0 || row >= mesh.owned_nodes) continue;
    for (int k = 0; k < c; ++k) {
      Eigen::VectorXd v(r);
      for (Eigen::Index m = 0; m < r; ++m)
        v[m] = motion(mesh, body, candidates[static_cast<std::size_t>(m)], i, k);
      values.row(row * c + k) = v.transpose();
      if (mesh.is_fixed(i, k)) seen += v * v.transpose();
    }
  }
  parallel::sum(mesh.comm, seen.data(), static_cast<std::size_t>(seen.size()));
  if (seen.isZero(0)) return values;

  // 1e-9: motions are scaled to one kilogram-root each, so a held one shows at the order of 1/mass.
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> free(seen);
  const double bound = 1e-9 * free.eigenvalues().maxCoeff();
  Eigen::Index left = 0;
  while (left < r && free.eigenvalues()[left] < bound) ++left;
  Eigen::MatrixXd modes = values * free.eigenvectors().leftCols(left);
  for (std::size_t i = 0; i < mesh.node.size(); ++i) {
    const std::int64_t row = mesh.node[i] - mesh.first_node;
    if (row < 0 || row >= mesh.owned_nodes) continue;
    for (int k = 0; k < c; ++k)
      if (mesh.is_fixed(i, k)) modes.row(row * c + k).setZero();
  }
  return modes;
}

}  // namespace ricochet::elasticity
