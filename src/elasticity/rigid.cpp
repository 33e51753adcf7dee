// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/rigid.hpp"

#include <cmath>

namespace ricochet::elasticity {

namespace {

/// Calls visit(node, row, position) for the nodes of one connected part that this rank owns.
template <class Visit>
void for_each_own_node(const mesh::Mesh& mesh, std::int64_t part, const Visit& visit) {
  mesh.for_each_owned([&](std::size_t i, std::int64_t row) {
    if (mesh.part[i] == part) visit(i, row, Eigen::Map<const Eigen::Vector3d>(&mesh.position[3 * i]));
  });
}

/// Rigid motions of one part, (6, m). Each column is a combination of e_x, e_y, e_z, e_x × x, e_y × x,
/// e_z × x about the origin. Motions refer to the centroid of the part's nodes, and rotations are scaled by
/// its size, so that entries are of order one. Collective.
Eigen::MatrixXd rigid_motions(const mesh::Mesh& mesh, std::int64_t part) {
  if (mesh.dim == 1) {
    Eigen::MatrixXd motion = Eigen::MatrixXd::Zero(6, 1);
    for (int k = 0; k < 3; ++k) motion(k, 0) = mesh.axis[static_cast<std::size_t>(k)];
    return motion;
  }
  Eigen::Matrix<double, 5, 1> sums = Eigen::Matrix<double, 5, 1>::Zero();
  for_each_own_node(mesh, part, [&](std::size_t, std::int64_t, const Eigen::Vector3d& x) {
    sums.head<3>() += x;
    sums[3] += x.squaredNorm();
    sums[4] += 1;
  });
  parallel::sum(mesh.comm, sums);
  const Eigen::Vector3d middle = sums.head<3>() / sums[4];
  const double size = std::sqrt(std::max(sums[3] / sums[4] - middle.squaredNorm(), 1e-300));
  Eigen::MatrixXd motion = Eigen::MatrixXd::Identity(6, 6);
  for (int k = 0; k < 3; ++k) {
    motion(3 + k, 3 + k) = 1 / size;
    motion.block<3, 1>(0, 3 + k) = -Eigen::Vector3d::Unit(k).cross(middle) / size;
  }
  return motion;
}

/// Basis of the combinations of m motions that the supports leave free: the null space of the Gram matrix of
/// these motions at the supports, (m,m).
Eigen::MatrixXd left_free(const Eigen::MatrixXd& at_supports) {
  const Eigen::Index m = at_supports.rows();
  if (at_supports.isZero(0)) return Eigen::MatrixXd::Identity(m, m);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(at_supports);
  Eigen::Index left = 0;
  while (left < m && eigen.eigenvalues()[left] < 1e-9 * eigen.eigenvalues()[m - 1]) ++left;
  return eigen.eigenvectors().leftCols(left);
}

/// Returns the M-orthonormal rigid motions of one connected part that its supports leave free, (local rows,
/// r). The products of the rigid motions with M are known. Collective.
Eigen::MatrixXd rigid_modes_of(const mesh::Mesh& mesh, const Body& body, std::int64_t part) {
  const int c = mesh.components();
  const Eigen::MatrixXd motion = rigid_motions(mesh, part);
  const Eigen::Index m = motion.cols();
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(body.local_rows, m), load = values,
                  at_supports = Eigen::MatrixXd::Zero(m, m);
  for_each_own_node(mesh, part, [&](std::size_t i, std::int64_t row, const Eigen::Vector3d& x) {
    Eigen::MatrixXd here(3, m);
    for (Eigen::Index k = 0; k < m; ++k) {
      const Eigen::Vector3d turn = motion.block<3, 1>(3, k);
      here.col(k) = motion.block<3, 1>(0, k) + turn.cross(x);
    }
    if (mesh.dim == 1) here = Eigen::Map<const Eigen::RowVector3d>(mesh.axis.data()) * here;
    values.middleRows(row * c, c) = here;
    load.middleRows(row * c, c) = body.rigid_load.middleRows(row * c, c) * motion;
    for (int k = 0; k < c; ++k)
      if (mesh.is_fixed(i, k)) at_supports += here.row(k).transpose() * here.row(k);
  });
  parallel::sum(mesh.comm, at_supports);

  const Eigen::MatrixXd free = left_free(at_supports);
  Eigen::MatrixXd modes = values * free;
  for_each_own_node(mesh, part, [&](std::size_t i, std::int64_t row, const Eigen::Vector3d&) {
    for (int k = 0; k < c; ++k)
      if (mesh.is_fixed(i, k)) modes.row(row * c + k).setZero();
  });
  // Fixed rows of the modes are zero, so their entries in the loads do not matter.
  Eigen::MatrixXd gram = modes.transpose() * (load * free);
  parallel::sum(mesh.comm, gram);
  const Eigen::LLT<Eigen::MatrixXd> cholesky((gram + gram.transpose()) / 2);
  return cholesky.matrixL().solve(modes.transpose()).transpose();
}

}  // namespace

Eigen::MatrixXd rigid_modes(const mesh::Mesh& mesh, const Body& body) {
  Eigen::MatrixXd all(body.local_rows, 0);
  for (std::int64_t part = 0; part < mesh.parts; ++part) {
    const Eigen::MatrixXd modes = rigid_modes_of(mesh, body, part);
    all.conservativeResize(Eigen::NoChange, all.cols() + modes.cols());
    all.rightCols(modes.cols()) = modes;
  }
  return all;
}

}  // namespace ricochet::elasticity
