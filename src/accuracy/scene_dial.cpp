// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/scene_dial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "contact/accuracy/first_touch.hpp"
#include "kernels/band.hpp"
#include "kernels/read.hpp"
#include "src/accuracy/around_first_touch.hpp"
#include "src/scene/scene.hpp"
#include "src/store/surfaces.hpp"

namespace ricochet::accuracy {
namespace {

store::KernelPointers pointers(const std::vector<kernels::Kernel>& kernels) {
  store::KernelPointers out;
  for (const kernels::Kernel& kernel : kernels) out.push_back(&kernel);
  return out;
}

std::vector<kernels::Kernel> without_skins(const store::Kernels& kernels) {
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

/// Sets the rate of contact steps.
void set_rate(const scene::Contact& contact, Hertz rate, scene::Time& time) {
  (contact.has_contact_rate() ? time.contact_rate_hz.emplace() : time.rate_hz) = rate.value;
  if (time.samples_by_accuracy) time.rate_hz = std::min(time.rate_hz, rate.value);
  time.rate_by_accuracy = time.samples_by_accuracy = false;
}

}  // namespace

ClosedScene closed(scene::Scene scene, const std::filesystem::path& folder, store::KernelStore& store) {
  store::find_surfaces(scene, folder);
  if (!scene.accuracy) return {std::move(scene)};
  const std::filesystem::path path = settings_path(folder, scene, &store.meshes);
  auto settings = read_settings(path);
  if (!settings && scene.modes.open())
    throw InputError(fmt::format(
        "{}: no settings for accuracy = {:g} at {}. Run ricochet-kernel {} first, with the same --set and "
        "--out.",
        scene.file.string(), *scene.accuracy, path.string(), scene.file.string()));
  return {settings ? with_settings(std::move(scene), settings->found) : std::move(scene),
          std::move(settings)};
}

scene::Scene chosen(const scene::Scene& scene, const std::filesystem::path& folder,
                    store::KernelStore& store) {
  ClosedScene out = closed(scene, folder, store);
  if (out.settings && out.settings->rate.value > 0 && scene.time.rate_by_accuracy)
    set_rate(out.scene.contact, out.settings->rate, out.scene.time);
  return without_accuracy(std::move(out.scene));
}

scene::Scene closed_if_known(const scene::Scene& scene, const std::filesystem::path& folder) try {
  store::KernelStore store;
  return missing_settings(scene, folder, store) ? scene : closed(scene, folder, store).scene;
} catch (const InputError&) {
  return scene;
}

std::optional<std::filesystem::path> missing_settings(const scene::Scene& scene,
                                                      const std::filesystem::path& folder,
                                                      store::KernelStore& store) {
  if (!scene.accuracy) return std::nullopt;
  std::filesystem::path path = settings_path(folder, scene, &store.meshes);
  if (read_settings(path)) return std::nullopt;
  return path;
}

namespace {

/// A turn that ends the search with linear rotations at once. Runs with the long steps of its beginning may
/// exceed most_linear_turn where those of its end do not.
constexpr double clearly_turned = 2 * scene::most_linear_turn;

/// Of a scene with linear rotations. @param choose_points  whether to run it with fewer points
contact::Dialled dial_linear(const scene::Scene& scene, const store::Kernels& kernels,
                             const store::Prepared& prepared, contact::Model model, Hertz rate,
                             bool choose_points, std::function<void()> poll) {
  contact::Subject subject{
      .rebuild =
          [&](const std::vector<kernels::Kernel>& others) {
            return store::model_of(
                scene, {prepared.scene, store::with_kernels(prepared.placement, pointers(others))});
          },
      .kernels = without_skins(kernels),
      .low_rank = scene.modes.low_rank,
      .at_rest = scene.contact.scheme == Scheme::at_rest,
      .duration = scene.time.duration,
      .poll = std::move(poll)};
  if (scene.time.until_parted && !subject.at_rest)
    if (const auto parted = store::in_file(scene.file, [&] {
          return contact::find_parting(model, store::step_options(scene), subject.duration, subject.poll);
        }))
      subject.duration = *parted;
  if (scene.motion.rotation_open) subject.most_turn = clearly_turned;
  subject.requested = subject.at_rest ? std::vector{Quantity::force, Quantity::approach} : scene.accuracy_of;
  return store::in_file(scene.file, [&] {
    return contact::dial(subject, std::move(model),
                         {.accuracy = *scene.accuracy,
                          .options = store::step_options(scene),
                          .choose_rate = scene.time.rate_by_accuracy,
                          .choose_precision = scene.time.precision_by_accuracy,
                          .choose_points = choose_points,
                          .choose_samples = scene.time.samples_by_accuracy,
                          .rate = rate});
  });
}

}  // namespace

Dialled dial_of(const scene::Scene& scene, const store::Kernels& kernels, const store::Prepared& prepared,
                contact::Model model, Hertz rate, std::function<void()> poll) {
  if (!scene.motion.is_finite())
    return {dial_linear(scene, kernels, prepared, std::move(model), rate, leaves_points_open(scene),
                        std::move(poll))};
  const auto touch = store::in_file(scene.file, [&] {
    return contact::find_first_touch(model, store::step_options(scene), scene.time.duration, poll);
  });
  if (!touch) return {{.model = std::move(model)}};
  AroundFirstTouch part =
      store::in_file(scene.file, [&] { return around_first_touch(*touch, scene, kernels, model); });
  Dialled out{dial_linear(part.scene, part.kernels, part.prepared, std::move(part.model), rate, false, poll),
              part.kernels.kernel};
  if (!out.estimate) return out;
  out.estimate->until_s = touch->end;
  out.estimate->by_cause[contact::Cause::rotation] =
      store::in_file(scene.file, [&] { return share_of_rotation(part, *out.quantities, out.rate, poll); });
  return out;
}

scene::Scene resolved(scene::Scene scene, const contact::Dialled& dialled) {
  if (dialled.rate) set_rate(scene.contact, *dialled.rate, scene.time);
  if (dialled.precision) {
    scene.time.precision = *dialled.precision;
    scene.time.precision_by_accuracy = false;
  }
  return scene;
}

}  // namespace ricochet::accuracy
