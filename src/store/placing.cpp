// SPDX-License-Identifier: BSD-2-Clause
#include "src/store/placing.hpp"

#include <algorithm>
#include <limits>

#include "contact/files/history_file.hpp"
#include "contact/pairing/placement.hpp"
#include "kernels/read.hpp"

namespace ricochet::store {
namespace {

namespace fs = std::filesystem;

Eigen::Vector3d vector(const Vector3& v) { return {v[0], v[1], v[2]}; }

}  // namespace

std::vector<contact::PlacedBody> placed_bodies(const scene::Scene& scene, const KernelPointers& kernels) {
  std::vector<contact::PlacedBody> bodies;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const scene::Body& body = scene.bodies[k];
    const auto rotation = scene::rotation_of(body);
    bodies.push_back(contact::arriving(
        {.name = body.name,
         .kernel = kernels[k],
         .rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data()),
         .translation = vector(body.translate),
         .velocity = vector(body.velocity),
         .angular_velocity = vector(body.angular_velocity)},
        body.arrival, vector(scene.loads.gravity)));
  }
  return bodies;
}

std::vector<contact::HalfSpace> half_spaces(const scene::Scene& scene) {
  std::vector<contact::HalfSpace> obstacles;
  for (const scene::Obstacle& obstacle : scene.obstacles)
    obstacles.push_back({obstacle.name, vector(obstacle.point), vector(obstacle.normal)});
  return obstacles;
}

std::vector<contact::PairRequest> pair_requests(const scene::Scene& scene) {
  std::vector<contact::PairRequest> pairs;
  for (const scene::Pair& pair : scene.contact.pairs) {
    contact::PairRequest request{pair.a, pair.b, {}, pair.gap, pair.reach, pair.zone, pair.friction};
    if (pair.direction) request.direction = vector(*pair.direction);
    pairs.push_back(request);
  }
  return pairs;
}

contact::Placement place(const scene::Scene& scene, const KernelPointers& kernels) {
  return contact::place(placed_bodies(scene, kernels), half_spaces(scene), pair_requests(scene));
}

contact::Placement with_kernels(contact::Placement placement, const KernelPointers& kernels) {
  for (std::size_t k = 0; k < kernels.size(); ++k) placement.bodies[k].kernel = kernels[k];
  return placement;
}

namespace {

/// Time up to which obstacles keep their velocity [s]: longer than any run.
constexpr double forever = 1e9;

void refuse_rods(const scene::Scene& scene, const contact::Placement& placement) {
  for (const contact::PlacedBody& body : placement.bodies)
    if (body.kernel->surface.corners() == 1 && scene.contact.rubs(body.name))
      throw InputError(friction_on_rod(body.name));
}

}  // namespace

StepOptions step_options(const scene::Scene& scene) {
  return {.scheme = scene.contact.scheme,
          .admittance = scene.contact.admittance,
          .instant = scene.contact.instant,
          .restitution = scene.contact.restitution,
          .contact_step = scene.contact.integration,
          .step = scene.time.step(),
          .steps_per_sample = scene.time.steps_per_sample(),
          .max_pivots = scene.contact.max_pivots.value_or(std::numeric_limits<int>::max()),
          .precision = scene.time.precision.value_or(Precision::float64)};
}

std::string friction_on_rod(const std::string& body) {
  return fmt::format(
      "contact.friction: bodies.{} is a rod, which moves along its axis alone, so that nothing rubs: leave "
      "friction out of its pairs, or give a solid mesh",
      body);
}

Driven forcing_of(const scene::Scene& scene) {
  Driven out;
  const auto add = [&](const std::vector<scene::Forcing>& all, bool support) {
    for (const scene::Forcing& driven : all) {
      if (!driven.obstacle.empty()) continue;
      contact::ForcingRequest request{
          driven.body, support ? driven.group : driven.name, support, vector(driven.vector), {}};
      request.history = driven.history.empty() ? contact::dead_load : contact::read_history(driven.history);
      out.forcing.push_back(std::move(request));
    }
  };
  add(scene.loads.tractions, false);
  add(scene.loads.points, false);
  add(scene.loads.motions, true);
  for (const scene::Obstacle& obstacle : scene.obstacles)
    if (obstacle.velocity != Vector3{} && scene.contact.scheme != Scheme::at_rest)
      out.belts.push_back({obstacle.name, vector(obstacle.velocity), {{0, forever}, {0, forever}}});
  for (const scene::Forcing& driven : scene.loads.motions)
    if (!driven.obstacle.empty())
      out.belts.push_back({driven.obstacle, vector(driven.vector), contact::read_history(driven.history)});
  return out;
}

contact::Model model_of(const scene::Scene& scene, const contact::Placement& placement,
                        const Driven& driven) {
  refuse_rods(scene, placement);
  contact::Model model = contact::build_model(placement, vector(scene.loads.gravity), driven.forcing);
  std::vector<double> arrivals;
  for (const scene::Body& body : scene.bodies) arrivals.push_back(body.arrival);
  contact::refuse_early_contact(model, arrivals);
  if (scene.contact.scheme == Scheme::impulse || scene.contact.kernel == scene::ContactKernel::table)
    contact::use_mean_gaps(model);
  for (const BeltRequest& belt : driven.belts)
    contact::add_belt(model, belt.obstacle, belt.vector, belt.history);
  return model;
}

bool is_limited(const scene::Scene& scene, const scene::Body& body) {
  const auto names = [&](const scene::Pair& pair) { return pair.names(body.name); };
  return std::ranges::any_of(scene.contact.pairs, names) &&
         std::ranges::all_of(scene.contact.pairs, [&](const scene::Pair& pair) {
           return pair.reach || pair.zone || !names(pair);
         });
}

std::vector<Points> points_within_reach(const scene::Scene& scene, const contact::Placement& placement) {
  auto paired = contact::paired_candidates(placement);
  std::vector<Points> out(paired.size());
  for (std::size_t k = 0; k < paired.size(); ++k) {
    const kernels::Surface& surface = placement.bodies[k].kernel->surface;
    const std::size_t all = surface.whole ? surface.whole->area.size() : surface.size();
    if (is_limited(scene, scene.bodies[k]) && paired[k].size() < all) out[k] = std::move(paired[k]);
  }
  return out;
}

std::vector<bool> normals_suffice(const contact::Placement& placement) {
  std::vector<bool> out;
  for (const double tilt : contact::largest_tilts(placement)) out.push_back(tilt <= contact::most_tilt);
  return out;
}

bool KernelFile::holds(const Points& points, bool normals) const {
  return (normals || !normal_residual) && (!held || (points && std::ranges::includes(*held, *points)));
}

std::vector<KernelFile> kernel_files(const fs::path& folder, const scene::KernelRequest& whole) {
  std::vector<KernelFile> out;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(whole.body.name + "-") || !name.ends_with(".kernel.h5")) continue;
    const auto header = kernels::read_header(entry.path());
    if (!header) continue;
    scene::KernelRequest request = whole;
    request.points = header->held;
    request.within_reach = header->held.has_value();
    request.normal_residual = header->normal_residual;
    if (request.normal_residual && !scene::may_be_normal(request)) continue;
    scene::seal(request);
    if (request.hash == header->hash && entry.path() == scene::kernel_path(folder, request))
      out.push_back({entry.path(), header->held, header->normal_residual});
  }
  const auto candidates = [](const KernelFile& file) {
    return file.held ? file.held->size() : std::numeric_limits<std::size_t>::max();
  };
  std::ranges::sort(out, [&](const KernelFile& a, const KernelFile& b) {
    return std::tuple(candidates(a), !a.normal_residual, a.path) <
           std::tuple(candidates(b), !b.normal_residual, b.path);
  });
  return out;
}

}  // namespace ricochet::store
