// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/look_ahead_block.hpp"

#include <algorithm>

namespace ricochet::contact {

/// A new set of kept points includes those that could close after this many times the budgeted changes, so
/// that the set lasts.
constexpr double provision = 1.5;
/// A new set is chosen after this many blocks in a row with a surplus of more than one point in `few_of`:
/// what the surplus has cost by then is about what the matrices of another set cost.
constexpr int patience = 16, few_of = 16;

template <class T>
LookAheadBlock<T>::LookAheadBlock(std::shared_ptr<const BlockSystem<T>> system, bool forcing)
    : system_(std::move(system)),
      forcing_(*system_, forcing),
      held_(*system_),
      changes_(*system_),
      motion_(*system_),
      prediction_(*system_),
      kept_(*system_),
      screening_(*system_),
      taken_(system_->length),
      advanced_(system_->length),
      has_force_(system_->contacts),
      largest_change_(Vector::Zero(system_->points)) {
  for (std::vector<int>* x : {&rows_, &changed_}) x->reserve(system_->points);
  change_.reserve(system_->points);
}

template <class T>
void LookAheadBlock<T>::start(const Vector& q, const Vector& v, const Vector& force, ContactLaw& law,
                              const MeanForce& mean) noexcept {
  kept_.end(taken_);
  taken_ = advanced_ = 0;
  screening_.start(*system_, changes_.rows());
  changes_.clear();
  held_.set(*system_, force);
  for (int i = 0; i < system_->contacts; ++i)
    has_force_[i] = force(i) > 0 || mean.end()(i) > 0 || mean.before()(i) > 0 ? 1 : 0;
  motion_.start(*system_, q, v, forcing_, held_);
  prediction_.clear();
  choose_kept(law, mean);
}

/// u at the start of the block.
template <class T>
double LookAheadBlock<T>::at_start(int point, const MeanForce& mean) const noexcept {
  if (const double* ended = kept_.ended(point)) return *ended;
  const StepSystem& plain = *system_->plain;
  double u =
      forcing_.s(0, point) - plain.model->R.row(point).dot(mean.end()) + plain.model->B.row(point).dot(q());
  if (point < system_->contacts && !plain.springs.empty() && mean.end()(point) > 0)
    u -= plain.springs[point].displacement(mean.end()(point));
  return u;
}

/// Solves the next step with the kept points.
template <class T>
StepTrial LookAheadBlock<T>::attempt(ContactLaw& law, const MeanForce& mean, Slip* slip) noexcept {
  for (int k = 0; k < kept_.size(); ++k) {
    law.free(k) = kept_.u(k, taken_ + 1) + kept_.pushed()(k);
    law.start(k) = before(k, mean);
  }
  const StepTrial trial = law.solve(kept_.matrices(), mean, slip);
  for (int k = 0; k < kept_.size(); ++k) {
    const double held = held_.force(kept_.rows()[k]);
    largest_change_(k) = std::max(std::abs(law.force()(k) - held), std::abs(law.end()(k) - held));
  }
  return trial;
}

/// Keeps further points until no other point could close.
template <class T>
StepTrial LookAheadBlock<T>::step(ContactLaw& law, const MeanForce& mean, Slip* slip, Vector& force,
                                  Vector& end) noexcept {
  StepTrial trial;
  do {
    trial = attempt(law, mean, slip);
    if (!has_forces(trial.status)) return trial;
  } while (screening_.raise_budgets(*system_, kept_.rows(), largest_change_) && keep_more(law, mean));

  changed_.clear();
  change_.clear();
  for (int k = 0; k < kept_.size(); ++k) {
    const int i = kept_.rows()[k];
    screening_.spend(i, largest_change_(k));
    const auto change = static_cast<T>(law.force()(k) - held_.force(i));
    if (change == 0) continue;
    changed_.push_back(k);
    change_.push_back(change);
    changes_.add(i, taken_, change);
  }
  const int l = ++taken_;
  kept_.push(*system_, l, changed_, change_);
  touching_ = 0;
  work_ = 0;
  force.setZero();
  end.setZero();
  for (int k = 0; k < kept_.size(); ++k) {
    const int i = kept_.rows()[k];
    kept_.u(k, l) -= law.yielded()(k) - kept_.yielded()(k);
    force(i) = law.force()(k);
    end(i) = law.end()(k);
    if (i >= system_->contacts) continue;
    touching_ += law.end()(k) > 0 ? 1 : 0;
    if (law.force()(k) > 0) work_ += law.force()(k) * (kept_.u(k, l) - law.start(k));
  }
  in_residual_ = trial.in_residual;
  return trial;
}

template <class T>
void LookAheadBlock<T>::take_back() noexcept {
  taken_ = advanced_ = length();
  kept_.clear();
}

template <class T>
simd::Sums LookAheadBlock<T>::advance(bool keep_rates) noexcept {
  const simd::Sums sums = motion_.advance(*system_, forcing_, held_, changes_, advanced_, taken_, keep_rates);
  advanced_ = taken_;
  return sums;
}

template <class T>
void LookAheadBlock<T>::copy_state(Vector& q, Vector& v) const noexcept {
  std::copy_n(motion_.q().begin(), q.size(), q.begin());
  std::copy_n(motion_.v().begin(), v.size(), v.begin());
}

/// Predicts rows and sets the margins of contacts among them.
template <class T>
void LookAheadBlock<T>::predict(std::span<const int> rows) noexcept {
  prediction_.add(*system_, motion_, forcing_, held_, rows);
  for (int i : rows)
    if (i < system_->contacts) screening_.set_margin(i, system_->gap(i) - prediction_.largest(i));
}

/// Predicts the contacts that must be kept if forces change by `times` their budgets.
template <class T>
void LookAheadBlock<T>::predict_kept(double times) noexcept {
  rows_.clear();
  for (int i = 0; i < system_->contacts; ++i)
    if (!prediction_.has(i) && must_keep(i, times)) rows_.push_back(i);
  predict(rows_);
}

template <class T>
void LookAheadBlock<T>::choose_kept(ContactLaw& law, const MeanForce& mean) noexcept {
  if (forcing_.has_knot)
    screening_.drop_margins();
  else
    screening_.bound_by_energy(*system_, motion_, forcing_, held_);
  predict_kept(1);
  std::size_t needed = 0, wanted = 0, covered = 0, contacts = 0;
  for (int i = 0; i < system_->contacts; ++i) {
    needed += must_keep(i, 1) ? 1 : 0;
    wanted += must_keep(i, provision) ? 1 : 0;
  }
  for (int i : kept_.gathered()) {
    if (i >= system_->contacts) continue;
    ++contacts;
    covered += must_keep(i, 1) ? 1 : 0;
  }
  // A few surplus points cost less than a new matrix, for some blocks.
  surplus_ = contacts > wanted + wanted / few_of ? surplus_ + 1 : 0;
  const bool reuse = needed > 0 && covered == needed && contacts <= 2 * needed + 8 && surplus_ < patience;
  kept_.clear();
  if (reuse) {
    rows_.clear();
    for (int i : kept_.gathered())
      if (!prediction_.has(i)) rows_.push_back(i);
    predict(rows_);
    for (int i : kept_.gathered()) keep(i, mean);
  } else if (needed > 0) {
    surplus_ = 0;
    predict_kept(provision);
    keep_contacts(provision, mean);
  }
  gather(law);
}

/// Keeps the predicted contacts that must be kept if forces change by `times` their budgets, each with its
/// tangential rows.
template <class T>
void LookAheadBlock<T>::keep_contacts(double times, const MeanForce& mean) noexcept {
  rows_.clear();
  for (int i = 0; i < system_->contacts; ++i)
    if (const int t = system_->tangential[i]; t >= 0 && !kept_.has(i) && must_keep(i, times))
      for (int row : {t, t + 1})
        if (!prediction_.has(row)) rows_.push_back(row);
  if (!rows_.empty()) predict(rows_);
  for (int i = 0; i < system_->contacts; ++i) {
    if (kept_.has(i) || !must_keep(i, times)) continue;
    keep(i, mean);
    if (const int t = system_->tangential[i]; t >= 0)
      for (int row : {t, t + 1}) keep(row, mean);
  }
}

/// Adds a predicted point to the kept points. Its u includes all changes of force so far in this block.
template <class T>
void LookAheadBlock<T>::keep(int point, const MeanForce& mean) noexcept {
  const int k = kept_.size();
  BlockMatrices<T>& matrices = *system_->matrices;
  matrices.need(point);
  for (int l = 1; l <= length(); ++l) kept_.u(k, l) = prediction_.u(point, l);
  for (int j : changes_.rows()) {
    const T* lag = matrices.lags(j) + matrices.place(point);
    for (int from = 1; from <= taken_; ++from) {
      const auto change = static_cast<double>(changes_.of(j)[from - 1]);
      if (change == 0) continue;
      for (int l = from; l <= length(); ++l)
        kept_.u(k, l) -= change * static_cast<double>(lag[(l - from) * system_->width]);
    }
  }
  if (taken_ > 0)
    for (int other : kept_.rows())
      kept_.u(k, taken_) -= system_->plain->model->R(point, other) * (mean.end()(other) - held_.force(other));
  kept_.add(point);
}

/// Gathers the matrices of the kept points.
template <class T>
void LookAheadBlock<T>::gather(ContactLaw& law) noexcept {
  law.hold(kept_.rows());
  kept_.gather(*system_, held_);
}

/// Keeps further points that could now close. Returns whether there are any.
template <class T>
bool LookAheadBlock<T>::keep_more(ContactLaw& law, const MeanForce& mean) noexcept {
  predict_kept(1);
  const int before = kept_.size();
  keep_contacts(1, mean);
  if (kept_.size() == before) return false;
  gather(law);
  return true;
}

template class LookAheadBlock<double>;
template class LookAheadBlock<float>;

}  // namespace ricochet::contact
