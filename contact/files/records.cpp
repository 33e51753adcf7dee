// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/records.hpp"

#include "contact/files/rows.hpp"
#include "contact/stepping/step_system.hpp"

namespace ricochet::contact {

Records::Records(const MotionSource& source, const StepOptions& step, const RecordOptions& options)
    : source_(source), step_(step.step), every_(options.every), file_(base::hdf5::Unnamed{}) {
  const Model* const model = source_.modes();
  file_.attribute("/", "format", "ricochet-histories");
  file_.attribute("/", "version", 1);
  if (options.force) {
    force_time_ = &file_.rows("/contact/time", {}, "s");
    force_ = &file_.rows("/contact/total_force", {}, "N");
  }
  const bool keeps_energy = options.energy && model;
  if ((options.bodies && !source_.bodies().empty()) || keeps_energy) time_ = &file_.rows("/time", {}, "s");
  if (options.bodies)
    for (const MotionSource::Body& body : source_.bodies())
      velocity_.push_back(&file_.rows("/bodies/" + body.name + "/velocity", {3}, "m/s"));
  if (keeps_energy) energy_.emplace(file_);
  if (options.gauges && model && has_gauges(*model))
    gauge_rows_.emplace(file_, *model, step, options.receivers_every);
  if (step.contact.scheme == Scheme::at_rest) return;
  if (time_) time_->append(0);
  bodies_row(source_.initial_state(), 0);
  if (energy_) energy_->append(initial_energy(*model));
  const ReceiverRows::Kept kept{
      .displacement = false, .velocity = options.receivers, .acceleration = options.acceleration};
  if (!(kept.velocity || kept.acceleration) || !model || model->receivers.empty()) return;
  receivers_.emplace(*model, step);
  receiver_rows_.emplace(file_, *model, step, options.receivers_every, kept);
  receiver_rows_->record(*receivers_);
}

Records::Records(const Model& model, const RecordOptions& options)
    : Records(model, {.contact = {.scheme = Scheme::at_rest}},
              {.force = options.force, .gauges = options.gauges, .energy = options.energy}) {}

void Records::record(const Stepper& stepper) {
  if (force_) force_row(stepper);
  if (!stepper.at_sample()) return;
  const double t = stepper.time();
  if (time_ && stepper.steps() / stepper.options().steps_per_sample % every_ == 0) {
    time_->append(t);
    bodies_row(source_.state(stepper), t);
    if (energy_) energy_->append(stepper.modal()->energy());
  }
  if (gauge_rows_) gauge_rows_->record(stepper);
  if (!receivers_) return;
  receivers_->observe(stepper);
  receiver_rows_->record(*receivers_);
}

/// Appends the total force of every n-th step in contact. The rows before and after are 0, so that straight
/// lines between rows show the force.
void Records::force_row(const Stepper& stepper) {
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

void Records::add_force(double time, double force) {
  force_time_->append(time);
  force_->append(force);
}

void Records::record(const Equilibrium& equilibrium) {
  if (force_) add_force(equilibrium.time, equilibrium.force.head(source_.gap().size()).sum());
  if (time_) time_->append(equilibrium.time);
  if (energy_) energy_->append(equilibrium.energy);
  if (gauge_rows_) gauge_rows_->record(equilibrium.time, equilibrium.q, equilibrium.force);
}

void Records::bodies_row(const Vector& state, double time) {
  for (std::size_t k = 0; k < velocity_.size(); ++k)
    append(velocity_[k], source_.momentum(static_cast<int>(k), state, time) / source_.bodies()[k].mass);
}

std::string Records::file() {
  if (receiver_rows_) receiver_rows_->finish();
  if (gauge_rows_) gauge_rows_->finish();
  return file_.content();
}

}  // namespace ricochet::contact
