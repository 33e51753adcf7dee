// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/obstacle_surface.hpp"

#include <algorithm>

#include "contact/pairing/surface_projection.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Index;

/// Half of the edge of the square that shows a half-space, as a share of the size of its contact points.
constexpr double square = 1.5;

/// (4,3) corners of the part of a half-space that is near `points` (m,3). @param normal  out of it
Matrix square_of(const Matrix& points, const Eigen::Vector3d& normal) {
  const Eigen::RowVector3d middle = 0.5 * (points.colwise().minCoeff() + points.colwise().maxCoeff()),
                           at =
                               middle - normal.dot((middle - points.row(0)).transpose()) * normal.transpose();
  const double size = square * std::max((points.rowwise() - middle).rowwise().norm().maxCoeff(), 1e-6);
  const Eigen::Matrix<double, 2, 3> across = size * tangents_of(normal);
  Matrix out(4, 3);
  out << at - across.row(0) - across.row(1), at + across.row(0) - across.row(1),
      at + across.row(0) + across.row(1), at - across.row(0) + across.row(1);
  return out;
}

ObstacleSurface surface_of(const Model& model, const Model::PairBlock& pair) {
  ObstacleSurface out{.name = pair.obstacle, .is_half_space = pair.is_half_space(), .driven = pair.driven};
  if (pair.solid) {
    const WorldSurface surface = placed(*pair.solid);
    out.start = {.position = pair.solid->point, .attitude = Eigen::Quaterniond(pair.solid->rotation)};
    out.node.resize(std::ssize(surface.node), 3);
    for (std::size_t i = 0; i < surface.node.size(); ++i)
      out.node.row(static_cast<Index>(i)) = surface.node[i].transpose();
    for (const WorldSurface::Element& one : surface.element)
      out.element.insert(out.element.end(), one.corner.begin(), one.corner.end());
  } else {
    out.node = square_of(model.point_b.middleRows(pair.first_point, pair.points),
                         -model.normal.row(pair.first_point).transpose());
    out.start.position = model.point_b.row(pair.first_point).transpose();
    out.element = {0, 1, 2, 0, 2, 3};
  }
  return out;
}

}  // namespace

Matrix ObstacleSurface::at(double t) const {
  if (!driven) return node;
  const Pose now = driven_pose(*driven, start, t);
  const Eigen::Matrix3d turn = (now.attitude * start.attitude.conjugate()).toRotationMatrix();
  return ((node.rowwise() - start.position.transpose()) * turn.transpose()).rowwise() +
         now.position.transpose();
}

std::vector<ObstacleSurface> obstacle_surfaces(const Model& model) {
  std::vector<ObstacleSurface> out;
  for (const Model::PairBlock& pair : model.pairs)
    if (pair.b < 0 && (pair.solid || pair.points > 0) &&
        std::ranges::count(out, pair.obstacle, &ObstacleSurface::name) == 0)
      out.push_back(surface_of(model, pair));
  return out;
}

}  // namespace ricochet::contact
