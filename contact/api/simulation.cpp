// SPDX-License-Identifier: BSD-2-Clause
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>

#include "base/rotation.hpp"
#include "contact/model/model.hpp"
#include "contact/stepping/run_steps.hpp"
#include "contact/stepping/stepper.hpp"
#include "kernels/read.hpp"
#include "kernels/write.hpp"
#include "ricochet/ricochet.hpp"

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

void check_names(const Scene& scene) {
  std::set<std::string> names;
  const auto add = [&](const std::string& name, const char* list) {
    if (name.empty()) throw InputError(fmt::format("{}: one has no name. Name each.", list));
    if (!names.insert(name).second)
      throw InputError(
          fmt::format("{}.{}: the name is taken. Bodies and obstacles need names of their own.", list, name));
  };
  for (const Body& body : scene.bodies) add(body.name, "bodies");
  for (const HalfSpace& obstacle : scene.obstacles) add(obstacle.name, "obstacles");
}

contact::PlacedBody placed(const Body& body) {
  const std::string where = "bodies." + body.name;
  if (!body.kernel) throw InputError(where + ": has no kernel. Load one with load_kernel.");
  kernels::validate(*body.kernel, where + ".kernel");
  finite(body.rotate_deg, where + ".rotate_deg");
  const auto rotation = rotation_of(body.rotate_deg);
  return {.name = body.name,
          .kernel = body.kernel.get(),
          .rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data()),
          .translation = finite(body.translate, where + ".translate"),
          .velocity = finite(body.velocity, where + ".velocity"),
          .angular_velocity = finite(body.angular_velocity, where + ".angular_velocity")};
}

/// No value if the pair is frictionless. @param where  the pair, for messages
std::optional<Friction> friction_of(const Scene& scene, const Pair& pair, const std::string& where) {
  if (!pair.friction) return std::nullopt;
  const Friction& f = *pair.friction;
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
  if (scene.scheme != Scheme::compliant)
    throw InputError(
        fmt::format("{}: friction needs the compliant scheme. Leave it out, or change the scheme.", where));
  return f;
}

/// Sets the half-spaces in motion.
void add_belts(const Scene& scene, contact::Model& model) {
  constexpr double forever = 1e9;  // [s]
  for (const HalfSpace& obstacle : scene.obstacles) {
    const std::string where = "obstacles." + obstacle.name;
    const Vector3d velocity = finite(obstacle.velocity, where + ".velocity"),
                   normal = unit(obstacle.normal, where + ".normal");
    if (std::abs(normal.dot(velocity)) > 1e-9 * velocity.norm())
      throw InputError(fmt::format(
          "{}.velocity = [{:.6g}, {:.6g}, {:.6g}]: has the component {:.6g} m/s along the normal. Leave it "
          "out, because a half-space moves along its surface.",
          where, velocity.x(), velocity.y(), velocity.z(), normal.dot(velocity)));
    if (!velocity.isZero(0)) contact::add_belt(model, obstacle.name, velocity, {{0, forever}, {0, forever}});
  }
}

contact::Model model_of(const Scene& scene) {
  check_names(scene);
  std::vector<contact::PlacedBody> bodies;
  for (const Body& body : scene.bodies) bodies.push_back(placed(body));
  std::vector<contact::HalfSpace> obstacles;
  for (const HalfSpace& obstacle : scene.obstacles) {
    const std::string where = "obstacles." + obstacle.name;
    obstacles.push_back(
        {obstacle.name, finite(obstacle.point, where + ".point"), unit(obstacle.normal, where + ".normal")});
  }
  std::vector<contact::PairRequest> pairs;
  for (const Pair& pair : scene.pairs) {
    const std::string where = fmt::format("contact between \"{}\" and \"{}\"", pair.a, pair.b);
    contact::PairRequest request{pair.a, pair.b, {}, pair.gap, pair.reach};
    if (pair.direction) request.direction = unit(*pair.direction, where + ": direction");
    request.friction = friction_of(scene, pair, where);
    pairs.push_back(request);
  }
  contact::Model model =
      contact::build_model(std::move(bodies), obstacles, pairs, finite(scene.gravity, "gravity"));
  add_belts(scene, model);
  contact::refuse_sag(model);
  return model;
}

StepOptions step_options(const Scene& scene) {
  if (!(scene.rate_hz > 0 && std::isfinite(scene.rate_hz)))
    throw InputError(fmt::format("rate_hz = {}: must be positive and finite.", scene.rate_hz));
  const double ratio = std::max(1.0, std::ceil(scene.contact_rate_hz / scene.rate_hz * (1 - 1e-12)));
  if (!(ratio <= 1e6) || (ratio > 1 && scene.scheme != Scheme::compliant))
    throw InputError(
        fmt::format("contact_rate_hz = {}: must be 0 with the impulse scheme, and at most 1e6 times rate_hz "
                    "= {} otherwise.",
                    scene.contact_rate_hz, scene.rate_hz));
  return {.scheme = scene.scheme,
          .admittance = scene.admittance,
          .restitution = scene.restitution,
          .contact_step = scene.integration,
          .friction_law = scene.friction_law,
          .step = 1 / (scene.rate_hz * ratio),
          .steps_per_sample = static_cast<int>(ratio),
          .precision = scene.single_precision ? Precision::float32 : Precision::float64};
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

/// Matrix (p,N) that maps q̇ to the velocities of the pickups.
contact::Matrix pickups_of(const Scene& scene, const contact::Model& model) {
  contact::Matrix out = contact::Matrix::Zero(scene.pickups.size(), model.omega.size());
  for (std::size_t k = 0; k < scene.pickups.size(); ++k) {
    const Pickup& pickup = scene.pickups[k];
    const std::string where = fmt::format("pickups[{}]", k);
    const auto body = std::ranges::find(model.bodies, pickup.body, &contact::Model::BodyBlock::name);
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

Vector3 array(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::vector<ContactPoint> points_of(const contact::Model& model) {
  std::vector<ContactPoint> out;
  for (std::size_t k = 0; k < model.pairs.size(); ++k)
    for (int i = 0; i < model.pairs[k].points; ++i) {
      const Eigen::Index row = model.pairs[k].first_point + i;
      out.push_back({k, array(model.point_a.row(row)), array(model.point_b.row(row)),
                     array(model.normal.row(row)), model.gap(row), model.area(row)});
    }
  return out;
}

std::span<const double> span_of(const contact::Vector& v) noexcept {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

std::uint64_t next_identity() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

SharedKernel load_kernel(const std::filesystem::path& path) {
  return std::make_shared<const kernels::Kernel>(kernels::read(path));
}

void save_kernel(const kernels::Kernel& kernel, const std::filesystem::path& path) {
  kernels::write(kernel, path);
}

struct Simulation::Impl {
  explicit Impl(const Scene& scene)
      : model(model_of(scene)),
        stepper(contact::make_stepper(model, step_options(scene))),
        force(stepper->force().head(stepper->points())),
        rubbing(stepper->force().tail(stepper->force().size() - force.size())),
        tangential_force(contact::Matrix::Zero(force.size(), 3)),
        pickups(pickups_of(scene, model)),
        points(points_of(model)) {
    for (const Body& body : scene.bodies) kernels.push_back(body.kernel);
  }

  int per_sample() const noexcept { return stepper->options().steps_per_sample; }
  std::int64_t samples() const noexcept { return stepper->steps() / per_sample(); }

  /// Adds the force of the last contact step to the mean over the sample.
  void add_force() noexcept {
    if (begins_sample) {
      force.setZero();
      rubbing.setZero();
    }
    force += stepper->force().head(force.size()) / per_sample();
    rubbing += stepper->force().tail(rubbing.size()) / per_sample();
    begins_sample = stepper->at_sample();
    if (begins_sample) turn_to_world();
  }

  /// Computes the tangential forces of the points from those along their tangents.
  void turn_to_world() noexcept {
    const Eigen::Index m = force.size();
    for (const contact::Model::FrictionPoint& point : model.friction)
      tangential_force.row(point.point).noalias() = rubbing.segment<2>(point.tangential - m).transpose() *
                                                    model.tangent.middleRows<2>(point.tangential - m);
  }

  /// Writes row k from the last sample.
  void write_forces(const Block& out, std::int64_t k) const noexcept {
    const Eigen::Index m = force.size();
    if (out.total_force) out.total_force[k] = force.sum();
    if (out.force) std::copy_n(force.data(), m, out.force + k * m);
    if (out.displacement) std::copy_n(stepper->displacement().data(), m, out.displacement + k * m);
    if (out.tangential_force) std::copy_n(tangential_force.data(), 3 * m, out.tangential_force + 3 * k * m);
  }

  /// Writes the rows of velocities of the samples between contact steps `from` and `to` of the block: the
  /// steps through which the state was last advanced.
  void write_velocities(const Block& out, std::int64_t from, std::int64_t to) const noexcept {
    if (!out.velocity) return;
    const Eigen::Index p = pickups.rows();
    for (std::int64_t row = from / per_sample(); (row + 1) * per_sample() <= to; ++row) {
      const auto back = static_cast<int>(to - (row + 1) * per_sample());
      const Eigen::Map<const contact::Vector> v(stepper->rate(back), pickups.cols());
      for (Eigen::Index i = 0; i < p; ++i) out.velocity[row * p + i] = pickups.row(i).dot(v);
    }
  }

  void clear(const Block& out, std::int64_t from, std::int64_t to) const noexcept {
    const Eigen::Index m = force.size(), p = pickups.rows();
    const auto rows = [&](double* values, std::int64_t columns) {
      if (values) std::fill(values + from * columns, values + to * columns, 0.0);
    };
    rows(out.velocity, p);
    rows(out.total_force, 1);
    rows(out.force, m);
    rows(out.displacement, m);
    rows(out.tangential_force, 3 * m);
  }

  std::uint64_t identity = next_identity();
  std::vector<SharedKernel> kernels;  ///< the model contains pointers to them
  contact::Model model;
  std::unique_ptr<contact::Stepper> stepper;
  contact::Vector force;             ///< (m) mean over the sample
  contact::Vector rubbing;           ///< (n − m) mean of the forces along the tangents over the sample
  contact::Matrix tangential_force;  ///< (m,3) of the last sample, world
  bool begins_sample = true;
  contact::Matrix pickups;  ///< (p,N)
  std::vector<ContactPoint> points;
};

struct Simulation::State::Impl {
  std::uint64_t identity;
  std::unique_ptr<contact::Stepper> stepper;
  contact::Vector force, rubbing;
};

Simulation::Simulation(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

StepStatus Simulation::step() noexcept {
  const FlushDenormals scope;
  StepStatus status = StepStatus::ok;
  do {
    status = impl_->stepper->step();
    if (status == StepStatus::ok) impl_->add_force();
  } while (status == StepStatus::ok && !impl_->stepper->at_sample());
  return status;
}

// The state is advanced a block at a time unless displacements are requested after each step.
BlockResult Simulation::step_block(std::int64_t steps, const Block& out) noexcept {
  const FlushDenormals scope;
  contact::Stepper& stepper = *impl_->stepper;
  const std::int64_t first = stepper.steps(), per_sample = impl_->per_sample();
  std::int64_t heard = 0;
  const auto made = [&] { return (stepper.steps() - first) / per_sample; };
  const auto hear = [&] {
    impl_->write_velocities(out, heard, stepper.steps() - first);
    heard = stepper.steps() - first;
  };
  stepper.keep(out.displacement != nullptr, out.velocity != nullptr);
  StepStatus status = contact::run_steps(stepper, steps * per_sample, [&](std::int64_t) {
                        impl_->add_force();
                        if (stepper.at_sample()) impl_->write_forces(out, made() - 1);
                        if (stepper.pending() == 0) hear();
                      }).status;
  if (stepper.catch_up() != StepStatus::ok) status = StepStatus::not_finite;
  hear();
  stepper.keep(true, false);
  if (status != StepStatus::ok) impl_->clear(out, made(), steps);
  return {made(), status};
}

std::int64_t Simulation::steps() const noexcept { return impl_->samples(); }
double Simulation::time() const noexcept { return impl_->stepper->time(); }

std::span<const ContactPoint> Simulation::points() const noexcept { return impl_->points; }
std::span<const double> Simulation::force() const noexcept { return span_of(impl_->force); }
std::span<const double> Simulation::displacement() const noexcept {
  return span_of(impl_->stepper->displacement()).first(static_cast<std::size_t>(impl_->force.size()));
}
std::span<const double> Simulation::tangential_force() const noexcept {
  return {impl_->tangential_force.data(), static_cast<std::size_t>(impl_->tangential_force.size())};
}
int Simulation::active() const noexcept { return impl_->stepper->active(); }

std::size_t Simulation::pickups() const noexcept { return static_cast<std::size_t>(impl_->pickups.rows()); }
double Simulation::pickup_velocity(std::size_t pickup) const noexcept {
  return impl_->pickups.row(pickup).dot(impl_->stepper->modal()->v);
}
double Simulation::pickup_displacement(std::size_t pickup) const noexcept {
  return impl_->pickups.row(pickup).dot(impl_->stepper->modal()->q);
}

Vector3 Simulation::mean_velocity(std::size_t body) const noexcept {
  const contact::Model::BodyBlock& block = impl_->model.bodies[body];
  Vector3 out{};
  for (Eigen::Index k = 0; k < 3; ++k)
    out[k] = block.momentum.row(k).dot(impl_->stepper->modal()->v.segment(block.first_mode, block.modes)) /
             block.mass;
  return out;
}

Energy Simulation::energy() const noexcept { return impl_->stepper->modal()->energy(); }

int Simulation::quasi_static_modes() const noexcept { return impl_->stepper->modal()->modes_in_residual(); }

Simulation::State Simulation::save() const {
  return State(std::make_unique<const State::Impl>(
      State::Impl{impl_->identity, impl_->stepper->clone(), impl_->force, impl_->rubbing}));
}

// Assigns to the stepper instead of replacing it, so that its arrays keep their memory and capacity.
bool Simulation::restore(const State& state) noexcept {
  if (!state.impl_ || state.impl_->identity != impl_->identity) return false;
  impl_->stepper->assign(*state.impl_->stepper);
  impl_->force = state.impl_->force;
  impl_->rubbing = state.impl_->rubbing;
  impl_->turn_to_world();
  impl_->begins_sample = true;
  return true;
}

Simulation::State::State(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Simulation::State::~State() = default;
Simulation::State::State(State&&) noexcept = default;
Simulation::State& Simulation::State::operator=(State&&) noexcept = default;

}  // namespace ricochet
