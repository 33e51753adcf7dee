#include "contact/output/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/atomic_file.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

// Where linear elasticity with pairs fixed in the reference configuration stops being a model of the impact.
constexpr double fastest_share = 0.02;        // of the wave speed: strains of per cents
constexpr double farthest_share = 0.5;        // of the spacing: the neighbour would be the nearer candidate
constexpr double largest_rotation_deg = 5.0;  // linear rotations lengthen a body by 1 − cos, 0.4 % here

/// Mass-mean displacement and rotation (or their rates) of a body. Supported bodies have none.
struct RigidMotion {
  Vector3d linear = Vector3d::Zero(), rotation = Vector3d::Zero(), centre = Vector3d::Zero();
  Vector3d at(const Vector3d& x) const { return linear + rotation.cross(x - centre); }
};

RigidMotion rigid_motion(const Model::BodyBlock& body, const Matrix3d& inverse_inertia, const Vector& state) {
  RigidMotion out;
  out.centre = body.centre;
  if (body.supported) return out;
  const auto modal = state.segment(body.first_mode, body.modes);
  const Vector3d linear = body.momentum * modal, angular = body.angular_momentum * modal;
  out.linear = linear / body.mass;
  out.rotation = inverse_inertia * (angular - body.centre.cross(linear));
  return out;
}

/// Rods have no inertia about their axis, or none at all.
Matrix3d pseudo_inverse(const Matrix3d& inertia) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(inertia);
  Vector3d inverse = Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    if (eigen.eigenvalues()(k) > 1e-9 * eigen.eigenvalues()(2)) inverse(k) = 1 / eigen.eigenvalues()(k);
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

std::string turned(const std::string& body, double angle) {
  return fmt::format("{} turned by {:.3g} degrees while touching (above {:g}): rotations are linearised",
                     body, angle * 180 / std::numbers::pi, largest_rotation_deg);
}

/// Bodies that come nearer than points which were left out may bring these together.
std::string beyond_reach(const Model& model, const Model::PairBlock& pair, double nearer) {
  return fmt::format(
      "{} came {:.4g} m nearer to what it touches, beyond reach = {:g} m: points that reach left out may "
      "touch, too",
      model.bodies[pair.a].name, nearer, *pair.reach);
}

/// Smallest distance of two corners of one surface element; infinite for rods.
/// @param surface  kernels::Surface or kernels::WholeSurface
template <class Any>
double spacing_of(const Any& surface) {
  double smallest = std::numeric_limits<double>::infinity();
  const std::size_t k = static_cast<std::size_t>(surface.element_corners);
  const auto node = [&](std::size_t corner) {
    return Eigen::Map<const Vector3d>(&surface.node[3 * static_cast<std::size_t>(surface.element[corner])]);
  };
  for (std::size_t t = 0; t + k <= surface.element.size(); t += k)
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < i; ++j) smallest = std::min(smallest, (node(t + i) - node(t + j)).norm());
  return smallest;
}

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json shares(const std::optional<ErrorEstimate>& estimate) {
  if (!estimate) return nullptr;
  return {{"total", estimate->total()},
          {"mesh", number(estimate->mesh)},
          {"modes", number(estimate->modes)},
          {"step", number(estimate->step)},
          {"eigensolver", number(estimate->eigensolver)},
          {"precision", number(estimate->precision)},
          {"spacing", number(estimate->spacing)}};
}

void write(const Json& json, const std::filesystem::path& path) {
  base::AtomicFile temporary(path);
  std::ofstream file(temporary.path());
  file << json.dump(2) << '\n';
  file.close();
  if (!file) temporary.fail();
  temporary.commit();
}

}  // namespace

double ErrorEstimate::total() const {
  double sum = 0;
  for (const auto& share : {mesh, modes, step, eigensolver, precision, spacing}) sum += share.value_or(0);
  return sum;
}

bool count_forces(Summary& out, bool touching, const Vector& force, double time, double step) {
  const int active = static_cast<int>((force.array() > 0).count());
  if (active == 0) {
    if (touching) out.contact_end_s = out.episodes.back().end_s = time - step;
    return false;
  }
  if (!touching) out.episodes.push_back({.start_s = time - step, .end_s = {}});
  if (!out.contact_start_s) out.contact_start_s = time - step;
  out.contact_end_s.reset();
  const double sum = force.sum();
  Episode& episode = out.episodes.back();
  episode.impulse_ns += sum * step;
  episode.peak_force_n = std::max(episode.peak_force_n, sum);
  out.impulse_ns += sum * step;
  out.peak_force_n = std::max(out.peak_force_n, sum);
  out.max_active = std::max(out.max_active, active);
  ++out.contact_steps;
  return true;
}

SummaryObserver::SummaryObserver(const Model& model, double step, double wave_speed)
    : model_(model),
      step_(step),
      wave_speed_(wave_speed),
      before_(model.initial_rates()),
      impulse_(model.pairs.size(), Vector3d::Zero()) {
  for (const Model::BodyBlock& body : model.bodies) {
    out_.modes[body.name] = body.modes;
    out_.basis[body.name] = body.kernel->modes.kind();
    inverse_inertia_.push_back(pseudo_inverse(body.inertia));
  }
  for (const Model::PairBlock& pair : model.pairs) {
    out_.unpaired += pair.unpaired;
    const kernels::Surface& surface = model.bodies[pair.a].kernel->surface;
    spacing_.push_back(surface.whole ? spacing_of(*surface.whole) : spacing_of(surface));
  }
  nearer_.assign(model.pairs.size(), 0);
  out_.candidates = static_cast<int>(model.gap.size());
  energy_before_ =
      0.5 * model.v0.squaredNorm() + 0.5 * (model.omega.array() * model.q0.array()).square().sum();
  initial_ledger_ = largest_energy_ = energy_before_;
}

void SummaryObserver::observe(const Stepper& stepper) {
  const Energy& energy = stepper.modal()->energy();
  worst_ledger_ = std::max(worst_ledger_, std::abs(energy.ledger() - initial_ledger_));
  largest_energy_ = std::max({largest_energy_, energy.kinetic + energy.strain + energy.residual,
                              std::abs(energy.loads), std::abs(energy.contact)});
  out_.modes_in_residual = stepper.modal()->modes_in_residual();
  out_.precision = stepper.options().precision;
  if (model_.gap.size() > 0)
    out_.max_penetration_m =
        std::max(out_.max_penetration_m, (stepper.displacement() - model_.gap).maxCoeff());
  out_.limited_steps = stepper.solver().limited;
  if (const SolveResidual& left = stepper.residual(); left.scale > 0)
    out_.limited_residual = std::max(out_.limited_residual, left.violation / left.scale);
  const bool untouched = !out_.contact_start_s, touched = touching_;
  touching_ = count_forces(out_, touched, stepper.force(), stepper.time(), step_);
  if (touching_ && untouched) {
    at_start_ = mean_velocities(stepper.time() - step_);
    energy_at_start_ = energy_before_;
  }
  if (touching_) {
    push(stepper.force());
    look_at_validity(stepper);
  } else if (touched) {
    at_end_ = mean_velocities(stepper.time() - step_);
  }
  energy_lost_ = energy.contact;
  energy_before_ = energy.kinetic + energy.strain;
  before_ = stepper.modal()->v;
}

/// At the end of the step before, which was at `time`.
std::vector<Vector3d> SummaryObserver::mean_velocities(double time) const {
  std::vector<Vector3d> out;
  for (std::size_t k = 0; k < model_.bodies.size(); ++k)
    out.push_back(model_.momentum(static_cast<int>(k), before_, time) / model_.bodies[k].mass);
  return out;
}

void SummaryObserver::push(const Vector& force) {
  for (std::size_t p = 0; p < impulse_.size(); ++p) {
    const Model::PairBlock& pair = model_.pairs[p];
    impulse_[p] += step_ * model_.normal.middleRows(pair.first_point, pair.points).transpose() *
                   force.segment(pair.first_point, pair.points);
  }
}

void SummaryObserver::look_at_validity(const Stepper& stepper) {
  std::vector<RigidMotion> moved, speed;
  for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
    moved.push_back(rigid_motion(model_.bodies[k], inverse_inertia_[k], stepper.modal()->q));
    speed.push_back(rigid_motion(model_.bodies[k], inverse_inertia_[k], before_));
    const double angle = moved.back().rotation.norm();
    if (angle > tilt_) {
      tilt_ = angle;
      tilted_ = model_.bodies[k].name;
    }
  }
  const auto relative = [&](const std::vector<RigidMotion>& motion, const Model::PairBlock& pair, int i) {
    Vector3d out = motion[pair.a].at(model_.point_a.row(i).transpose());
    if (pair.b >= 0) out -= motion[pair.b].at(model_.point_b.row(i).transpose());
    return out;
  };
  for (std::size_t p = 0; p < model_.pairs.size(); ++p) {
    const Model::PairBlock& pair = model_.pairs[p];
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      const bool pressed = stepper.force()(i) > 0;
      if (!pressed && !pair.reach) continue;
      const Vector3d n = model_.normal.row(i).transpose();
      nearer_[p] = std::max(nearer_[p], n.dot(relative(moved, pair, i)));
      if (!pressed) continue;
      if (out_.contact_steps == 1) approach_ = std::max(approach_, n.dot(relative(speed, pair, i)));
      const Vector3d shift = relative(moved, pair, i);
      const double slip = (shift - shift.dot(n) * n).norm();
      if (slip / spacing_[p] > slip_share_) {
        slip_ = slip;
        slip_share_ = slip / spacing_[p];
      }
    }
  }
}

std::vector<std::string> SummaryObserver::warnings() const {
  std::vector<std::string> out;
  if (wave_speed_ > 0 && approach_ > fastest_share * wave_speed_)
    out.push_back(
        fmt::format("approach speed {:.4g} m/s is {:.3g} % of the wave speed {:.4g} m/s (above {:g} %): "
                    "strains may be too "
                    "large for linear elasticity",
                    approach_, 100 * approach_ / wave_speed_, wave_speed_, 100 * fastest_share));
  if (slip_share_ > farthest_share)
    out.push_back(
        fmt::format("tangential motion {:.4g} m is {:.3g} times the candidate spacing (above {:g}): pairs "
                    "are fixed in the "
                    "initial configuration",
                    slip_, slip_share_, farthest_share));
  if (tilt_ * 180 / std::numbers::pi > largest_rotation_deg) out.push_back(turned(tilted_, tilt_));
  for (std::size_t p = 0; p < model_.pairs.size(); ++p)
    if (model_.pairs[p].reach && nearer_[p] >= *model_.pairs[p].reach)
      out.push_back(beyond_reach(model_, model_.pairs[p], nearer_[p]));
  return out;
}

Summary SummaryObserver::summary() const {
  Summary out = out_;
  out.energy_drift = largest_energy_ > 0 ? worst_ledger_ / largest_energy_ : 0;
  if (energy_at_start_ > 0)
    out.energy_lost_contact = energy_lost_ / energy_at_start_;
  else if (energy_lost_ == 0)
    out.energy_lost_contact = 0;
  out.warnings = warnings();
  if (!out.contact_end_s) return out;

  for (std::size_t k = 0; k < model_.bodies.size(); ++k)
    out.exit_velocity[model_.bodies[k].name] = at_end_[k];

  const auto touched = [](const Vector3d& impulse) { return impulse.norm() > 0; };
  if (std::count_if(impulse_.begin(), impulse_.end(), touched) != 1) return out;
  const std::size_t p = std::find_if(impulse_.begin(), impulse_.end(), touched) - impulse_.begin();
  const Model::PairBlock& pair = model_.pairs[p];
  const auto closing = [&](const std::vector<Vector3d>& mean) {
    Vector3d relative = Vector3d::Zero();
    if (!model_.bodies[pair.a].supported) relative += mean[pair.a];
    if (pair.b >= 0 && !model_.bodies[pair.b].supported) relative -= mean[pair.b];
    return relative.dot(impulse_[p].normalized());
  };
  if (closing(at_start_) > 0) out.restitution = -closing(at_end_) / closing(at_start_);
  return out;
}

namespace {

Json json_of(const Summary& summary) {
  Json episodes = Json::array(), exit_velocity = Json::object(), sounds = Json::object();
  for (const Episode& episode : summary.episodes)
    episodes.push_back({{"start_s", episode.start_s},
                        {"end_s", number(episode.end_s)},
                        {"impulse_ns", episode.impulse_ns},
                        {"peak_force_n", episode.peak_force_n}});
  for (const auto& [name, v] : summary.exit_velocity) exit_velocity[name] = {v.x(), v.y(), v.z()};
  for (const auto& [name, sound] : summary.sounds)
    sounds[name] = {
        {"file", sound.file}, {"full_scale_m_per_s", sound.full_scale_m_per_s}, {"rate_hz", sound.rate_hz}};
  return {{"contact_start_s", number(summary.contact_start_s)},
          {"contact_end_s", number(summary.contact_end_s)},
          {"contact_steps", summary.contact_steps},
          {"episodes", episodes},
          {"peak_force_n", summary.peak_force_n},
          {"impulse_ns", summary.impulse_ns},
          {"exit_velocity", exit_velocity},
          {"restitution", number(summary.restitution)},
          {"energy_drift", number(summary.energy_drift)},
          {"energy_lost_contact", number(summary.energy_lost_contact)},
          {"max_penetration_m", summary.max_penetration_m},
          {"limited_steps", summary.limited_steps},
          {"limited_residual", summary.limited_residual},
          {"modes", summary.modes},
          {"basis", summary.basis},
          {"modes_in_residual", summary.modes_in_residual},
          {"precision", summary.precision == Precision::float32 ? "single" : "double"},
          {"candidates", summary.candidates},
          {"unpaired", summary.unpaired},
          {"max_active", summary.max_active},
          {"error_estimate", shares(summary.error_estimate)},
          {"sounds", sounds},
          {"warnings", summary.warnings},
          {"real_time_factor", summary.real_time_factor},
          {"wall_s", summary.wall_s}};
}

Json json_of(const EquilibriumSummary& summary) {
  Json pairs = Json::array();
  for (const EquilibriumSummary::Pair& pair : summary.pairs)
    pairs.push_back({{"force_n", pair.force_n},
                     {"approach_m", pair.approach_m},
                     {"contact_points", pair.contact_points},
                     {"contact_area_m2", pair.contact_area_m2},
                     {"peak_pressure_pa", pair.peak_pressure_pa}});
  return {{"pairs", pairs},
          {"imbalance", summary.imbalance},
          {"max_penetration_m", summary.max_penetration_m},
          {"modes", summary.modes},
          {"candidates", summary.candidates},
          {"unpaired", summary.unpaired},
          {"iterations", summary.iterations},
          {"error_estimate", shares(summary.error_estimate)},
          {"warnings", summary.warnings},
          {"wall_s", summary.wall_s}};
}

}  // namespace

std::string json_text(const Summary& summary) { return json_of(summary).dump(); }
void write_json(const Summary& summary, const std::filesystem::path& path) { write(json_of(summary), path); }

std::string json_text(const EquilibriumSummary& summary) { return json_of(summary).dump(); }
void write_json(const EquilibriumSummary& summary, const std::filesystem::path& path) {
  write(json_of(summary), path);
}

EquilibriumSummary summarise(const Model& model, const Equilibrium& equilibrium) {
  EquilibriumSummary out;
  out.imbalance = equilibrium.imbalance;
  out.iterations = equilibrium.iterations;
  out.candidates = static_cast<int>(model.gap.size());
  if (out.candidates > 0)
    out.max_penetration_m = std::max(0.0, (equilibrium.displacement - model.gap).maxCoeff());
  for (const Model::BodyBlock& body : model.bodies) {
    out.modes[body.name] = body.modes;
    out.basis[body.name] = body.kernel->modes.kind();
    const double angle = rigid_motion(body, pseudo_inverse(body.inertia), equilibrium.q).rotation.norm();
    if (equilibrium.active > 0 && angle * 180 / std::numbers::pi > largest_rotation_deg)
      out.warnings.push_back(turned(body.name, angle));
  }
  const auto moved = [&](int k) -> Vector3d {
    const Model::BodyBlock& body = model.bodies[k];
    return body.momentum * equilibrium.q.segment(body.first_mode, body.modes) / body.mass;
  };
  for (const Model::PairBlock& pair : model.pairs) {
    EquilibriumSummary::Pair figures;
    const auto force = equilibrium.force.segment(pair.first_point, pair.points).array();
    const auto area = model.area.segment(pair.first_point, pair.points).array();
    const Vector3d sum = model.normal.middleRows(pair.first_point, pair.points).transpose() * force.matrix();
    out.unpaired += pair.unpaired;
    figures.force_n = sum.norm();
    figures.contact_points = static_cast<int>((force > 0).count());
    figures.contact_area_m2 = (force > 0).select(area, 0).sum();
    if (figures.contact_points > 0) {
      figures.peak_pressure_pa = (force / area).maxCoeff();
      const Vector3d nearer = moved(pair.a) - (pair.b < 0 ? Vector3d::Zero() : moved(pair.b));
      figures.approach_m = nearer.dot(sum.normalized());
      if (pair.reach && figures.approach_m >= *pair.reach)
        out.warnings.push_back(beyond_reach(model, pair, figures.approach_m));
    }
    out.pairs.push_back(figures);
  }
  return out;
}

}  // namespace ricochet::contact
