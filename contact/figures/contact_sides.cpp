// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/contact_sides.hpp"

namespace ricochet::contact {

ContactSides::ContactSides(const Model& model, const StepOptions& options)
    : model_(model), options_(options), before_{.q = model.q0, .p = Vector::Zero(model.rows())} {
  const Eigen::Index m = model.points();
  for (Vector* x : {&before_a_, &before_b_, &motion_.displacement_a, &motion_.displacement_b,
                    &motion_.velocity_a, &motion_.velocity_b})
    x->setZero(m);
  pressed_.reserve(static_cast<std::size_t>(model.rows()));
  if (options.contact.scheme != Scheme::impulse) springs_ = model.springs();
  share_a_.setZero(m);
  const Vector flexibility = model.patch_flexibility(), of_a = model.patch_flexibility_of_a();
  for (Eigen::Index i = 0; i < m; ++i)
    if (flexibility(i) > 0) share_a_(i) = of_a(i) / flexibility(i);
  s_a_ = model.static_a.head(m);
  s_b_ = s_a_ - model.static_displacement.head(m);
  driven_a_.setZero(m, model.forcing.size());
  driven_b_ = driven_a_;
  for (std::size_t d = 0; d < model.forcing.size(); ++d) {
    driven_a_.col(d) = model.forcing[d].displacement_a.head(m);
    driven_b_.col(d) = (model.forcing[d].displacement_a - model.forcing[d].displacement).head(m);
  }
}

/// a = B_a q and b = B_b q, with B = B_a − B_b. A half-space does not move.
void ContactSides::along(const Vector& q, Vector& a, Vector& b) const noexcept {
  for (const Model::PairBlock& pair : model_.pairs) {
    const auto part = [&](int body, double sign, Vector& out) {
      const Bodies::Block& block = model_.bodies[body];
      out.segment(pair.first_point, pair.points).noalias() =
          sign * (model_.B.block(pair.first_point, block.first_mode, pair.points, block.modes) *
                  q.segment(block.first_mode, block.modes));
    };
    part(pair.a, 1, a);
    if (pair.b >= 0)
      part(pair.b, -1, b);
    else
      b.segment(pair.first_point, pair.points).setZero();
  }
}

void ContactSides::displacement(double time, const Vector& q, const Vector& p, Vector& a,
                                Vector& b) noexcept {
  along(q, a, b);
  a += s_a_;
  b += s_b_;
  pressed_.clear();
  for (Eigen::Index j = 0; j < p.size() && options_.contact.scheme != Scheme::impulse; ++j)
    if (p(j) != 0) pressed_.push_back(static_cast<int>(j));
  const Matrix& R_a = model_.residual_of_a();
  for (Eigen::Index i = 0; i < a.size() && !pressed_.empty(); ++i) {
    double of_a = 0, of_both = 0;
    for (const int j : pressed_) {
      of_a += R_a(i, j) * p(j);
      of_both += model_.R(i, j) * p(j);
    }
    a(i) -= of_a;
    b(i) += of_both - of_a;
  }
  for (std::size_t k = 0; k < springs_.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (!(springs_[k].bulge > 0) || !(p(i) > 0)) continue;
    const double s = springs_[k].displacement(p(i));
    a(i) -= share_a_(i) * s;
    b(i) += (1 - share_a_(i)) * s;
  }
  for (std::size_t d = 0; d < model_.forcing.size(); ++d) {
    const double value = model_.forcing[d].history.at(time);
    a += value * driven_a_.col(d);
    b += value * driven_b_.col(d);
  }
}

const SidesMotion& ContactSides::after(const Stepper& stepper) noexcept {
  time_ = stepper.time();
  const ModalState& state = *stepper.modal();
  displacement(time_, state.q, stepper.end_force(), motion_.displacement_a, motion_.displacement_b);
  if (options_.contact.scheme == Scheme::impulse) {
    along(state.v, motion_.velocity_a, motion_.velocity_b);
    for (std::size_t d = 0; d < model_.forcing.size(); ++d) {
      const double slope = model_.forcing[d].history.slope(time_);
      motion_.velocity_a += slope * driven_a_.col(d);
      motion_.velocity_b += slope * driven_b_.col(d);
    }
    return motion_;
  }
  if (!knows_displacement_) displacement(before_.time, before_.q, before_.p, before_a_, before_b_);
  knows_displacement_ = true;
  motion_.velocity_a = (motion_.displacement_a - before_a_) / options_.step;
  motion_.velocity_b = (motion_.displacement_b - before_b_) / options_.step;
  return motion_;
}

void ContactSides::pass(const Stepper& stepper) noexcept {
  if (options_.contact.scheme == Scheme::impulse) return;
  before_.time = stepper.time();
  before_.q = stepper.modal()->q;
  before_.p = stepper.end_force();
  knows_displacement_ = time_ == before_.time;
  if (!knows_displacement_) return;
  before_a_ = motion_.displacement_a;
  before_b_ = motion_.displacement_b;
}

const SidesMotion& ContactSides::at_rest(const Equilibrium& equilibrium) noexcept {
  displacement(equilibrium.time, equilibrium.q, equilibrium.force, motion_.displacement_a,
               motion_.displacement_b);
  return motion_;
}

}  // namespace ricochet::contact
