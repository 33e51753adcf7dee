// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/recorder.hpp"

#include <algorithm>
#include <utility>

#include "contact/files/axes.hpp"
#include "contact/files/rows.hpp"
#include "contact/motion/turning.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

std::vector<double> flat(const Matrix& x) { return {x.data(), x.data() + x.size()}; }

}  // namespace

double least_bytes(const MotionSource& source, const RecorderOptions& options, std::int64_t samples) {
  const Model* const model = source.modes();
  const double rows = samples / options.every, bodies = std::ssize(source.bodies());
  double numbers = rows * (1 + (model ? 9 + 12 * bodies : 6 * bodies));
  if (!model) return sizeof(double) * numbers;
  if (const double receivers = std::ssize(model->receivers); receivers > 0)
    numbers += static_cast<double>(samples / options.receivers_every) * (1 + 9 * receivers);
  double of_gauges = 0;
  for (const Bodies::Block& body : model->bodies)
    for (const kernels::Gauge& gauge : body.kernel->gauges)
      of_gauges += static_cast<double>(kernels::stress_rows) + (gauge.strain ? 1 : 0);
  if (of_gauges > 0) numbers += static_cast<double>(samples / options.receivers_every) * (1 + of_gauges);
  if (options.snapshot_every > 0)
    numbers += static_cast<double>(samples / options.snapshot_every) * (1.0 + model->omega.size());
  return sizeof(double) * numbers;
}

Recorder::Recorder(const MotionSource& source, const StepOptions& step, const RecorderOptions& options)
    : source_(source),
      step_(step.step),
      turns_(source.modes() && step.rigid.rotation == Rotation::finite),
      every_(options.every),
      snapshot_every_(options.snapshot_every),
      file_(options.path) {
  file_.attribute("/", "format", "ricochet-result");
  file_.attribute("/", "version", turns_ ? 2 : 1);
  file_.attribute("/", "title", options.title);
  file_.attribute("/", "scene", options.scene);
  file_.attribute("/", "created_by", options.created_by);
  const std::size_t m = source_.gap().size();
  file_.write<double>("/contact/initial_gap", flat(source_.gap()), {m}, "m");
  file_.attribute("/contact", "step", step_ * static_cast<double>(every_));
  if (source_.area().size() > 0) file_.write<double>("/contact/area", flat(source_.area()), {m}, "m^2");
  time_ = &file_.rows("/time", {}, "s");
  if (turns_)
    entries_.emplace(file_, *source_.modes());
  else
    contact_ = {&file_.rows("/contact/time", {}, "s"), &file_.rows("/contact/force", {m}, "N"),
                &file_.rows("/contact/gap", {m}, "m")};
  for (const MotionSource::Body& body : source_.bodies()) {
    const std::string group = "/bodies/" + body.name;
    file_.group(group);
    file_.attribute(group, "mass", body.mass);
    bodies_.push_back({.velocity = &file_.rows(group + "/velocity", {3}, "m/s"),
                       .momentum = &file_.rows(group + "/momentum", {3}, "kg m/s")});
  }
  if (const Model* const places = source_.places()) {
    write_points(*places);
    const std::vector<ObstacleSurface> obstacles = obstacle_surfaces(*places);
    write_obstacles(file_, obstacles);
    obstacle_rows_.emplace(file_, obstacles);
    if (source_.modes() && snapshot_every_ > 0) snapshots_.emplace(file_, *places, turns_, obstacles);
    for (std::size_t k = 0; k < places->bodies.size(); ++k)
      if (std::ranges::count(source_.bodies(), places->bodies[k].name, &MotionSource::Body::name) > 0)
        write_place(places->bodies[k], k, options);
  }
  if (step.contact.scheme != Scheme::impulse || source_.modes())
    persistency_ = &file_.rows("/contact/persistency", {}, "W");
  if (const Model* const model = source_.modes()) add_model_rows(*model, step, options);
  if (step.contact.scheme == Scheme::at_rest) return;
  time_->append(0);
  const std::optional<Turning> turning =
      source_.modes() ? initial_turning(*source_.modes(), step) : std::nullopt;
  bodies_row(source_.initial_state(), turning ? turning->poses : std::vector<Pose>(), 0, 0);
  if (obstacle_rows_) obstacle_rows_->append(0);
  if (persistency_) persistency_->append(0);
}

Recorder::Recorder(const Model& model, const RecorderOptions& options)
    : Recorder(model, {.contact = {.scheme = Scheme::at_rest}}, options) {}

void Recorder::record(const Equilibrium& equilibrium) {
  const Model& model = *source_.modes();
  time_->append(equilibrium.time);
  push(model, equilibrium.force, 1);  // for one second, so that impulses are forces
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Bodies::Block& body = model.bodies[k];
    Vector3d load = bodies_[k].contact_impulse + body.weight;
    for (const Model::Forcing& one : model.forcing)
      if (one.body == static_cast<int>(k)) load += one.history.at(equilibrium.time) * one.total;
    for (Rows* const rows : {bodies_[k].velocity, bodies_[k].momentum, bodies_[k].angular_momentum})
      append(rows, Vector3d::Zero());
    append(bodies_[k].reaction, body.supported ? Vector3d(-load) : Vector3d::Zero());
    bodies_[k].contact_impulse.setZero();
  }
  obstacle_rows_->append(equilibrium.time);
  energy_->append(equilibrium.energy);
  persistency_->append(0);
  if (equilibrium.active > 0) {
    contact_row(equilibrium.time, equilibrium.displacement, equilibrium.force);
    sides_row(sides_->at_rest(equilibrium));
    friction_row(equilibrium.displacement, equilibrium.force, equilibrium.states);
  }
  if (snapshots_) snapshots_->append(equilibrium.time, equilibrium.q, equilibrium.force, nullptr);
  if (gauge_rows_) gauge_rows_->record(equilibrium.time, equilibrium.q, equilibrium.force);
}

void Recorder::write_points(const Model& model) {
  const std::size_t m = model.gap.size();
  file_.write<double>("/contact/point_a", flat(model.point_a), {m, 3}, "m");
  file_.write<double>("/contact/point_b", flat(model.point_b), {m, 3}, "m");
  file_.write<double>("/contact/normal", flat(model.normal), {m, 3}, "1");
  std::vector<double> number(m);
  for (std::size_t p = 0; p < model.pairs.size(); ++p)
    std::fill_n(number.begin() + model.pairs[p].first_point, model.pairs[p].points, p + 1);
  file_.write<double>("/contact/pair", number, {m}, "1");
}

void Recorder::write_place(const Bodies::Block& body, std::size_t number, const RecorderOptions& options) {
  const std::string group = "/bodies/" + body.name;
  file_.attribute(group, "kernel", number < options.kernel_files.size() ? options.kernel_files[number] : "");
  file_.attribute(group, "rotation", flat(Matrix(body.rotation)));
  file_.attribute(group, "translation", flat(Vector(body.translation)));
}

/// Adds the rows of quantities that only modes give, also for t = 0.
void Recorder::add_model_rows(const Model& model, const StepOptions& step, const RecorderOptions& options) {
  const auto m = static_cast<std::size_t>(model.points());
  receivers_.emplace(model, step);
  if (!turns_) {
    sides_.emplace(model, step);
    contact_.displacement_a = &file_.rows("/contact/displacement_a", {m}, "m");
    contact_.displacement_b = &file_.rows("/contact/displacement_b", {m}, "m");
    contact_.velocity_a = &file_.rows("/contact/velocity_a", {m}, "m/s");
    contact_.velocity_b = &file_.rows("/contact/velocity_b", {m}, "m/s");
  }
  if (!turns_ && !model.friction.empty()) {
    contact_.tangential_force = &file_.rows("/contact/tangential_force", {m, 3}, "N");
    contact_.tangential_displacement = &file_.rows("/contact/tangential_displacement", {m, 3}, "m");
    contact_.state = &file_.rows("/contact/state", {m}, "1");
  }
  energy_.emplace(file_);
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const std::string group = "/bodies/" + model.bodies[k].name;
    bodies_[k].angular_momentum = &file_.rows(group + "/angular_momentum", {3}, "kg m^2/s");
    bodies_[k].reaction = &file_.rows(group + "/reaction", {3}, "N");
    if (!turns_) continue;
    bodies_[k].pose.emplace(file_, group);
    bodies_[k].spin = &file_.rows(group + "/spin", {3}, "rad/s");
  }
  if (has_gauges(model)) gauge_rows_.emplace(file_, model, step, options.receivers_every);
  if (!model.receivers.empty()) receiver_rows_.emplace(file_, model, step, options.receivers_every);
  if (step.contact.scheme == Scheme::at_rest) return;
  energy_->append(initial_energy(model));
  if (snapshots_) {
    const std::optional<Turning> turning = initial_turning(model, step);
    snapshots_->append(0, model.q0, Vector::Zero(model.rows()), turning ? &*turning : nullptr);
  }
  if (receiver_rows_) receiver_rows_->record(*receivers_);
}

void Recorder::record(const Stepper& stepper) {
  const std::int64_t k = stepper.steps();
  const double t = stepper.time();
  const Model* const model = source_.modes();
  const bool touching = (stepper.force().array() > 0).any();
  if (model && touching) push(frames_of(*model, stepper), stepper.force(), step_);
  if (touching && k % every_ == 0) {
    if (entries_)
      entries_->append(stepper);
    else
      contact_row(t, stepper.displacement(), stepper.force());
    if (sides_) {
      sides_row(sides_->after(stepper));
      friction_row(stepper.displacement(), stepper.force(), stepper.slip().states());
    }
  }
  if (sides_) sides_->pass(stepper);
  if (!stepper.at_sample()) return;
  const std::int64_t sample = k / stepper.options().steps_per_sample;
  if (sample % every_ == 0) {
    time_->append(t);
    if (persistency_) persistency_->append(stepper.persistency());
    bodies_row(source_.state(stepper), stepper.poses(), static_cast<double>(last_row_) * step_, t);
    if (obstacle_rows_) obstacle_rows_->append(t);
    if (energy_) energy_->append(stepper.modal()->energy());
    last_row_ = k;
  }
  if (!model) return;
  if (snapshots_ && sample % snapshot_every_ == 0)
    snapshots_->append(t, stepper.modal()->q, stepper.end_force(), stepper.turning());
  receivers_->observe(stepper);
  if (receiver_rows_) receiver_rows_->record(*receivers_);
  if (gauge_rows_) gauge_rows_->record(stepper);
}

/// Adds the impulses that `force` (n) exerts on the bodies in `duration` [s].
void Recorder::push(const RowFrames& frames, const Vector& force, double duration) {
  const Model& model = *source_.modes();
  for (const Model::PairBlock& pair : model.pairs) {
    const Vector3d impulse = duration * model.resultant(pair, force, frames);
    bodies_[pair.a].contact_impulse -= impulse;
    if (pair.b >= 0) bodies_[pair.b].contact_impulse += impulse;
  }
}

/// @param from  time of the previous row, or `to` in the first row
void Recorder::bodies_row(const Vector& state, std::span<const Pose> poses, double from, double to) {
  const Model* const model = source_.modes();
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    BodyRows& rows = bodies_[k];
    const Vector3d momentum = source_.momentum(static_cast<int>(k), state, to);
    append(rows.velocity, momentum / source_.bodies()[k].mass);
    append(rows.momentum, momentum);
    if (!model) continue;
    const Bodies::Block& body = model->bodies[k];
    Vector3d reaction = Vector3d::Zero();
    if (body.supported && to > from) {
      Vector3d impulse = rows.contact_impulse + (to - from) * body.weight;
      for (const Model::Forcing& one : model->forcing)
        if (one.body == static_cast<int>(k)) impulse += one.history.integral(from, to) * one.total;
      reaction = (momentum - rows.last_momentum - impulse) / (to - from);
    }
    append(rows.angular_momentum, source_.angular_momentum(static_cast<int>(k), state, to, poses));
    if (rows.pose) {
      rows.pose->append(poses[k]);
      append(rows.spin, poses[k].spin);
    }
    append(rows.reaction, reaction);
    rows.last_momentum = momentum;
    rows.contact_impulse.setZero();
  }
}

void Recorder::contact_row(double time, const Vector& u, const Vector& force) {
  contact_.time->append(time);
  append(contact_.force, force.head(source_.gap().size()));
  append(contact_.gap, source_.gap() - u.head(source_.gap().size()));
}

/// Forces τ on b, displacements of a relative to b, and states of all points; 0 for points without friction.
void Recorder::friction_row(const Vector& w, const Vector& force, std::span<const ContactState> states) {
  if (contact_.state == nullptr) return;
  const Model& model = *source_.modes();
  const Eigen::Index m = model.points();
  Matrix pushed = Matrix::Zero(m, 3), moved = pushed;
  Vector state = Vector::Zero(m);
  for (std::size_t f = 0; f < states.size(); ++f) {
    const auto& [point, row, law] = model.friction[f];
    const auto tangents = model.tangent.middleRows(row - m, 2);
    pushed.row(point) = force.segment<2>(row).transpose() * tangents;
    moved.row(point) = w.segment<2>(row).transpose() * tangents;
    state(point) = static_cast<double>(states[f]);
  }
  contact_.tangential_force->append(std::span<const double>(pushed.data(), pushed.size()));
  contact_.tangential_displacement->append(std::span<const double>(moved.data(), moved.size()));
  append(contact_.state, state);
}

void Recorder::sides_row(const SidesMotion& sides) {
  append(contact_.displacement_a, sides.displacement_a);
  append(contact_.displacement_b, sides.displacement_b);
  append(contact_.velocity_a, sides.velocity_a);
  append(contact_.velocity_b, sides.velocity_b);
}

void Recorder::record(const std::map<std::string, StressEnvelope>& envelopes) {
  for (const auto& [body, envelope] : envelopes) {
    const auto add = [&](const std::string& name, const StressEnvelope::Largest& largest) {
      const std::string dataset = "/stress/" + body + "/" + name;
      file_.write(dataset, largest.value, {largest.value.size()}, "Pa");
      file_.write(dataset + "_time", largest.time, {largest.time.size()}, "s");
    };
    add("von_mises", envelope.von_mises);
    add("principal", envelope.principal);
    add("shear", envelope.shear);
  }
}

void Recorder::commit(const std::string& run, const std::filesystem::path& summary) {
  if (receiver_rows_) receiver_rows_->finish();
  if (gauge_rows_) gauge_rows_->finish();
  if (!run.empty()) file_.attribute("/", "run", run);
  name_axes(file_, turns_);
  file_.commit(summary);
}

}  // namespace ricochet::contact
