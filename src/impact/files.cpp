// SPDX-License-Identifier: BSD-2-Clause
#include "src/impact/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.hpp"
#include "base/hdf5_reader.hpp"
#include "contact/files/summary_file.hpp"
#include "ricochet/error.hpp"
#include "src/impact/motion.hpp"
#include "src/scene/request.hpp"
#include "src/scene/write.hpp"

namespace ricochet::impact {

namespace fs = std::filesystem;

namespace {

constexpr double most_snapshots = 400;  // that nobody asked for

/// Identifies the run by what went into it and what came out, without times. Equal runs thus have equal
/// files.
std::string identifier(const contact::RecorderOptions& run, const ImpactSummary& figures) {
  std::string all = run.created_by + '\n' + run.scene;
  for (const std::string& kernel : run.kernel_files) all += kernel + '\n';
  std::visit(
      [&](auto known) {
        known.wall_s = 0;
        if constexpr (requires { known.real_time_factor; }) known.real_time_factor = 0;
        all += contact::json_text(known);
      },
      figures);
  return scene::sha256(all).substr(0, 16);
}

/// A line if there is a result of another scene under this name; otherwise empty.
std::string of_another_run(const contact::RecorderOptions& run) {
  std::error_code ignored;
  if (!fs::exists(run.path, ignored)) return "";
  std::string title;
  try {
    const base::hdf5::Reader before(run.path, "");
    if (before.string_attribute("/", "scene") == run.scene) return "";
    title = before.string_attribute("/", "title");
  } catch (const InputError&) {  // not a result that can be read: any file may be replaced
    return "";
  }
  return fmt::format("{}: replaces the files of a run with {}; another title keeps both",
                     run.path.filename().string(),
                     title == run.title ? "other settings" : fmt::format("the title \"{}\"", title));
}

}  // namespace

fs::path ImpactFiles::with(const char* ending) const {
  fs::path out = stem_;
  return out += ending;
}

std::optional<fs::path> ImpactFiles::motion() const {
  if (!options_.motion) return std::nullopt;
  return with(".motion.xdmf");
}

std::optional<int> ImpactFiles::problems() const {
  if (!problems_) return std::nullopt;
  return problems_->written();
}

/// Whether snapshots are kept that the scene does not ask for.
bool ImpactFiles::adds_snapshots(const Impact& impact) const {
  return options_.snapshots_mb > 0 && impact.scene.output.snapshot_every == 0 && impact.model;
}

const contact::RecorderOptions& ImpactFiles::recorder_options(const Impact& impact) {
  scene::Scene scene = impact.scene;
  if (adds_snapshots(impact)) {
    const double coordinates = std::max(1.0, static_cast<double>(impact.model->omega.size()));
    const double most = std::clamp(options_.snapshots_mb * 1e6 / (8 * coordinates), 1.0, most_snapshots);
    scene.output.snapshot_every =
        std::max<std::int64_t>(1, std::llround(std::ceil(static_cast<double>(impact.samples()) / most)));
  }
  result_ = {.path = result(),
             .title = scene.title,
             .scene = scene::to_toml(scene),
             .created_by = std::string("ricochet-contact ") + RICOCHET_VERSION,
             .kernel_files = impact.kernels.file,
             .every = scene.output.every,
             .snapshot_every = scene.output.snapshot_every,
             .receivers_every = scene.output.receivers_every(scene.time.rate_hz)};
  return result_;
}

void ImpactFiles::prepared(const Impact& impact) {
  stem_ = options_.folder / scene::slug(impact.scene.title);
  base::check_place(result());
}

/// The frames of the motion and snapshots that nobody asked for are spread over the run.
bool ImpactFiles::needs_steps(const Impact& impact) const {
  return (options_.motion && impact.scene.output.vtk_every == 0) || adds_snapshots(impact);
}

void ImpactFiles::started(const Impact& impact, const contact::Stepper& stepper) {
  const contact::RecorderOptions& options = recorder_options(impact);
  const contact::MotionSource source = impact.source();
  // A run that ends when bodies have parted may be much shorter.
  const std::int64_t least = impact.scene.time.until_parted ? 0 : impact.samples();
  base::check_place(result(), contact::least_bytes(source, options, least));
  recorder_.emplace(source, impact.options, options);
  if (!source.modes()) return;
  const contact::Model& model = *source.modes();
  if (options_.motion) motion_.emplace(stepper, model, motion_options(impact.scene, impact.samples(), stem_));
  store::in_file(impact.scene.file, [&] {
    sounds_.emplace(model.receivers, least, impact.scene.time.rate_hz, impact.scene.output.sound);
  });
  sounds_->record(recorder_->receivers());
  if (problems_) problems_->remove();
  if (!options_.problems.empty())
    problems_.emplace(model, impact.options,
                      contact::ProblemOptions{.folder = options_.problems,
                                              .name = scene::slug(impact.scene.title),
                                              .title = impact.scene.title,
                                              .every = options_.problems_every});
}

void ImpactFiles::stepped(const contact::Stepper& stepper) {
  if (problems_) problems_->observe(stepper);
  recorder_->record(stepper);
  if (sounds_ && stepper.at_sample()) sounds_->record(recorder_->receivers());
  if (motion_) motion_->record(stepper);
}

void ImpactFiles::at_rest(const Impact& impact, const contact::Equilibrium& equilibrium) {
  if (!recorder_) {
    recorder_.emplace(*impact.model, recorder_options(impact));
    if (options_.motion)
      motion_.emplace(*impact.model, motion_options(impact.scene, impact.samples(), stem_));
  }
  recorder_->record(equilibrium);
  if (motion_) motion_->record(equilibrium);
}

std::string ImpactFiles::commit(ImpactSummary& figures, std::chrono::steady_clock::time_point started) {
  std::visit([&](const auto& known) { recorder_->record(known.stress_envelope); }, figures);
  const std::string run = identifier(result_, figures);
  const base::SetLock alone(stem_);
  const std::string replaced = of_another_run(result_);
  recorder_->commit(run, summary());
  if (motion_) motion_->commit(run);
  if (sounds_) {
    auto& of_motion = std::get<contact::Summary>(figures);
    of_motion.sounds = sounds_->write(stem_, run);
    of_motion.sound = sounds_->write_for_players(stem_);
  }
  std::visit(
      [&](auto& all) {
        all.run = run;
        all.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
        contact::write_json(all, summary());
      },
      figures);
  return replaced;
}

}  // namespace ricochet::impact
