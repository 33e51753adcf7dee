// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/contact_zone.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "src/accuracy/local_refinement.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::accuracy {
namespace {

double norm(const Vector3& v) { return std::hypot(v[0], v[1], v[2]); }

/// Whether most of the surfaces that may touch lies within a distance of the closest pair. Areas are
/// compared, as coarser patches have fewer points.
bool covers_most(const contact::Model& model, double zone) {
  double within = 0, whole = 0;
  for (const contact::Model::PairBlock& pair : model.pairs) {
    const auto gap = model.gap.segment(pair.first_point, pair.points).array();
    const auto area = model.area.segment(pair.first_point, pair.points).array();
    within += (gap < gap.minCoeff() + zone).select(area, 0).sum();
    const kernels::Surface& surface = model.bodies[static_cast<std::size_t>(pair.a)].kernel->surface;
    const std::vector<double>& areas = surface.whole ? surface.whole->area : surface.area;
    whole = std::accumulate(areas.begin(), areas.end(), whole);
  }
  return 2 * within > whole;
}

/// Area of the patches of a pair whose gap exceeds the smallest one by less than a distance [m²]. Where this
/// is less than that of the closest few, as on a coarse mesh, it follows from the power law by which the area
/// grows with the gap: linearly on rounded surfaces, with the square root on cylinders.
double area_within(const contact::Model& model, const contact::Model::PairBlock& pair, double distance) {
  constexpr std::size_t few = 9;
  std::vector<std::pair<double, double>> by_gap;  // gap, area of all patches up to there
  for (Eigen::Index i = pair.first_point; i < pair.first_point + pair.points; ++i)
    by_gap.emplace_back(model.gap[i], model.area[i]);
  std::ranges::sort(by_gap);
  const double closest = by_gap.front().first;
  double sum = 0;
  for (auto& [gap, area] : by_gap) {
    gap -= closest;
    area = sum += area;
  }
  const auto beyond = std::ranges::upper_bound(by_gap, std::pair(distance, sum));
  const auto count = static_cast<std::size_t>(beyond - by_gap.begin());
  if (count >= few || count == by_gap.size()) return by_gap[count - 1].second;
  const auto [far, whole] = by_gap[std::min(2 * few, by_gap.size()) - 1];
  const auto [near, part] = by_gap[std::min(few, by_gap.size() / 2)];
  const double power = far > near && near > 0 ? std::log(whole / part) / std::log(far / near) : 1;
  return whole * std::pow(distance / far, std::clamp(power, 0.0, 1.0));
}

int points_pressed(const contact::Model::PairBlock& pair, const contact::Quantities& run) {
  int count = 0;
  for (int i = 0; i < pair.points; ++i) count += run.pressed[static_cast<std::size_t>(pair.first_point + i)];
  return count;
}

/// Gap of the third point beyond those that were pressed, above that of the closest one [m].
double gap_of_ring(const contact::Model& model, const contact::Model::PairBlock& pair,
                   const contact::Quantities& run) {
  constexpr std::size_t ring = 3;
  const auto gap = model.gap.segment(pair.first_point, pair.points);
  std::vector<double> beyond(gap.begin(), gap.end());
  std::ranges::sort(beyond);
  const double closest = beyond.front();
  double farthest = closest;
  for (int i = 0; i < pair.points; ++i)
    if (run.pressed[static_cast<std::size_t>(pair.first_point + i)]) farthest = std::max(farthest, gap[i]);
  const auto next =
      static_cast<std::size_t>(std::ranges::upper_bound(beyond, farthest) - beyond.begin()) + ring;
  return beyond[std::min(next, beyond.size() - 1)] - closest;
}

}  // namespace

bool has_zone(const scene::Scene& scene) {
  return scene.contact.scheme != Scheme::at_rest && !scene.motion.is_finite();
}

std::optional<double> within_flight(const scene::Scene& scene) {
  const scene::Loads& loads = scene.loads;
  if (!has_zone(scene) || !loads.tractions.empty() || !loads.points.empty() || !loads.motions.empty())
    return std::nullopt;
  double fastest = 0;
  for (const scene::Body& body : scene.bodies) {
    if (norm(body.angular_velocity) > 0) return std::nullopt;
    fastest += norm(body.velocity);
  }
  const double duration = scene.time.duration;
  const double distance = after_impact * (fastest + norm(loads.gravity) * duration) * duration;
  return distance > 0 ? std::optional(distance) : std::nullopt;
}

double zone_near_contact(const contact::Quantities& run) { return 2 * run.nearer; }

double zone_with_finer_elements(const contact::Model& model, const contact::Quantities& run, double wanted) {
  double zone = zone_near_contact(run);
  for (const contact::Model::PairBlock& pair : model.pairs)
    if (const int pressed = points_pressed(pair, run); pressed > 0) {
      const double denser = times_denser(pressed, wanted);
      zone = std::max(zone, 2 * gap_of_ring(model, pair, run) / (denser * denser));
    }
  return zone;
}

std::optional<int> few_pressed(const contact::Model& model, const contact::Quantities& run) {
  std::optional<int> out;
  if (run.pressed.empty()) return out;
  for (const contact::Model::PairBlock& pair : model.pairs) {
    const int corners = model.bodies[static_cast<std::size_t>(pair.a)].kernel->surface.corners(),
              fewest = corners == 1   ? 0
                       : corners == 2 ? 3
                                      : 4,
              pressed = points_pressed(pair, run);
    if (pressed > 0 && pressed < fewest) out = std::min(pressed, out.value_or(pressed));
  }
  return out;
}

std::optional<double> zone_of(const contact::Model& model, const contact::Quantities& run) {
  double zone = zone_near_contact(run);
  for (const contact::Model::PairBlock& pair : model.pairs)
    zone = std::max(zone, gap_of_ring(model, pair, run));
  zone *= 1 + 1e-6;  // so that round-off drops none of them
  if (!(zone > 0) || covers_most(model, zone)) return std::nullopt;
  return zone;
}

Eigen::Index candidates_within(const contact::Model& model, double distance) {
  Eigen::Index count = 0;
  for (const contact::Model::PairBlock& pair : model.pairs) {
    const auto gap = model.gap.segment(pair.first_point, pair.points).array();
    count += (gap < gap.minCoeff() + distance).count();
  }
  return count;
}

std::size_t largest_surface(const contact::Model& model) {
  std::size_t most = 0;
  for (const contact::Bodies::Block& body : model.bodies) {
    const kernels::Surface& surface = body.kernel->surface;
    most = std::max(most, (surface.whole ? surface.whole->area : surface.area).size());
  }
  return most;
}

double expected_candidates(const contact::Model& model, const KernelSettings& settings, double distance) {
  // Two triangles of order p and side s have the area √3/2 s² and p² nodes.
  double per_area = 0;
  for (const auto& [body, mesh] : settings.mesh)
    for (const scene::FineBall& ball : mesh.refine)
      per_area = std::max(per_area, 2 / std::sqrt(3.0) * std::pow(mesh.order / ball.size, 2));
  double count = static_cast<double>(candidates_within(model, distance));
  if (per_area > 0)
    for (const contact::Model::PairBlock& pair : model.pairs)
      count = std::max(count, per_area * area_within(model, pair, distance));
  return count;
}

}  // namespace ricochet::accuracy
