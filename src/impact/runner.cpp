// SPDX-License-Identifier: BSD-2-Clause
#include "src/impact/runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "contact/accuracy/error_report.hpp"
#include "contact/figures/summary_observer.hpp"
#include "contact/law/contact_law.hpp"
#include "contact/stepping/run_steps.hpp"
#include "ricochet/error.hpp"
#include "src/accuracy/scene_dial.hpp"
#include "src/impact/motion.hpp"
#include "src/impact/parting.hpp"
#include "src/impact/sampled_responses.hpp"
#include "src/impact/second_run.hpp"
#include "src/impact/warnings.hpp"
#include "src/scene/elastic_law.hpp"
#include "src/store/memory.hpp"

namespace ricochet::impact {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The pairs of a scene and the model of its kernels, both empty if the responses come from a file.
struct Paired {
  store::Prepared prepared{};
  contact::Model model{};
};

Paired pair(Impact& impact, const ImpactRequest& request, store::KernelStore& store,
            console::Console& console) {
  const scene::Scene& scene = impact.scene;
  console.begin("kernels");
  impact.kernels = store::read_kernels(scene, request.folder, store, request.views || scene.output.stress);
  if (request.views) check_views(impact.kernels);
  console.end(fmt::format("{} bodies", impact.kernels.kernel.size()));

  console.begin("pairing");
  Paired out;
  auto& [library, placement] = out.prepared;
  library = store::library_scene(scene, impact.kernels.pointers());
  store::in_file(scene.file, [&] { store::read_histories(scene, library); });
  placement = store.placements.place(scene, impact.kernels.pointers());
  const std::string memory = store::check_impact(scene, impact.kernels.pointers(), placement);
  out.model = store::in_file(scene.file, [&] { return store::model_of(scene, out.prepared); });
  if (scene.contact.scheme != Scheme::at_rest)
    store::in_file(scene.file, [&] { contact::refuse_sag(out.model); });
  console.end(
      fmt::format("{} contact points, {} modes; {}", out.model.gap.size(), out.model.omega.size(), memory));
  return out;
}

/// Ends a run with linear rotations that is to be repeated with finite ones. @param reason  for the user
struct Repeat {
  std::string reason;
};

/// Watches the rotations of a run whose scene leaves them open.
class OpenRotation {
 public:
  /// @param obstacle  why the run cannot be repeated; empty: nothing is known
  OpenRotation(const ImpactRequest& request, store::KernelStore& store, std::string obstacle)
      : request_(request), store_(store), obstacle_(std::move(obstacle)) {}

  /// Throws Repeat if a body turned too far and nothing prevents finite rotations.
  void observe(const contact::FarthestTurn& turn) {
    if (turn.angle <= scene::most_linear_turn || !obstacle_.empty()) return;
    obstacle_ = obstacle();
    if (obstacle_.empty()) throw Repeat{fmt::format("{} turns by more than 1 degree", name(turn))};
  }

  /// Adds what there is to say about a run that has ended with linear rotations.
  void add_to(contact::Summary& summary, const contact::FarthestTurn& turn) const {
    if (turn.angle <= scene::most_linear_turn) return;
    summary.needs_turning_kernels = lacks_kernels_;
    summary.warnings.push_back(fmt::format("{} turned by {:.3g} degrees, and rotations are linear: {}",
                                           name(turn), turn.angle * 180 / std::numbers::pi, obstacle_));
  }

 private:
  const std::string& name(const contact::FarthestTurn& turn) const {
    return request_.scene.bodies[turn.body].name;
  }
  std::string obstacle() {
    const scene::Scene turning = scene::with_finite_rotation(request_.scene, "");
    try {
      const scene::Scene closed = accuracy::closed(turning, request_.folder, store_).scene;
      const auto kernels = store::find_kernels(closed, request_.folder, store_);
      if (std::ranges::all_of(kernels, &store::StoredKernel::enough)) return "";
    } catch (const InputError&) {
      // No settings for its accuracy
    }
    lacks_kernels_ = true;
    return "set motion.rotation = \"finite\" and run ricochet-kernel again, because finite ones need other "
           "kernels, or set \"linear\"";
  }

  const ImpactRequest& request_;
  store::KernelStore& store_;
  std::string obstacle_;
  bool lacks_kernels_ = false;
};

struct ErrorReport {
  std::optional<contact::ErrorEstimate> estimate;
  std::vector<std::string> warnings;
};

/// Chooses the settings of steps that a scene with an accuracy leaves open.
/// @param settings  chosen by ricochet-kernel; no value if unknown
/// @param open  null if rotations are decided
ErrorReport choose(Impact& impact, Paired& paired, const std::optional<accuracy::Settings>& settings,
                   OpenRotation* open, console::Console& console) {
  ErrorReport out{{}, impact.kernels.warnings};
  if (!impact.scene.accuracy) return out;
  console.begin("estimates");
  std::int64_t steps = 0;
  const auto poll = [&] {
    if ((++steps & 63) == 0) console.advance(steps);
  };
  // The model that comes back has fewer points, or serves the first touch of bodies that turn alone.
  const bool turns = impact.scene.motion.is_finite();
  const auto dial = [&](const scene::Scene& scene) {
    accuracy::Dialled made = accuracy::dial_of(scene, impact.kernels, paired.prepared,
                                               turns ? paired.model : std::move(paired.model),
                                               settings ? settings->rate : Hertz{0}, poll);
    if (!turns) paired.model = std::move(made.model);
    return made;
  };
  accuracy::Dialled dialled = dial(impact.scene);
  if (open != nullptr && dialled.quantities && dialled.quantities->turn.angle > scene::most_linear_turn) {
    open->observe(dialled.quantities->turn);
    scene::Scene linear = impact.scene;  // as it has to stay
    linear.motion.rotation_open = false;
    if (!dialled.estimate) dialled = dial(linear);
  }
  impact.scene = accuracy::resolved(std::move(impact.scene), dialled);
  out.estimate = dialled.estimate;
  if (out.estimate)
    std::ranges::copy(contact::warnings(*out.estimate, *impact.scene.accuracy),
                      std::back_inserter(out.warnings));
  else
    out.warnings.push_back("nothing touches: no error is estimated");
  console.end(out.estimate ? fmt::format("error {:.2g}, {} contact points", out.estimate->total(),
                                         paired.model.gap.size())
                           : "");
  return out;
}

contact::EquilibriumSummary rest(const Impact& impact, console::Console& console, ImpactObserver& observer) {
  using Solver = contact::EquilibriumOptions::Solver;
  const Solver solver = impact.scene.contact.solver == scene::Solver::uzawa ? Solver::uzawa : Solver::exact;
  console.begin("equilibrium");
  const contact::Equilibrium equilibrium = store::in_file(impact.scene.file, [&] {
    return contact::find_equilibrium(
        *impact.model, {.solver = solver, .increments = impact.scene.contact.increments},
        [&](const contact::Equilibrium& at_knot) { observer.at_rest(impact, at_knot); });
  });
  console.end(fmt::format("{} iterations", equilibrium.iterations));
  return contact::summarise(*impact.model, equilibrium, limits_of(impact.scene));
}

/// Steps until bodies have parted, or those of the run.
std::int64_t steps_until_parted(const Impact& impact, console::Console& console) {
  console.begin("length");
  const auto stepper =
      store::in_file(impact.scene.file, [&] { return contact::make_stepper(impact.model, impact.options); });
  contact::FigureObserver figures(impact.source(), impact.options.step);
  const contact::StepsMade made = contact::run_steps(*stepper, impact.steps, [&](std::int64_t k) {
    figures.observe(*stepper);
    console.advance(k);
    return !(stepper->at_sample() && figures.parted(*stepper));
  });
  console.end(fmt::format("{} steps", made.steps));
  return made.status == StepStatus::ok ? made.steps : impact.steps;
}

/// @param open  null if rotations are decided
contact::Summary steps(const Impact& impact, OpenRotation* open, console::Console& console,
                       ImpactObserver& observer) {
  const double step = impact.options.step;
  const bool until_parted = impact.scene.time.until_parted;
  console.begin("steps", until_parted ? 0 : impact.steps);
  const Clock::time_point started = Clock::now();
  const std::unique_ptr<contact::Stepper> stepper =
      impact.table ? table_stepper(impact) : store::in_file(impact.scene.file, [&] {
        return contact::make_stepper(impact.model, impact.options);
      });
  std::optional<SecondRun> second;
  if (impact.scene.motion.is_finite() && impact.scene.motion.second_run) second.emplace(impact);
  observer.started(impact, *stepper);
  contact::SummaryObserver figures(impact.source(), step, slowest_wave(impact.scene),
                                   limits_of(impact.scene));
  const contact::StepsMade made = contact::run_steps(*stepper, impact.steps, [&](std::int64_t k) {
    figures.observe(*stepper);
    if (open != nullptr) open->observe(figures.farthest_turn());
    if (second) second->observe(*stepper);
    observer.stepped(*stepper);
    console.advance(k);
    return !(until_parted && stepper->at_sample() && figures.figures().parted(*stepper));
  });
  check(made.status, impact.scene, static_cast<double>(made.steps + 1) * step);
  contact::Summary out = figures.summary();
  out.duration_s = stepper->time();
  if (open != nullptr) open->add_to(out, figures.farthest_turn());
  const double elapsed = seconds_since(started);
  out.real_time_factor = elapsed > 0 ? out.duration_s / elapsed : 0;
  if (out.contact_start_s && !out.contact_end_s) out.parted_s = parting(impact, *stepper, figures.figures());
  console.end(fmt::format("{} steps of {:.4g} s", made.steps, step));
  if (second) {
    console.begin("second run");
    out.separation_s = second->separation(made.steps / impact.options.steps_per_sample);
    console.end();
  }
  return out;
}

/// Runs the scene once. @param obstacle  why rotations that it leaves open stay linear; empty: nothing is
/// known, and then Repeat is thrown if they are to be finite
ImpactResult run_once(const ImpactRequest& request, const std::string& obstacle, store::KernelStore& store,
                      console::Console& console, ImpactObserver& observer) {
  accuracy::ClosedScene closed = accuracy::closed(request.scene, request.folder, store);
  auto data = std::make_unique<Impact>(Impact{.scene = std::move(closed.scene)});
  Impact& impact = *data;
  std::optional<OpenRotation> open;
  if (impact.scene.motion.rotation_open) open.emplace(request, store, obstacle);
  const bool by_table = impact.scene.contact.kernel == scene::ContactKernel::table;
  Paired paired;
  if (impact.scene.contact.table.empty()) paired = pair(impact, request, store, console);
  observer.prepared(impact);
  const ErrorReport report = choose(impact, paired, closed.settings, open ? &*open : nullptr, console);
  impact.options = store::step_options(impact.scene);
  if (impact.scene.contact.table.empty())
    impact.model =
        contact::fold(std::make_shared<const contact::Model>(std::move(paired.model)), impact.options);

  ImpactSummary summary;
  if (impact.scene.contact.scheme == Scheme::at_rest) {
    summary = rest(impact, console, observer);
  } else {
    impact.steps = contact::step_count(impact.scene.time.duration, impact.scene.time.rate_hz) *
                   impact.options.steps_per_sample;
    if (by_table) add_table(impact, console);
    if (impact.scene.time.until_parted && observer.needs_steps(impact))
      impact.steps = steps_until_parted(impact, console);
    summary = steps(impact, open ? &*open : nullptr, console, observer);
  }
  std::visit(
      [&](auto& figures) {
        if (by_table) return;
        figures.error_estimate = report.estimate;
        figures.warnings.insert(figures.warnings.end(), report.warnings.begin(), report.warnings.end());
      },
      summary);
  if (auto* const figures = std::get_if<contact::Summary>(&summary)) add_warnings(impact.scene, *figures);
  std::visit(
      [&](auto& figures) {
        for (std::string& warning : motions_without_friction(impact.scene))
          figures.warnings.push_back(std::move(warning));
      },
      summary);
  return {std::move(data), std::move(summary)};
}

/// Runs the scene, again with finite rotations if it leaves them open and a body turns too far.
ImpactResult run_as_it_turns(const ImpactRequest& request, store::KernelStore& store,
                             console::Console& console, ImpactObserver& observer) {
  ImpactRequest turning;
  try {
    return run_once(request, "", store, console, observer);
  } catch (const Repeat& repeat) {
    console.end();
    console.say(
        fmt::format("{}: repeated with finite rotation (motion.rotation = \"linear\" keeps the axes "
                    "of the start)",
                    repeat.reason));
    turning = request;
    turning.scene = scene::with_finite_rotation(request.scene, repeat.reason);
  }
  std::string failure;
  try {
    return run_once(turning, "", store, console, observer);
  } catch (const InputError& error) {
    failure = error.what();
  }
  console.say("repeated with linear rotation");
  return run_once(request, fmt::format("finite ones failed ({})", failure), store, console, observer);
}

}  // namespace

std::vector<MaterialLimits> limits_of(const scene::Scene& scene) {
  std::vector<MaterialLimits> out;
  const auto least = [](double& known, double value) {
    if (value > 0 && (known == 0 || value < known)) known = value;
  };
  for (const scene::Body& body : scene.bodies) {
    MaterialLimits& of_body = out.emplace_back();
    for (const scene::Material& material : body.materials) {
      least(of_body.young, scene::softest_young(material));
      least(of_body.yield, material.yield);
    }
  }
  return out;
}

double slowest_wave(const scene::Scene& scene) {
  double slowest = std::numeric_limits<double>::infinity();
  for (const scene::Body& body : scene.bodies) slowest = std::min(slowest, scene::wave_speeds(body).low);
  return std::isfinite(slowest) ? slowest : 0;
}

ImpactResult run_impact(ImpactRequest request, store::KernelStore& store, console::Console& console,
                        ImpactObserver& observer) {
  const Clock::time_point started = Clock::now();
  ImpactResult out = run_as_it_turns(request, store, console, observer);
  std::visit([&](auto& figures) { figures.wall_s = seconds_since(started); }, out.summary);
  return out;
}

void check(StepStatus status, const scene::Scene& scene, double time) {
  if (status == StepStatus::no_solution)
    throw InputError(fmt::format(
        "{}: no contact forces keep the bodies apart at t = {:.6g} s, as there are more contact points than "
        "their modes can move. Set modes.residual_flexibility = true, or fewer candidates (contact.spacing).",
        scene.file.string(), time));
  if (status == StepStatus::crowded)
    throw InputError(fmt::format(
        "{}: at t = {:.6g} s, more than {} rows of contact may act at once, three for each point with "
        "friction. Mesh the bodies coarser.",
        scene.file.string(), time, contact::most_held));
  if (status == StepStatus::not_finite)
    throw SolverError(
        fmt::format("{}: the motion stops being finite at t = {:.6g} s", scene.file.string(), time));
}

}  // namespace ricochet::impact
