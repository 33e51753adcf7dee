// SPDX-License-Identifier: BSD-2-Clause
#include <algorithm>
#include <limits>
#include <utility>

#include "contact/api/simulation_impl.hpp"
#include "kernels/read.hpp"
#include "kernels/write.hpp"

namespace ricochet {
namespace {

std::span<const double> span_of(const contact::Vector& v) noexcept {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

/// What is known of a body that is not there.
constexpr Vector3 missing{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::quiet_NaN()};

}  // namespace

SharedKernel load_kernel(const std::filesystem::path& path) {
  return std::make_shared<const kernels::Kernel>(kernels::read(path));
}

void save_kernel(const kernels::Kernel& kernel, const std::filesystem::path& path) {
  kernels::write(kernel, path);
}

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
    if (status == StepStatus::ok) impl_->made_step();
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
  stepper.keep(out.displacement != nullptr || impl_->watch, out.velocity != nullptr);
  StepStatus status = StepStatus::ok;
  for (bool goes_on = true; goes_on && made() < steps;) {
    if ((status = stepper.step()) != StepStatus::ok) break;
    goes_on = impl_->made_step();
    if (stepper.at_sample()) impl_->write_forces(out, made() - 1);
    if (stepper.pending() == 0) hear();
  }
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
std::span<const Touching> Simulation::contacts() noexcept { return impl_->find_touching(); }
int Simulation::active() const noexcept { return impl_->stepper->active(); }

std::size_t Simulation::pickups() const noexcept { return static_cast<std::size_t>(impl_->pickups.rows()); }
double Simulation::pickup_velocity(std::size_t pickup) const noexcept {
  return impl_->velocity(pickup, impl_->stepper->modal()->v.data());
}
double Simulation::pickup_displacement(std::size_t pickup) const noexcept {
  if (!impl_->turning.empty())
    return impl_->turning[pickup].body < 0
               ? 0
               : impl_->place_of(impl_->turning[pickup]) - impl_->pickups_at_start[pickup];
  const auto row = static_cast<Eigen::Index>(pickup);
  return impl_->pickups.row(row).dot(impl_->stepper->modal()->q) + impl_->displacement_of_supports(row);
}

void Simulation::on_contact(OnContact callback, void* user) noexcept {
  impl_->on_contact = callback;
  impl_->user = user;
  impl_->touched = !impl_->find_touching().empty();
}

Vector3 Simulation::mean_velocity(std::size_t number) const noexcept {
  const int body = impl_->body_of(number);
  if (body < 0) return missing;
  const Eigen::Vector3d mean = impl_->model.momentum(body, impl_->stepper->modal()->v, time()) /
                               impl_->model.bodies[static_cast<std::size_t>(body)].mass;
  return array(mean);
}

BodyMotion Simulation::body_motion(std::size_t number) const noexcept {
  const int body = impl_->body_of(number);
  if (body < 0) return {missing, {missing[0], missing[0], missing[0], missing[0]}, missing, missing};
  const contact::Pose pose = impl_->rigid.pose(body, *impl_->stepper);
  const Eigen::Quaterniond& q = pose.attitude;
  return {array(pose.position), {q.w(), q.x(), q.y(), q.z()}, array(pose.velocity), array(pose.spin)};
}

std::size_t Simulation::modes(std::size_t number) const noexcept {
  const int body = impl_->body_of(number);
  return body < 0 ? 0 : static_cast<std::size_t>(impl_->model.bodies[static_cast<std::size_t>(body)].modes);
}

void Simulation::modal_coordinates(std::size_t number, double* displacement,
                                   double* velocity) const noexcept {
  const int body = impl_->body_of(number);
  if (body < 0) return;
  const contact::Bodies::Block& block = impl_->model.bodies[static_cast<std::size_t>(body)];
  const auto copy = [&](const contact::Vector& of_all, double* out) {
    if (out == nullptr) return;
    std::copy_n(of_all.data() + block.first_mode, block.modes, out);
    if (impl_->floating != nullptr) std::fill_n(out, block.frame_modes(), 0.0);
  };
  copy(impl_->stepper->modal()->q, displacement);
  copy(impl_->stepper->modal()->v, velocity);
}

bool Simulation::push(std::size_t number, const Vector3& force, const Vector3& torque) noexcept {
  const int body = impl_->body_of(number);
  return body >= 0 &&
         impl_->stepper->push(body, {force[0], force[1], force[2]}, {torque[0], torque[1], torque[2]});
}

void Simulation::watch(std::span<const MaterialLimits> limits, double slowest_wave) {
  impl_->begin_watch({limits.begin(), limits.end()}, slowest_wave);
}

std::vector<std::string> Simulation::warnings() const { return impl_->warnings(); }

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
  impl_->list_forced();
  impl_->tangential_force.setZero();
  impl_->turn_to_world();
  impl_->begins_sample = true;
  impl_->touched = !impl_->find_touching().empty();
  return true;
}

Simulation::State::State(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Simulation::State::~State() = default;
Simulation::State::State(State&&) noexcept = default;
Simulation::State& Simulation::State::operator=(State&&) noexcept = default;

}  // namespace ricochet
