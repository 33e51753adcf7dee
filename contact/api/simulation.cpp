// SPDX-License-Identifier: BSD-2-Clause
#include <algorithm>
#include <atomic>

#include "contact/api/scene_model.hpp"
#include "contact/figures/rigid_motion.hpp"
#include "contact/motion/floating_body.hpp"
#include "contact/stepping/run_steps.hpp"
#include "contact/stepping/stepper.hpp"
#include "kernels/read.hpp"
#include "kernels/write.hpp"
#include "ricochet/ricochet.hpp"

namespace ricochet {
namespace {

using Eigen::Vector3d;

Vector3 array(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::vector<ContactPoint> points_of(const contact::Model& model) {
  std::vector<ContactPoint> out;
  for (std::size_t k = 0; k < model.pairs.size(); ++k)
    for (int i = 0; i < model.pairs[k].points; ++i) {
      const Eigen::Index row = model.pairs[k].first_point + i;
      out.push_back({k, array(model.point_a.row(row)), array(model.point_b.row(row)),
                     array(model.normal.row(row)), model.gap(row), model.area(row)});
    }
  return out;
}

std::span<const double> span_of(const contact::Vector& v) noexcept {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

std::uint64_t next_identity() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

SharedKernel load_kernel(const std::filesystem::path& path) {
  return std::make_shared<const kernels::Kernel>(kernels::read(path));
}

void save_kernel(const kernels::Kernel& kernel, const std::filesystem::path& path) {
  kernels::write(kernel, path);
}

struct Simulation::Impl {
  explicit Impl(const Scene& scene)
      : shared(contact::fold(std::make_shared<const contact::Model>(model_of(scene)), step_options(scene))),
        stepper(contact::make_stepper(shared, step_options(scene))),
        force(stepper->force().head(stepper->points())),
        rubbing(stepper->force().tail(stepper->force().size() - force.size())),
        tangential_force(contact::Matrix::Zero(force.size(), 3)),
        pickups(pickups_of(scene, model)),
        turning(turning_pickups_of(scene, model)),
        rigid(model),
        points(points_of(model)) {
    for (const Body& body : scene.bodies) kernels.push_back(body.kernel);
    touching.reserve(points.size());
    for (const TurningPickup& pickup : turning) pickups_at_start.push_back(place_of(pickup));
  }

  int per_sample() const noexcept { return stepper->options().steps_per_sample; }
  std::int64_t samples() const noexcept { return stepper->steps() / per_sample(); }

  /// Adds the force of the last contact step to the mean over the sample.
  void add_force() noexcept {
    if (begins_sample) {
      force.setZero();
      rubbing.setZero();
    }
    force += stepper->force().head(force.size()) / per_sample();
    rubbing += stepper->force().tail(rubbing.size()) / per_sample();
    begins_sample = stepper->at_sample();
    if (begins_sample) turn_to_world();
  }

  /// Computes the tangential forces of the points from those along their tangents.
  void turn_to_world() noexcept {
    const Eigen::Index m = force.size();
    const contact::Matrix& tangent = contact::frames_of(model, *stepper).tangent;
    for (const contact::Model::FrictionPoint& point : model.friction)
      tangential_force.row(point.point).noalias() =
          rubbing.segment<2>(point.tangential - m).transpose() * tangent.middleRows<2>(point.tangential - m);
  }

  std::span<const Touching> find_touching() noexcept {
    touching.clear();
    const contact::RowFrames& frames = contact::frames_of(model, *stepper);
    for (Eigen::Index i = 0; i < force.size(); ++i) {
      if (!(force(i) > 0)) continue;
      const Vector3d pushed = force(i) * frames.normal.row(i) + tangential_force.row(i);
      touching.push_back({static_cast<std::size_t>(i), array(frames.point_a.row(i)),
                          array(frames.normal.row(i)), array(pushed)});
    }
    return touching;
  }

  /// Writes row k from the last sample.
  void write_forces(const Block& out, std::int64_t k) const noexcept {
    const Eigen::Index m = force.size();
    if (out.total_force) out.total_force[k] = force.sum();
    if (out.force) std::copy_n(force.data(), m, out.force + k * m);
    if (out.displacement) std::copy_n(stepper->displacement().data(), m, out.displacement + k * m);
    if (out.tangential_force) std::copy_n(tangential_force.data(), 3 * m, out.tangential_force + 3 * k * m);
  }

  /// The part of the motion of a pickup that moving supports give to the modes. Blocks of steps in which one
  /// moves are advanced step by step.
  double velocity_of_supports(Eigen::Index pickup) const noexcept {
    const contact::ModalState& state = *stepper->modal();
    return state.forcing.any() ? pickups.row(pickup).dot(state.now.lift) : 0;
  }
  double displacement_of_supports(Eigen::Index pickup) const noexcept {
    double sum = 0;
    for (const contact::Model::Forcing& one : model.forcing)
      if (one.support)
        sum += one.history.at(stepper->time()) *
               pickups.row(pickup).segment(one.first_mode, one.lift.size()).dot(one.lift);
    return sum;
  }

  /// Elastic displacement, or its rate, of a pickup on a body that turns, in the axes of the body.
  /// @param driven  the factor of supports, or its rate
  Eigen::Vector3d elastic(const TurningPickup& pickup, const contact::Vector& modal,
                          double (contact::History::*driven)(double) const noexcept) const noexcept {
    const contact::Bodies::Block& body = model.bodies[pickup.body];
    const Eigen::Index count = body.modes - body.frame_modes();
    Eigen::Vector3d out =
        pickup.shape.rightCols(count) * modal.segment(body.first_mode + body.frame_modes(), count);
    for (const contact::Model::Forcing& one : model.forcing)
      if (one.support && one.first_mode == body.first_mode)
        out += (one.history.*driven)(stepper->time()) * (pickup.shape * one.lift);
    return out;
  }
  /// Its arm from the centre and its rate, body axes.
  Eigen::Vector3d arm(const TurningPickup& pickup) const noexcept {
    return pickup.place + elastic(pickup, stepper->modal()->q, &contact::History::at);
  }
  /// Its place along its direction [m], and the rate [m/s].
  double place_of(const TurningPickup& pickup) const noexcept {
    return pickup.direction.dot(stepper->poses()[pickup.body].at(arm(pickup)));
  }
  double rate_of(const TurningPickup& pickup) const noexcept {
    return pickup.direction.dot(stepper->poses()[pickup.body].velocity_at(
        arm(pickup), elastic(pickup, stepper->turning()->rates, &contact::History::slope)));
  }
  /// @param v  (N) modal rates, those of the present with finite rotations
  double velocity(std::size_t pickup, const double* v) const noexcept {
    if (!turning.empty()) return rate_of(turning[pickup]);
    const auto row = static_cast<Eigen::Index>(pickup);
    return pickups.row(row).dot(Eigen::Map<const contact::Vector>(v, pickups.cols())) +
           velocity_of_supports(row);
  }

  /// Writes the rows of velocities of the samples between contact steps `from` and `to` of the block: the
  /// steps through which the state was last advanced.
  void write_velocities(const Block& out, std::int64_t from, std::int64_t to) const noexcept {
    if (!out.velocity) return;
    const Eigen::Index p = pickups.rows();
    for (std::int64_t row = from / per_sample(); (row + 1) * per_sample() <= to; ++row) {
      const auto back = static_cast<int>(to - (row + 1) * per_sample());
      for (Eigen::Index i = 0; i < p; ++i)
        out.velocity[row * p + i] = velocity(static_cast<std::size_t>(i), stepper->rate(back));
    }
  }

  void clear(const Block& out, std::int64_t from, std::int64_t to) const noexcept {
    const Eigen::Index m = force.size(), p = pickups.rows();
    const auto rows = [&](double* values, std::int64_t columns) {
      if (values) std::fill(values + from * columns, values + to * columns, 0.0);
    };
    rows(out.velocity, p);
    rows(out.total_force, 1);
    rows(out.force, m);
    rows(out.displacement, m);
    rows(out.tangential_force, 3 * m);
  }

  std::uint64_t identity = next_identity();
  std::vector<SharedKernel> kernels;  ///< the model contains pointers to them
  std::shared_ptr<const contact::Model> shared;
  const contact::Model& model = *shared;
  std::unique_ptr<contact::Stepper> stepper;
  contact::Vector force;             ///< (m) mean over the sample
  contact::Vector rubbing;           ///< (n − m) mean of the forces along the tangents over the sample
  contact::Matrix tangential_force;  ///< (m,3) of the last sample, world
  bool begins_sample = true;
  contact::Matrix pickups;             ///< (p,N)
  std::vector<TurningPickup> turning;  ///< (p) with finite rotations
  std::vector<double> pickups_at_start;
  contact::RigidMotions rigid;
  std::vector<ContactPoint> points;
  std::vector<Touching> touching;
};

struct Simulation::State::Impl {
  std::uint64_t identity;
  std::unique_ptr<contact::Stepper> stepper;
  contact::Vector force, rubbing;
};

Simulation::Simulation(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

StepStatus Simulation::step() noexcept {
  const FlushDenormals scope;
  StepStatus status = StepStatus::ok;
  do {
    status = impl_->stepper->step();
    if (status == StepStatus::ok) impl_->add_force();
  } while (status == StepStatus::ok && !impl_->stepper->at_sample());
  return status;
}

// The state is advanced a block at a time unless displacements are requested after each step.
BlockResult Simulation::step_block(std::int64_t steps, const Block& out) noexcept {
  const FlushDenormals scope;
  contact::Stepper& stepper = *impl_->stepper;
  const std::int64_t first = stepper.steps(), per_sample = impl_->per_sample();
  std::int64_t heard = 0;
  const auto made = [&] { return (stepper.steps() - first) / per_sample; };
  const auto hear = [&] {
    impl_->write_velocities(out, heard, stepper.steps() - first);
    heard = stepper.steps() - first;
  };
  stepper.keep(out.displacement != nullptr, out.velocity != nullptr);
  StepStatus status = contact::run_steps(stepper, steps * per_sample, [&](std::int64_t) {
                        impl_->add_force();
                        if (stepper.at_sample()) impl_->write_forces(out, made() - 1);
                        if (stepper.pending() == 0) hear();
                      }).status;
  if (stepper.catch_up() != StepStatus::ok) status = StepStatus::not_finite;
  hear();
  stepper.keep(true, false);
  if (status != StepStatus::ok) impl_->clear(out, made(), steps);
  return {made(), status};
}

std::int64_t Simulation::steps() const noexcept { return impl_->samples(); }
double Simulation::time() const noexcept { return impl_->stepper->time(); }

std::span<const ContactPoint> Simulation::points() const noexcept { return impl_->points; }
std::span<const double> Simulation::force() const noexcept { return span_of(impl_->force); }
std::span<const double> Simulation::displacement() const noexcept {
  return span_of(impl_->stepper->displacement()).first(static_cast<std::size_t>(impl_->force.size()));
}
std::span<const double> Simulation::tangential_force() const noexcept {
  return {impl_->tangential_force.data(), static_cast<std::size_t>(impl_->tangential_force.size())};
}
std::span<const Touching> Simulation::contacts() noexcept { return impl_->find_touching(); }
int Simulation::active() const noexcept { return impl_->stepper->active(); }

std::size_t Simulation::pickups() const noexcept { return static_cast<std::size_t>(impl_->pickups.rows()); }
double Simulation::pickup_velocity(std::size_t pickup) const noexcept {
  return impl_->velocity(pickup, impl_->stepper->modal()->v.data());
}
double Simulation::pickup_displacement(std::size_t pickup) const noexcept {
  if (!impl_->turning.empty())
    return impl_->place_of(impl_->turning[pickup]) - impl_->pickups_at_start[pickup];
  const auto row = static_cast<Eigen::Index>(pickup);
  return impl_->pickups.row(row).dot(impl_->stepper->modal()->q) + impl_->displacement_of_supports(row);
}

Vector3 Simulation::mean_velocity(std::size_t body) const noexcept {
  const Eigen::Vector3d mean =
      impl_->model.momentum(static_cast<int>(body), impl_->stepper->modal()->v, time()) /
      impl_->model.bodies[body].mass;
  return array(mean);
}

BodyMotion Simulation::body_motion(std::size_t body) const noexcept {
  const contact::Pose pose = impl_->rigid.pose(static_cast<int>(body), *impl_->stepper);
  const Eigen::Quaterniond& q = pose.attitude;
  return {array(pose.position), {q.w(), q.x(), q.y(), q.z()}, array(pose.velocity), array(pose.spin)};
}

bool Simulation::push(std::size_t body, const Vector3& force, const Vector3& torque) noexcept {
  return impl_->stepper->push(static_cast<int>(body), {force[0], force[1], force[2]},
                              {torque[0], torque[1], torque[2]});
}

Energy Simulation::energy() const noexcept { return impl_->stepper->modal()->energy(); }

int Simulation::quasi_static_modes() const noexcept { return impl_->stepper->modal()->modes_in_residual(); }

Simulation::State Simulation::save() const {
  return State(std::make_unique<const State::Impl>(
      State::Impl{impl_->identity, impl_->stepper->clone(), impl_->force, impl_->rubbing}));
}

// Assigns to the stepper instead of replacing it, so that its arrays keep their memory and capacity.
bool Simulation::restore(const State& state) noexcept {
  if (!state.impl_ || state.impl_->identity != impl_->identity) return false;
  impl_->stepper->assign(*state.impl_->stepper);
  impl_->force = state.impl_->force;
  impl_->rubbing = state.impl_->rubbing;
  impl_->turn_to_world();
  impl_->begins_sample = true;
  return true;
}

Simulation::State::State(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Simulation::State::~State() = default;
Simulation::State::State(State&&) noexcept = default;
Simulation::State& Simulation::State::operator=(State&&) noexcept = default;

}  // namespace ricochet
