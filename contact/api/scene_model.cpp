// SPDX-License-Identifier: BSD-2-Clause
#include "contact/api/scene_model.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/rotation.hpp"
#include "contact/model/forcing.hpp"
#include "contact/pairing/rigid_surface.hpp"

namespace ricochet {
namespace {

using Eigen::Vector3d;

/// Largest coefficient of friction; most dry surfaces have 0.1 to 1.
constexpr double most_friction = 10;

Vector3d finite(const Vector3& v, const std::string& where) {
  if (!std::ranges::all_of(v, [](double x) { return std::isfinite(x); }))
    throw InputError(
        fmt::format("{} = [{}, {}, {}]: contains a value that is not finite.", where, v[0], v[1], v[2]));
  return {v[0], v[1], v[2]};
}

Vector3d unit(const Vector3& v, const std::string& where) {
  const Vector3d out = finite(v, where);
  if (!(out.norm() > 0))
    throw InputError(where + " = [0, 0, 0]: has no direction. Give a vector of any length but 0.");
  return out.normalized();
}

void check(const Scene& scene) {
  std::set<std::string> names;
  const auto add = [&](const std::string& name, const char* list) {
    if (name.empty()) throw InputError(fmt::format("{}: one has no name. Name each.", list));
    if (!names.insert(name).second)
      throw InputError(
          fmt::format("{}.{}: the name is taken. Bodies and obstacles need names of their own.", list, name));
  };
  for (const Body& body : scene.bodies) {
    add(body.name, "bodies");
    const std::string where = "bodies." + body.name;
    if (!body.kernel) throw InputError(where + ": has no kernel. Load one with load_kernel.");
    kernels::validate(*body.kernel, where + ".kernel");
  }
  for (const Obstacle& obstacle : scene.obstacles) add(obstacle.name, "obstacles");
}

Eigen::Matrix3d rotation_by(const Vector3& degrees, const std::string& where) {
  finite(degrees, where + ".rotate_deg");
  const auto rotation = rotation_of(degrees);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data());
}

contact::PlacedBody placed(const Body& body) {
  const std::string where = "bodies." + body.name;
  return {.name = body.name,
          .kernel = body.kernel.get(),
          .rotation = rotation_by(body.rotate_deg, where),
          .translation = finite(body.translate, where + ".translate"),
          .velocity = finite(body.velocity, where + ".velocity"),
          .angular_velocity = finite(body.angular_velocity, where + ".angular_velocity")};
}

double arrival_of(const Body& body) {
  if (!(body.arrival >= 0 && std::isfinite(body.arrival)))
    throw InputError(fmt::format("bodies.{}.arrival = {}: must not be negative.", body.name, body.arrival));
  return body.arrival;
}

/// @param motion  a Slide or a Forcing
contact::History history_of(const auto& motion, const std::string& where) {
  const auto finite_values = [](const std::vector<double>& values) {
    return std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
  };
  if (motion.time.empty() || motion.time.size() != motion.factor.size())
    throw InputError(fmt::format("{}: {} times and {} factors: give one factor for each of its times.", where,
                                 motion.time.size(), motion.factor.size()));
  if (!finite_values(motion.time) || !finite_values(motion.factor))
    throw InputError(where + ": contains a time or a factor that is not finite.");
  if (std::ranges::adjacent_find(motion.time, std::ranges::greater_equal{}) != motion.time.end())
    throw InputError(where + ": its times do not ascend. Sort them, and merge equal ones.");
  return {motion.time, motion.factor};
}

/// The triangles of a mesh, from one of the library.
contact::RigidMesh rigid_mesh(const SurfaceMesh& mesh, bool inside, const std::string& where) {
  contact::RigidMesh out{.inside = inside};
  for (const Vector3& x : mesh.node) out.node.push_back(finite(x, where + ".mesh.node"));
  for (const auto& t : mesh.triangle)
    out.triangle.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  if (const std::string flaw = contact::flaw_of(out); !flaw.empty())
    throw InputError(fmt::format("{}: its surface {}. Give a closed surface.", where, flaw));
  return out;
}

contact::WorldSurface surface_of(const Obstacle& obstacle, const std::string& where) {
  const bool inside = obstacle.side == ObstacleSide::inside;
  const auto refuse_length = [&](const char* name, double value, const char* rule) {
    throw InputError(fmt::format("{}.{} = {}: must be {}.", where, name, value, rule));
  };
  const auto above_0 = [&](const char* name, double value) {
    if (!(value > 0 && std::isfinite(value))) refuse_length(name, value, "above 0");
    return value;
  };
  using Form = contact::RoundSurface::Form;
  contact::RoundSurface round{.side = inside ? -1.0 : 1.0};
  switch (obstacle.shape) {
    case Shape::box: {
      const Vector3d size = finite(obstacle.size, where + ".size");
      for (const double edge : obstacle.size) above_0("size", edge);
      return contact::rigid_box(size, inside);
    }
    case Shape::mesh:
      return contact::rigid_surface(rigid_mesh(obstacle.mesh, inside, where));
    case Shape::cone:
      round.form = Form::cone;
      round.length = above_0("length", obstacle.length);
      for (const auto& [name, value] :
           {std::pair{"radius", obstacle.radius}, std::pair{"radius_small", obstacle.radius_small}})
        if (!(value >= 0 && std::isfinite(value))) refuse_length(name, value, "at least 0");
      above_0("radius", std::max(obstacle.radius, obstacle.radius_small));
      round.radius = obstacle.radius;
      round.radius_small = obstacle.radius_small;
      break;
    case Shape::torus:
      round.form = Form::torus;
      round.radius_small = above_0("radius_small", obstacle.radius_small);
      round.radius = above_0("radius", obstacle.radius);
      if (!(round.radius > round.radius_small))
        refuse_length("radius", round.radius, "above radius_small, or the tube would cross itself");
      break;
    default:
      round.radius = above_0("radius", obstacle.radius);
      if (obstacle.shape != Shape::sphere) round.length = above_0("length", obstacle.length);
      if (obstacle.shape == Shape::cylinder) {
        round.form = Form::cone;
        round.radius_small = round.radius;
      }
  }
  return contact::rigid_surface(round);
}

contact::Obstacle placed(const Obstacle& obstacle) {
  const std::string where = "obstacles." + obstacle.name;
  contact::Obstacle out{.name = obstacle.name, .point = finite(obstacle.point, where + ".point")};
  if (obstacle.shape == Shape::half_space) {
    out.normal = unit(obstacle.normal, where + ".normal");
    return out;
  }
  out.surface = std::make_shared<const contact::WorldSurface>(surface_of(obstacle, where));
  out.rotation = rotation_by(obstacle.rotate_deg, where);
  return out;
}

std::vector<contact::Obstacle> obstacles_of(const Scene& scene) {
  std::vector<contact::Obstacle> out;
  for (const Obstacle& obstacle : scene.obstacles) out.push_back(placed(obstacle));
  return out;
}

std::vector<contact::ForcingRequest> forcing_of(const Scene& scene) {
  std::vector<contact::ForcingRequest> out;
  for (std::size_t k = 0; k < scene.forcing.size(); ++k) {
    const Forcing& one = scene.forcing[k];
    const std::string where = fmt::format("forcing[{}]", k);
    const bool dead = !one.support && one.time.empty() && one.factor.empty();
    finite({one.pressure.value_or(0), 0, 0}, where + ".pressure");
    out.push_back({one.body, one.name, one.support, finite(one.vector, where + ".vector"),
                   dead ? contact::dead_load : history_of(one, where), one.axes, one.pressure});
  }
  return out;
}

/// Modes at the point of the pickup: (3,N) in the axes of the body, or (1,N) along the only direction of the
/// kernel.
Eigen::Map<const contact::Matrix> modes_at(const Pickup& pickup, const kernels::Kernel& kernel,
                                           const std::string& where) {
  const Eigen::Index modes = kernel.modes.size();
  if (!pickup.receiver.empty()) {
    const auto found = std::ranges::find(kernel.receivers, pickup.receiver, &kernels::Receiver::name);
    if (found == kernel.receivers.end())
      throw InputError(fmt::format("{}: no receiver \"{}\" in the kernel of \"{}\", which has {}.", where,
                                   pickup.receiver, pickup.body, kernel.receivers.size()));
    return {found->shape.data(), 3, modes};
  }
  const kernels::Surface& surface = kernel.surface;
  if (pickup.candidate >= surface.size())
    throw InputError(fmt::format("{}: candidate = {}: the kernel of \"{}\" has {}, counted from 0.", where,
                                 pickup.candidate, pickup.body, surface.size()));
  const Eigen::Index rows = surface.components;
  return {surface.shape.data() + pickup.candidate * rows * modes, rows, modes};
}

}  // namespace

std::vector<contact::PlacedBody> bodies_of(const Scene& scene) {
  std::vector<contact::PlacedBody> out;
  const Vector3d gravity = finite(scene.gravity, "gravity");
  for (const Body& body : scene.bodies)
    out.push_back(contact::arriving(placed(body), arrival_of(body), gravity));
  return out;
}

std::optional<Friction> friction_of(const Scene& scene, const std::optional<Friction>& friction,
                                    const std::string& where) {
  if (!friction) return std::nullopt;
  const Friction& f = *friction;
  for (const auto& [name, value] : {std::pair{"static_coefficient", f.static_coefficient},
                                    std::pair{"dynamic_coefficient", f.dynamic_coefficient}})
    if (!(value >= 0 && value <= most_friction))
      throw InputError(
          fmt::format("{}: friction.{} = {}: must be from 0 to {}.", where, name, value, most_friction));
  if (f.static_coefficient == 0 && f.dynamic_coefficient == 0) return std::nullopt;
  if (f.static_coefficient != f.dynamic_coefficient &&
      !(f.stribeck_velocity > 0 && std::isfinite(f.stribeck_velocity)))
    throw InputError(fmt::format(
        "{}: friction.stribeck_velocity = {}: must be above 0, as the coefficients at rest ({}) and in "
        "sliding ({}) differ.",
        where, f.stribeck_velocity, f.static_coefficient, f.dynamic_coefficient));
  if (scene.scheme == Scheme::impulse)
    throw InputError(
        fmt::format("{}: friction needs the compliant scheme. Leave it out, or change the scheme.", where));
  return f;
}

contact::Placement placement_of(const Scene& scene) {
  std::vector<contact::PairRequest> pairs;
  for (const Pair& pair : scene.pairs) {
    const std::string where = fmt::format("contact between \"{}\" and \"{}\"", pair.a, pair.b);
    contact::PairRequest request{pair.a, pair.b, {}, pair.gap, pair.reach, pair.zone};
    if (pair.direction) request.direction = unit(*pair.direction, where + ": direction");
    request.friction = friction_of(scene, pair.friction, where);
    request.everywhere = scene.rotation == Rotation::finite;
    pairs.push_back(request);
  }
  return contact::place(bodies_of(scene), obstacles_of(scene), pairs);
}

contact::Placement placement_with(const Scene& scene, std::vector<contact::PlacedBody> present,
                                  const contact::PlacedBody& added, const std::optional<Friction>& friction) {
  const auto number = static_cast<int>(present.size());
  contact::Placement out{std::move(present), {}};
  const auto request = [&](const std::string& a, const std::string& b) {
    contact::PairRequest pair{a, b, {}, {}, {}};
    pair.friction = friction;
    pair.everywhere = true;
    return pair;
  };
  for (int k = 0; k < number; ++k) {
    const contact::PlacedBody& other = out.bodies[static_cast<std::size_t>(k)];
    const contact::PairRequest pair = request(other.name, added.name);
    out.pairs.push_back({pair, k, number, contact::pair(other, added, pair)});
  }
  for (const contact::Obstacle& obstacle : obstacles_of(scene)) {
    const contact::PairRequest pair = request(added.name, obstacle.name);
    out.pairs.push_back(
        {pair, number, -1, contact::pair(added, obstacle, pair), {}, contact::solid_of(obstacle)});
  }
  out.bodies.push_back(added);
  return out;
}

contact::Model model_of(const Scene& scene, const contact::Placement& placement) {
  for (const contact::ContactPair& pair : placement.pairs)
    for (const int body : {pair.a, pair.b})
      if (body >= 0 && pair.request.friction && is_rod(placement.bodies[body].kernel->surface))
        throw InputError(friction_on_rod(placement.bodies[body].name));
  contact::Model model = contact::build_model(placement, finite(scene.gravity, "gravity"), forcing_of(scene));
  std::vector<double> arrivals;
  for (const Body& body : scene.bodies) arrivals.push_back(body.arrival);
  contact::refuse_early_contact(model, arrivals);
  if (scene.scheme == Scheme::impulse) contact::use_mean_gaps(model);
  drive_obstacles(scene, model);
  return model;
}

contact::Model model_of(const Scene& scene) {
  check(scene);
  contact::Model model = model_of(scene, placement_of(scene));
  contact::refuse_sag(model);
  return model;
}

namespace {

/// The component along the normal of a half-space; exactly 0 if it is round-off.
double along_normal(const Vector3d& normal, const Vector3d& vector) {
  const double along = normal.dot(vector);
  return std::abs(along) > 1e-9 * vector.norm() ? along : 0;
}

/// All motions of an obstacle, in the order of the scene.
std::vector<contact::DrivenMotion::Part> motions_of(const Obstacle& obstacle, bool with_velocity,
                                                    const std::string& where) {
  constexpr double forever = 1e9;  // [s]
  std::vector<contact::DrivenMotion::Part> out;
  const Vector3d velocity = finite(obstacle.velocity, where + ".velocity"),
                 spin = finite(obstacle.angular_velocity, where + ".angular_velocity");
  if (with_velocity && !(velocity.isZero(0) && spin.isZero(0)))
    out.push_back({velocity, spin, {{0, forever}, {0, forever}}});
  for (std::size_t k = 0; k < obstacle.slides.size(); ++k) {
    const std::string slide = fmt::format("{}.slides[{}]", where, k);
    const Slide& one = obstacle.slides[k];
    out.push_back({finite(one.vector, slide + ".vector"),
                   std::numbers::pi / 180 * finite(one.turn_deg, slide + ".turn_deg"),
                   history_of(one, slide)});
  }
  return out;
}

/// Throws InputError if turns have different axes, since they would not add up.
void refuse_axes(const std::vector<contact::DrivenMotion::Part>& motions, const std::string& where) {
  Vector3d axis = Vector3d::Zero();
  for (const contact::DrivenMotion::Part& one : motions) {
    if (one.turn.isZero(0)) continue;
    if (axis.isZero(0)) axis = one.turn.normalized();
    if (axis.cross(one.turn).norm() > 1e-9 * one.turn.norm())
      throw InputError(where + ": it turns about two axes. Give all its turns the same one.");
  }
}

}  // namespace

void drive_obstacles(const Scene& scene, contact::Model& model) {
  for (const Obstacle& obstacle : scene.obstacles) {
    const std::string where = "obstacles." + obstacle.name;
    const bool flat = obstacle.shape == Shape::half_space;
    const auto motions = motions_of(obstacle, scene.scheme != Scheme::at_rest, where);
    refuse_axes(motions, where);
    const Vector3d normal = flat ? unit(obstacle.normal, where + ".normal") : Vector3d(Vector3d::Zero());
    contact::DrivenMotion driven;
    for (const contact::DrivenMotion::Part& one : motions) {
      if (flat && !one.turn.isZero(0))
        throw InputError(where + ": a half-space does not turn. Give a box that is large enough.");
      if (flat) contact::add_belt(model, obstacle.name, one.shift, one.history);
      if (flat && along_normal(normal, one.shift) == 0) continue;
      if (const double start = one.history.at(0); start != 0)
        throw InputError(
            fmt::format("{}: its factor at t = 0 is {:.6g}, so it would not begin at its point. Begin "
                        "with a factor of 0, and move the point.",
                        where, start));
      driven.parts.push_back(one);
    }
    if (!driven.parts.empty())
      contact::drive_obstacle(model, obstacle.name, finite(obstacle.point, where + ".point"), driven);
  }
}

contact::PlacedBody placed_body(const std::string& name, const SharedKernel& kernel,
                                const BodyMotion& motion) {
  const std::string where = "bodies." + name;
  if (!kernel) throw InputError(where + ": has no kernel. Load one with load_kernel.");
  const auto& [w, x, y, z] = motion.attitude;
  const Eigen::Quaterniond attitude(w, x, y, z);
  if (!(attitude.norm() > 0 && std::isfinite(attitude.norm())))
    throw InputError(fmt::format(
        "{}.attitude = [{}, {}, {}, {}]: is no rotation. Give a quaternion w, x, y, z of any length but 0.",
        where, w, x, y, z));
  contact::PlacedBody out{.name = name,
                          .kernel = kernel.get(),
                          .rotation = attitude.normalized().toRotationMatrix(),
                          .velocity = finite(motion.velocity, where + ".velocity"),
                          .angular_velocity = finite(motion.spin, where + ".spin")};
  out.translation = finite(motion.position, where + ".position") -
                    out.rotation * Eigen::Map<const Vector3d>(kernel->centre.data());
  return out;
}

bool is_rod(const kernels::Surface& surface) {
  if (surface.corners() > 1) return false;
  if (surface.components == 1) return true;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();  // of the motions of all points in all modes
  const auto modes =
      static_cast<Eigen::Index>(surface.shape.size() / (3 * std::max<std::size_t>(surface.size(), 1)));
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Map<const contact::Matrix> of_point(&surface.shape[3 * i * modes], 3, modes);
    moments += of_point * of_point.transpose();
  }
  // The largest is the last. 1e-20: squares of round-off
  const Vector3d sizes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvalues();
  return sizes(1) <= 1e-20 * sizes(2);
}

std::string friction_on_rod(const std::string& body) {
  return fmt::format(
      "contact.friction: bodies.{} is a rod, which moves along its axis alone, so that nothing rubs: leave "
      "friction out of its pairs, or give a solid mesh",
      body);
}

StepOptions step_options(const Scene& scene) {
  if (!(scene.rate_hz > 0 && std::isfinite(scene.rate_hz)))
    throw InputError(fmt::format("rate_hz = {}: must be positive and finite.", scene.rate_hz));
  const double ratio = scene.steps_per_sample();
  if (!(ratio <= most_steps_per_sample) || (ratio > 1 && scene.scheme != Scheme::compliant))
    throw InputError(
        fmt::format("contact_rate_hz = {}: must be left out with the impulse scheme, and at most 1e6 times "
                    "rate_hz = {} otherwise.",
                    scene.contact_rate_hz.value_or(scene.rate_hz), scene.rate_hz));
  return {.contact = scene,
          .rigid = scene,
          .step = scene.step(),
          .steps_per_sample = static_cast<int>(ratio),
          .precision = scene.precision};
}

std::vector<TurningPickup> turning_pickups_of(const Scene& scene, const contact::Model& model) {
  std::vector<TurningPickup> out;
  for (std::size_t k = 0; k < scene.pickups.size() && scene.rotation == Rotation::finite; ++k) {
    const Pickup& pickup = scene.pickups[k];
    const std::string where = fmt::format("pickups[{}]", k);
    const auto body = std::ranges::find(model.bodies, pickup.body, &contact::Bodies::Block::name);
    const kernels::Kernel& kernel = *body->kernel;  // pickups_of has found it
    const double* const at =
        pickup.receiver.empty()
            ? &kernel.surface.places()[3 * pickup.candidate]
            : std::ranges::find(kernel.receivers, pickup.receiver, &kernels::Receiver::name)->point.data();
    out.push_back({static_cast<int>(body - model.bodies.begin()),
                   Eigen::Map<const Vector3d>(at) - body->own_centre(),
                   unit(pickup.direction, where + ".direction"), modes_at(pickup, kernel, where)});
  }
  return out;
}

contact::Matrix pickups_of(const Scene& scene, const contact::Model& model) {
  contact::Matrix out = contact::Matrix::Zero(scene.pickups.size(), model.omega.size());
  for (std::size_t k = 0; k < scene.pickups.size(); ++k) {
    const Pickup& pickup = scene.pickups[k];
    const std::string where = fmt::format("pickups[{}]", k);
    const auto body = std::ranges::find(model.bodies, pickup.body, &contact::Bodies::Block::name);
    if (body == model.bodies.end())
      throw InputError(fmt::format("{}: \"{}\" is not a body. Name one of bodies.", where, pickup.body));
    const kernels::Kernel& kernel = *body->kernel;
    const Vector3d own = body->rotation.transpose() * unit(pickup.direction, where + ".direction");
    const auto modes = modes_at(pickup, kernel, where);
    auto row = out.row(k).segment(body->first_mode, body->modes);
    if (modes.rows() == 3) {
      row = own.transpose() * modes;
      continue;
    }
    const Vector3& d = *kernel.surface.direction;
    const double along = own.dot(Vector3d(d[0], d[1], d[2]));
    if (std::abs(along) < 1 - 1e-9)
      throw InputError(
          fmt::format("{}.direction: the kernel of \"{}\" holds the motion along [{:.6g}, {:.6g}, "
                      "{:.6g}] (its own axes) alone. Listen along it.",
                      where, pickup.body, d[0], d[1], d[2]));
    row = std::copysign(1.0, along) * modes;
  }
  return out;
}

}  // namespace ricochet
