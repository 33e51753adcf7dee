// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/look_ahead_block.hpp"

#include <algorithm>

namespace ricochet::contact {

/// A new set of kept points includes those that could close after this many times the budgeted changes, so
/// that the set lasts.
constexpr double provision = 1.5;

template <class T>
LookAheadBlock<T>::LookAheadBlock(std::shared_ptr<const BlockSystem<T>> system, bool forcing)
    : system_(std::move(system)),
      near_(*system_),
      screening_(*system_),
      taken_(system_->length),
      advanced_(system_->length) {
  const auto m = static_cast<std::size_t>(system_->points), L = static_cast<std::size_t>(system_->length);
  const std::size_t N = system_->modes, width = system_->width, rigid = system_->rigid.size();
  for (std::vector<double>* x : {&q_, &v_, &load_, &held_}) x->assign(N, 0.0);
  for (std::vector<double>* x : {&rigid_q_, &rigid_v_, &rigid_held_}) x->assign(rigid, 0.0);
  rigid_motion_.setZero(system_->length, rigid);
  rigid_at_.setZero(system_->length);
  constant_ = system_->plain->load;
  highest_rest_.setZero(system_->points);
  s_.setZero(forcing ? system_->length + 1 : 1, system_->points);
  if (forcing) {
    for (Vector* x : {&rest_q_, &rest_v_}) x->setZero(constant_.size());
    for (std::vector<double>* x : {&y_, &rate_}) x->assign(N, 0.0);
    forcing_.assign(2 * L * N, 0.0);
  }
  x_.assign(L * N, T(0));
  rates_.assign(L * N, 0.0);
  predicted_u_.assign(L * width, 0.0);
  u_.assign(L * width, 0.0);
  changes_.assign(m * L, T(0));
  for (Vector* x : {&held_force_, &held_rest_, &held_push_, &held_at_, &step_change_, &rest_, &ended_})
    x->setZero(system_->points);
  for (std::vector<char>* x : {&was_kept_, &is_predicted_, &has_changed_}) x->assign(m, 0);
  has_force_.assign(static_cast<std::size_t>(system_->contacts), 0);
  position_.assign(m, -1);
  for (std::vector<int>* x :
       {&pressed_, &places_, &predicted_, &kept_, &gathered_, &have_changed_, &changed_})
    x->reserve(m);
  change_.reserve(m);
  factor_.reserve(m);
  sum_.assign(std::max(N, width), T(0));
}

template <class T>
simd::Modes LookAheadBlock<T>::modes() const {
  const ModeConstants& of = system_->elastic;
  return {system_->modes,    of.stiffness.data(), load_.data(),     of.b.data(),  of.c.data(),
          of.e.data(),       of.h.data(),         of.load.data(),   held_.data(), of.q0.data(),
          of.damp_ss.data(), of.damp_sr.data(),   of.damp_rr.data()};
}

template <class T>
bool LookAheadBlock<T>::set_forcing(const ForcedResponse::Piece& piece, double end) noexcept {
  has_knot_ = piece.to <= end;
  forced_ = has_knot_ || !piece.steady;
  s_.row(0) = piece.s.transpose();
  constant_ = forced_ ? system_->plain->load : piece.load;
  highest_rest_ = piece.rest;
  if (!forced_) return false;
  highest_rest_ += ((end - piece.at) * piece.drift).cwiseMax(0);
  rest_q_ = piece.rest_q;
  rest_v_ = piece.rest_v;
  return true;
}

template <class T>
void LookAheadBlock<T>::set_response(int l, const Vector& q, const Vector& v, const Vector& s) noexcept {
  s_.row(l) = s.transpose();
  double* to = &forcing_[2 * (l - 1) * system_->modes];
  std::copy(q.begin(), q.end(), to);
  std::copy(v.begin(), v.end(), to + system_->modes);
}

/// Makes `force` the held force λ̂ and includes it in the load.
template <class T>
void LookAheadBlock<T>::hold(const Vector& force) noexcept {
  held_force_ = force;
  pressed_.clear();
  places_.clear();
  factor_.clear();
  for (int j = 0; j < system_->points; ++j) {
    if (force(j) == 0) continue;
    pressed_.push_back(j);
    system_->matrices->need(j);
    places_.push_back(system_->matrices->place(j));
    factor_.push_back(static_cast<T>(force(j)));
  }
  system_->loops->combine(system_->modes, system_->B.data(), system_->modes, pressed_.data(), pressed_.size(),
                          factor_.data(), sum_.data());
  std::fill(load_.begin(), load_.end(), 0.0);
  std::copy(constant_.begin(), constant_.end(), load_.begin());
  for (std::size_t n = 0; n < system_->modes; ++n) {
    held_[n] = static_cast<double>(sum_[n]);
    load_[n] -= held_[n];
  }
  if (system_->yields) {
    system_->loops->combine(system_->width, system_->matrices->residual(), system_->width, places_.data(),
                            places_.size(), factor_.data(), sum_.data());
    std::copy_n(sum_.begin(), system_->points, held_rest_.begin());
  }
  for (std::size_t r = 0; r < rigid_held_.size(); ++r) {
    rigid_held_[r] = 0;
    for (int j : pressed_) rigid_held_[r] += force(j) * system_->rigid_B(j, r);
  }
}

template <class T>
void LookAheadBlock<T>::start(const Vector& q, const Vector& v, const Vector& force, ContactLaw& law,
                              const MeanForce& mean) noexcept {
  std::fill(was_kept_.begin(), was_kept_.end(), 0);
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    was_kept_[kept_[k]] = 1;
    ended_(kept_[k]) = u(k, taken_);
  }
  taken_ = advanced_ = 0;
  std::copy(q.begin(), q.end(), q_.begin());
  std::copy(v.begin(), v.end(), v_.begin());
  for (std::size_t r = 0; r < rigid_q_.size(); ++r) {
    rigid_q_[r] = q(system_->rigid[r]);
    rigid_v_[r] = v(system_->rigid[r]);
  }
  screening_.start(*system_, have_changed_);
  for (int i : have_changed_) {
    has_changed_[i] = 0;
    std::fill_n(changes_.begin() + i * length(), length(), T(0));
  }
  have_changed_.clear();
  hold(force);
  for (int i = 0; i < system_->contacts; ++i)
    has_force_[i] = force(i) > 0 || mean.end()(i) > 0 || mean.before()(i) > 0 ? 1 : 0;
  std::fill(is_predicted_.begin(), is_predicted_.end(), 0);
  system_->loops->free_motion(modes(), length(), q_.data(), v_.data(), forced_ ? forcing_.data() : nullptr,
                              x_.data());
  predict_rigid();
  choose_kept(law, mean);
}

/// Computes the motion of the rigid modes under λ̂.
template <class T>
void LookAheadBlock<T>::predict_rigid() noexcept {
  const StepSystem& plain = *system_->plain;
  for (std::size_t r = 0; r < rigid_q_.size(); ++r) {
    const int n = system_->rigid[r];
    const double load = constant_(n) - rigid_held_[r];
    double q = rigid_q_[r], v = rigid_v_[r];
    for (int l = 0; l < length(); ++l) {
      q += plain.b(n) * v + plain.c(n) * load;
      v = plain.e(n) * v + plain.h(n) * load;
      if (forced_) {
        const double* more = &forcing_[2 * l * system_->modes];
        q += more[n];
        v += more[system_->modes + n];
      }
      rigid_motion_(l, r) = q;
    }
  }
}

/// u at the start of the block.
template <class T>
double LookAheadBlock<T>::at_start(int point, const MeanForce& mean) const noexcept {
  if (was_kept_[point] != 0) return ended_(point);
  const StepSystem& plain = *system_->plain;
  double u = s_(0, point) - plain.model->R.row(point).dot(mean.end());
  for (Eigen::Index n = 0; n < constant_.size(); ++n) u += plain.model->B(point, n) * q_[n];
  if (point < system_->contacts && !plain.springs.empty() && mean.end()(point) > 0)
    u -= plain.springs[point].displacement(mean.end()(point));
  return u;
}

/// Keeps further points until no other point could close.
template <class T>
StepTrial LookAheadBlock<T>::step(ContactLaw& law, const MeanForce& mean, Slip* slip, Vector& force,
                                  Vector& end) noexcept {
  const int l = taken_ + 1;
  StepTrial trial;
  do {
    for (std::size_t k = 0; k < kept_.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      law.free(at) = u(k, l) + held_push_(at);
      law.start(at) = before(at, mean);
    }
    trial = law.solve(near_.all(), mean, slip);
    if (!has_forces(trial.status)) return trial;
    for (std::size_t k = 0; k < kept_.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      const double held = held_force_(kept_[k]);
      step_change_(at) = std::max(std::abs(law.force()(at) - held), std::abs(law.end()(at) - held));
    }
  } while (screening_.raise_budgets(*system_, kept_, step_change_) && keep_more(law, mean));

  const auto n = static_cast<Eigen::Index>(kept_.size());
  changed_.clear();
  change_.clear();
  rest_.head(n) = law.yielded().head(n) - held_at_.head(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const int i = kept_[k];
    screening_.spend(i, step_change_(k));
    const auto change = static_cast<T>(law.force()(k) - held_force_(i));
    if (change == 0) continue;
    near_.need(*system_, static_cast<int>(k));
    changed_.push_back(static_cast<int>(k));
    change_.push_back(change);
    changes_[i * length() + taken_] = change;
    if (has_changed_[i] == 0) have_changed_.push_back(i);
    has_changed_[i] = 1;
  }
  if (!changed_.empty())
    system_->loops->near(near_.width, near_.lag.data(), length(), changed_.data(), changed_.size(),
                         change_.data(), length() - taken_, &u(0, l), system_->width);
  touching_ = 0;
  work_ = 0;
  force.setZero();
  end.setZero();
  for (Eigen::Index k = 0; k < n; ++k) {
    u(k, l) -= rest_(k);
    force(kept_[k]) = law.force()(k);
    end(kept_[k]) = law.end()(k);
    if (kept_[k] >= system_->contacts) continue;
    touching_ += law.end()(k) > 0 ? 1 : 0;
    if (law.force()(k) > 0) work_ += law.force()(k) * (u(k, l) - law.start(k));
  }
  in_residual_ = trial.in_residual;
  taken_ = l;
  return trial;
}

template <class T>
void LookAheadBlock<T>::take_back() noexcept {
  taken_ = advanced_ = length();
  for (int i : kept_) position_[i] = -1;
  kept_.clear();
}

template <class T>
simd::Sums LookAheadBlock<T>::advance(bool keep_rates) noexcept {
  simd::Sums sums;
  const auto from = static_cast<std::size_t>(advanced_), L = static_cast<std::size_t>(length());
  system_->loops->pushed_motion(
      modes(), {system_->B.data(), have_changed_.data(), have_changed_.size(), changes_.data() + from, L},
      taken_ - advanced_, q_.data(), v_.data(), keep_rates ? rates_.data() + from * system_->modes : nullptr,
      sums);
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
        push += system_->rigid_B(i, r) * static_cast<double>(changes_[i * length() + l]);
      const double f = constant_(n) - push, dq = plain.b(n) * v + plain.c(n) * f;
      sums.damping += f * (plain.damp_ss(n) * f + plain.damp_sr(n) * v) + plain.damp_rr(n) * v * v;
      sums.contact += push * dq;
      q += dq;
      v = plain.e(n) * v + plain.h(n) * f;
      if (keep_rates) rates_[l * system_->modes + n] = v;
    }
    sums.kinetic += 0.5 * v * v;
    sums.loads += plain.load(n) * (q - plain.q0(n));
    q_[n] = q;
    v_[n] = v;
  }
}

template <class T>
void LookAheadBlock<T>::copy_state(Vector& q, Vector& v) const noexcept {
  std::copy_n(q_.begin(), q.size(), q.begin());
  std::copy_n(v_.begin(), v.size(), v.begin());
}

/// Sets predicted_u_ of the points `rows` and their margins under λ̂.
template <class T>
void LookAheadBlock<T>::predict(std::span<const int> rows) noexcept {
  const std::size_t width = system_->width;
  for (int i : rows) {
    is_predicted_[i] = 1;
    if (!system_->rigid.empty()) rigid_at_.noalias() = rigid_motion_ * system_->rigid_B.row(i).transpose();
    for (int l = 0; l < length(); ++l)
      predicted_u_[l * width + i] = s_(forced_ ? l + 1 : 0, i) + rigid_at_(l) - held_rest_(i);
  }
  system_->loops->displacement(system_->modes, system_->B.data(), rows.data(), rows.size(), x_.data(),
                               length(), predicted_u_.data(), width);
  for (int i : rows) {
    if (i >= system_->contacts) continue;
    double farthest = predicted_u_[i];
    for (int l = 1; l < length(); ++l) {
      const double u = predicted_u_[l * width + i];
      farthest = u > farthest || u != u ? u : farthest;
    }
    screening_.set_margin(i, system_->gap(i) - farthest);
  }
}

/// Predicts the contacts that must be kept if forces change by `times` their budgets.
template <class T>
void LookAheadBlock<T>::predict_kept(double times) noexcept {
  predicted_.clear();
  for (int i = 0; i < system_->contacts; ++i)
    if (is_predicted_[i] == 0 && must_keep(i, times)) predicted_.push_back(i);
  predict(predicted_);
}

template <class T>
void LookAheadBlock<T>::choose_kept(ContactLaw& law, const MeanForce& mean) noexcept {
  if (has_knot_) {
    screening_.drop_margins();
  } else {
    const double *q = q_.data(), *v = v_.data();
    if (forced_) {
      for (Eigen::Index n = 0; n < rest_q_.size(); ++n) {
        y_[n] = q[n] - rest_q_(n);
        rate_[n] = v[n] - rest_v_(n);
      }
      q = y_.data();
      v = rate_.data();
    }
    screening_.bound_by_energy(*system_, {q, v, load_.data()}, highest_rest_, held_force_, pressed_,
                               rigid_motion_);
  }
  predict_kept(1);
  std::size_t needed = 0, covered = 0, contacts = 0;
  for (int i = 0; i < system_->contacts; ++i) needed += must_keep(i, 1) ? 1 : 0;
  for (int i : gathered_) {
    if (i >= system_->contacts) continue;
    ++contacts;
    covered += must_keep(i, 1) ? 1 : 0;
  }
  // A few surplus points cost less than a new matrix.
  const bool reuse = needed > 0 && covered == needed && contacts <= 2 * needed + 8;
  for (int i : kept_) position_[i] = -1;
  kept_.clear();
  if (reuse) {
    predicted_.clear();
    for (int i : gathered_)
      if (is_predicted_[i] == 0) predicted_.push_back(i);
    predict(predicted_);
    for (int i : gathered_) keep(i, mean);
  } else if (needed > 0) {
    predict_kept(provision);
    keep_contacts(provision, mean);
  }
  gather(law);
}

/// Keeps the predicted contacts that must be kept if forces change by `times` their budgets, each with its
/// tangential rows.
template <class T>
void LookAheadBlock<T>::keep_contacts(double times, const MeanForce& mean) noexcept {
  predicted_.clear();
  for (int i = 0; i < system_->contacts; ++i)
    if (const int t = system_->tangential[i]; t >= 0 && position_[i] < 0 && must_keep(i, times))
      for (int row : {t, t + 1})
        if (is_predicted_[row] == 0) predicted_.push_back(row);
  if (!predicted_.empty()) predict(predicted_);
  for (int i = 0; i < system_->contacts; ++i) {
    if (position_[i] >= 0 || !must_keep(i, times)) continue;
    keep(i, mean);
    if (const int t = system_->tangential[i]; t >= 0)
      for (int row : {t, t + 1}) keep(row, mean);
  }
}

/// Adds a predicted point to the kept points. Its u includes all changes of force so far in this block.
template <class T>
void LookAheadBlock<T>::keep(int point, const MeanForce& mean) noexcept {
  const std::size_t k = kept_.size(), width = system_->width;
  const auto i = static_cast<std::size_t>(point);
  BlockMatrices<T>& matrices = *system_->matrices;
  matrices.need(point);
  position_[i] = static_cast<int>(k);
  kept_.push_back(point);
  for (int l = 1; l <= length(); ++l) u(k, l) = predicted_u_[(l - 1) * width + i];
  for (int j : have_changed_) {
    const T* lag = matrices.lags(j) + matrices.place(point);
    for (int from = 1; from <= taken_; ++from) {
      const auto change = static_cast<double>(changes_[j * length() + from - 1]);
      if (change == 0) continue;
      for (int l = from; l <= length(); ++l) u(k, l) -= change * static_cast<double>(lag[(l - from) * width]);
    }
  }
  if (taken_ == 0) return;
  for (std::size_t other = 0; other < k; ++other)
    u(k, taken_) -= system_->plain->model->R(point, kept_[other]) *
                    (mean.end()(kept_[other]) - held_force_(kept_[other]));
}

/// Gathers the matrices of the kept points.
template <class T>
void LookAheadBlock<T>::gather(ContactLaw& law) noexcept {
  law.hold(kept_);
  if (kept_.empty()) return;
  if (gathered_ != kept_) {
    gathered_ = kept_;
    near_.take(*system_, gathered_);
  }
  const auto n = static_cast<Eigen::Index>(kept_.size());
  const auto [M, R, S, S_mean] = near_.all();
  held_push_.head(n).setZero();
  held_at_.head(n).setZero();
  for (Eigen::Index k = 0; k < n; ++k)
    if (const double force = held_force_(kept_[k]); force != 0) {
      held_push_.head(n) += force * S.col(k).head(n);
      if (system_->yields) held_at_.head(n) += force * R.col(k).head(n);
    }
}

/// Keeps further points that could now close. Returns whether there are any.
template <class T>
bool LookAheadBlock<T>::keep_more(ContactLaw& law, const MeanForce& mean) noexcept {
  predict_kept(1);
  const std::size_t before = kept_.size();
  keep_contacts(1, mean);
  if (kept_.size() == before) return false;
  gather(law);
  return true;
}

template class LookAheadBlock<double>;
template class LookAheadBlock<float>;

}  // namespace ricochet::contact
