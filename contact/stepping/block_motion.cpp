// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/block_motion.hpp"

#include <algorithm>

namespace ricochet::contact {

template <class T>
BlockForcing::BlockForcing(const BlockSystem<T>& system, bool any)
    : load(system.plain->load),
      highest_rest(Vector::Zero(system.points)),
      rest_q(Vector::Zero(any ? load.size() : 0)),
      rest_v(rest_q),
      modes_(system.modes),
      response_(any ? 2 * static_cast<std::size_t>(system.length) * modes_ : 0),
      s_(Matrix::Zero(any ? system.length + 1 : 2, system.points)) {}

void BlockForcing::set(const ForcedResponse::Piece& piece, double end, const Vector& gravity,
                       const Vector& s) noexcept {
  has_knot = piece.to <= end;
  forced = has_knot || !piece.steady;
  s_.row(0) = s.transpose();
  s_.row(1) = piece.s.transpose();
  jumps = !forced && s != piece.s;
  load = forced ? gravity : piece.load;
  highest_rest = piece.rest;
  if (!forced) return;
  highest_rest += ((end - piece.at) * piece.drift).cwiseMax(0);
  rest_q = piece.rest_q;
  rest_v = piece.rest_v;
}

void BlockForcing::set_response(int l, const Vector& q, const Vector& v, const Vector& s) noexcept {
  s_.row(l) = s.transpose();
  double* to = &response_[2 * (l - 1) * modes_];
  std::copy(q.begin(), q.end(), to);
  std::copy(v.begin(), v.end(), to + modes_);
}

template <class T>
BlockForce<T>::BlockForce(const BlockSystem<T>& system)
    : force(Vector::Zero(system.points)),
      on_modes(system.modes),
      on_rigid(system.rigid.size()),
      sum_(system.modes) {
  for (std::vector<int>* x : {&rows, &places}) x->reserve(system.points);
  factor_.reserve(system.points);
}

template <class T>
void BlockForce<T>::set(const BlockSystem<T>& system, const Vector& mean) noexcept {
  force = mean;
  rows.clear();
  places.clear();
  factor_.clear();
  for (int j = 0; j < system.points; ++j) {
    if (force(j) == 0) continue;
    rows.push_back(j);
    system.matrices->need(j);
    places.push_back(system.matrices->place(j));
    factor_.push_back(static_cast<T>(force(j)));
  }
  system.loops->combine(system.modes, system.B.data(), system.modes, rows.data(), rows.size(), factor_.data(),
                        sum_.data());
  std::copy_n(sum_.begin(), system.modes, on_modes.begin());
  for (std::size_t r = 0; r < on_rigid.size(); ++r) {
    on_rigid[r] = 0;
    for (int j : rows) on_rigid[r] += force(j) * system.rigid_B(j, r);
  }
}

template <class T>
double BlockForce<T>::yielded(const BlockSystem<T>& system, int row) const noexcept {
  double sum = 0;
  if (system.yields)
    for (const int j : rows) sum += system.plain->model->R(row, j) * force(j);
  return sum;
}

template <class T>
ForceChanges<T>::ForceChanges(const BlockSystem<T>& system)
    : length_(system.length), change_(system.points * length_), has_(system.points) {
  rows_.reserve(system.points);
}

template <class T>
void ForceChanges<T>::clear() noexcept {
  for (int row : rows_) {
    has_[row] = 0;
    std::fill_n(change_.begin() + row * length_, length_, T(0));
  }
  rows_.clear();
}

template <class T>
void ForceChanges<T>::add(int row, int step, T change) noexcept {
  change_[row * length_ + step] = change;
  if (has_[row] == 0) rows_.push_back(row);
  has_[row] = 1;
}

template <class T>
BlockMotion<T>::BlockMotion(const BlockSystem<T>& system)
    : q_(system.modes),
      v_(system.modes),
      load_(system.modes),
      rigid_v_(system.rigid.size()),
      predicted_(system.length * system.modes),
      rigid_(Matrix::Zero(system.length, std::ssize(system.rigid))),
      rates_(system.length * system.modes) {}

template <class T>
simd::Modes BlockMotion<T>::modes(const BlockSystem<T>& system, const BlockForce<T>& held) const noexcept {
  simd::Modes out = system.elastic;
  out.load = load_.data();
  out.held = held.on_modes.data();
  return out;
}

template <class T>
void BlockMotion<T>::start(const BlockSystem<T>& system, const Vector& q, const Vector& v,
                           const BlockForcing& forcing, const BlockForce<T>& held) noexcept {
  std::copy(q.begin(), q.end(), q_.begin());
  std::copy(v.begin(), v.end(), v_.begin());
  for (std::size_t r = 0; r < rigid_v_.size(); ++r) rigid_v_[r] = v(system.rigid[r]);
  std::fill(load_.begin(), load_.end(), 0.0);
  std::copy(forcing.load.begin(), forcing.load.end(), load_.begin());
  for (std::size_t n = 0; n < load_.size(); ++n) load_[n] -= held.on_modes[n];
  for (const int n : system.rigid) load_[n] = 0;
  system.loops->free_motion(modes(system, held), system.length, q_.data(), v_.data(), forcing.response(),
                            predicted_.data());
  predict_rigid(system, forcing, held);
}

template <class T>
void BlockMotion<T>::predict_rigid(const BlockSystem<T>& system, const BlockForcing& forcing,
                                   const BlockForce<T>& held) noexcept {
  const StepSystem& plain = *system.plain;
  for (std::size_t r = 0; r < system.rigid.size(); ++r) {
    const int n = system.rigid[r];
    const double load = forcing.load(n) - held.on_rigid[r];
    double q = q_[n], v = rigid_v_[r];
    for (int l = 1; l <= system.length; ++l) {
      q += plain.b(n) * v + plain.c(n) * load;
      v = plain.e(n) * v + plain.h(n) * load;
      if (forcing.forced) {
        q += forcing.of_q(l, n);
        v += forcing.of_v(l, n);
      }
      rigid_(l - 1, r) = q;
    }
  }
}

/// The loops stop rigid modes, whose constants are 0 there.
template <class T>
simd::Sums BlockMotion<T>::advance(const BlockSystem<T>& system, const BlockForcing& forcing,
                                   const BlockForce<T>& held, const ForceChanges<T>& changes, int from,
                                   int to, bool keep_rates) noexcept {
  simd::Sums sums;
  double* const rates = keep_rates ? &rates_[from * q_.size()] : nullptr;
  system.loops->pushed_motion(modes(system, held), changes.pushes(system.B.data(), from), to - from,
                              q_.data(), v_.data(), rates, sums);
  const StepSystem& plain = *system.plain;
  for (std::size_t r = 0; r < system.rigid.size(); ++r) {
    const int n = system.rigid[r];
    double &q = q_[n], &v = rigid_v_[r];
    for (int l = from; l < to; ++l) {
      double push = held.on_rigid[r];
      for (int i : changes.rows()) push += system.rigid_B(i, r) * static_cast<double>(changes.of(i)[l]);
      const double f = forcing.load(n) - push, dq = plain.b(n) * v + plain.c(n) * f;
      sums.damping += f * (plain.damp_ss(n) * f + plain.damp_sr(n) * v) + plain.damp_rr(n) * v * v;
      sums.contact += push * dq;
      q += dq;
      v = plain.e(n) * v + plain.h(n) * f;
      if (keep_rates) rates_[l * q_.size() + n] = v;
    }
    sums.kinetic += 0.5 * v * v;
    sums.loads += plain.load(n) * (q - plain.q0(n));
    v_[n] = v;
  }
  return sums;
}

template BlockForcing::BlockForcing(const BlockSystem<double>&, bool);
template BlockForcing::BlockForcing(const BlockSystem<float>&, bool);
template struct BlockForce<double>;
template struct BlockForce<float>;
template class ForceChanges<double>;
template class ForceChanges<float>;
template class BlockMotion<double>;
template class BlockMotion<float>;

}  // namespace ricochet::contact
