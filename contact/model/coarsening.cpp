// SPDX-License-Identifier: BSD-2-Clause
#include "contact/model/coarsening.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace ricochet::contact {
namespace {

using Eigen::Index;

/// Weight of a curvature against a slope where the parts of a patch do not separate them, as at an edge.
constexpr double weight_of_curvature = 1e-3;

struct Shares {
  Matrix T;                   ///< (fewer, m); in `rows_of` (fewer n, n)
  Vector area;                ///< (fewer) A_I [m²]
  std::vector<Index> centre;  ///< (fewer) the points that were kept
};

Shares shares(const Model& model) {
  const Matrix& at = model.point_a;
  const Index m = model.gap.size();
  Matrix c = Matrix::Zero(m, m);  // (kept, m); rows in use first
  Index kept = 0;
  std::vector<Index> all;
  for (const Model::PairBlock& pair : model.pairs) {
    const Index first = pair.first_point, count = pair.points;
    std::vector<double> near;
    for (Index i = first; i < first + count; ++i) near.push_back(reach_of_neighbours(at, i, first, count));
    const auto adjacent = [&](Index i, Index j) {
      return (at.row(i) - at.row(j)).norm() <= 0.5 * (near[i - first] + near[j - first]);
    };
    std::vector<Index> order, centre;
    for (Index i = first; i < first + count; ++i) order.push_back(i);
    const auto faces = [&](Index i) {
      return model.faces.empty() ? 1 : model.faces[static_cast<std::size_t>(i)];
    };
    std::ranges::stable_sort(order, std::greater{}, faces);
    for (const Index i : order)
      if (std::ranges::none_of(centre, [&](Index j) { return adjacent(i, j); })) centre.push_back(i);
    std::ranges::sort(centre);
    for (Index i = first; i < first + count; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < centre.size(); ++k) {
        const double d = (at.row(i) - at.row(centre[k])).norm();
        if (d > 0 && (std::ranges::count(centre, i) > 0 || !adjacent(i, centre[k]))) continue;
        const double weight = d > 0 ? 1 / d : 1;
        c(kept + k, i) = weight;
        sum += weight;
      }
      c.col(i) /= sum;
    }
    kept += static_cast<Index>(centre.size());
    all.insert(all.end(), centre.begin(), centre.end());
  }
  Shares out{c.topRows(kept) * model.area.asDiagonal(), {}, std::move(all)};
  out.area = out.T.rowwise().sum();
  out.T = (out.area.cwiseInverse().asDiagonal() * out.T).eval();
  return out;
}

/// Sets the friction points and the tangents of `out`, whose pairs and normals are known.
void set_friction(const Model& model, Model& out) {
  if (model.friction.empty()) return;
  out.friction.clear();
  Index rows = out.normal.rows();
  for (std::size_t k = 0; k < out.pairs.size(); ++k) {
    Model::PairBlock& pair = out.pairs[k];
    if (pair.first_tangential < 0) continue;
    const auto of_pair = [&](const Model::FrictionPoint& p) { return p.point == model.pairs[k].first_point; };
    const Friction law = std::ranges::find_if(model.friction, of_pair)->law;
    pair.first_tangential = static_cast<int>(rows);
    for (int i = 0; i < pair.points; ++i, rows += 2)
      out.friction.push_back({pair.first_point + i, static_cast<int>(rows), law});
  }
  out.tangent.resize(rows - out.normal.rows(), 3);
  for (const Model::FrictionPoint& to : out.friction)
    out.tangent.middleRows(to.tangential - out.normal.rows(), 2) =
        tangents_of(out.normal.row(to.point).transpose().normalized());
}

/// Returns the means of all rows for the means T (fewer, m) of the normal ones: those of tangential
/// displacements are means of vectors, along the tangents of `out`.
Matrix rows_of(const Model& model, const Matrix& T, const Model& out) {
  if (model.friction.empty()) return T;
  const Index m = model.points(), fewer = T.rows();
  Matrix all = Matrix::Zero(fewer + out.tangent.rows(), model.rows());
  all.topLeftCorner(fewer, m) = T;
  for (const Model::FrictionPoint& to : out.friction)
    for (const Model::FrictionPoint& from : model.friction)
      all.block(to.tangential, from.tangential, 2, 2) =
          T(to.point, from.point) * out.tangent.middleRows(to.tangential - fewer, 2) *
          model.tangent.middleRows(from.tangential - m, 2).transpose();
  return all;
}

/// By how much the gaps of the parts of a wide patch exceed, on average, those of a linear function, because
/// they curve away from the point at its centre [m]; at least 0.
double curve_of(const Model& model, const Eigen::Ref<const Vector>& share, Index centre) {
  std::vector<Index> parts;
  for (Index i = 0; i < share.size(); ++i)
    if (share(i) > 0 && i != centre) parts.push_back(i);
  if (parts.empty()) return 0;
  const auto count = static_cast<Index>(parts.size());
  const Matrix d = model.point_a(parts, Eigen::all).rowwise() - model.point_a.row(centre);
  const Vector square = 0.5 * d.rowwise().squaredNorm();
  const double size = std::sqrt(2 * square.maxCoeff());
  if (!(size > 0)) return 0;
  Eigen::MatrixXd features(count, 4);
  features << d / size, weight_of_curvature / (size * size) * square;
  const Vector rise = model.gap(parts).array() - model.gap(centre);
  const double curvature =
      features.completeOrthogonalDecomposition().solve(rise)(3) * weight_of_curvature / (size * size);
  return std::max(0.0, curvature) * share(parts).dot(square);
}

/// Steepest rise of gaps between parts of a patch that touch together.
constexpr double level_slope = 1e-6;

/// Returns the means (fewer, m) of those parts of each wide patch that touch together with the point that was
/// kept: all of a face that lies flat, and points along the edge of a tilted one.
Matrix level_means(const Model& model, const Shares& shares) {
  Matrix out = shares.T;
  for (Index I = 0; I < out.rows(); ++I) {
    const Index centre = shares.centre[I];
    for (Index i = 0; i < out.cols(); ++i)
      if (std::abs(model.gap(i) - model.gap(centre)) >
          level_slope * (model.point_a.row(i) - model.point_a.row(centre)).norm())
        out(I, i) = 0;
    out.row(I) /= out.row(I).sum();
  }
  return out;
}

/// Sets the gaps and bulges of wide patches. @param level  level_means()
void set_gaps(const Model& model, const Shares& shares, const Matrix& level, Model& out) {
  Vector curve(level.rows());
  for (Index I = 0; I < curve.size(); ++I)
    curve(I) = curve_of(model, shares.T.row(I).transpose(), shares.centre[I]);
  out.gap = level * model.gap;
  if (model.bulge.size() == 0 || model.bulge.isZero(0)) {
    out.gap += curve;
    out.bulge.setZero(model.bulge.size() == 0 ? 0 : curve.size());
  } else {
    out.bulge = shares.T * model.bulge + curve;
  }
}

}  // namespace

double reach_of_neighbours(const Matrix& at, Index i, Index first, Index count) {
  // The two points on either side on a line, and the six around a point of a surface of equal triangles.
  constexpr double reach = 1.4;
  double nearest = std::numeric_limits<double>::infinity(), second = nearest;
  for (Index j = first; j < first + count; ++j) {
    if (j == i) continue;
    const double d = (at.row(i) - at.row(j)).norm();
    if (d < nearest)
      second = std::exchange(nearest, d);
    else
      second = std::min(second, d);
  }
  return reach * (std::isfinite(second) ? second : nearest);
}

Model coarsened(const Model& model) {
  Model out = model;
  const Shares wide = shares(model);
  const Matrix& means = wide.T;
  Index first = 0;
  for (Model::PairBlock& pair : out.pairs) {
    const auto columns = means.middleCols(pair.first_point, pair.points).array();
    const auto count = static_cast<int>((columns > 0).rowwise().any().count());
    pair.first_point = static_cast<int>(std::exchange(first, first + count));
    pair.points = count;
  }
  const Matrix level = level_means(model, wide);
  for (Matrix* x : {&out.point_a, &out.point_b, &out.normal}) *x = (level * *x).eval();
  out.faces.clear();
  for (const Index i : wide.centre)
    if (!model.faces.empty()) out.faces.push_back(model.faces[static_cast<std::size_t>(i)]);
  set_gaps(model, wide, level, out);
  out.area = wide.area;
  set_friction(model, out);
  const Matrix T = rows_of(model, means, out), rigid = rows_of(model, level, out);
  out.B = T * model.B;
  for (Index n = 0; n < model.omega.size(); ++n)
    if (model.omega(n) == 0) out.B.col(n) = rigid * model.B.col(n);
  out.R = T * model.R * T.transpose();
  if (model.R_a.size() > 0) out.R_a = T * model.R_a * T.transpose();
  out.static_displacement = T * model.static_displacement;
  out.static_a = T * model.static_a;
  for (Model::Belt& belt : out.belts) belt.slide = T * belt.slide;
  for (Model::Forcing& one : out.forcing) {
    one.displacement = T * one.displacement;
    one.displacement_a = T * one.displacement_a;
  }
  const Selection combined = T.sparseView();
  for (std::vector<Selection>* all : {&out.selection, &out.static_selection})
    for (Selection& one : *all) one = combined * one;
  for (Model::Receiver& receiver : out.receivers) receiver.flexibility = receiver.flexibility * T.transpose();
  return out;
}

Model coarsened(Model model, int times) {
  for (int k = 0; k < times; ++k) model = coarsened(model);
  return model;
}

}  // namespace ricochet::contact
