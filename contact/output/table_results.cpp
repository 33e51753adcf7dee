#include "contact/output/table_results.hpp"

#include <algorithm>

namespace ricochet::contact {
namespace {

std::vector<double> flat(const Matrix& x) { return {x.data(), x.data() + x.size()}; }
std::vector<double> flat(const Vector& x) { return {x.data(), x.data() + x.size()}; }

void append(base::hdf5::Rows* rows, const Vector& row) {
  rows->append(std::span<const double>(row.data(), static_cast<std::size_t>(row.size())));
}

}  // namespace

TableRecorder::TableRecorder(const Table& table, const Model* model, const Stepper& start,
                             const RecorderOptions& options)
    : initial_gap_(table.gap),
      every_(options.every),
      has_power_(start.options().scheme == Scheme::compliant),
      file_(options.path) {
  write_setting(table, model, options);
  make_rows(table);
  state_row(start);
}

void TableRecorder::write_setting(const Table& table, const Model* model, const RecorderOptions& options) {
  file_.attribute("/", "format", "ricochet-result");
  file_.attribute("/", "version", 1);
  file_.attribute("/", "title", options.title);
  file_.attribute("/", "scene", options.scene);
  file_.attribute("/", "created_by", options.created_by);
  const std::size_t m = static_cast<std::size_t>(table.points());
  file_.write<double>("/contact/initial_gap", flat(table.gap), {m}, "m");
  if (table.area.size() > 0) file_.write<double>("/contact/area", flat(table.area), {m}, "m^2");
  for (const FreeBody& body : table.bodies) {
    file_.group("/bodies/" + body.name);
    file_.attribute("/bodies/" + body.name, "mass", body.mass);
  }
  if (!model) return;
  file_.write<double>("/contact/point_a", flat(model->point_a), {m, 3}, "m");
  file_.write<double>("/contact/point_b", flat(model->point_b), {m, 3}, "m");
  file_.write<double>("/contact/normal", flat(model->normal), {m, 3}, "1");
  for (std::size_t k = 0; k < model->bodies.size(); ++k) {
    const Model::BodyBlock& body = model->bodies[k];
    if (body.supported) continue;
    const std::string group = "/bodies/" + body.name;
    file_.attribute(group, "kernel", k < options.kernel_files.size() ? options.kernel_files[k] : "");
    file_.attribute(group, "rotation", flat(Matrix(body.rotation)));
    file_.attribute(group, "translation", flat(Vector(body.translation)));
  }
}

void TableRecorder::make_rows(const Table& table) {
  const std::size_t m = static_cast<std::size_t>(table.points());
  time_ = &file_.rows("/time", {}, "s");
  contact_time_ = &file_.rows("/contact/time", {}, "s");
  force_ = &file_.rows("/contact/force", {m}, "N");
  gap_ = &file_.rows("/contact/gap", {m}, "m");
  if (has_power_) persistency_ = &file_.rows("/contact/persistency", {}, "W");
  for (const FreeBody& body : table.bodies)
    bodies_.push_back({body.mass, &file_.rows("/bodies/" + body.name + "/velocity", {3}, "m/s"),
                       &file_.rows("/bodies/" + body.name + "/momentum", {3}, "kg m/s")});
}

void TableRecorder::state_row(const Stepper& stepper) {
  time_->append(stepper.time());
  if (has_power_) persistency_->append(stepper.persistency());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Vector velocity = (*stepper.body_velocities()).col(static_cast<Eigen::Index>(b));
    append(bodies_[b].velocity, velocity);
    append(bodies_[b].momentum, bodies_[b].mass * velocity);
  }
  if (stepper.active() == 0) return;
  contact_time_->append(stepper.time());
  append(force_, stepper.force());
  append(gap_, initial_gap_ - stepper.displacement());
}

void TableRecorder::record(const Stepper& stepper) {
  if (stepper.steps() % every_ == 0) state_row(stepper);
}

void TableRecorder::commit(const std::filesystem::path& summary) { file_.commit(summary); }

TableObserver::TableObserver(const Table& table, const Stepper& start, double step, int unpaired)
    : bodies_(table.bodies),
      gap_(table.gap),
      step_(step),
      before_(*start.body_velocities()),
      at_start_(before_),
      at_end_(before_),
      impulse_(Eigen::Matrix3Xd::Zero(3, before_.cols())) {
  out_.candidates = static_cast<int>(gap_.size());
  out_.unpaired = unpaired;
}

void TableObserver::observe(const Stepper& stepper) {
  out_.max_penetration_m = std::max(out_.max_penetration_m, (stepper.displacement() - gap_).maxCoeff());
  const bool untouched = !out_.contact_start_s, touched = touching_;
  touching_ = count_forces(out_, touched, stepper.force(), stepper.time(), step_);
  if (touching_ && untouched) at_start_ = before_;
  if (touched && !touching_) at_end_ = before_;
  if (touching_)
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      impulse_.col(static_cast<Eigen::Index>(b)) += step_ * bodies_[b].push.transpose() * stepper.force();
  before_ = (*stepper.body_velocities());
}

Summary TableObserver::summary() const {
  Summary out = out_;
  if (!out.contact_end_s) return out;
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    out.exit_velocity[bodies_[b].name] = at_end_.col(static_cast<Eigen::Index>(b));
  const Eigen::Index count = impulse_.cols();
  // Two bodies that others push too have unequal impulses. 1e-9: far above the round-off of a sum of steps.
  const bool pair = count == 2 && impulse_.rowwise().sum().norm() < 1e-9 * impulse_.norm();
  if (count != 1 && !pair) return out;
  const double size = impulse_.col(0).norm();
  const auto closing = [&](const Eigen::Matrix3Xd& v) { return -v.cwiseProduct(impulse_).sum() / size; };
  if (size > 0 && closing(at_start_) > 0) out.restitution = -closing(at_end_) / closing(at_start_);
  return out;
}

}  // namespace ricochet::contact
