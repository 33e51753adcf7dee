// SPDX-License-Identifier: BSD-2-Clause
#include "contact/api/simulation_impl.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "contact/api/system_digest.hpp"

namespace ricochet {
namespace {

using Eigen::Vector3d;

/// @param number  by pair
std::vector<ContactPoint> points_of(const contact::Model& model, const std::vector<std::size_t>& number) {
  std::vector<ContactPoint> out;
  for (std::size_t k = 0; k < model.pairs.size(); ++k)
    for (int i = 0; i < model.pairs[k].points; ++i) {
      const Eigen::Index row = model.pairs[k].first_point + i;
      out.push_back({number[k], array(model.point_a.row(row)), array(model.point_b.row(row)),
                     array(model.normal.row(row)), model.gap(row), model.area(row)});
    }
  return out;
}

std::vector<std::size_t> numbers(std::size_t count) {
  std::vector<std::size_t> out(count);
  std::iota(out.begin(), out.end(), 0);
  return out;
}

}  // namespace

Simulation::Impl::Impl(const Scene& scene)
    : Impl(scene, contact::fold(std::make_shared<const contact::Model>(model_of(scene)), step_options(scene)),
           nullptr, numbers(scene.pairs.size())) {
  pickups = pickups_of(scene, model);
  turning = turning_pickups_of(scene, model);
  for (const Body& body : scene.bodies) {
    entries.push_back({entries.size(), body.name, static_cast<int>(entries.size())});
    kernel_digests.push_back(digest_of_kernel(body.kernel));
    kernels.push_back(body.kernel);
  }
  system = digest_of(scene, kernel_digests);
  body_numbers = numbers(entries.size());
  next_number = entries.size();
  for (const TurningPickup& pickup : turning) pickups_at_start.push_back(place_of(pickup));
}

Simulation::Impl::Impl(const Scene& of, std::shared_ptr<const contact::Model> of_bodies,
                       std::unique_ptr<contact::Stepper> by, std::vector<std::size_t> pairs)
    : scene(of),
      shared(std::move(of_bodies)),
      stepper(by ? std::move(by) : contact::make_stepper(shared, step_options(scene))),
      floating(scene.rotation == Rotation::finite ? static_cast<contact::FloatingStepper*>(stepper.get())
                                                  : nullptr),
      forces(model, *stepper, floating),
      rigid(model),
      pair_number(std::move(pairs)),
      points(points_of(model, pair_number)) {
  scene.bodies.clear();
  scene.pairs.clear();
  scene.forcing.clear();
  touching.reserve(points.size());
}

base::Digest::Value Simulation::Impl::digest_of_kernel(const SharedKernel& kernel) const {
  const auto found = std::ranges::find(kernels, kernel);
  return found == kernels.end() ? digest_of(*kernel)
                                : kernel_digests[static_cast<std::size_t>(found - kernels.begin())];
}

bool Simulation::Impl::made_step() {
  if (watch) watch->observer.observe(*stepper);
  forces.add();
  if (!stepper->at_sample() || on_contact == nullptr) return true;
  const std::span<const Touching> now = find_touching();
  const bool called = !now.empty() || touched;
  touched = !now.empty();
  return !called || on_contact(user, now);
}

std::vector<std::string> Simulation::Impl::warnings() const {
  if (!watch) return {};
  std::vector<std::string> out = watch->earlier;
  for (std::string& warning : watch->observer.warnings())
    if (std::ranges::count(out, warning) == 0) out.push_back(std::move(warning));
  return out;
}

void Simulation::Impl::begin_watch(std::vector<MaterialLimits> limits, double slowest_wave) {
  limits.resize(model.bodies.size());
  const double step = stepper->options().step;
  // A body that has taken the place of another one has a name that the model does not know.
  auto named = std::make_shared<contact::Model>(model);
  for (const Entry& entry : entries) named->bodies[static_cast<std::size_t>(entry.body)].name = entry.name;
  contact::SummaryObserver observer(*named, step, slowest_wave, limits);
  observer.begin(*stepper);
  watch.emplace(std::move(limits), slowest_wave, std::move(named), std::move(observer));
}

std::span<const Touching> Simulation::Impl::find_touching() noexcept {
  touching.clear();
  forces.for_each_point([&](Eigen::Index i) { add_touching(i); });
  std::ranges::sort(touching, {}, &Touching::point);
  return touching;
}

void Simulation::Impl::add_touching(Eigen::Index i) noexcept {
  const double normal = forces.normal()(i);
  if (!(normal > 0)) return;
  const contact::RowFrames& frames = contact::frames_of(model, *stepper);
  const Vector3d pushed = normal * frames.normal.row(i) + forces.tangential().row(i);
  const contact::Model::PairBlock& pair = *std::prev(std::ranges::upper_bound(
      model.pairs, i, {},
      [](const contact::Model::PairBlock& one) -> Eigen::Index { return one.first_point; }));
  touching.push_back({static_cast<std::size_t>(i),
                      {name_of(pair.a), pair.b < 0 ? std::string_view(pair.obstacle) : name_of(pair.b)},
                      array(frames.point_a.row(i)),
                      array(frames.normal.row(i)),
                      array(pushed)});
}

std::string_view Simulation::Impl::name_of(int body) const noexcept {
  const auto found = std::ranges::find(entries, body, &Entry::body);
  return found == entries.end() ? std::string_view() : std::string_view(found->name);
}

int Simulation::Impl::body_of(std::size_t number) const noexcept {
  const auto found = std::ranges::lower_bound(entries, number, {}, &Entry::number);
  return found == entries.end() || found->number != number ? -1 : found->body;
}

void Simulation::Impl::write_forces(const Block& out, std::int64_t k) const noexcept {
  const Eigen::Index m = forces.normal().size();
  if (out.total_force) out.total_force[k] = forces.total();
  if (out.force) std::copy_n(forces.normal().data(), m, out.force + k * m);
  if (out.displacement) std::copy_n(stepper->displacement().data(), m, out.displacement + k * m);
  if (out.tangential_force) std::copy_n(forces.tangential().data(), 3 * m, out.tangential_force + 3 * k * m);
}

double Simulation::Impl::velocity_of_supports(Eigen::Index pickup) const noexcept {
  const contact::ModalState& state = *stepper->modal();
  return state.forcing.any() ? pickups.row(pickup).dot(state.now.lift) : 0;
}

double Simulation::Impl::displacement_of_supports(Eigen::Index pickup) const noexcept {
  double sum = 0;
  for (const contact::Model::Forcing& one : model.forcing)
    if (one.support)
      sum += one.history.at(stepper->time()) *
             pickups.row(pickup).segment(one.first_mode, one.lift.size()).dot(one.lift);
  return sum;
}

Eigen::Vector3d Simulation::Impl::elastic(const TurningPickup& pickup, const contact::Vector& modal,
                                          double (contact::History::*driven)(double)
                                              const noexcept) const noexcept {
  const contact::Bodies::Block& body = model.bodies[static_cast<std::size_t>(pickup.body)];
  const Eigen::Index count = body.modes - body.frame_modes();
  Eigen::Vector3d out =
      pickup.shape.rightCols(count) * modal.segment(body.first_mode + body.frame_modes(), count);
  for (const contact::Model::Forcing& one : model.forcing)
    if (one.support && one.first_mode == body.first_mode)
      out += (one.history.*driven)(stepper->time()) * (pickup.shape * one.lift);
  return out;
}

Eigen::Vector3d Simulation::Impl::arm(const TurningPickup& pickup) const noexcept {
  return pickup.place + elastic(pickup, stepper->modal()->q, &contact::History::at);
}

double Simulation::Impl::place_of(const TurningPickup& pickup) const noexcept {
  return pickup.direction.dot(stepper->poses()[static_cast<std::size_t>(pickup.body)].at(arm(pickup)));
}

double Simulation::Impl::rate_of(const TurningPickup& pickup) const noexcept {
  return pickup.direction.dot(stepper->poses()[static_cast<std::size_t>(pickup.body)].velocity_at(
      arm(pickup), elastic(pickup, stepper->turning()->rates, &contact::History::slope)));
}

double Simulation::Impl::velocity(std::size_t pickup, const double* v) const noexcept {
  if (!turning.empty()) return turning[pickup].body < 0 ? 0 : rate_of(turning[pickup]);
  const auto row = static_cast<Eigen::Index>(pickup);
  return pickups.row(row).dot(Eigen::Map<const contact::Vector>(v, pickups.cols())) +
         velocity_of_supports(row);
}

void Simulation::Impl::write_velocities(const Block& out, std::int64_t from, std::int64_t to) const noexcept {
  if (!out.velocity) return;
  const Eigen::Index p = pickups.rows();
  for (std::int64_t row = from / per_sample(); (row + 1) * per_sample() <= to; ++row) {
    const auto back = static_cast<int>(to - (row + 1) * per_sample());
    for (Eigen::Index i = 0; i < p; ++i)
      out.velocity[row * p + i] = velocity(static_cast<std::size_t>(i), stepper->rate(back));
  }
}

void Simulation::Impl::clear(const Block& out, std::int64_t from, std::int64_t to) const noexcept {
  const Eigen::Index m = forces.normal().size(), p = pickups.rows();
  const auto rows = [&](double* values, std::int64_t columns) {
    if (values) std::fill(values + from * columns, values + to * columns, 0.0);
  };
  rows(out.velocity, p);
  rows(out.total_force, 1);
  rows(out.force, m);
  rows(out.displacement, m);
  rows(out.tangential_force, 3 * m);
}

}  // namespace ricochet
