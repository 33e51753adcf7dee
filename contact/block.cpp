#include "contact/block.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "contact/propagator.hpp"

namespace ricochet::contact {
namespace {

/// Bands of frequency whose energies bound what points can do. More tell more and cost more.
constexpr int bands = 16;

/// Forces of a block are expected below this many times those of the last one; if they are not, more points
/// come in.
constexpr double growth = 2;

/// A new set of watched points takes in those that so many times the expected forces could reach, to last.
constexpr double ahead = 1.5;

template <class T>
const simd::Loops<T>& best_loops();
template <>
const simd::Loops<double>& best_loops() {
  return simd::best().in_double;
}
template <>
const simd::Loops<float>& best_loops() {
  return simd::best().in_float;
}

std::vector<double> padded(const Vector& values, std::size_t size) {
  std::vector<double> out(size, 0.0);
  std::copy(values.begin(), values.end(), out.begin());
  return out;
}

}  // namespace

template <class T>
Block<T>::Block(std::shared_ptr<const StepSystem> shared, int steps, double step)
    : system_(std::move(shared)),
      loops_(&best_loops<T>()),
      length_(steps),
      points_(static_cast<int>(system_->gap.size())),
      taken_(steps),
      modes_(simd::padded(static_cast<std::size_t>(system_->omega.size()))),
      lags_(simd::padded(static_cast<std::size_t>(steps), simd::step_pad)),
      stride_(lags_ + static_cast<std::size_t>(steps)),
      stiffness_(padded(system_->stiffness, modes_)),
      load_(padded(system_->load, modes_)),
      b_(padded(system_->b, modes_)),
      c_(padded(system_->c, modes_)),
      e_(padded(system_->e, modes_)),
      h_(padded(system_->h, modes_)) {
  const StepSystem& system = *system_;
  const auto m = static_cast<std::size_t>(points_);
  const Eigen::Index N = system.omega.size();
  const Matrix& B = system.B;
  B_.assign(m * modes_, T(0));
  std::vector<int> elastic;
  for (Eigen::Index n = 0; n < N; ++n) {
    if (system.stiffness(n) == 0) {
      if (system.h(n) != 0) rigid_.push_back(static_cast<int>(n));
      continue;
    }
    elastic.push_back(static_cast<int>(n));
    for (std::size_t i = 0; i < m; ++i)
      B_[i * modes_ + static_cast<std::size_t>(n)] = static_cast<T>(B(i, n));
  }
  std::sort(elastic.begin(), elastic.end(), [&](int a, int b) { return system.omega(a) < system.omega(b); });
  band_.resize(bands);
  reach_.setZero(points_, bands);
  rest_ = system.s;
  softness_.setZero(N);
  flexibility_ = system.R;
  for (std::size_t k = 0; k < elastic.size(); ++k) {
    const int n = elastic[k], band = static_cast<int>(k * bands / elastic.size());
    band_[static_cast<std::size_t>(band)].push_back(n);
    reach_.col(band) += B.col(n).cwiseAbs2() / system.stiffness(n);
    softness_(n) = 1 / system.stiffness(n);
    rest_ += B.col(n) * (system.load(n) / system.stiffness(n));
    flexibility_ += B.col(n) * B.col(n).transpose() / system.stiffness(n);
  }
  reach_ = reach_.cwiseSqrt().eval();

  lag_.assign(m * m * lags_, T(0));
  influence_.setZero(points_);
  Vector held = Vector::Zero(N);  // c of the steps so far
  for (std::size_t d = 0; d < static_cast<std::size_t>(steps); ++d) {
    Vector more(N);
    for (Eigen::Index n = 0; n < N; ++n)
      more(n) = mode_step(system.omega(n), system.decay(n), static_cast<double>(d + 1) * step).c;
    Eigen::MatrixXd lag = B * (more - held).asDiagonal() * B.transpose();
    if (d == 0) lag += system.R;
    held = more;
    for (std::size_t j = 0; j < m; ++j)
      for (std::size_t i = 0; i < m; ++i) lag_[(j * m + i) * lags_ + d] = static_cast<T>(lag(i, j));
    influence_ = influence_.cwiseMax(lag.cwiseAbs().rowwise().maxCoeff());
  }

  const auto L = static_cast<std::size_t>(steps);
  q_.assign(modes_, 0.0);
  v_.assign(modes_, 0.0);
  x_.assign(L * modes_, T(0));
  push_.assign(L * modes_, T(0));
  rigid_motion_.setZero(steps);
  energy_.setZero(N);
  u_.assign(m * stride_, 0.0);
  changes_.assign(m * lags_, T(0));
  sum_.assign(m * lags_, T(0));
  amplitude_.setZero(bands);
  for (Vector* x : {&ended_, &held_force_, &held_rest_, &held_push_, &margin_, &rhs_, &solution_})
    x->setZero(points_);
  for (std::vector<char>* x : {&was_watched_, &is_predicted_, &is_watched_, &has_changed_}) x->assign(m, 0);
  for (std::vector<int>* x :
       {&predicted_, &watched_, &gathered_, &have_changed_, &pushing_, &changed_, &held_})
    x->reserve(m);
  change_.reserve(m);
  S_.setZero(points_, points_);
}

/// Takes λ̄ into the load and into where the points would rest.
template <class T>
void Block<T>::hold(const Vector& force) noexcept {
  held_force_ = force;
  held_.clear();
  held_rest_ = rest_;
  for (int j = 0; j < points_; ++j) {
    if (force(j) == 0) continue;
    held_.push_back(j);
    held_rest_ -= force(j) * flexibility_.col(j);
    changes_[static_cast<std::size_t>(j) * lags_] = static_cast<T>(force(j));
  }
  loops_->push(modes_, B_.data(), held_.data(), held_.size(), changes_.data(), lags_, 1, push_.data());
  for (std::size_t n = 0; n < static_cast<std::size_t>(system_->load.size()); ++n)
    load_[n] = system_->load(static_cast<Eigen::Index>(n)) - static_cast<double>(push_[n]);
  for (int n : rigid_)
    for (int j : held_) load_[static_cast<std::size_t>(n)] -= force(j) * system_->B(j, n);
  for (int j : held_) changes_[static_cast<std::size_t>(j) * lags_] = T(0);
}

template <class T>
void Block<T>::start(const Vector& q, const Vector& v, const Vector& force) noexcept {
  was_watched_ = is_watched_;
  for (int i : watched_) ended_(i) = u_[at(i, taken_)];
  taken_ = 0;
  last_total_ = total_;
  total_ = 0;
  std::copy(q.begin(), q.end(), q_.begin());
  std::copy(v.begin(), v.end(), v_.begin());
  for (int i : have_changed_) {
    has_changed_[static_cast<std::size_t>(i)] = 0;
    std::fill_n(changes_.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(i) * lags_), lags_,
                T(0));
  }
  have_changed_.clear();
  pushing_.clear();
  hold(force);
  std::fill(is_predicted_.begin(), is_predicted_.end(), 0);
  predict_rigid(q, v);
  loops_->free_motion(modes(), static_cast<std::size_t>(length_), q_.data(), v_.data(), x_.data());
  bound_by_energy(q, v);
  predicted_.clear();
  for (int i = 0; i < points_; ++i)
    if (matters(i, growth * last_total_)) predicted_.push_back(i);
  for (int i : gathered_)
    if (!matters(i, growth * last_total_)) predicted_.push_back(i);
  predict(predicted_);
  choose_watched();
}

/// u_ of all points as if they were rigid.
template <class T>
void Block<T>::predict_rigid(const Vector& q, const Vector& v) noexcept {
  for (int i = 0; i < points_; ++i) std::fill_n(&u_[at(i, 1)], length_, system_->s(i));
  for (std::size_t r = 0; r < rigid_.size(); ++r) {
    const int n = rigid_[r];
    const double load = load_[static_cast<std::size_t>(n)];
    double x = q(n), rate = v(n);
    for (int l = 0; l < length_; ++l) {
      x += system_->b(n) * rate + system_->c(n) * load;
      rate = system_->e(n) * rate + system_->h(n) * load;
      rigid_motion_(l) = x;
    }
    for (int i = 0; i < points_; ++i) {
      const double B = system_->B(i, n);
      double* u = &u_[at(i, 1)];
      for (int l = 0; l < length_; ++l) u[l] += B * rigid_motion_(l);
    }
  }
}

/// margin_: the gap less the farthest that a point gets at the end of any step. Without force the energy of
/// an elastic mode about its rest never grows, and |Σ B y| ≤ (Σ B²/ω²)^½ (Σ ω²y² + ẏ²)^½. Needs u_ of the
/// rigid motion.
template <class T>
void Block<T>::bound_by_energy(const Vector& q, const Vector& v) noexcept {
  const Eigen::Index N = q.size();
  const auto load = Eigen::Map<const Vector>(load_.data(), N).array();
  energy_ = system_->stiffness.array() * (q.array() - load * softness_.array()).square() + v.array().square();
  for (int band = 0; band < bands; ++band) {
    double sum = 0;
    for (int n : band_[static_cast<std::size_t>(band)]) sum += energy_(n);
    amplitude_(band) = sum;
  }
  amplitude_ = amplitude_.cwiseSqrt();
  margin_ = system_->gap - held_rest_;
  margin_.noalias() -= reach_ * amplitude_;
  for (int i = 0; i < points_; ++i) {
    const double* u = &u_[at(i, 1)];
    margin_(i) -= *std::max_element(u, u + length_) - system_->s(i);
  }
}

/// Adds elastic motion to u_ of `rows`, and sets margin_ to what is left of their gaps without force.
template <class T>
void Block<T>::predict(std::span<const int> rows) noexcept {
  loops_->displacement(modes_, B_.data(), rows.data(), rows.size(), x_.data(),
                       static_cast<std::size_t>(length_), u_.data(), stride_);
  for (int i : rows) {
    is_predicted_[static_cast<std::size_t>(i)] = 1;
    double residual = 0;
    for (int j : held_) residual += system_->R(j, i) * held_force_(j);
    double* u = &u_[at(i, 1)];
    for (int l = 0; l < length_; ++l) u[l] -= residual;
    margin_(i) = system_->gap(i) - *std::max_element(u, u + length_);
  }
}

template <class T>
void Block<T>::choose_watched() noexcept {
  const double expected = growth * last_total_;
  std::size_t needed = 0, kept = 0;
  for (int i = 0; i < points_; ++i) needed += matters(i, expected) ? 1 : 0;
  for (int i : gathered_) kept += matters(i, expected) ? 1 : 0;
  // Points too many cost less than a new matrix, up to a point.
  const bool keep = needed > 0 && kept == needed && gathered_.size() <= 2 * needed + 8;
  for (int i : watched_) is_watched_[static_cast<std::size_t>(i)] = 0;
  watched_.clear();
  if (keep)
    for (int i : gathered_) watch(i);
  else if (needed > 0)
    for (int i = 0; i < points_; ++i)
      if (matters(i, ahead * expected)) watch(i);
  if (!watched_.empty()) gather();
  find_allowed();
}

/// Makes up for the forces so far.
template <class T>
void Block<T>::watch(int point) noexcept {
  const auto i = static_cast<std::size_t>(point);
  if (is_predicted_[i] == 0) predict({&point, 1});
  is_watched_[i] = 1;
  watched_.push_back(point);
  held_push_(point) = 0;
  for (int j : held_) held_push_(point) += system_->S(j, point) * held_force_(j);
  for (int j : have_changed_) {
    const T* lag = &lag_[(static_cast<std::size_t>(j) * static_cast<std::size_t>(points_) + i) * lags_];
    for (int k = 1; k <= taken_; ++k) {
      const double force = changes_[static_cast<std::size_t>(j) * lags_ + static_cast<std::size_t>(k - 1)];
      if (force == 0) continue;
      for (int l = k; l <= length_; ++l) u_[at(point, l)] -= force * lag[l - k];
    }
  }
}

/// How much forces of a block may change before a point that is not watched could close.
template <class T>
void Block<T>::find_allowed() noexcept {
  allowed_ = std::numeric_limits<double>::infinity();
  for (int i = 0; i < points_; ++i)
    if (is_watched_[static_cast<std::size_t>(i)] == 0 && influence_(i) > 0)
      allowed_ = std::min(allowed_, margin_(i) / influence_(i));
}

template <class T>
void Block<T>::gather() noexcept {
  if (gathered_ == watched_) return;
  gathered_ = watched_;
  const auto n = static_cast<Eigen::Index>(watched_.size());
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) S_(i, j) = system_->S(watched_[i], watched_[j]);
  is_new_problem_ = true;
}

/// u when the block started.
template <class T>
double Block<T>::at_start(int point) const noexcept {
  if (was_watched_[static_cast<std::size_t>(point)] != 0) return ended_(point);
  double u = system_->s(point);
  for (int j : held_) u -= system_->R(j, point) * held_force_(j);
  for (Eigen::Index n = 0; n < system_->B.cols(); ++n)
    u += system_->B(point, n) * q_[static_cast<std::size_t>(n)];
  return u;
}

template <class T>
SolveStatus Block<T>::step(ComplementaritySolver& solver, Vector& force) noexcept {
  const bool deep = solver.statistics().limited > 0;
  const int l = taken_ + 1;
  double changed = 0;
  SolveStatus status = SolveStatus::solved;
  for (;;) {
    const auto n = static_cast<Eigen::Index>(watched_.size());
    bool closed = false;
    for (Eigen::Index k = 0; k < n; ++k) {
      rhs_(k) = u_[at(watched_[k], l)] + held_push_(watched_[k]) - system_->gap(watched_[k]);
      if (deep)
        rhs_(k) -= std::max(0.0, (taken_ > 0 ? u_[at(watched_[k], taken_)] : at_start(watched_[k])) -
                                     system_->gap(watched_[k]));
      closed = closed || !(rhs_(k) < 0);  // NaN included
    }
    if (closed) {
      if (is_new_problem_) solver.reset();
      is_new_problem_ = false;
      status = solver.solve(S_.topLeftCorner(n, n), rhs_.head(n), solution_.head(n));
      if (status != SolveStatus::solved && status != SolveStatus::limited) return status;
    } else {
      solution_.head(n).setZero();
    }
    changed = 0;
    for (Eigen::Index k = 0; k < n; ++k) changed += std::abs(solution_(k) - held_force_(watched_[k]));
    if (total_ + changed < allowed_) break;
    for (int i = 0; i < points_; ++i)
      if (is_watched_[static_cast<std::size_t>(i)] == 0 && matters(i, growth * (total_ + changed))) watch(i);
    gather();
    find_allowed();
  }
  total_ += changed;
  force.setZero();
  pushing_.clear();
  changed_.clear();
  change_.clear();
  for (std::size_t k = 0; k < watched_.size(); ++k) {
    const int i = watched_[k];
    force(i) = solution_(static_cast<Eigen::Index>(k));
    if (force(i) > 0) pushing_.push_back(i);
    const auto change = static_cast<T>(force(i) - held_force_(i));
    if (change == 0) continue;
    changed_.push_back(i);
    change_.push_back(change);
    changes_[static_cast<std::size_t>(i) * lags_ + static_cast<std::size_t>(l - 1)] = change;
    if (has_changed_[static_cast<std::size_t>(i)] == 0) have_changed_.push_back(i);
    has_changed_[static_cast<std::size_t>(i)] = 1;
  }
  if (!changed_.empty())
    loops_->near(lag_.data(), static_cast<std::size_t>(points_), lags_,
                 simd::padded(static_cast<std::size_t>(length_ - l + 1), simd::step_pad), changed_.data(),
                 change_.data(), changed_.size(), watched_.data(), watched_.size(), sum_.data(),
                 u_.data() + taken_, stride_);
  taken_ = l;
  return status;
}

template <class T>
void Block<T>::take_back() noexcept {
  taken_ = length_;
  for (int i : watched_) is_watched_[static_cast<std::size_t>(i)] = 0;
  watched_.clear();
}

template <class T>
void Block<T>::advance(Vector& q, Vector& v) noexcept {
  const auto steps = static_cast<std::size_t>(taken_);
  loops_->push(modes_, B_.data(), have_changed_.data(), have_changed_.size(), changes_.data(), lags_, steps,
               push_.data());
  for (std::size_t r = 0; r < rigid_.size(); ++r)
    for (std::size_t l = 0; l < steps; ++l) {
      double sum = 0;
      for (int i : have_changed_)
        sum += system_->B(i, rigid_[r]) * changes_[static_cast<std::size_t>(i) * lags_ + l];
      push_[l * modes_ + static_cast<std::size_t>(rigid_[r])] = static_cast<T>(sum);
    }
  loops_->pushed_motion(modes(), steps, push_.data(), q_.data(), v_.data());
  std::copy_n(q_.begin(), q.size(), q.begin());
  std::copy_n(v_.begin(), v.size(), v.begin());
}

template class Block<double>;
template class Block<float>;

}  // namespace ricochet::contact
