// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/around_first_touch.hpp"

#include <algorithm>
#include <utility>

#include "base/rotation.hpp"
#include "contact/accuracy/estimate.hpp"
#include "contact/api/scene_model.hpp"
#include "contact/pairing/placement.hpp"
#include "contact/stepping/run_steps.hpp"
#include "kernels/algebra.hpp"
#include "src/accuracy/contact_zone.hpp"
#include "src/store/placing.hpp"

namespace ricochet::accuracy {
namespace {

bool needs_receivers(const scene::Scene& scene) {
  return std::ranges::count(scene.accuracy_of, Quantity::receivers) > 0;
}

bool has_loads(const scene::Loads& loads) {
  return !loads.tractions.empty() || !loads.points.empty() || !loads.motions.empty();
}

/// Leaves out the loads of bodies that a scene does not have.
void keep_loads_of_bodies(scene::Scene& scene) {
  for (std::vector<scene::Forcing>* all : {&scene.loads.tractions, &scene.loads.points, &scene.loads.motions})
    std::erase_if(*all, [&](const scene::Forcing& one) {
      return one.obstacle.empty() && std::ranges::count(scene.bodies, one.body, &scene::Body::name) == 0;
    });
}

/// Places a body as it is in a pose. @param block  the same body at the start
void place(scene::Body& body, const contact::Bodies::Block& block, const contact::Pose& pose) {
  const auto components = [](const Eigen::Vector3d& v) { return Vector3{v.x(), v.y(), v.z()}; };
  std::array<double, 9> rotation{};
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data()) =
      pose.attitude.toRotationMatrix();
  body.rotate_deg = degrees_of(rotation);
  body.translate = components(pose.at(-block.own_centre()));
  body.velocity = components(pose.velocity);
  body.angular_velocity = components(pose.spin);
}

contact::Model model_around(const scene::Scene& scene, const store::Kernels& kernels,
                            store::Prepared& prepared) {
  prepared.scene = store::library_scene(scene, kernels.pointers());
  store::read_histories(scene, prepared.scene);
  prepared.placement = placement_of(prepared.scene);
  return store::model_of(scene, prepared);
}

/// Kernels with the candidates that a placement pairs. The runs of an estimate then cost a fraction.
store::Kernels paired_alone(const store::Kernels& kernels, const contact::Placement& placement) {
  const auto paired = contact::paired_candidates(placement);
  store::Kernels out;
  for (std::size_t k = 0; k < kernels.kernel.size(); ++k) {
    kernels::Kernel kernel = *kernels.kernel[k];
    kernel.view.reset();
    kernel.receivers.clear();
    kernel.gauges.clear();
    kernels::WholeSurface whole = kernels::whole_surface(kernel.surface);
    kernel = kernels::restricted_to_points(std::move(kernel), paired[k]);
    whole.held = paired[k];
    kernel.surface.whole = std::move(whole);
    out.kernel.push_back(std::make_shared<const kernels::Kernel>(std::move(kernel)));
  }
  return out;
}

}  // namespace

AroundFirstTouch around_first_touch(const contact::FirstTouch& touch, const scene::Scene& whole,
                                    const store::Kernels& kernels, const contact::Model& model) {
  AroundFirstTouch out;
  out.turned = touch.turned;
  scene::Scene& scene = out.scene = whole;
  scene.motion = {};  // linear rotations
  scene.time.duration = touch.until - touch.from;
  scene.time.until_parted = false;
  scene.bodies.clear();
  scene.contact.pairs.clear();
  std::vector<double> farthest;  // way of a point of a body until the touch ends, if none slowed it down
  const double time = touch.end - touch.from;
  for (std::size_t k = 0; k < whole.bodies.size(); ++k) {
    const contact::Bodies::Block& block = model.bodies[k];
    const contact::Pose& pose = touch.poses[k];
    farthest.push_back(
        time * (pose.velocity.norm() + block.radius() * pose.spin.norm() + time * model.gravity.norm()));
    const auto takes_part = [&](std::size_t p) {
      return std::cmp_equal(model.pairs[p].a, k) || std::cmp_equal(model.pairs[p].b, k);
    };
    if (std::ranges::none_of(touch.pairs, takes_part)) continue;
    out.all.kernel.push_back(kernels.kernel[k]);
    place(scene.bodies.emplace_back(whole.bodies[k]), block, pose);
  }
  for (const std::size_t p : touch.pairs) {
    const contact::Model::PairBlock& block = model.pairs[p];
    scene::Pair& pair = scene.contact.pairs.emplace_back(whole.contact.pairs[p]);
    pair.direction.reset();
    pair.gap.reset();
    if (has_loads(whole.loads)) continue;  // which move bodies farther
    pair.zone = farthest[static_cast<std::size_t>(block.a)];
    if (block.b >= 0) *pair.zone += farthest[static_cast<std::size_t>(block.b)];
    *pair.zone *= after_impact;
  }
  keep_loads_of_bodies(scene);
  out.kernels.kernel = out.all.kernel;
  out.model = model_around(scene, out.kernels, out.prepared);
  if (needs_receivers(scene) || has_loads(whole.loads)) return out;
  out.kernels = paired_alone(out.all, out.prepared.placement);
  out.model = model_around(scene, out.kernels, out.prepared);
  return out;
}

std::optional<contact::Errors> share_of_rotation(const AroundFirstTouch& touch,
                                                 const contact::Quantities& linear, std::optional<Hertz> rate,
                                                 const std::function<void()>& poll) {
  scene::Scene scene = touch.scene;
  scene.motion.rotation = Rotation::finite;
  for (scene::Pair& pair : scene.contact.pairs) pair.zone.reset();
  store::Prepared prepared;
  const contact::Model model = model_around(scene, touch.all, prepared);
  StepOptions options = store::step_options(scene);
  if (rate) options = contact::with_step(options, 1 / rate->value);
  const auto found =
      contact::impact_quantities(model, options, contact::step_count(scene.time.duration, 1 / options.step),
                                 needs_receivers(scene), poll);
  if (!found) return std::nullopt;
  contact::Errors out = contact::distances(linear, *found);
  for (auto& [quantity, error] : out) error = std::max(0.0, error - touch.turned);
  return out;
}

}  // namespace ricochet::accuracy
