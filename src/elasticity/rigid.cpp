// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/rigid.hpp"

#include <cmath>

namespace ricochet::elasticity {

namespace {

/// Returns the M-orthonormal rigid motions of one connected part that its supports leave free, (local rows,
/// r).
Eigen::MatrixXd rigid_modes_of(const mesh::Mesh& mesh, const Body& body, std::int64_t part) {
  const int c = mesh.components();
  const auto for_each_own_node = [&](auto&& visit) {
    mesh.for_each_owned([&](std::size_t i, std::int64_t row) {
      if (mesh.part[i] == part) visit(i, row, Eigen::Map<const Eigen::Vector3d>(&mesh.position[3 * i]));
    });
  };
  // Motions refer to the centroid of the part's nodes, and rotations are scaled by its size, so that entries
  // are of order one.
  Eigen::Matrix<double, 5, 1> sums = Eigen::Matrix<double, 5, 1>::Zero();
  for_each_own_node([&](std::size_t, std::int64_t, const Eigen::Vector3d& x) {
    sums.head<3>() += x;
    sums[3] += x.squaredNorm();
    sums[4] += 1;
  });
  parallel::sum(mesh.comm, sums);
  const Eigen::Vector3d middle = sums.head<3>() / sums[4];
  const double size = std::sqrt(std::max(sums[3] / sums[4] - middle.squaredNorm(), 1e-300));

  // Each column of `motion` is a combination of e_x, e_y, e_z, e_x × x, e_y × x, e_z × x about the origin.
  // The products of these with M are known.
  const Eigen::Index m = mesh.dim == 1 ? 1 : 6;
  Eigen::MatrixXd motion = Eigen::MatrixXd::Zero(6, m);
  if (mesh.dim == 1) {
    for (int k = 0; k < 3; ++k) motion(k, 0) = mesh.axis[static_cast<std::size_t>(k)];
  } else {
    motion.topLeftCorner<3, 3>().setIdentity();
    for (int k = 0; k < 3; ++k) {
      motion(3 + k, 3 + k) = 1 / size;
      motion.block<3, 1>(0, 3 + k) = -Eigen::Vector3d::Unit(k).cross(middle) / size;
    }
  }
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(body.local_rows, m), load = values,
                  seen = Eigen::MatrixXd::Zero(m, m);
  for_each_own_node([&](std::size_t i, std::int64_t row, const Eigen::Vector3d& x) {
    Eigen::MatrixXd here(3, m);
    for (Eigen::Index k = 0; k < m; ++k) {
      const Eigen::Vector3d turn = motion.block<3, 1>(3, k);
      here.col(k) = motion.block<3, 1>(0, k) + turn.cross(x);
    }
    if (mesh.dim == 1) here = Eigen::Map<const Eigen::RowVector3d>(mesh.axis.data()) * here;
    values.middleRows(row * c, c) = here;
    load.middleRows(row * c, c) = body.rigid_load.middleRows(row * c, c) * motion;
    for (int k = 0; k < c; ++k)
      if (mesh.is_fixed(i, k)) seen += here.row(k).transpose() * here.row(k);
  });
  parallel::sum(mesh.comm, seen);

  // The supports leave the null space of `seen` free.
  Eigen::MatrixXd free = Eigen::MatrixXd::Identity(m, m);
  if (!seen.isZero(0)) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(seen);
    Eigen::Index left = 0;
    while (left < m && eigen.eigenvalues()[left] < 1e-9 * eigen.eigenvalues()[m - 1]) ++left;
    free = eigen.eigenvectors().leftCols(left);
  }
  Eigen::MatrixXd modes = values * free;
  for_each_own_node([&](std::size_t i, std::int64_t row, const Eigen::Vector3d&) {
    for (int k = 0; k < c; ++k)
      if (mesh.is_fixed(i, k)) modes.row(row * c + k).setZero();
  });
  // Held rows of the modes are zero, so their entries in the loads do not matter.
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
