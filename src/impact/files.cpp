// SPDX-License-Identifier: BSD-2-Clause
#include "src/impact/files.hpp"

#include "base/atomic_file.hpp"
#include "src/impact/motion.hpp"
#include "src/scene/write.hpp"

namespace ricochet::impact {

namespace fs = std::filesystem;

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

contact::RecorderOptions ImpactFiles::recorder_options(const Impact& impact) const {
  const scene::Scene& scene = impact.scene;
  return {.path = result(),
          .title = scene.title,
          .scene = scene::to_toml(scene),
          .created_by = std::string("ricochet-contact ") + RICOCHET_VERSION,
          .kernel_files = impact.kernels.file,
          .every = scene.output.every,
          .snapshot_every = scene.output.snapshot_every,
          .receivers_every = scene.output.receivers_every(scene.time.rate_hz)};
}

void ImpactFiles::prepared(const Impact& impact) {
  stem_ = options_.folder / scene::slug(impact.scene.title);
  base::check_place(result());
}

void ImpactFiles::started(const Impact& impact, const contact::Stepper& stepper) {
  const contact::RecorderOptions options = recorder_options(impact);
  const contact::MotionSource source = impact.source();
  base::check_place(result(), contact::least_bytes(source, options, impact.samples()));
  recorder_.emplace(source, impact.options, options);
  if (!source.modes()) return;
  const contact::Model& model = *source.modes();
  if (options_.motion) motion_.emplace(stepper, model, motion_options(impact.scene, impact.samples(), stem_));
  store::in_file(impact.scene.file, [&] {
    sounds_.emplace(model.receivers, impact.samples(), impact.scene.time.rate_hz, impact.scene.output.sound);
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

void ImpactFiles::commit(ImpactSummary& figures) {
  recorder_->commit(summary());
  if (motion_) motion_->commit();
  if (!sounds_) return;
  auto& summary = std::get<contact::Summary>(figures);
  summary.sounds = sounds_->write(stem_);
  summary.sound = sounds_->write_for_players(stem_);
}

}  // namespace ricochet::impact
