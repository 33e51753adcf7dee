// SPDX-License-Identifier: BSD-2-Clause
// Boxes of masses on a lattice, joined by springs: free bodies of any number of modes and surface points,
// whose modes and residual flexibility come from one dense eigenproblem.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::benchmarks {

struct Lattice {
  std::array<int, 3> count;  ///< masses along the axes
  Eigen::Vector3d spacing;   ///< [m]
  int elastic = 300;         ///< modes that are kept; R contains the others
  double highest = 20000;    ///< frequency of the last one [Hz]
  double damping = 0.01;     ///< ratio of each mode
  double foot = 0;           ///< by which the four lowest corners stand out [m]
};

/// Kernel of a lattice about its centre. The masses of its sides are candidates, also for rest on a floor.
inline kernels::Kernel kernel_of(const Lattice& lattice) {
  using Eigen::Index;
  using Eigen::Matrix3d;
  using Eigen::MatrixXd;
  using Eigen::Vector3d;
  constexpr double density = 7850;
  const auto [nx, ny, nz] = lattice.count;
  const int masses = nx * ny * nz;
  const auto number = [&](int i, int j, int k) { return i + nx * (j + ny * k); };
  std::vector<Vector3d> place;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        place.push_back(lattice.spacing.cwiseProduct(
            Vector3d(i - 0.5 * (nx - 1), j - 0.5 * (ny - 1), k - 0.5 * (nz - 1))));
        if (k == 0 && (i == 0 || i == nx - 1) && (j == 0 || j == ny - 1)) place.back().z() -= lattice.foot;
      }
  const double mass = density * lattice.spacing.prod();
  Vector3d centre = Vector3d::Zero();
  for (const Vector3d& x : place) centre += x / masses;
  for (Vector3d& x : place) x -= centre;

  MatrixXd K = MatrixXd::Zero(3 * masses, 3 * masses), rigid = MatrixXd::Zero(3 * masses, 6);
  Matrix3d inertia = Matrix3d::Zero();
  for (int p = 0; p < masses; ++p) {
    const Vector3d x = place[static_cast<std::size_t>(p)];
    inertia += mass * (x.squaredNorm() * Matrix3d::Identity() - x * x.transpose());
    for (int n = 0; n < 3; ++n) {
      rigid.block<3, 1>(3 * p, n) = Vector3d::Unit(n);
      rigid.block<3, 1>(3 * p, 3 + n) = Vector3d::Unit(n).cross(x);
    }
  }
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (int step = 14; step < 27; ++step) {  // half of the neighbours, also along diagonals
          const int u = i + step % 3 - 1, v = j + step / 3 % 3 - 1, w = k + step / 9 - 1;
          if (u < 0 || u >= nx || v < 0 || v >= ny || w < 0 || w >= nz) continue;
          const int p = number(i, j, k), q = number(u, v, w);
          const Vector3d d = place[static_cast<std::size_t>(q)] - place[static_cast<std::size_t>(p)];
          const Matrix3d spring = d * d.transpose() / (d.squaredNorm() * d.norm());
          for (const auto& [a, b, sign] : {std::tuple(p, p, 1), {q, q, 1}, {p, q, -1}, {q, p, -1}})
            K.block<3, 3>(3 * a, 3 * b) += sign * spring;
        }
  Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(K);
  MatrixXd shape = eigen.eigenvectors() / std::sqrt(mass);
  for (int n = 0; n < 6; ++n) shape.col(n) = rigid.col(n) / std::sqrt(mass * rigid.col(n).squaredNorm());
  const int modes = 6 + lattice.elastic;
  const double scale = 2 * std::numbers::pi * lattice.highest / std::sqrt(eigen.eigenvalues()(modes - 1));

  kernels::Kernel kernel;
  kernel.body = "lattice";
  kernel.mass = mass * masses;
  kernel.centre = {0, 0, 0};
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(kernel.inertia.data()) = inertia;
  for (int n = 0; n < modes; ++n) {
    const double omega = n < 6 ? 0 : scale * std::sqrt(eigen.eigenvalues()(n));
    kernel.modes.angular_frequency.push_back(omega);
    kernel.modes.decay_rate.push_back(lattice.damping * omega);
  }
  for (int axis = 0; axis < 3; ++axis)
    for (int n = 0; n < modes; ++n) {
      kernel.loads.body_force.push_back(n < 6 ? mass * rigid.col(axis).dot(shape.col(n)) : 0);
      kernel.loads.rotation.push_back(n < 6 ? mass * rigid.col(3 + axis).dot(shape.col(n)) : 0);
    }

  kernels::Surface& surface = kernel.surface;
  std::vector<int> candidate(static_cast<std::size_t>(masses), -1), of;
  for (int p = 0; p < masses; ++p) {
    const int i = p % nx, j = p / nx % ny, k = p / nx / ny;
    if (i % (nx - 1) != 0 && j % (ny - 1) != 0 && k % (nz - 1) != 0) continue;
    candidate[static_cast<std::size_t>(p)] = static_cast<int>(of.size());
    of.push_back(p);
    const Vector3d x = place[static_cast<std::size_t>(p)], n = x.normalized();
    surface.node.insert(surface.node.end(), {x.x(), x.y(), x.z()});
    surface.normal.insert(surface.normal.end(), {n.x(), n.y(), n.z()});
    surface.group.push_back("skin");
    surface.area.push_back(lattice.spacing.x() * lattice.spacing.y());
  }
  const auto M = static_cast<Index>(of.size());
  MatrixXd rest(3 * M, 3 * masses - modes);  // the traces of the modes that are not kept over ω
  for (Index c = 0; c < M; ++c)
    for (int axis = 0; axis < 3; ++axis) {
      const int row = 3 * of[static_cast<std::size_t>(c)] + axis;
      for (int n = 0; n < modes; ++n) surface.shape.push_back(shape(row, n));
      for (int n = modes; n < 3 * masses; ++n)
        rest(3 * c + axis, n - modes) = shape(row, n) / (scale * std::sqrt(eigen.eigenvalues()(n)));
    }
  MatrixXd R = rest * rest.transpose();
  R.diagonal().array() += R.trace() / static_cast<double>(R.rows());  // of the patches themselves
  surface.residual_flexibility.assign(R.data(), R.data() + R.size());
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const auto along = [&](int direction) { return lattice.count[static_cast<std::size_t>(direction)]; };
      for (int i = 0; i + 1 < along(u); ++i)
        for (int j = 0; j + 1 < along(v); ++j) {
          const auto node = [&](int a, int b) {
            std::array<int, 3> at{};
            at[static_cast<std::size_t>(axis)] = side * (along(axis) - 1);
            at[static_cast<std::size_t>(u)] = i + a;
            at[static_cast<std::size_t>(v)] = j + b;
            return number(at[0], at[1], at[2]);
          };
          const int p = node(0, 0), q = node(1, 0), r = node(1, 1), s = node(0, 1);
          for (std::array<int, 3> corner : {std::array{p, q, r}, std::array{p, r, s}}) {
            if (side == 0) std::swap(corner[1], corner[2]);
            const auto at = [&](std::size_t c) { return place[static_cast<std::size_t>(corner[c])]; };
            const Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
            for (const int p_of_corner : corner) {
              surface.element.push_back(candidate[static_cast<std::size_t>(p_of_corner)]);
              surface.element_normal.insert(surface.element_normal.end(), normal.begin(), normal.end());
            }
          }
        }
    }
  return kernel;
}

/// Bodies that may all meet each other and, with a floor, the half-space z ≤ 0.
inline contact::Model all_meet(std::vector<contact::PlacedBody> bodies, double friction, bool floor,
                               double gravity) {
  std::vector<contact::PairRequest> pairs;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    bodies[k].name = std::string("b").append(std::to_string(k));
    for (std::size_t j = 0; j < k; ++j) pairs.push_back({bodies[j].name, bodies[k].name, {}, {}, {}});
    if (floor) pairs.push_back({bodies[k].name, "floor", {}, {}, {}});
  }
  for (contact::PairRequest& pair : pairs) {
    pair.friction = Friction{friction, friction, 0};
    pair.everywhere = true;
  }
  return build_model(bodies, {{.name = "floor", .point = {0, 0, 0}, .normal = Eigen::Vector3d::UnitZ()}},
                     pairs, {0, 0, -gravity});
}

}  // namespace ricochet::benchmarks
