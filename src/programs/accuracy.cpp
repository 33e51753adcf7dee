// SPDX-License-Identifier: BSD-2-Clause
#include "src/programs/accuracy.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "kernels/read.hpp"
#include "src/scene/request.hpp"

namespace ricochet::programs {
namespace {

KernelPointers pointers(const std::vector<kernels::Kernel>& kernels) {
  KernelPointers out;
  for (const kernels::Kernel& kernel : kernels) out.push_back(&kernel);
  return out;
}

/// Kernels of another element order for all bodies; empty if any of them is missing.
std::vector<kernels::Kernel> of_other_order(const scene::Scene& scene, const std::filesystem::path& folder) {
  std::vector<kernels::Kernel> out;
  for (const scene::Body& body : scene.bodies) {
    const auto request = scene::other_order(scene::kernel_request(scene, body));
    if (!request) return {};
    const std::filesystem::path path = scene::kernel_path(folder, *request);
    if (kernels::read_hash(path) != request->hash) return {};
    out.push_back(kernels::read(path, false));
  }
  return out;
}

/// Highest frequency that the kernels represent: the end of the band of a contact-adapted basis, or the last
/// mode.
Hertz band(const Kernels& kernels) {
  Hertz highest{0};
  for (const auto& kernel : kernels.kernel) {
    const kernels::Modes& modes = kernel->modes;
    const Hertz end = modes.contact_adapted() ? Hertz{modes.certificate.upto_hz}
                      : modes.angular_frequency.empty()
                          ? Hertz{0}
                          : to_hertz(RadPerSecond{modes.angular_frequency.back()});
    highest.value = std::max(highest.value, end.value);
  }
  return highest;
}

std::vector<kernels::Kernel> without_skins(const Kernels& kernels) {
  std::vector<kernels::Kernel> out;
  for (const auto& kernel : kernels.kernel) {
    out.push_back(*kernel);
    out.back().view.reset();
  }
  return out;
}

bool leaves_points_open(const scene::Scene& scene) {
  return scene.contact.scheme != Scheme::at_rest &&
         std::ranges::none_of(scene.contact.pairs,
                              [](const scene::Pair& pair) { return pair.spacing.has_value(); });
}

}  // namespace

StepOptions step_options(const scene::Scene& scene) {
  return {.scheme = scene.contact.scheme,
          .admittance = scene.contact.admittance,
          .instant = scene.contact.instant,
          .restitution = scene.contact.restitution,
          .step = 1 / scene.time.rate.value,
          .max_pivots = scene.contact.max_pivots.value_or(std::numeric_limits<int>::max()),
          .precision = scene.time.precision.value_or(Precision::float64)};
}

contact::Dialled dial_of(const scene::Scene& scene, const Kernels& kernels,
                         const contact::Placement& placement,
                         const std::vector<contact::ForcingRequest>& forcing, contact::Model model,
                         const std::filesystem::path& folder, std::function<void()> poll) {
  contact::Subject subject{.rebuild =
                               [&](const std::vector<kernels::Kernel>& others) {
                                 return model_of(scene, with_kernels(placement, pointers(others)), forcing);
                               },
                           .kernels = without_skins(kernels),
                           .low_rank = scene.modes.low_rank,
                           .at_rest = scene.contact.scheme == Scheme::at_rest,
                           .duration = scene.time.duration,
                           .poll = std::move(poll)};
  const std::vector<kernels::Kernel> other_order = of_other_order(scene, folder);
  if (!other_order.empty())
    subject.other_order = [&] {
      const KernelPointers others = pointers(other_order);
      return model_of(scene, place(scene, others), forcing);
    };
  subject.left_of_other = 0;
  for (const scene::Body& body : scene.bodies)
    subject.left_of_other = std::max(subject.left_of_other, contact::left_by_order(body.order));
  return in_scene(scene, [&] {
    return contact::dial(subject, std::move(model),
                         {.accuracy = *scene.accuracy,
                          .options = step_options(scene),
                          .choose_rate = scene.time.rate_by_accuracy,
                          .choose_precision = !scene.time.precision,
                          .choose_points = leaves_points_open(scene),
                          .band = band(kernels)});
  });
}

scene::Scene resolved(scene::Scene scene, const contact::Settings& settings) {
  if (settings.rate) {
    scene.time.rate = *settings.rate;
    scene.time.rate_by_accuracy = false;
  }
  if (settings.precision) scene.time.precision = settings.precision;
  return scene;
}

}  // namespace ricochet::programs
