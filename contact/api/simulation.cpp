// SPDX-License-Identifier: BSD-2-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "base/archive.hpp"
#include "contact/api/simulation_impl.hpp"
#include "contact/files/surface_file.hpp"
#include "kernels/read.hpp"
#include "kernels/write.hpp"
#include "ricochet/ricochet.h"

namespace ricochet {
namespace {

std::span<const double> span_of(const contact::Vector& v) noexcept {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

/// What is known of a body that is not there.
constexpr Vector3 missing{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::quiet_NaN()};

/// What precedes the arrays of a state, and the digest that follows them.
struct StateHeader {
  std::array<char, 8> format{'r', 'i', 'c', 'o', 's', 't', 'a', 't'};
  std::int64_t version = RICOCHET_VERSION_NUMBER;
  base::Digest::Value system{};
};

base::Digest::Value digest_of(std::span<const std::byte> bytes) {
  base::Digest digest;
  digest.add(bytes.data(), bytes.size());
  return digest.value();
}

}  // namespace

SharedKernel load_kernel(const std::filesystem::path& path) {
  return std::make_shared<const kernels::Kernel>(kernels::read(path));
}

SurfaceMesh load_surface(const std::filesystem::path& path, double scale) {
  return contact::read_surface(path, scale);
}

void save_kernel(const kernels::Kernel& kernel, const std::filesystem::path& path) {
  kernels::write(kernel, path);
}

struct Simulation::State::Impl {
  base::Digest::Value system;
  std::shared_ptr<const contact::Model> model;  ///< to whose data the stepper refers
  std::unique_ptr<contact::Stepper> stepper;
  SampleForces::Means forces;

  void archive(base::Archive& a) const {
    Impl& own = const_cast<Impl&>(*this);  // a writer changes nothing
    a(own.forces);
    stepper->archive(a);
  }
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
std::span<const double> Simulation::force() const noexcept { return span_of(impl_->forces.normal()); }
std::span<const double> Simulation::displacement() const noexcept {
  return span_of(impl_->stepper->displacement())
      .first(static_cast<std::size_t>(impl_->forces.normal().size()));
}
std::span<const double> Simulation::tangential_force() const noexcept {
  const contact::Matrix& tangential = impl_->forces.tangential();
  return {tangential.data(), static_cast<std::size_t>(tangential.size())};
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

bool Simulation::push_at(std::size_t number, const BodyPoint& point, const Vector3& force) noexcept {
  const int body = impl_->body_of(number);
  if (body < 0) return false;
  const auto& receivers = impl_->kernels[static_cast<std::size_t>(body)]->receivers;
  contact::BodyPlace place{.is_receiver = !point.receiver.empty()};
  if (place.is_receiver)
    place.number = static_cast<int>(std::ranges::find(receivers, point.receiver, &kernels::Receiver::name) -
                                    receivers.begin());
  else
    place.number = static_cast<int>(std::min<std::size_t>(point.candidate, std::numeric_limits<int>::max()));
  return impl_->stepper->push_at(body, place, {force[0], force[1], force[2]});
}

void Simulation::watch(std::span<const MaterialLimits> limits, double slowest_wave) {
  impl_->begin_watch({limits.begin(), limits.end()}, slowest_wave);
}

std::vector<std::string> Simulation::warnings() const { return impl_->warnings(); }

Energy Simulation::energy() const noexcept { return impl_->stepper->modal()->energy(); }

int Simulation::quasi_static_modes() const noexcept { return impl_->stepper->modal()->modes_in_residual(); }

Simulation::State Simulation::save() const {
  return State(std::make_unique<const State::Impl>(
      State::Impl{impl_->system, impl_->shared, impl_->stepper->clone(), impl_->forces.means()}));
}

// Assigns to the stepper instead of replacing it, so that its arrays keep their memory and capacity. The
// stepper of another simulation refers to kernels of that one, so that its state is taken as bytes.
bool Simulation::restore(const State& state) noexcept {
  if (!state.impl_ || state.impl_->system != impl_->system) return false;
  if (state.impl_->model != impl_->shared) {
    try {
      return restore(this->state(state.bytes()));
    } catch (...) {  // without memory
      return false;
    }
  }
  impl_->stepper->assign(*state.impl_->stepper);
  impl_->forces.set(state.impl_->forces);
  impl_->touched = !impl_->find_touching().empty();
  return true;
}

Simulation::State Simulation::state(std::span<const std::byte> bytes) const {
  StateHeader header;
  base::Digest::Value digest{};
  constexpr std::size_t fewest = sizeof header + sizeof digest;
  if (bytes.size() < fewest || std::memcmp(bytes.data(), header.format.data(), sizeof header.format) != 0)
    throw InputError("state: is not a saved state. Give the bytes of one.");
  std::memcpy(&header, bytes.data(), sizeof header);
  std::memcpy(&digest, bytes.last(sizeof digest).data(), sizeof digest);
  if (digest != digest_of(bytes.first(bytes.size() - sizeof digest)))
    throw InputError("state: its bytes are damaged. Save it again.");
  if (header.version != RICOCHET_VERSION_NUMBER)
    throw InputError(
        fmt::format("state: version {} of the library saved it, and this is version {}. Save it again.",
                    header.version, RICOCHET_VERSION_NUMBER));
  if (header.system != impl_->system)
    throw InputError(
        "state: is of another system: its kernels, its scene, or the bodies that were added or removed "
        "differ. "
        "Restore it in a simulation of the same.");
  auto out = std::make_unique<State::Impl>(
      State::Impl{impl_->system, impl_->shared, impl_->stepper->clone(), impl_->forces.means()});
  base::Archive archive(bytes.subspan(sizeof header, bytes.size() - fewest));
  out->archive(archive);
  if (!archive.complete())
    throw InputError(
        "state: its arrays do not fit this simulation, because another build saved it. Save it again.");
  return State(std::move(out));
}

std::vector<std::byte> Simulation::State::bytes() const {
  std::vector<std::byte> out(sizeof(StateHeader));
  const StateHeader header{.system = impl_->system};
  std::memcpy(out.data(), &header, sizeof header);
  base::Archive archive(out);
  impl_->archive(archive);
  const base::Digest::Value digest = digest_of(out);
  const auto* const at = reinterpret_cast<const std::byte*>(&digest);
  out.insert(out.end(), at, at + sizeof digest);
  return out;
}

Simulation::State::State(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Simulation::State::~State() = default;
Simulation::State::State(State&&) noexcept = default;
Simulation::State& Simulation::State::operator=(State&&) noexcept = default;

}  // namespace ricochet
