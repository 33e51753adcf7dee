// SPDX-License-Identifier: BSD-2-Clause
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <tuple>
#include <utility>

#include "ricochet/ricochet.h"
#include "ricochet/ricochet.hpp"

struct ricochet_kernel {
  ricochet::SharedKernel kernel;
};
struct ricochet_scene {
  ricochet::Scene scene;
};
struct ricochet_simulation {
  ricochet::Simulation simulation;
};
struct ricochet_state {
  ricochet::Simulation::State state;
};

namespace {

using ricochet::InputError;
using ricochet::Vector3;

static_assert(RICOCHET_OK == static_cast<int>(ricochet::StepStatus::ok) &&
              RICOCHET_NO_SOLUTION == static_cast<int>(ricochet::StepStatus::no_solution) &&
              RICOCHET_NOT_FINITE == static_cast<int>(ricochet::StepStatus::not_finite) &&
              RICOCHET_CROWDED == static_cast<int>(ricochet::StepStatus::crowded));
static_assert(RICOCHET_VERSION_NUMBER == RICOCHET_PROJECT_VERSION_NUMBER,
              "ricochet.h and project(Ricochet VERSION …) must agree");

thread_local char last_error[1024] = "";

/// Returns the result of `action`, or `failed` if it throws.
template <class Result, class Action>
Result guarded(Result failed, Action action) noexcept {
  try {
    return action();
  } catch (const std::exception& error) {
    std::snprintf(last_error, sizeof last_error, "%s", error.what());
  } catch (...) {
    std::snprintf(last_error, sizeof last_error, "unknown error");
  }
  return failed;
}

/// Runs `action`. Returns RICOCHET_OK, or RICOCHET_REFUSED if it throws.
template <class Action>
int checked(Action action) noexcept {
  return guarded<int>(RICOCHET_REFUSED, [&] {
    action();
    return RICOCHET_OK;
  });
}

template <class T>
T& given(T* pointer, const char* what) {
  if (!pointer)
    throw InputError(std::string(what) +
                     " is NULL. Give one, or ask ricochet_error() of the call that made it.");
  return *pointer;
}

Vector3 vector(const double* v, const char* what) {
  given(v, what);
  return {v[0], v[1], v[2]};
}
Vector3 vector_or_zero(const double* v) { return v ? Vector3{v[0], v[1], v[2]} : Vector3{}; }
std::string text(const char* s, const char* what) { return &given(s, what); }
std::optional<double> number(const double* x) { return x ? std::optional(*x) : std::nullopt; }

/// @param setting  what is set, for the message
ricochet::Obstacle& obstacle_of(ricochet_scene* scene, const char* name, const char* setting) {
  auto& obstacles = given(scene, "scene").scene.obstacles;
  const auto found = std::ranges::find(obstacles, text(name, "obstacle"), &ricochet::Obstacle::name);
  if (found == obstacles.end())
    throw InputError(std::string(setting) + ": \"" + name +
                     "\" is not an obstacle of the scene. Add it first.");
  return *found;
}

ricochet::Body& body_of(ricochet_scene* scene, const char* name, const char* setting) {
  auto& bodies = given(scene, "scene").scene.bodies;
  const auto found = std::ranges::find(bodies, text(name, "body"), &ricochet::Body::name);
  if (found == bodies.end())
    throw InputError(std::string(setting) + ": \"" + name + "\" is not a body of the scene.");
  return *found;
}

void add_forcing(ricochet_scene* scene, const char* body, const char* name, bool support, const double* along,
                 const double* time, const double* factor, size_t count) {
  const char* const setting = support ? "support" : "load";
  if (count > 0 && (!time || !factor))
    throw InputError(std::string(setting) + ": time or factor is NULL. Give both.");
  const std::string moved = body_of(scene, body, setting).name;
  given(scene, "scene")
      .scene.forcing.push_back({moved,
                                text(name, setting),
                                support,
                                vector(along, "vector"),
                                {time, time + count},
                                {factor, factor + count}});
}

}  // namespace

int ricochet_version(void) { return RICOCHET_VERSION_NUMBER; }
const char* ricochet_error(void) { return last_error; }

ricochet_kernel* ricochet_kernel_load(const char* path) {
  return guarded<ricochet_kernel*>(
      nullptr, [&] { return new ricochet_kernel{ricochet::load_kernel(text(path, "path"))}; });
}
void ricochet_kernel_free(ricochet_kernel* kernel) { delete kernel; }
double ricochet_kernel_mass(const ricochet_kernel* kernel) { return kernel->kernel->mass; }
size_t ricochet_kernel_modes(const ricochet_kernel* kernel) { return kernel->kernel->modes.size(); }
size_t ricochet_kernel_candidates(const ricochet_kernel* kernel) { return kernel->kernel->surface.size(); }
const double* ricochet_kernel_nodes(const ricochet_kernel* kernel) {
  return kernel->kernel->surface.node.data();
}

ricochet_scene* ricochet_scene_new(double rate_hz) {
  return guarded<ricochet_scene*>(nullptr, [&] {
    return new ricochet_scene{{{}, {.rate_hz = rate_hz}, {}}};
  });
}
void ricochet_scene_free(ricochet_scene* scene) { delete scene; }

int ricochet_scene_body(ricochet_scene* scene, const char* name, const ricochet_kernel* kernel,
                        const double* rotate_deg, const double* translate, const double* velocity) {
  return checked([&] {
    given(scene, "scene")
        .scene.bodies.push_back({.name = text(name, "name"),
                                 .kernel = given(kernel, "kernel").kernel,
                                 .rotate_deg = vector_or_zero(rotate_deg),
                                 .translate = vector_or_zero(translate),
                                 .velocity = vector_or_zero(velocity)});
  });
}

int ricochet_scene_angular_velocity(ricochet_scene* scene, const char* body, const double* angular_velocity) {
  return checked(
      [&] { body_of(scene, body, "angular_velocity").angular_velocity = vector_or_zero(angular_velocity); });
}

int ricochet_scene_arrival(ricochet_scene* scene, const char* body, double arrival) {
  return checked([&] { body_of(scene, body, "arrival").arrival = arrival; });
}

int ricochet_scene_half_space(ricochet_scene* scene, const char* name, const double* point,
                              const double* normal) {
  return checked([&] {
    given(scene, "scene")
        .scene.obstacles.push_back({text(name, "name"), vector(point, "point"), vector(normal, "normal")});
  });
}

int ricochet_scene_obstacle(ricochet_scene* scene, const char* name, const char* shape, int inside,
                            const double* point, const double* rotate_deg, const double* sizes) {
  return checked([&] {
    using ricochet::Shape;
    ricochet::Obstacle made{.name = text(name, "name"), .point = vector(point, "point")};
    const std::string is = text(shape, "shape");
    const Vector3 size = vector(sizes, "sizes");
    const std::map<std::string, Shape> shapes{{"sphere", Shape::sphere},   {"cylinder", Shape::cylinder},
                                              {"capsule", Shape::capsule}, {"box", Shape::box},
                                              {"cone", Shape::cone},       {"torus", Shape::torus}};
    const auto found = shapes.find(is);
    if (found == shapes.end())
      throw InputError("shape: \"" + is + "\" is none of sphere, cylinder, capsule, box, cone and torus.");
    made.shape = found->second;
    made.side = inside ? ricochet::ObstacleSide::inside : ricochet::ObstacleSide::outside;
    made.rotate_deg = vector_or_zero(rotate_deg);
    if (made.shape == Shape::box)
      made.size = size;
    else
      std::tie(made.radius, made.radius_small, made.length) = std::tie(size[0], size[1], size[2]);
    given(scene, "scene").scene.obstacles.push_back(std::move(made));
  });
}

int ricochet_scene_obstacle_mesh(ricochet_scene* scene, const char* name, const char* path, double scale,
                                 int inside, const double* point, const double* rotate_deg) {
  return checked([&] {
    ricochet::Obstacle made{
        .name = text(name, "name"), .point = vector(point, "point"), .shape = ricochet::Shape::mesh};
    made.side = inside ? ricochet::ObstacleSide::inside : ricochet::ObstacleSide::outside;
    made.rotate_deg = vector_or_zero(rotate_deg);
    made.mesh = ricochet::load_surface(text(path, "path"), scale);
    given(scene, "scene").scene.obstacles.push_back(std::move(made));
  });
}

int ricochet_scene_pair(ricochet_scene* scene, const char* a, const char* b, const double* direction,
                        const double* gap, const double* reach) {
  return checked([&] {
    ricochet::Pair pair{.a = text(a, "a"), .b = text(b, "b"), .gap = number(gap), .reach = number(reach)};
    if (direction) pair.direction = vector(direction, "direction");
    given(scene, "scene").scene.pairs.push_back(std::move(pair));
  });
}

int ricochet_scene_friction(ricochet_scene* scene, double static_coefficient, double dynamic_coefficient,
                            double stribeck_velocity) {
  return checked([&] {
    auto& pairs = given(scene, "scene").scene.pairs;
    if (pairs.empty())
      throw InputError("friction: the scene has no pair yet. Add one with ricochet_scene_pair first.");
    pairs.back().friction = {static_coefficient, dynamic_coefficient, stribeck_velocity};
  });
}

int ricochet_scene_obstacle_velocity(ricochet_scene* scene, const char* obstacle, const double* velocity,
                                     const double* angular_velocity) {
  return checked([&] {
    ricochet::Obstacle& moved = obstacle_of(scene, obstacle, "velocity");
    moved.velocity = vector_or_zero(velocity);
    moved.angular_velocity = vector_or_zero(angular_velocity);
  });
}

int ricochet_scene_obstacle_motion(ricochet_scene* scene, const char* obstacle, const double* shift,
                                   const double* turn_deg, const double* time, const double* factor,
                                   size_t count) {
  return checked([&] {
    ricochet::Obstacle& moved = obstacle_of(scene, obstacle, "motion");
    if (count > 0 && (!time || !factor)) throw InputError("motion: time or factor is NULL. Give both.");
    moved.slides.push_back(
        {vector_or_zero(shift), {time, time + count}, {factor, factor + count}, vector_or_zero(turn_deg)});
  });
}

int ricochet_scene_pickup(ricochet_scene* scene, const char* body, const char* receiver, size_t candidate,
                          const double* direction) {
  return checked([&] {
    given(scene, "scene")
        .scene.pickups.push_back({.body = text(body, "body"),
                                  .receiver = receiver ? receiver : "",
                                  .candidate = candidate,
                                  .direction = vector(direction, "direction")});
  });
}

int ricochet_scene_gravity(ricochet_scene* scene, const double* gravity) {
  return checked([&] { given(scene, "scene").scene.gravity = vector(gravity, "gravity"); });
}

int ricochet_scene_load(ricochet_scene* scene, const char* body, const char* load, const double* along,
                        const double* time, const double* factor, size_t count) {
  return checked([&] { add_forcing(scene, body, load, false, along, time, factor, count); });
}

int ricochet_scene_pressure(ricochet_scene* scene, const char* body, const char* load, double pressure,
                            const double* time, const double* factor, size_t count) {
  return checked([&] {
    const Vector3 none{};
    add_forcing(scene, body, load, false, none.data(), time, factor, count);
    scene->scene.forcing.back().pressure = pressure;
  });
}

int ricochet_scene_load_axes(ricochet_scene* scene, int axes) {
  return checked([&] {
    auto& forcing = given(scene, "scene").scene.forcing;
    if (forcing.empty() || forcing.back().support)
      throw InputError("axes: no load was added last. Add one with ricochet_scene_load first.");
    if (axes != RICOCHET_WORLD && axes != RICOCHET_BODY)
      throw InputError("axes = " + std::to_string(axes) + ": must be RICOCHET_WORLD or RICOCHET_BODY.");
    forcing.back().axes = axes == RICOCHET_WORLD ? ricochet::Axes::world : ricochet::Axes::body;
  });
}

int ricochet_scene_rotation(ricochet_scene* scene, int rotation) {
  return checked([&] {
    if (rotation != RICOCHET_LINEAR && rotation != RICOCHET_FINITE)
      throw InputError("rotation = " + std::to_string(rotation) +
                       ": must be RICOCHET_LINEAR or RICOCHET_FINITE.");
    given(scene, "scene").scene.rotation =
        rotation == RICOCHET_LINEAR ? ricochet::Rotation::linear : ricochet::Rotation::finite;
  });
}

int ricochet_scene_support(ricochet_scene* scene, const char* body, const char* support, const double* along,
                           const double* time, const double* factor, size_t count) {
  return checked([&] { add_forcing(scene, body, support, true, along, time, factor, count); });
}

int ricochet_scene_exact_events(ricochet_scene* scene) {
  return checked([&] { given(scene, "scene").scene.instant = ricochet::Instant::exact; });
}

int ricochet_scene_impulse(ricochet_scene* scene, int admittance, double restitution) {
  return checked([&] {
    if (admittance != RICOCHET_JUMP && admittance != RICOCHET_DIFFERENCE)
      throw InputError("admittance = " + std::to_string(admittance) +
                       ": must be RICOCHET_JUMP or RICOCHET_DIFFERENCE.");
    ricochet::Scene& s = given(scene, "scene").scene;
    s.scheme = ricochet::Scheme::impulse;
    s.admittance =
        admittance == RICOCHET_JUMP ? ricochet::Admittance::jump : ricochet::Admittance::difference;
    s.restitution = restitution;
  });
}

ricochet_simulation* ricochet_simulation_new(const ricochet_scene* scene) {
  return guarded<ricochet_simulation*>(
      nullptr, [&] { return new ricochet_simulation{ricochet::Simulation(given(scene, "scene").scene)}; });
}
void ricochet_simulation_free(ricochet_simulation* simulation) { delete simulation; }

int ricochet_simulation_step(ricochet_simulation* simulation) {
  return static_cast<int>(simulation->simulation.step());
}

int ricochet_simulation_step_block(ricochet_simulation* simulation, int64_t steps,
                                   const ricochet_block* block) {
  ricochet::Block out;
  if (block)
    out = {block->velocity, block->total_force, block->force, block->displacement, block->tangential_force};
  return static_cast<int>(simulation->simulation.step_block(steps, out).status);
}

int64_t ricochet_simulation_steps(const ricochet_simulation* simulation) {
  return simulation->simulation.steps();
}
double ricochet_simulation_time(const ricochet_simulation* simulation) {
  return simulation->simulation.time();
}
size_t ricochet_simulation_points(const ricochet_simulation* simulation) {
  return simulation->simulation.points().size();
}
size_t ricochet_simulation_pickups(const ricochet_simulation* simulation) {
  return simulation->simulation.pickups();
}
int ricochet_simulation_active(const ricochet_simulation* simulation) {
  return simulation->simulation.active();
}
const double* ricochet_simulation_force(const ricochet_simulation* simulation) {
  return simulation->simulation.force().data();
}
const double* ricochet_simulation_displacement(const ricochet_simulation* simulation) {
  return simulation->simulation.displacement().data();
}
const double* ricochet_simulation_tangential_force(const ricochet_simulation* simulation) {
  return simulation->simulation.tangential_force().data();
}

void ricochet_simulation_point(const ricochet_simulation* simulation, size_t point, ricochet_point* out) {
  const ricochet::ContactPoint& p = simulation->simulation.points()[point];
  *out = {p.pair,
          {p.a[0], p.a[1], p.a[2]},
          {p.b[0], p.b[1], p.b[2]},
          {p.normal[0], p.normal[1], p.normal[2]},
          p.gap,
          p.area};
}

double ricochet_simulation_pickup_velocity(const ricochet_simulation* simulation, size_t pickup) {
  return simulation->simulation.pickup_velocity(pickup);
}
double ricochet_simulation_pickup_displacement(const ricochet_simulation* simulation, size_t pickup) {
  return simulation->simulation.pickup_displacement(pickup);
}

void ricochet_simulation_mean_velocity(const ricochet_simulation* simulation, size_t body, double out[3]) {
  std::ranges::copy(simulation->simulation.mean_velocity(body), out);
}

void ricochet_simulation_motion(const ricochet_simulation* simulation, size_t body, ricochet_motion* out) {
  const ricochet::BodyMotion motion = simulation->simulation.body_motion(body);
  std::ranges::copy(motion.position, out->position);
  std::ranges::copy(motion.attitude, out->attitude);
  std::ranges::copy(motion.velocity, out->velocity);
  std::ranges::copy(motion.spin, out->spin);
}

size_t ricochet_simulation_contacts(ricochet_simulation* simulation, ricochet_contact* out, size_t count) {
  const auto touching = simulation->simulation.contacts();
  for (const ricochet::Touching& one : touching.first(std::min(count, touching.size()))) {
    out->pair = simulation->simulation.points()[one.point].pair;
    out->point = one.point;
    out->a = one.between[0].data();
    out->b = one.between[1].data();
    std::ranges::copy(one.place, out->place);
    std::ranges::copy(one.normal, out->normal);
    std::ranges::copy(one.force, out->force);
    ++out;
  }
  return touching.size();
}

int ricochet_simulation_push(ricochet_simulation* simulation, size_t body, const double* force,
                             const double* torque) {
  if (simulation->simulation.push(body, vector_or_zero(force), vector_or_zero(torque))) return RICOCHET_OK;
  std::snprintf(last_error, sizeof last_error,
                "push: the body is not there, or rotations are linear. Call ricochet_scene_rotation with "
                "RICOCHET_FINITE first.");
  return RICOCHET_REFUSED;
}

int ricochet_simulation_push_at(ricochet_simulation* simulation, size_t body, const char* receiver,
                                size_t candidate, const double* force) {
  if (simulation->simulation.push_at(body, {receiver ? receiver : "", candidate}, vector_or_zero(force)))
    return RICOCHET_OK;
  std::snprintf(
      last_error, sizeof last_error,
      "push_at: the body or the point is not there, its kernel does not hold the motion along the force, "
      "or too many forces act. Name a receiver or a candidate of the kernel.");
  return RICOCHET_REFUSED;
}

int ricochet_simulation_add(ricochet_simulation* simulation, const char* name, const ricochet_kernel* kernel,
                            const ricochet_motion* motion, const double* friction, size_t* body) {
  return checked([&] {
    const ricochet_motion& given_motion = given(motion, "motion");
    const double* const q = given_motion.attitude;
    std::optional<ricochet::Friction> rubs;
    if (friction) rubs = {friction[0], friction[1], friction[2]};
    const std::size_t number = simulation->simulation.add(text(name, "name"), given(kernel, "kernel").kernel,
                                                          {vector(given_motion.position, "position"),
                                                           {q[0], q[1], q[2], q[3]},
                                                           vector(given_motion.velocity, "velocity"),
                                                           vector(given_motion.spin, "spin")},
                                                          rubs);
    if (body) *body = number;
  });
}

int ricochet_simulation_remove(ricochet_simulation* simulation, size_t body) {
  return checked([&] { simulation->simulation.remove(body); });
}

int ricochet_simulation_find(const ricochet_simulation* simulation, const char* name, size_t* body) {
  return checked([&] {
    const auto found = simulation->simulation.find(text(name, "name"));
    if (!found) throw InputError(std::string("find: there is no body \"") + name + "\".");
    given(body, "body") = *found;
  });
}

size_t ricochet_simulation_bodies(const ricochet_simulation* simulation, size_t* out, size_t count) {
  const auto numbers = simulation->simulation.bodies();
  std::ranges::copy(numbers.first(std::min(count, numbers.size())), out);
  return numbers.size();
}

void ricochet_simulation_energy(const ricochet_simulation* simulation, ricochet_energy* out) {
  const ricochet::Energy e = simulation->simulation.energy();
  *out = {e.kinetic, e.strain, e.residual, e.loads, e.damping, e.contact, e.friction, e.added};
}

ricochet_state* ricochet_simulation_save(const ricochet_simulation* simulation) {
  return guarded<ricochet_state*>(nullptr, [&] { return new ricochet_state{simulation->simulation.save()}; });
}

int ricochet_simulation_restore(ricochet_simulation* simulation, const ricochet_state* state) {
  if (state && simulation->simulation.restore(state->state)) return RICOCHET_OK;
  std::snprintf(
      last_error, sizeof last_error,
      "state: is not one of this system. Restore it in a simulation of the same kernels and scene.");
  return RICOCHET_REFUSED;
}

size_t ricochet_state_bytes(const ricochet_state* state, void* out, size_t count) {
  return guarded<size_t>(0, [&] {
    const std::vector<std::byte> bytes = given(state, "state").state.bytes();
    if (out && bytes.size() <= count) std::memcpy(out, bytes.data(), bytes.size());
    return bytes.size();
  });
}

ricochet_state* ricochet_state_read(const ricochet_simulation* simulation, const void* bytes, size_t count) {
  return guarded<ricochet_state*>(nullptr, [&] {
    const auto* const from = static_cast<const std::byte*>(bytes);
    return new ricochet_state{given(simulation, "simulation").simulation.state({from, from ? count : 0})};
  });
}

void ricochet_state_free(ricochet_state* state) { delete state; }
