#include "contact/recorder.hpp"

#include <numbers>

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

std::vector<double> flat(const Matrix& x) { return {x.data(), x.data() + x.size()}; }
std::vector<double> flat(const Vector& x) { return {x.data(), x.data() + x.size()}; }

void append(kernels::hdf5::Rows* rows, const Eigen::Ref<const Vector>& row) {
  rows->append(std::span<const double>(row.data(), static_cast<std::size_t>(row.size())));
}

/// The initial state has no integrator: its energy is that of q0, v0.
Energy initial_energy(const Model& model) {
  Energy out;
  out.kinetic = 0.5 * model.v0.squaredNorm();
  out.strain = 0.5 * (model.omega.array() * model.q0.array()).square().sum();
  return out;
}

}  // namespace

Recorder::Recorder(const Model& model, double step, const RecorderOptions& options)
    : model_(model),
      step_(step),
      every_(options.every),
      snapshot_every_(options.snapshot_every),
      file_(options.path),
      B_a_(Matrix::Zero(model.B.rows(), model.B.cols())),
      R_a_(Matrix::Zero(model.R.rows(), model.R.cols())),
      s_a_(model.static_a) {
  for (const Model::PairBlock& pair : model.pairs) {
    const Model::BodyBlock& a = model.bodies[pair.a];
    B_a_.block(pair.first_point, a.first_mode, pair.points, a.modes) =
        model.B.block(pair.first_point, a.first_mode, pair.points, a.modes);
  }
  write_setting(options);
  make_rows();
  time_->append(0);
}

Recorder::Recorder(const Model& model, const StepOptions& step, const RecorderOptions& options)
    : Recorder(model, step.step, options) {
  if (step.scheme == Scheme::compliant) {
    R_a_ = model.R_a;
    // The integrator moves modes above half the rate into R and s; a's share of them follows.
    for (Eigen::Index n = 0; n < model.omega.size(); ++n)
      if (model.omega(n) * step.step > std::numbers::pi) {
        const double stiffness = model.omega(n) * model.omega(n);
        R_a_ += B_a_.col(n) * model.B.col(n).transpose() / stiffness;
        s_a_ += B_a_.col(n) * (model.load(n) / stiffness);
      }
  }
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Model::BodyBlock& body = model_.bodies[k];
    bodies_[k].last_momentum = body.momentum * model.v0.segment(body.first_mode, body.modes);
    bodies_[k].contact_impulse.setZero();
  }
  bodies_row(model.v0, 0);
  energy_row(initial_energy(model), 0);
  if (snapshot_every_ > 0) snapshot_row(0, model.q0);
}

Recorder::Recorder(const Model& model, const Equilibrium& equilibrium, const RecorderOptions& options)
    : Recorder(model, 0.0, options) {
  R_a_ = model.R_a;
  const Vector rest = Vector::Zero(model.omega.size());
  push(equilibrium.force, 1);  // for a second, in which momentum does not change
  bodies_row(rest, 1);
  energy_row(equilibrium.energy, 0);
  if (equilibrium.active > 0)
    contact_row(0, equilibrium.q, rest, equilibrium.displacement, equilibrium.force);
  if (snapshot_every_ > 0) snapshot_row(0, equilibrium.q);
}

void Recorder::write_setting(const RecorderOptions& options) {
  file_.attribute("/", "format", "ricochet-result");
  file_.attribute("/", "version", 1);
  file_.attribute("/", "title", options.title);
  file_.attribute("/", "scene", options.scene);
  file_.attribute("/", "created_by", options.created_by);
  for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
    const Model::BodyBlock& body = model_.bodies[k];
    const std::string group = "/bodies/" + body.name;
    file_.group(group);
    file_.attribute(group, "kernel", k < options.kernel_files.size() ? options.kernel_files[k] : "");
    const Matrix rotation = body.rotation;
    file_.attribute(group, "rotation", flat(rotation));
    file_.attribute(group, "translation", flat(Vector(body.translation)));
    file_.attribute(group, "mass", body.mass);
  }
  const std::size_t m = static_cast<std::size_t>(model_.gap.size());
  file_.write<double>("/contact/point_a", flat(model_.point_a), {m, 3}, "m");
  file_.write<double>("/contact/point_b", flat(model_.point_b), {m, 3}, "m");
  file_.write<double>("/contact/normal", flat(model_.normal), {m, 3}, "1");
  file_.write<double>("/contact/initial_gap", flat(model_.gap), {m}, "m");
  file_.write<double>("/contact/area", flat(model_.area), {m}, "m^2");
}

void Recorder::make_rows() {
  const std::size_t m = static_cast<std::size_t>(model_.gap.size());
  time_ = &file_.rows("/time", {}, "s");
  contact_ = {&file_.rows("/contact/time", {}, "s"),
              &file_.rows("/contact/force", {m}, "N"),
              &file_.rows("/contact/gap", {m}, "m"),
              &file_.rows("/contact/displacement_a", {m}, "m"),
              &file_.rows("/contact/displacement_b", {m}, "m"),
              &file_.rows("/contact/velocity_a", {m}, "m/s"),
              &file_.rows("/contact/velocity_b", {m}, "m/s")};
  energy_ = {&file_.rows("/energy/total", {}, "J"),   &file_.rows("/energy/kinetic", {}, "J"),
             &file_.rows("/energy/strain", {}, "J"),  &file_.rows("/energy/residual", {}, "J"),
             &file_.rows("/energy/loads", {}, "J"),   &file_.rows("/energy/damping", {}, "J"),
             &file_.rows("/energy/contact", {}, "J"), &file_.rows("/contact/persistency", {}, "W")};
  if (snapshot_every_ > 0) snapshot_time_ = &file_.rows("/snapshots/time", {}, "s");
  for (const Model::BodyBlock& body : model_.bodies) {
    const std::string group = "/bodies/" + body.name;
    BodyRows rows;
    rows.velocity = &file_.rows(group + "/velocity", {3}, "m/s");
    rows.momentum = &file_.rows(group + "/momentum", {3}, "kg m/s");
    rows.angular_momentum = &file_.rows(group + "/angular_momentum", {3}, "kg m^2/s");
    rows.reaction = &file_.rows(group + "/reaction", {3}, "N");
    if (snapshot_every_ > 0)
      rows.snapshot =
          &file_.rows("/snapshots/" + body.name, {static_cast<std::size_t>(body.modes)}, "kg^1/2 m");
    bodies_.push_back(rows);
  }
}

void Recorder::record(const Integrator& integrator) {
  if (integrator.active() > 0) push(integrator.force(), step_);
  const std::int64_t k = integrator.steps();
  if (k % every_ == 0) {
    time_->append(integrator.time());
    bodies_row(integrator.v(), static_cast<double>(k - last_row_) * step_);
    energy_row(integrator.energy(), integrator.persistency());
    if (integrator.active() > 0)
      contact_row(integrator.time(), integrator.q(), integrator.v(), integrator.displacement(),
                  integrator.force());
    last_row_ = k;
  }
  if (snapshot_every_ > 0 && k % snapshot_every_ == 0) snapshot_row(integrator.time(), integrator.q());
}

/// The impulses of contact on the bodies while `force` (m) lasts for `duration` [s].
void Recorder::push(const Vector& force, double duration) {
  for (const Model::PairBlock& pair : model_.pairs) {
    const Vector3d impulse = duration * model_.normal.middleRows(pair.first_point, pair.points).transpose() *
                             force.segment(pair.first_point, pair.points);
    bodies_[pair.a].contact_impulse -= impulse;
    if (pair.b >= 0) bodies_[pair.b].contact_impulse += impulse;
  }
}

/// `elapsed` [s] since the row before; 0 for the first one.
void Recorder::bodies_row(const Vector& v, double elapsed) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Model::BodyBlock& body = model_.bodies[k];
    BodyRows& rows = bodies_[k];
    const auto rates = v.segment(body.first_mode, body.modes);
    const Vector3d momentum = body.momentum * rates;
    Vector3d reaction = Vector3d::Zero();
    if (body.supported && elapsed > 0)
      reaction = (momentum - rows.last_momentum - rows.contact_impulse) / elapsed - body.weight;
    append(rows.velocity, momentum / body.mass);
    append(rows.momentum, momentum);
    append(rows.angular_momentum, body.angular_momentum * rates);
    append(rows.reaction, reaction);
    rows.last_momentum = momentum;
    rows.contact_impulse.setZero();
  }
}

void Recorder::energy_row(const Energy& energy, double persistency) {
  energy_.total->append(energy.total());
  energy_.kinetic->append(energy.kinetic);
  energy_.strain->append(energy.strain);
  energy_.residual->append(energy.residual);
  energy_.loads->append(energy.loads);
  energy_.damping->append(energy.damping);
  energy_.contact->append(energy.contact);
  energy_.persistency->append(persistency);
}

/// u = n·u_a − n·u_b, and n·u_a = B_a q + s_a − R_a λ.
void Recorder::contact_row(double time, const Vector& q, const Vector& v, const Vector& u,
                           const Vector& force) {
  Vector u_a = B_a_ * q + s_a_ - R_a_ * force;
  const Vector v_a = B_a_ * v;
  Vector u_b = u_a - u, v_b = v_a - model_.B * v;
  for (const Model::PairBlock& pair : model_.pairs)
    if (pair.b < 0) {  // a half-space stays where it is
      u_a.segment(pair.first_point, pair.points) = u.segment(pair.first_point, pair.points);
      u_b.segment(pair.first_point, pair.points).setZero();
      v_b.segment(pair.first_point, pair.points).setZero();
    }
  contact_.time->append(time);
  append(contact_.force, force);
  append(contact_.gap, model_.gap - u);
  append(contact_.displacement_a, u_a);
  append(contact_.displacement_b, u_b);
  append(contact_.velocity_a, v_a);
  append(contact_.velocity_b, v_b);
}

void Recorder::snapshot_row(double time, const Vector& q) {
  snapshot_time_->append(time);
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    append(bodies_[k].snapshot, q.segment(model_.bodies[k].first_mode, model_.bodies[k].modes));
}

void Recorder::commit() { file_.commit(); }

}  // namespace ricochet::contact
