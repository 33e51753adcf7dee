// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/look_ahead_block.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::contact {

template <class T>
LookAheadBlock<T>::LookAheadBlock(std::shared_ptr<const BlockSystem<T>> system, bool forced)
    : system_(std::move(system)),
      near_(*system_),
      forced_(forced),
      taken_(system_->length),
      advanced_(system_->length) {
  const auto m = static_cast<std::size_t>(system_->points), L = static_cast<std::size_t>(system_->length);
  const std::size_t N = system_->modes, width = system_->width, rigid = system_->rigid.size();
  for (std::vector<double>* x : {&q_, &v_, &load_, &held_}) x->assign(N, 0.0);
  for (std::vector<double>* x : {&rigid_q_, &rigid_v_, &rigid_held_}) x->assign(rigid, 0.0);
  rigid_motion_.setZero(system_->length, static_cast<Eigen::Index>(rigid));
  rigid_at_.setZero(system_->length);
  if (forced_) forcing_.assign(2 * L * N, 0.0);
  s_ = system_->plain->s.transpose().replicate(forced_ ? system_->length + 1 : 1, 1);
  x_.assign(L * N, T(0));
  rates_.assign(L * N, 0.0);
  ahead_.assign(L * width, 0.0);
  u_.assign(L * width, 0.0);
  changes_.assign(m * L, T(0));
  for (Vector* x : {&held_force_, &margin_, &could_, &spent_, &budget_, &held_rest_, &held_push_, &rhs_,
                    &solution_, &ended_})
    x->setZero(system_->points);
  for (std::vector<char>* x : {&was_watched_, &is_predicted_, &has_changed_}) x->assign(m, 0);
  position_.assign(m, -1);
  for (std::vector<int>* x :
       {&pressed_, &predicted_, &watched_, &gathered_, &have_changed_, &changed_, &raised_})
    x->reserve(m);
  change_.reserve(m);
  factor_.reserve(std::max<std::size_t>(m, bands));
  sum_.assign(std::max(N, width), T(0));
}

template <class T>
simd::Modes LookAheadBlock<T>::modes() const {
  const BlockSystem<T>& of = *system_;
  return {of.modes,          of.stiffness.data(), load_.data(),     of.b.data(),  of.c.data(),
          of.e.data(),       of.h.data(),         of.load.data(),   held_.data(), of.origin.data(),
          of.damp_ss.data(), of.damp_sr.data(),   of.damp_rr.data()};
}

template <class T>
void LookAheadBlock<T>::set_forcing(int l, const Vector& q, const Vector& v, const Vector& s) noexcept {
  s_.row(l) = s.transpose();
  if (l == 0) return;
  double* to = &forcing_[2 * static_cast<std::size_t>(l - 1) * system_->modes];
  std::copy(q.begin(), q.end(), to);
  std::copy(v.begin(), v.end(), to + system_->modes);
}

/// Takes λ̄ into the load.
template <class T>
void LookAheadBlock<T>::hold(const Vector& force) noexcept {
  held_force_ = force;
  pressed_.clear();
  factor_.clear();
  for (int j = 0; j < system_->points; ++j) {
    if (force(j) == 0) continue;
    pressed_.push_back(j);
    factor_.push_back(static_cast<T>(force(j)));
  }
  system_->loops->combine(system_->modes, system_->B.data(), system_->modes, pressed_.data(), pressed_.size(),
                          factor_.data(), sum_.data());
  for (std::size_t n = 0; n < system_->modes; ++n) {
    held_[n] = static_cast<double>(sum_[n]);
    load_[n] = system_->load[n] - held_[n];
  }
  if (system_->yields) {
    combine(system_->residual, pressed_);
    std::copy_n(sum_.begin(), system_->points, held_rest_.begin());
  }
  for (std::size_t r = 0; r < rigid_held_.size(); ++r) {
    rigid_held_[r] = 0;
    for (int j : pressed_) rigid_held_[r] += force(j) * system_->rigid_B(j, static_cast<Eigen::Index>(r));
  }
}

template <class T>
void LookAheadBlock<T>::start(const Vector& q, const Vector& v, const Vector& force) noexcept {
  std::fill(was_watched_.begin(), was_watched_.end(), 0);
  for (std::size_t k = 0; k < watched_.size(); ++k) {
    was_watched_[static_cast<std::size_t>(watched_[k])] = 1;
    ended_(watched_[k]) = u(k, taken_);
  }
  taken_ = advanced_ = 0;
  std::copy(q.begin(), q.end(), q_.begin());
  std::copy(v.begin(), v.end(), v_.begin());
  for (std::size_t r = 0; r < rigid_q_.size(); ++r) {
    rigid_q_[r] = q(system_->rigid[r]);
    rigid_v_[r] = v(system_->rigid[r]);
  }
  expect();
  hold(force);
  std::fill(is_predicted_.begin(), is_predicted_.end(), 0);
  system_->loops->free_motion(modes(), static_cast<std::size_t>(length()), q_.data(), v_.data(),
                              forced_ ? forcing_.data() : nullptr, x_.data());
  predict_rigid();
  choose_watched();
}

/// Motion of the rigid modes under λ̄.
template <class T>
void LookAheadBlock<T>::predict_rigid() noexcept {
  const StepSystem& plain = *system_->plain;
  for (std::size_t r = 0; r < rigid_q_.size(); ++r) {
    const int n = system_->rigid[r];
    const double load = plain.load(n) - rigid_held_[r];
    double q = rigid_q_[r], v = rigid_v_[r];
    for (int l = 0; l < length(); ++l) {
      q += plain.b(n) * v + plain.c(n) * load;
      v = plain.e(n) * v + plain.h(n) * load;
      if (forced_) {
        const double* more = &forcing_[2 * static_cast<std::size_t>(l) * system_->modes];
        q += more[n];
        v += more[system_->modes + static_cast<std::size_t>(n)];
      }
      rigid_motion_(l, static_cast<Eigen::Index>(r)) = q;
    }
  }
}

/// u when the block started.
template <class T>
double LookAheadBlock<T>::at_start(int point) const noexcept {
  if (was_watched_[static_cast<std::size_t>(point)] != 0) return ended_(point);
  const StepSystem& plain = *system_->plain;
  double u = s_(0, point);
  for (int j : pressed_) u -= plain.R(j, point) * held_force_(j);
  for (Eigen::Index n = 0; n < plain.B.cols(); ++n) u += plain.B(point, n) * q_[static_cast<std::size_t>(n)];
  return u;
}

template <class T>
SolveStatus LookAheadBlock<T>::step(ComplementaritySolver& solver, Vector& force) noexcept {
  const bool deep = solver.statistics().limited > 0;
  const int l = taken_ + 1;
  SolveStatus status = SolveStatus::solved;
  if (!watched_.empty() && !near_.holds()) near_.take(*system_, gathered_);
  do {
    const auto n = static_cast<Eigen::Index>(watched_.size());
    bool closed = false;
    for (Eigen::Index k = 0; k < n; ++k) {
      const double gap = system_->plain->gap(watched_[k]);
      rhs_(k) = u(k, l) + held_push_(k) - gap;
      if (deep) rhs_(k) -= std::max(0.0, (taken_ > 0 ? u(k, taken_) : at_start(watched_[k])) - gap);
      closed = closed || !(rhs_(k) < 0);  // NaN included
    }
    if (closed) {
      if (is_new_problem_) solver.reset();
      is_new_problem_ = false;
      status = solver.solve(near_.S.topLeftCorner(n, n), rhs_.head(n), solution_.head(n));
      if (status != SolveStatus::solved && status != SolveStatus::limited) return status;
    } else {
      solution_.head(n).setZero();
    }
  } while (raise_budgets() && see_more());

  force.setZero();
  changed_.clear();
  change_.clear();
  for (std::size_t k = 0; k < watched_.size(); ++k) {
    const int i = watched_[k];
    force(i) = solution_(static_cast<Eigen::Index>(k));
    const auto change = static_cast<T>(force(i) - held_force_(i));
    if (change == 0) continue;
    near_.need(*system_, static_cast<int>(k));
    changed_.push_back(static_cast<int>(k));
    change_.push_back(change);
    changes_[static_cast<std::size_t>(i * length() + taken_)] = change;
    spent_(i) += std::abs(force(i) - held_force_(i));
    if (has_changed_[static_cast<std::size_t>(i)] == 0) have_changed_.push_back(i);
    has_changed_[static_cast<std::size_t>(i)] = 1;
  }
  if (!changed_.empty())
    system_->loops->near(near_.width, near_.lag.get(), static_cast<std::size_t>(length()), changed_.data(),
                         changed_.size(), change_.data(), static_cast<std::size_t>(length() - taken_),
                         &u(0, l), system_->width);
  pushing_ = 0;
  work_ = 0;
  for (std::size_t k = 0; k < watched_.size(); ++k) {
    const double lambda = solution_(static_cast<Eigen::Index>(k));
    if (!(lambda > 0)) continue;
    ++pushing_;
    work_ += lambda * (u(k, l) - (taken_ > 0 ? u(k, taken_) : at_start(watched_[k])));
  }
  taken_ = l;
  return status;
}

template <class T>
double LookAheadBlock<T>::energy_in_residual() const noexcept {
  if (!system_->yields || pushing_ == 0) return 0;
  const auto n = static_cast<Eigen::Index>(watched_.size());
  double twice = 0;
  for (Eigen::Index k = 0; k < n; ++k)
    if (solution_(k) != 0) twice += solution_(k) * near_.R.col(k).head(n).dot(solution_.head(n));
  return 0.5 * twice;
}

template <class T>
void LookAheadBlock<T>::take_back() noexcept {
  taken_ = advanced_ = length();
  for (int i : watched_) position_[static_cast<std::size_t>(i)] = -1;
  watched_.clear();
}

template <class T>
simd::Sums LookAheadBlock<T>::advance(bool keep_rates) noexcept {
  simd::Sums sums;
  const auto from = static_cast<std::size_t>(advanced_), L = static_cast<std::size_t>(length());
  system_->loops->pushed_motion(
      modes(), {system_->B.data(), have_changed_.data(), have_changed_.size(), changes_.data() + from, L},
      static_cast<std::size_t>(taken_ - advanced_), q_.data(), v_.data(),
      keep_rates ? rates_.data() + from * system_->modes : nullptr, sums);
  advance_rigid(keep_rates, sums);
  advanced_ = taken_;
  return sums;
}

template <class T>
void LookAheadBlock<T>::advance_rigid(bool keep_rates, simd::Sums& sums) noexcept {
  const StepSystem& plain = *system_->plain;
  for (std::size_t r = 0; r < rigid_q_.size(); ++r) {
    const int n = system_->rigid[r];
    double &q = rigid_q_[r], &v = rigid_v_[r];
    for (int l = advanced_; l < taken_; ++l) {
      double push = rigid_held_[r];
      for (int i : have_changed_)
        push += system_->rigid_B(i, static_cast<Eigen::Index>(r)) *
                static_cast<double>(changes_[static_cast<std::size_t>(i * length() + l)]);
      const double f = plain.load(n) - push, dq = plain.b(n) * v + plain.c(n) * f;
      sums.damping += f * (plain.damp_ss(n) * f + plain.damp_sr(n) * v) + plain.damp_rr(n) * v * v;
      sums.contact += push * dq;
      q += dq;
      v = plain.e(n) * v + plain.h(n) * f;
      if (keep_rates) rates_[static_cast<std::size_t>(l) * system_->modes + static_cast<std::size_t>(n)] = v;
    }
    sums.kinetic += 0.5 * v * v;
    sums.loads += plain.load(n) * (q - plain.q0(n));
    q_[static_cast<std::size_t>(n)] = q;
    v_[static_cast<std::size_t>(n)] = v;
  }
}

template <class T>
void LookAheadBlock<T>::copy_state(Vector& q, Vector& v) const noexcept {
  std::copy_n(q_.begin(), q.size(), q.begin());
  std::copy_n(v_.begin(), v.size(), v.begin());
}

template class LookAheadBlock<double>;
template class LookAheadBlock<float>;

}  // namespace ricochet::contact
