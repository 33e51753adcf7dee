#include "src/programs/contact_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <ostream>
#include <vector>

#include "base/atomic_file.hpp"
#include "contact/input/history_file.hpp"
#include "contact/model/model.hpp"
#include "contact/output/fclib.hpp"
#include "contact/output/recorder.hpp"
#include "contact/output/summary_observer.hpp"
#include "contact/static/equilibrium.hpp"
#include "contact/stepping/stepper.hpp"
#include "ricochet/error.hpp"
#include "ricochet/kernel.hpp"
#include "src/console/console.hpp"
#include "src/programs/accuracy.hpp"
#include "src/programs/contact_parts.hpp"
#include "src/programs/motion.hpp"
#include "src/scene/read.hpp"
#include "src/scene/scene.hpp"
#include "src/scene/write.hpp"
#include "src/sound/wav.hpp"

namespace ricochet::programs {

namespace fs = std::filesystem;
using contact::Summary;

namespace {

Eigen::Vector3d vector(const Vector3& v) { return {v[0], v[1], v[2]}; }

}  // namespace

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<contact::DriveRequest> drives_of(const scene::Scene& scene) {
  std::vector<contact::DriveRequest> out;
  const auto add = [&](const std::vector<scene::Forcing>& all, bool support) {
    for (const scene::Forcing& driven : all) {
      contact::DriveRequest request{
          driven.body, support ? driven.group : driven.name, support, vector(driven.vector), {}};
      if (!driven.history.empty()) request.history = contact::read_history(driven.history);
      out.push_back(std::move(request));
    }
  };
  add(scene.loads.tractions, false);
  add(scene.loads.points, false);
  add(scene.loads.motions, true);
  return out;
}

contact::Model model_of(const scene::Scene& scene, const std::vector<const kernels::Kernel*>& kernels,
                        contact::Pairings& known) {
  return contact::build_model(placed_bodies(scene, kernels), half_spaces(scene), pair_requests(scene),
                              vector(scene.loads.gravity), drives_of(scene), &known);
}

StepOptions step_options(const scene::Scene& scene) {
  return {.scheme = scene.contact.scheme,
          .admittance = scene.contact.admittance,
          .instant = scene.contact.instant,
          .restitution = scene.contact.restitution,
          .step = 1 / scene.time.rate.value,
          .max_pivots = scene.contact.max_pivots.value_or(std::numeric_limits<int>::max()),
          .precision = scene.time.precision.value_or(Precision::float64)};
}

contact::Equilibrium equilibrium_of(const scene::Scene& scene, const contact::Model& model) {
  using Solver = contact::EquilibriumOptions::Solver;
  const Solver solver = scene.contact.solver == scene::Solver::uzawa ? Solver::uzawa : Solver::exact;
  return in_scene(scene, [&] { return contact::find_equilibrium(model, {.solver = solver}); });
}

double slowest_wave(const scene::Scene& scene) {
  double slowest = std::numeric_limits<double>::infinity();
  for (const scene::Body& body : scene.bodies)
    for (const scene::Material& material : body.materials)
      slowest = std::min(slowest, std::sqrt(material.young / material.density));
  return std::isfinite(slowest) ? slowest : 0;
}

void check(StepStatus status, const scene::Scene& scene, double time) {
  if (status == StepStatus::no_solution)
    throw InputError(fmt::format(
        "{}: no contact forces keep the bodies apart at t = {:.6g} s, as there are more contact points than "
        "their "
        "modes can move. Set modes.residual_flexibility = true, or fewer candidates (contact.spacing).",
        scene.file.string(), time));
  if (status == StepStatus::not_finite)
    throw SolverError(
        fmt::format("{}: the motion stops being finite at t = {:.6g} s", scene.file.string(), time));
}

namespace {

/// Velocities of the receivers, step by step, for their sound files.
class Microphones {
 public:
  Microphones(const contact::Model& model, std::int64_t steps, double rate) : rate_(rate) {
    if (model.receivers.empty()) return;
    sound::check_length(steps + 1, rate);
    for (const contact::Model::Receiver& receiver : model.receivers) name_.push_back(receiver.name);
    velocity_.resize(name_.size());
    for (auto& velocity : velocity_) velocity.reserve(3 * static_cast<std::size_t>(steps + 1));
  }

  void listen(const contact::Receivers& receivers) {
    for (std::size_t k = 0; k < velocity_.size(); ++k)
      for (const double v : receivers[k].velocity) velocity_[k].push_back(static_cast<float>(v));
  }

  /// `<stem>.<receiver>.wav`
  std::map<std::string, contact::Sound> write(const fs::path& stem) const {
    std::map<std::string, contact::Sound> out;
    for (std::size_t k = 0; k < name_.size(); ++k) {
      fs::path file = stem;
      file += "." + name_[k] + ".wav";
      const sound::Scale scale = sound::write_wav(file, velocity_[k], rate_);
      out[name_[k]] = {file.filename().string(), scale.full_scale_m_per_s, scale.rate_hz};
    }
    return out;
  }

 private:
  double rate_;
  std::vector<std::string> name_;
  std::vector<std::vector<float>> velocity_;
};

std::string seconds(const std::optional<double>& value, const char* otherwise) {
  return value ? fmt::format("{:.6g} s", *value) : otherwise;
}

/// Of a touch: the bell of meshes/bell rebounds by 12 % too slowly with 16 steps, by 5 % with 32.
constexpr double few_steps = 20;

}  // namespace

void judge_steps(const scene::Scene& scene, Summary& summary) {
  if (scene.accuracy || scene.contact.scheme != Scheme::compliant) return;
  double longest = 0;
  for (const contact::Episode& episode : summary.episodes) {
    if (!episode.end_s) return;
    longest = std::max(longest, (*episode.end_s - episode.start_s) * scene.time.rate.value);
  }
  if (longest > 0 && longest < few_steps - 0.5)
    summary.warnings.push_back(fmt::format(
        "the longest touch has {:.0f} steps: peak force, rebound and the energy that contact takes hang on "
        "the step. Raise time.rate_hz, or set accuracy",
        longest));
}

std::string report(const Summary& s) {
  std::string text;
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("{:<20}{}\n", name, value);
  };
  std::string modes;
  for (const auto& [name, count] : s.modes) {
    const std::string& basis = s.basis.at(name);
    modes += fmt::format("{}{} {}{}", modes.empty() ? "" : ", ", name, count,
                         basis == "approximate modes" ? " (approximate)"
                         : basis == "imported"        ? " (imported)"
                                                      : "");
  }
  if (s.modes_in_residual > 0)
    modes += fmt::format(" ({} above half the rate: quasi-static)", s.modes_in_residual);
  if (!modes.empty()) line("modes", modes);
  line("contact points",
       fmt::format("{}, {} face nothing, at most {} touch", s.candidates, s.unpaired, s.max_active));
  if (!s.contact_start_s) {
    line("contact", "none");
  } else {
    line("contact starts", seconds(s.contact_start_s, ""));
    line("contact ends", seconds(s.contact_end_s, "still touching"));
    line("episodes", fmt::format("{} ({} steps)", s.episodes.size(), s.contact_steps));
    line("peak force", fmt::format("{:.6g} N", s.peak_force_n));
    line("impulse", fmt::format("{:.6g} N s", s.impulse_ns));
    for (const auto& [name, v] : s.exit_velocity)
      line("exit velocity", fmt::format("{} [{:.6g}, {:.6g}, {:.6g}] m/s", name, v.x(), v.y(), v.z()));
    if (s.restitution) line("restitution", fmt::format("{:.6g}", *s.restitution));
    if (s.energy_lost_contact)
      line("energy to contact", fmt::format("{:.3g} %", 100 * *s.energy_lost_contact));
  }
  if (s.error_estimate) line("error estimate", told(*s.error_estimate));
  if (s.energy_drift) line("energy drift", fmt::format("{:.2g}", *s.energy_drift));
  line("deepest penetration", fmt::format("{:.3g} m", s.max_penetration_m));
  for (const auto& [name, sound] : s.sounds)
    line("sound", fmt::format("{}, full scale {:.3g} m/s", sound.file, sound.full_scale_m_per_s));
  if (s.limited_steps > 0)
    line("limited steps",
         fmt::format("{} by max_pivots, residual up to {:.2g}", s.limited_steps, s.limited_residual));
  line("speed", fmt::format("{:.3g} x real time", s.real_time_factor));
  return text;
}

namespace {

std::string report(const contact::EquilibriumSummary& s, const scene::Scene& scene) {
  std::string text;
  for (std::size_t p = 0; p < s.pairs.size(); ++p) {
    const auto& pair = s.pairs[p];
    text += fmt::format("{} on {}: ", scene.contact.pairs[p].a, scene.contact.pairs[p].b);
    text += pair.contact_points == 0
                ? "no contact\n"
                : fmt::format("{:.6g} N on {} points, {:.4g} m^2, at most {:.4g} Pa; approach {:.6g} m\n",
                              pair.force_n, pair.contact_points, pair.contact_area_m2, pair.peak_pressure_pa,
                              pair.approach_m);
  }
  if (s.error_estimate) text += fmt::format("error estimate      {}\n", told(*s.error_estimate));
  return text + fmt::format("imbalance           {:.2g}\ndeepest penetration {:.3g} m\n", s.imbalance,
                            s.max_penetration_m);
}

/// Where results go, whatever the scheme.
struct Target {
  fs::path result, summary;
  contact::RecorderOptions recorder;
  std::optional<contact::MotionOptions> motion;  ///< none: not asked for
};

Target target_of(const scene::Scene& scene, const fs::path& folder, const Kernels& kernels, bool motion) {
  Target out;
  out.result = out.summary = folder / scene::slug(scene.title);
  out.result += ".result.h5";
  out.summary += ".summary.json";
  out.recorder = {.path = out.result,
                  .title = scene.title,
                  .scene = scene::to_toml(scene),
                  .created_by = std::string("ricochet-contact ") + RICOCHET_VERSION,
                  .kernel_files = kernels.file,
                  .every = scene.output.every,
                  .snapshot_every = scene.output.snapshot_every};
  if (motion) out.motion = motion_options(scene, folder / scene::slug(scene.title));
  return out;
}

void show(const console::Options& options, std::ostream& out, console::Console& console, const Target& target,
          const std::string& report, const std::vector<std::string>& warnings) {
  if (!options.quiet) {
    out << console::Console::table(console.phases()) << '\n'
        << report << fmt::format("\n{}\n{}\n", target.result.string(), target.summary.string());
    if (target.motion) out << target.motion->stem.string() << ".xdmf\n";
  }
  for (const std::string& warning : warnings) console.warn(warning);
}

void run_at_rest(const scene::Scene& scene, const contact::Model& model, const Judged& judged,
                 const Target& target, Clock::time_point started, const console::Options& options,
                 console::Console& console, std::ostream& out) {
  console.begin("equilibrium");
  const contact::Equilibrium equilibrium = equilibrium_of(scene, model);
  console.end(fmt::format("{} iterations", equilibrium.iterations));

  console.begin("writing");
  contact::Recorder(model, equilibrium, target.recorder).commit(target.summary);
  if (target.motion) contact::MotionFile(equilibrium, model, *target.motion).commit();
  contact::EquilibriumSummary summary = contact::summarise(model, equilibrium);
  judged.into(summary);
  summary.wall_s = seconds_since(started);
  contact::write_json(summary, target.summary);
  console.end(target.result.filename().string());
  show(options, out, console, target, report(summary, scene), summary.warnings);
}

/// Throws InputError where --fclib asks for problems that are not posed.
void refuse_problems(const console::Options& options, const scene::Scene& scene) {
  if (!options.fclib.empty() &&
      (scene.contact.scheme != Scheme::compliant || scene.contact.kernel != scene::ContactKernel::modes))
    throw InputError(fmt::format(
        "{}: --fclib: only contact.scheme = \"compliant\" with kernel = \"modes\" solves one complementarity "
        "problem of all points each step: choose them, or leave --fclib out",
        options.scene.string()));
}

}  // namespace

int run_contact(const console::Options& options, std::ostream& out) {
  const Clock::time_point started = Clock::now();
  scene::Scene scene = scene::read(options.scene, options.overrides);
  if (options.dry_run) {
    out << scene::to_toml(scene);
    return 0;
  }
  refuse_problems(options, scene);
  const fs::path folder = options.out.empty() ? options.scene.parent_path() / "out" : options.out;
  const bool motion = options.vtk || scene.output.vtk_every > 0;
  if (motion) check_motion(scene);
  console::Console console(options.quiet, console::peak_memory_mib, options.watch);
  if (scene.contact.kernel == scene::ContactKernel::table)
    return run_table(options, scene, folder, console, out);

  console.begin("kernels");
  KernelCache cache;
  const Kernels kernels = read_kernels(scene, folder, cache, motion);
  if (motion) check_skins(kernels);
  console.end(fmt::format("{} bodies", kernels.kernel.size()));

  console.begin("pairing");
  contact::Model model = in_scene(scene, [&] { return model_of(scene, kernels.pointers(), cache.pairings); });
  console.end(fmt::format("{} contact points, {} modes", model.gap.size(), model.omega.size()));

  base::check_place(target_of(scene, folder, kernels, motion).result);
  Judged judged{.warnings = kernels.warnings};
  if (scene.accuracy) {
    console.begin("estimates");
    judged = choose_and_judge(scene, kernels, folder, cache.pairings);
    model = thinned(std::move(model), judged.thinnings);
    console.end(judged.estimate ? fmt::format("error {:.2g}, {} contact points", judged.estimate->total(),
                                              model.gap.size())
                                : "");
  }
  const Target target = target_of(scene, folder, kernels, motion);
  if (scene.contact.scheme == Scheme::at_rest) {
    run_at_rest(scene, model, judged, target, started, options, console, out);
    return 0;
  }
  const StepOptions step = step_options(scene);
  const std::int64_t steps = std::llround(scene.time.duration * scene.time.rate.value);
  base::check_place(target.result, contact::least_bytes(model, target.recorder, steps));

  console.begin("steps", steps);
  const Clock::time_point stepping = Clock::now();
  const auto stepper = in_scene(scene, [&] { return contact::make_stepper(model, step); });
  contact::Recorder recorder(model, step, target.recorder);
  std::optional<contact::MotionFile> film;
  if (target.motion) film.emplace(*stepper, model, *target.motion);
  Microphones microphones = in_scene(scene, [&] { return Microphones(model, steps, scene.time.rate.value); });
  microphones.listen(recorder.receivers());
  contact::SummaryObserver observer(model, step.step, slowest_wave(scene));
  std::optional<contact::ProblemFiles> problems;
  if (!options.fclib.empty())
    problems.emplace(model, step,
                     contact::ProblemOptions{.folder = options.fclib,
                                             .name = scene::slug(scene.title),
                                             .title = scene.title,
                                             .every = options.fclib_every});
  for (std::int64_t k = 1; k <= steps; ++k) {
    check(stepper->step(), scene, static_cast<double>(k) * step.step);
    if (problems) problems->observe(*stepper);
    observer.observe(*stepper);
    recorder.record(*stepper);
    microphones.listen(recorder.receivers());
    if (film) film->record(*stepper);
    console.advance(k);
  }
  const double elapsed = seconds_since(stepping);
  console.end(fmt::format("{} steps of {:.4g} s", steps, step.step));

  if (problems) console.say(fmt::format("{}: {} problems", options.fclib.string(), problems->written()));

  console.begin("writing");
  recorder.commit(target.summary);
  if (film) film->commit();
  Summary summary = observer.summary();
  judged.into(summary);
  judge_steps(scene, summary);
  summary.sounds = microphones.write(folder / scene::slug(scene.title));
  summary.real_time_factor = elapsed > 0 ? stepper->time() / elapsed : 0;
  summary.wall_s = seconds_since(started);
  contact::write_json(summary, target.summary);
  console.end(target.result.filename().string());
  show(options, out, console, target, report(summary), summary.warnings);
  return 0;
}

}  // namespace ricochet::programs
