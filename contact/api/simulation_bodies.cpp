// SPDX-License-Identifier: BSD-2-Clause
// Bodies that are added to a simulation and removed from it.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "contact/api/simulation_impl.hpp"
#include "contact/model/changed_model.hpp"

namespace ricochet {

using Eigen::Vector3d;

void Simulation::Impl::refuse_linear(const char* what) const {
  if (floating == nullptr)
    throw InputError(fmt::format(
        "{}: bodies are added and removed with finite rotations only. Set rotation = \"finite\".", what));
}

/// The bodies of the model that are there, ascending.
std::vector<int> Simulation::Impl::present(int but) const {
  std::vector<int> out;
  for (const Entry& entry : entries)
    if (entry.body != but) out.push_back(entry.body);
  std::ranges::sort(out);
  return out;
}

/// A body at its present place.
contact::PlacedBody Simulation::Impl::placed(int body) const {
  const auto at = static_cast<std::size_t>(body);
  const contact::Pose& pose = stepper->poses()[at];
  contact::PlacedBody out{.name = std::string(name_of(body)),
                          .kernel = kernels[at].get(),
                          .rotation = pose.attitude.toRotationMatrix()};
  out.translation = pose.position - out.rotation * model.bodies[at].own_centre();
  return out;
}

/// A place that a removed body with this kernel has left, with pairs with all bodies that are there and with
/// all obstacles, and with this friction; or −1.
int Simulation::Impl::find_place(const SharedKernel& kernel, const std::optional<Friction>& friction) const {
  for (int body = 0; body < static_cast<int>(kernels.size()); ++body) {
    if (kernels[static_cast<std::size_t>(body)] != kernel || floating->is_present(body)) continue;
    std::size_t suits = 0;
    for (const contact::Model::PairBlock& pair : model.pairs) {
      if (pair.a != body && pair.b != body) continue;
      const int other = pair.a == body ? pair.b : pair.a;
      if (other >= 0 && !floating->is_present(other)) continue;
      const bool rubs = pair.first_tangential >= 0;
      const auto first = static_cast<std::size_t>(rubs ? (pair.first_tangential - model.points()) / 2 : 0);
      suits += rubs == friction.has_value() && (!rubs || model.friction[first].law == *friction) ? 1 : 0;
    }
    if (suits == entries.size() + scene.obstacles.size()) return body;
  }
  return -1;
}

/// Puts a body at a place that another one has left. Bodies whose spheres are apart do not overlap.
void Simulation::Impl::take_place(int body, const contact::PlacedBody& added,
                                  const std::optional<Friction>& friction) {
  constexpr double beyond_candidates = 1.05;  // by which a curved surface may reach
  const contact::Bodies::Block& block = model.bodies[static_cast<std::size_t>(body)];
  contact::Pose pose{.position = added.translation + added.rotation * block.own_centre(),
                     .attitude = Eigen::Quaterniond(added.rotation),
                     .velocity = added.velocity,
                     .spin = added.angular_velocity};
  std::vector<contact::PlacedBody> near;
  for (const int k : present()) {
    const auto at = static_cast<std::size_t>(k);
    const double reach = beyond_candidates * (block.radius() + model.bodies[at].radius());
    if ((stepper->poses()[at].position - pose.position).norm() < reach) near.push_back(placed(k));
  }
  Scene around = scene;
  std::erase_if(around.obstacles, [&](const Obstacle& obstacle) {
    if (obstacle.shape != Shape::half_space) return false;
    const Vector3d normal = Eigen::Map<const Vector3d>(obstacle.normal.data()).normalized();
    return normal.dot(pose.position - Eigen::Map<const Vector3d>(obstacle.point.data())) >
           beyond_candidates * block.radius();
  });
  placement_with(around, std::move(near), added, friction);
  floating->put_in(body, added.name, pose);
}

/// The simulation with some of its bodies, and with others. Numbers and names remain to be set.
std::unique_ptr<Simulation::Impl> Simulation::Impl::changed(const std::vector<int>& kept,
                                                            const contact::Placement* added) const {
  contact::ChangedModel change = contact::change(model, kept, added);
  drive_obstacles(scene, change.model);
  const StepOptions options = step_options(scene);
  const auto next = contact::fold(std::make_shared<const contact::Model>(std::move(change.model)), options);
  std::vector<std::size_t> pairs;
  for (const int pair : change.from.pair)
    pairs.push_back(pair < 0 ? ContactPoint::no_pair : pair_number[static_cast<std::size_t>(pair)]);
  auto out = std::make_unique<Impl>(
      scene, next, std::make_unique<contact::FloatingStepper>(next, options, *floating, change.from),
      std::move(pairs));
  const auto now = [&](int body) {
    const auto found = std::ranges::find(change.from.body, body);
    return body < 0 || found == change.from.body.end() ? -1
                                                       : static_cast<int>(found - change.from.body.begin());
  };
  for (const int body : kept) {
    out->kernels.push_back(kernels[static_cast<std::size_t>(body)]);
    out->kernel_digests.push_back(kernel_digests[static_cast<std::size_t>(body)]);
  }
  for (const Entry& entry : entries)
    if (const int body = now(entry.body); body >= 0) {
      out->entries.push_back({entry.number, entry.name, body});
      out->body_numbers.push_back(entry.number);
    }
  out->next_number = next_number;
  out->pickups.setZero(pickups.rows(), next->omega.size());
  out->turning = turning;
  for (TurningPickup& pickup : out->turning) pickup.body = now(pickup.body);
  out->pickups_at_start = pickups_at_start;
  out->forces.take(forces, change.from.rows);
  out->on_contact = on_contact;
  out->user = user;
  out->touched = touched;
  if (watch) {
    std::vector<MaterialLimits> limits;
    for (const int body : kept) limits.push_back(watch->limits[static_cast<std::size_t>(body)]);
    out->begin_watch(std::move(limits), watch->slowest_wave);
    out->watch->earlier = warnings();
  }
  return out;
}

/// Takes what a body that is removed has left in the last sample.
void Simulation::Impl::silence(int body) noexcept {
  for (TurningPickup& pickup : turning)
    if (pickup.body == body) pickup.body = -1;
  for (const contact::Model::PairBlock& pair : model.pairs)
    if (pair.a == body || pair.b == body) forces.silence(pair);
}

std::size_t Simulation::add(const std::string& name, const SharedKernel& kernel, const BodyMotion& motion,
                            const std::optional<Friction>& friction) {
  impl_->refuse_linear("add");
  if (name.empty()) throw InputError("bodies: one has no name. Name each.");
  if (find(name) || std::ranges::count(impl_->scene.obstacles, name, &Obstacle::name) > 0)
    throw InputError(
        fmt::format("bodies.{}: the name is taken. Bodies and obstacles need names of their own.", name));
  if (std::ranges::count(impl_->kernels, kernel) == 0 && kernel)
    kernels::validate(*kernel, "bodies." + name + ".kernel");
  for (const contact::Model::PairBlock& pair : impl_->model.pairs)
    if (pair.driven && pair.driven->moves(0, time()))
      throw InputError(
          fmt::format("add: obstacles.{} has moved, and whether a body overlaps it is known at its first "
                      "place alone. Add bodies before it moves.",
                      pair.obstacle));
  const contact::PlacedBody added = placed_body(name, kernel, motion);
  const auto rubs = friction_of(impl_->scene, friction, "bodies." + name);
  if (rubs && is_rod(kernel->surface)) throw InputError(friction_on_rod(name));
  int body = impl_->find_place(kernel, rubs);
  base::Digest system;
  system.add(impl_->system);
  system.add(body);
  system.add(name);
  if (body >= 0) {
    impl_->take_place(body, added, rubs);
  } else {
    const base::Digest::Value of_kernel = impl_->digest_of_kernel(kernel);
    system.add(of_kernel);
    for (const Vector3& vector : {motion.position, motion.velocity, motion.spin})
      system.add(vector.data(), sizeof vector);
    system.add(motion.attitude.data(), sizeof motion.attitude);
    if (rubs)
      for (const double x : {rubs->static_coefficient, rubs->dynamic_coefficient, rubs->stribeck_velocity})
        system.add(x);

    const std::vector<int> kept = impl_->present();
    std::vector<contact::PlacedBody> there;
    for (const int k : kept) there.push_back(impl_->placed(k));
    const contact::Placement placement = placement_with(impl_->scene, std::move(there), added, rubs);
    body = static_cast<int>(kept.size());
    impl_ = impl_->changed(kept, &placement);
    impl_->kernels.push_back(kernel);
    impl_->kernel_digests.push_back(of_kernel);
  }
  impl_->system = system.value();
  const std::size_t number = impl_->next_number++;
  impl_->entries.push_back({number, name, body});
  impl_->body_numbers.push_back(number);
  if (impl_->watch) {
    std::vector<std::string> earlier = impl_->warnings();
    impl_->begin_watch(impl_->watch->limits, impl_->watch->slowest_wave);
    impl_->watch->earlier = std::move(earlier);
  }
  return number;
}

// A free body without loads leaves its place to the next one.
void Simulation::remove(std::size_t number) {
  impl_->refuse_linear("remove");
  const int body = impl_->body_of(number);
  if (body < 0)
    throw InputError(
        fmt::format("remove: there is no body {}. bodies() lists those that are there.", number));
  base::Digest system;
  system.add(impl_->system);
  system.add(number);
  const bool stays = !impl_->model.bodies[static_cast<std::size_t>(body)].supported &&
                     std::ranges::count(impl_->model.forcing, body, &contact::Model::Forcing::body) == 0;
  if (stays) {
    impl_->floating->take_out(body);
    impl_->silence(body);
    std::erase(impl_->body_numbers, number);
    std::erase_if(impl_->entries, [&](const Impl::Entry& entry) { return entry.number == number; });
  } else {
    impl_ = impl_->changed(impl_->present(body), nullptr);
  }
  impl_->system = system.value();
}

std::span<const std::size_t> Simulation::bodies() const noexcept { return impl_->body_numbers; }

std::optional<std::size_t> Simulation::find(std::string_view name) const noexcept {
  const auto found = std::ranges::find(impl_->entries, name, &Impl::Entry::name);
  return found == impl_->entries.end() ? std::nullopt : std::optional(found->number);
}

std::string_view Simulation::name(std::size_t body) const noexcept {
  return impl_->name_of(impl_->body_of(body));
}

}  // namespace ricochet
