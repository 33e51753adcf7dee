// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/local_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "src/scene/scene.hpp"

namespace ricochet::accuracy {
namespace {

using contact::Model;

/// With fewer pressed points than this, the extent of the contact is not resolved at all.
constexpr int few = 3;

/// Distance from a point to the nearest other one of its pair [m]; without another one, the side of a square
/// of its area.
double distance_to_next(const Model& model, const Model::PairBlock& pair, Eigen::Index i) {
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index j = pair.first_point; j < pair.first_point + pair.points; ++j)
    if (j != i) nearest = std::min(nearest, (model.point_a.row(i) - model.point_a.row(j)).norm());
  return std::isfinite(nearest) ? nearest : std::sqrt(model.area[i]);
}

/// Rounded, so that round-off does not change the mesh.
double rounded(double value, double unit) { return unit * std::round(value / unit); }

double two_digits(double value) { return rounded(value, std::pow(10.0, std::floor(std::log10(value)) - 1)); }

double apart(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Whether the scene gives the spacing of the candidates of a pair. The model may have some pairs only.
bool gives_spacing(const scene::Scene& scene, const Model& model, const Model::PairBlock& pair) {
  const auto name = [&](int body) { return model.bodies[static_cast<std::size_t>(body)].name; };
  const std::string a = name(pair.a), b = pair.b < 0 ? pair.obstacle : name(pair.b);
  return std::ranges::any_of(scene.contact.pairs, [&](const scene::Pair& given) {
    return given.names(a) && given.names(b) && given.spacing;
  });
}

bool same_geometry(const scene::Body& a, const scene::Body& b) {
  return a.mesh == b.mesh && a.geometry == b.geometry && a.scale == b.scale;
}

}  // namespace

std::map<std::string, std::vector<scene::FineBall>> balls_near_contact(
    const scene::Scene& scene, const std::map<std::string, MeshSettings>& mesh, const contact::Dialled& round,
    double wanted) {
  std::map<std::string, std::vector<scene::FineBall>> out;
  if (!round.quantities || round.quantities->pressed.empty()) return out;
  const Model& model = round.model;
  const auto is_pressed = [&](Eigen::Index i) {
    return round.quantities->pressed[static_cast<std::size_t>(i)];
  };
  for (std::size_t p = 0; p < model.pairs.size(); ++p) {
    const Model::PairBlock& pair = model.pairs[p];
    if (gives_spacing(scene, model, pair)) continue;
    int pressed = 0;
    for (int i = 0; i < pair.points; ++i) pressed += is_pressed(pair.first_point + i);
    const double denser = times_denser(pressed, wanted), spread = pressed < few ? 1 : 2;
    for (Eigen::Index i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      if (!is_pressed(i)) continue;
      const double next = two_digits(distance_to_next(model, pair, i));
      for (const auto& [block, points] :
           {std::pair(pair.a, &model.point_a), std::pair(pair.b, &model.point_b)}) {
        if (block < 0) continue;
        const contact::Bodies::Block& body = model.bodies[static_cast<std::size_t>(block)];
        const Eigen::Vector3d at =
            body.rotation.transpose() * (points->row(i).transpose() - body.translation);
        const auto& placed = *std::ranges::find(scene.bodies, body.name, &scene::Body::name);
        // An element of order p has p candidates along an edge.
        const auto elements = mesh.find(placed.name);
        const int order = elements != mesh.end() ? elements->second.order : placed.order;
        scene::FineBall ball{.radius = spread * next, .size = order * next / denser};
        for (int k = 0; k < 3; ++k) ball.at[static_cast<std::size_t>(k)] = rounded(at[k], next / 100);
        const auto contains = [&](const scene::FineBall& other) {
          return apart(ball.at, other.at) + next <= 1.1 * other.radius && other.size <= 1.1 * ball.size;
        };
        for (const scene::Body& other : scene.bodies) {
          if (!other.refine_open || !same_geometry(other, placed)) continue;
          std::vector<scene::FineBall>& balls = out[other.name];
          if (std::ranges::none_of(balls, contains)) balls.push_back(ball);
        }
      }
    }
  }
  return out;
}

double times_denser(int pressed, double wanted) { return pressed < few ? 4 : wanted; }

double unknowns_in(const std::vector<scene::FineBall>& balls, int order, double distance) {
  // Half of each sphere lies in the body. Spheres around several balls are shared among those that they
  // contain.
  double per_cube = 0;
  for (const scene::FineBall& ball : balls) {
    double thickness = 0;
    for (double from = 0; from < ball.radius + distance; from += thickness) {
      thickness = ball.size_at(from) / 4;
      const double radius = from + thickness / 2;
      const auto contains = [&](const scene::FineBall& other) { return apart(ball.at, other.at) <= radius; };
      per_cube += 2 * std::numbers::pi * radius * radius * thickness / std::pow(ball.size_at(radius), 3) /
                  static_cast<double>(std::ranges::count_if(balls, contains));
    }
  }
  // A regular tetrahedron has the volume size³/8.5 and, as one of many, order³/6 nodes.
  return 3 * 8.5 * (order * order * order / 6.0) * per_cube;
}

}  // namespace ricochet::accuracy
