// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/histories.hpp"

#include "contact/files/rows.hpp"
#include "contact/stepping/step_system.hpp"

namespace ricochet::contact {
namespace {

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& bodies) {
  std::vector<std::string> out;
  for (const Named& body : bodies) out.push_back(body.name);
  return out;
}

}  // namespace

Histories::Histories(const Model* model, const StepOptions& step, const HistoryOptions& options,
                     const std::vector<std::string>& bodies)
    : model_(model), step_(step.step), every_(options.every), file_(base::hdf5::Unnamed{}) {
  file_.attribute("/", "format", "ricochet-histories");
  file_.attribute("/", "version", 1);
  if (options.force) {
    force_time_ = &file_.rows("/contact/time", {}, "s");
    force_ = &file_.rows("/contact/total_force", {}, "N");
  }
  const bool keeps_energy = options.energy && model;
  if (!bodies.empty() || keeps_energy) time_ = &file_.rows("/time", {}, "s");
  for (const std::string& name : bodies)
    velocity_.push_back(&file_.rows("/bodies/" + name + "/velocity", {3}, "m/s"));
  if (keeps_energy) energy_.emplace(file_);
}

Histories::Histories(const Model& model, const StepOptions& step, const HistoryOptions& options)
    : Histories(&model, step, options, options.bodies ? names_of(model.bodies) : std::vector<std::string>{}) {
  if (time_) time_->append(0);
  if (!velocity_.empty()) bodies_row(model.initial_rates(), 0);
  if (energy_) energy_->append(initial_energy(model));
  if (!options.receivers || model.receivers.empty()) return;
  receivers_.emplace(model, step);
  receiver_rows_.emplace(file_, model, step, options.receivers_every, true);
  receiver_rows_->record(*receivers_);
}

Histories::Histories(const Model& model, const HistoryOptions& options)
    : Histories(&model, {.scheme = Scheme::at_rest}, options, {}) {}

Histories::Histories(const Table& table, const StepOptions& step, const HistoryOptions& options)
    : Histories(nullptr, step, options,
                options.bodies ? names_of(table.bodies) : std::vector<std::string>{}) {
  if (velocity_.empty()) return;
  time_->append(0);
  for (std::size_t b = 0; b < velocity_.size(); ++b) append(velocity_[b], table.bodies[b].velocity);
}

void Histories::record(const Stepper& stepper) {
  if (force_) force_row(stepper);
  if (!stepper.at_sample()) return;
  const ModalState* const modal = stepper.modal();
  const double t = stepper.time();
  if (time_ && stepper.steps() / stepper.options().steps_per_sample % every_ == 0) {
    time_->append(t);
    if (!velocity_.empty() && modal) bodies_row(modal->v, t);
    if (!velocity_.empty() && !modal) bodies_row(*stepper.body_velocities());
    if (energy_) energy_->append(modal->energy());
  }
  if (!receivers_) return;
  receivers_->observe(stepper);
  receiver_rows_->record(*receivers_);
}

/// Appends the total force of every n-th step in contact. The rows before and after are 0, so that straight
/// lines between rows show the force.
void Histories::force_row(const Stepper& stepper) {
  const auto force = stepper.force().head(stepper.points());
  const bool touching = (force.array() > 0).any();
  const std::int64_t k = stepper.steps(), next = force_end_ + every_;
  if (pressed_ && (k > next || (k == next && !touching))) {  // a free flight may have passed `next`
    add_force(static_cast<double>(next) * step_, 0);
    force_end_ = next;
    pressed_ = false;
  }
  if (!touching || k % every_ != 0) return;
  if (force_end_ < k - every_) add_force(static_cast<double>(k - every_) * step_, 0);
  add_force(stepper.time(), force.sum());
  force_end_ = k;
  pressed_ = true;
}

void Histories::add_force(double time, double force) {
  force_time_->append(time);
  force_->append(force);
}

void Histories::record(const Equilibrium& equilibrium) {
  if (force_) add_force(equilibrium.time, equilibrium.force.head(model_->gap.size()).sum());
  if (time_) time_->append(equilibrium.time);
  if (energy_) energy_->append(equilibrium.energy);
}

void Histories::bodies_row(const Vector& v, double time) {
  for (std::size_t k = 0; k < velocity_.size(); ++k)
    append(velocity_[k], model_->momentum(static_cast<int>(k), v, time) / model_->bodies[k].mass);
}

void Histories::bodies_row(const Eigen::Matrix3Xd& velocity) {
  for (std::size_t b = 0; b < velocity_.size(); ++b)
    append(velocity_[b], velocity.col(static_cast<Eigen::Index>(b)));
}

std::string Histories::file() {
  if (receiver_rows_) receiver_rows_->finish();
  return file_.content();
}

}  // namespace ricochet::contact
