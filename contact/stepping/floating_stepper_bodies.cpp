// SPDX-License-Identifier: BSD-2-Clause
// Bodies that are added and removed between two steps.
#include <algorithm>
#include <numeric>

#include "contact/stepping/floating_stepper.hpp"

namespace ricochet::contact {

FloatingStepper::FloatingStepper(std::shared_ptr<const Model> model, const StepOptions& options,
                                 const FloatingStepper& earlier, const Correspondence& from)
    : FloatingStepper(std::move(model), options, &earlier.points_) {
  steps_ = earlier.steps_;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (from.body[k] < 0) {
      check_spin(state_.system->model->bodies[k].name, turning_.poses[k].spin);
      continue;
    }
    const auto then = static_cast<std::size_t>(from.body[k]);
    const int first_mode = bodies_[k].first_mode;
    bodies_[k] = earlier.bodies_[then];
    bodies_[k].first_mode = first_mode;
    bodies_[k].asleep = false;
    turning_.poses[k] = earlier.turning_.poses[then];
    turning_.pushed[k] = earlier.turning_.pushed[then];
    turning_.candidate_force[k] = earlier.turning_.candidate_force[then];
  }
  start_.bodies = bodies_;
  std::ranges::fill(slow_since_, time());
  carry(earlier.state_.q, state_.q, from.modes);
  carry(earlier.state_.v, state_.v, from.modes);
  carry(earlier.state_.now.lift, state_.now.lift, from.modes);
  carry(earlier.turning_.rates, turning_.rates, from.modes);
  for (Matrix RowFrames::*values : {&RowFrames::point_a, &RowFrames::point_b, &RowFrames::normal})
    carry(earlier.turning_.frames.*values, turning_.frames.*values, from.points);
  std::vector<Correspondence::Run> tangents;
  for (const auto& [f_then, f, count] : from.friction) tangents.push_back({2 * f_then, 2 * f, 2 * count});
  carry(earlier.turning_.frames.tangent, turning_.frames.tangent, tangents);
  for (const auto& [then, now, size] : from.points)
    for (int i = 0; i < size; ++i) law_.gap(now + i) = earlier.law_.gap(then + i);
  contact_.mean.take(earlier.contact_.mean, from);
  contact_.slip.take(earlier.contact_.slip, from);
  carry(earlier.contact_.force, contact_.force, from.rows);
  carry(earlier.next_u_, next_u_, from.rows);
  contact_.ambiguous = earlier.contact_.ambiguous;
  contact_.persistency = earlier.contact_.persistency;
  contact_.residual = earlier.contact_.residual;
  for (std::size_t p = 0; p < stored_.size(); ++p)
    if (from.pair[p] >= 0) stored_[p] = earlier.stored_[static_cast<std::size_t>(from.pair[p])];
  const std::vector<int> places = Correspondence::places(from.rows, earlier.next_u_.size());
  for (const std::vector<int>* rows : {&earlier.forced_.now, &earlier.forced_.asleep})
    for (const int then : *rows) {
      const int row = places[static_cast<std::size_t>(then)];
      if (row < 0) continue;
      forced_.now.push_back(row);
      contact_.active += row < points() && end_force()(row) > 0 ? 1 : 0;
    }
  for (int p = 0; p < islands_.pairs(); ++p) contact_.mean.let_sleep(p, false);
  points_.take(earlier.points_, from);
  loads_.take(earlier.loads_, from.body);
  state_.forcing.piece(time());
  state_.ledger = earlier.state_.ledger;
  exchange();
  search_.look_at = steps_;
  search_anew();
}

/// Enters the energies of the bodies that are there into the ledger.
void FloatingStepper::exchange() noexcept {
  for (const FloatingBody& body : bodies_) body.write_rates(state_.v);
  state_.ledger.exchange(energy_of(state_.q, state_.v, std::accumulate(stored_.begin(), stored_.end(), 0.0)));
}

void FloatingStepper::take_out(int number) noexcept {
  const Model& model = *state_.system->model;
  const auto k = static_cast<std::size_t>(number);
  wake(number);
  bool touched = false;
  for (std::size_t p = 0; p < model.pairs.size(); ++p) {
    const Model::PairBlock& pair = model.pairs[p];
    if (pair.a != number && pair.b != number) continue;
    touched = touched || contact_.mean.pairs()[p].carries;
    contact_.mean.forget(static_cast<int>(p));
    stored_[p] = 0;
    if (pair.first_tangential >= 0)
      for (int i = 0; i < pair.points; ++i) contact_.slip.forget((pair.first_tangential - points()) / 2 + i);
  }
  contact_.active = forced_.active_asleep;
  for (const int row : forced_.now) {
    const Model::PairBlock& pair =
        model.pairs[static_cast<std::size_t>(contact_.mean.pair_of_row()[static_cast<std::size_t>(row)])];
    if (pair.a == number || pair.b == number) contact_.force(row) = next_u_(row) = 0;
    contact_.active += row < points() && end_force()(row) > 0 ? 1 : 0;
  }
  bodies_[k].leave();
  for (Vector* x : {&state_.q, &state_.v, &state_.next_q, &state_.next_v, &turning_.rates})
    x->segment(bodies_[k].first_mode, bodies_[k].modes).setZero();
  turning_.poses[k] = bodies_[k].pose();
  turning_.pushed[k] = {};
  turning_.candidate_force[k].setZero();
  points_.forget(number);
  loads_.forget(number);
  exchange();
  if (touched) search_anew();
}

void FloatingStepper::put_in(int number, const std::string& name, const Pose& pose) {
  check_spin(name, pose.spin);
  const auto k = static_cast<std::size_t>(number);
  const Model& model = *state_.system->model;
  bodies_[k] = FloatingBody(model, model.bodies[k]);
  bodies_[k].move_to(pose);
  for (Vector* x : {&state_.q, &state_.v, &turning_.rates})
    x->segment(bodies_[k].first_mode, bodies_[k].modes).setZero();
  turning_.poses[k] = pose;
  slow_since_[k] = time();
  exchange();
  search_.look_at = steps_;
  search_anew();
}

}  // namespace ricochet::contact
