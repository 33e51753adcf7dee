#include "src/programs/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "contact/accuracy/estimate.hpp"
#include "contact/model/coarsening.hpp"
#include "kernels/read.hpp"

namespace ricochet::programs {
namespace {

using contact::ErrorEstimate;

/// Shares of the error asked for that the step may have, fewer contact points, and single precision.
constexpr double of_step = 0.5, of_spacing = 0.1, of_precision = 0.05;

/// The first step tried takes so many a period at the end of the kernels' band, and a run as many at least;
/// it is halved as long as a run takes no more than so many.
constexpr double steps_a_period = 4, fewest_steps = 200, most_steps = 5e5;

struct Cause {
  const char* name;
  std::optional<double> share;
  const char* advice;
};

std::vector<Cause> causes(const ErrorEstimate& e) {
  return {{"mesh", e.mesh, "a finer mesh or a higher bodies.*.order"},
          {"modes", e.modes, "a higher modes.up_to_hz or modes.count"},
          {"step", e.step, "a higher time.rate_hz"},
          {"eigensolver", e.eigensolver, "a lower modes.relative_residual or modes.low_rank"},
          {"precision", e.precision, "time.precision = \"double\""},
          {"spacing", e.spacing, "a smaller contact.spacing, or a finer mesh where bodies touch"}};
}

std::vector<std::string> warnings(const ErrorEstimate& estimate, double accuracy) {
  std::vector<std::string> out;
  std::string unknown;
  Cause worst{"", 0, ""};
  for (const Cause& cause : causes(estimate)) {
    if (!cause.share) unknown += (unknown.empty() ? "" : ", ") + std::string(cause.name);
    if (cause.share.value_or(0) > *worst.share) worst = cause;
  }
  if (estimate.total() > accuracy)
    out.push_back(
        fmt::format("the error is estimated at {:.2g}, above accuracy = {:g}, most of it ({:.2g}) by the "
                    "{}: it takes {}",
                    estimate.total(), accuracy, *worst.share, worst.name, worst.advice));
  if (!unknown.empty())
    out.push_back(fmt::format("the error estimate leaves out: {}{}", unknown,
                              estimate.mesh
                                  ? ""
                                  : " (for that of the mesh, run ricochet-kernel with this accuracy; "
                                    "mesh files have one order only)"));
  return out;
}

/// Kernels of another order for all bodies, or none.
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

/// End of the band that the kernels are for.
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

void choose_rate(scene::Scene& scene, const Kernels& kernels, contact::Estimator& estimator) {
  double steps =
      std::max(fewest_steps, std::ceil(steps_a_period * band(kernels).value * scene.time.duration));
  const auto set = [&] { scene.time.rate = Hertz{std::min(steps, most_steps) / scene.time.duration}; };
  for (set(); steps < most_steps; steps *= 2, set()) {
    const auto share = in_scene(scene, [&] { return estimator.step(step_options(scene)); });
    if (share && *share <= of_step * *scene.accuracy) return;
  }
}

std::vector<kernels::Kernel> copies(const Kernels& kernels) {
  std::vector<kernels::Kernel> out;
  for (const auto& kernel : kernels.kernel) {
    out.push_back(*kernel);
    out.back().view.reset();
  }
  return out;
}

/// The scene with its contact points thinned so many times.
std::unique_ptr<contact::Estimator> estimator_of(const scene::Scene& scene, const Kernels& kernels,
                                                 const std::vector<kernels::Kernel>& other_order,
                                                 int thinnings, contact::Pairings& known) {
  double left = 0;
  for (const scene::Body& body : scene.bodies) left = std::max(left, contact::left_by_order(body.order));
  return in_scene(scene, [&] {
    return std::make_unique<contact::Estimator>(
        contact::Subject{.place =
                             [&scene, &known, thinnings](const std::vector<kernels::Kernel>& placed) {
                               std::vector<const kernels::Kernel*> pointers;
                               for (const kernels::Kernel& kernel : placed) pointers.push_back(&kernel);
                               return thinned(model_of(scene, pointers, known), thinnings);
                             },
                         .kernels = copies(kernels),
                         .other_order = other_order,
                         .left_of_other = left,
                         .low_rank = scene.modes.low_rank,
                         .at_rest = scene.contact.scheme == Scheme::at_rest,
                         .duration = scene.time.duration});
  });
}

std::optional<contact::Outcome> outcome(const scene::Scene& scene, contact::Estimator& estimator) {
  return in_scene(scene, [&] { return estimator.outcome(step_options(scene)); });
}

/// Whether an impact with fewer contact points is the same one: results may be right where the force is not,
/// so the time of contact has to be, too.
bool alike(const contact::Outcome& all, const contact::Outcome& fewer, double accuracy) {
  return distance(all, fewer) <= of_spacing * accuracy &&
         std::abs(fewer.longest_touch - all.longest_touch) <= accuracy * all.longest_touch;
}

bool may_thin(const scene::Scene& scene) {
  return scene.contact.scheme != Scheme::at_rest &&
         std::ranges::none_of(scene.contact.pairs,
                              [](const scene::Pair& pair) { return pair.spacing.has_value(); });
}

void choose_precision(scene::Scene& scene, contact::Estimator& estimator) {
  scene.time.precision = Precision::float32;
  const auto share = in_scene(scene, [&] { return estimator.precision(step_options(scene)); });
  if (!share || *share > of_precision * *scene.accuracy) scene.time.precision = Precision::float64;
}

}  // namespace

contact::Model thinned(contact::Model model, int times) {
  for (int k = 0; k < times; ++k) model = contact::thinned(model);
  return model;
}

Judged choose_and_judge(scene::Scene& scene, const Kernels& kernels, const std::filesystem::path& folder,
                        contact::Pairings& known) {
  const std::vector<kernels::Kernel> other_order = of_other_order(scene, folder);
  Judged out{.warnings = kernels.warnings};
  auto estimator = estimator_of(scene, kernels, other_order, 0, known);
  if (std::exchange(scene.time.rate_by_accuracy, false)) choose_rate(scene, kernels, *estimator);
  const auto all = outcome(scene, *estimator);
  if (!all || !all->touched()) {
    scene.time.precision = scene.time.precision.value_or(Precision::float64);
    out.warnings.push_back("nothing touches: no error is estimated");
    return out;
  }
  double by_thinning = 0;
  while (may_thin(scene)) {
    auto wider = estimator_of(scene, kernels, other_order, out.thinnings + 1, known);
    const auto fewer = outcome(scene, *wider);
    if (wider->model().gap.size() == estimator->model().gap.size() || !fewer ||
        !alike(*all, *fewer, *scene.accuracy))
      break;
    estimator = std::move(wider);
    by_thinning = distance(*all, *fewer);
    ++out.thinnings;
  }
  if (!scene.time.precision) choose_precision(scene, *estimator);
  out.estimate = in_scene(scene, [&] { return estimator->estimate(step_options(scene)); });
  if (out.estimate->spacing) out.estimate->spacing = std::max(*out.estimate->spacing, by_thinning);
  for (const std::string& warning : warnings(*out.estimate, *scene.accuracy)) out.warnings.push_back(warning);
  return out;
}

std::string told(const ErrorEstimate& estimate) {
  std::string text = fmt::format("{:.2g}", estimate.total());
  for (const Cause& cause : causes(estimate))
    text += fmt::format("{} {} {}", text.find(':') == std::string::npos ? ":" : ",", cause.name,
                        cause.share ? fmt::format("{:.2g}", *cause.share) : "unknown");
  return text;
}

}  // namespace ricochet::programs
