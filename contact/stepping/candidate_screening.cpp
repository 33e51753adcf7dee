// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/candidate_screening.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace ricochet::contact {
namespace {

/// Budget of a point, relative to its change of force in the previous block.
constexpr double growth = 2;

/// An upper bound on the sum of this many positive terms, each of which was rounded.
double at_least(float sum, std::size_t terms) {
  return static_cast<double>(sum) * (1 + 2 * static_cast<double>(terms + 2) *
                                             static_cast<double>(std::numeric_limits<float>::epsilon()));
}

}  // namespace

template <class T>
CandidateScreening<T>::CandidateScreening(const BlockSystem<T>& system)
    : loops_(&simd::loops_of<float>(*simd::available().back())), every_band_(bands) {
  for (Vector* x : {&margin_, &could_}) x->setZero(system.contacts);
  for (Vector* x : {&spent_, &budget_}) x->setZero(system.points);
  rigid_at_.setZero(system.length);
  std::iota(every_band_.begin(), every_band_.end(), 0);
  places_.reserve(system.points);
  factor_.reserve(std::max<std::size_t>(system.points, bands));
  sum_.assign(system.width, 0);
}

template <class T>
void CandidateScreening<T>::start(const BlockSystem<T>& system, std::span<const int> changed) noexcept {
  budget_.setZero();
  factor_.clear();
  places_.clear();
  for (int i : changed) {
    budget_(i) = growth * spent_(i);
    places_.push_back(system.matrices->place(i));
    factor_.push_back(rounded_up(budget_(i)));
  }
  combine(system, system.matrices->influence(), places_);
  for (int i = 0; i < system.contacts; ++i) could_(i) = at_least(sum_[i], changed.size());
  spent_.setZero();
}

/// sum_ = Σ_k factor_k row_k of a matrix (·, width), for the contacts
template <class T>
void CandidateScreening<T>::combine(const BlockSystem<T>& system, const float* rows,
                                    std::span<const int> of) noexcept {
  loops_->combine(simd::padded(system.contacts, simd::point_pad), rows, system.width, of.data(), of.size(),
                  factor_.data(), sum_.data());
}

/// Under a constant force, the energy of an elastic mode about its rest position never grows, and
/// |Σ B y| ≤ (Σ B²/ω²)^½ (Σ ω²y² + ẏ²)^½. Under steady loads, the rest position moves steadily.
template <class T>
void CandidateScreening<T>::bound_by_energy(const BlockSystem<T>& of, const BlockMotion<T>& motion,
                                            const BlockForcing& forcing, const BlockForce<T>& held) noexcept {
  factor_.clear();
  for (int j : held.rows) factor_.push_back(static_cast<float>(held.force(j)));
  combine(of, of.matrices->flexibility(), held.places);
  // Round-off, and what single precision flushes to 0. Forces beyond its range bound nothing.
  constexpr double least = std::numeric_limits<float>::min(),
                   round_off = std::numeric_limits<float>::epsilon();
  const double terms = static_cast<double>(held.rows.size() + 2), forces = held.force.cwiseAbs().sum();
  for (int i = 0; i < of.contacts; ++i) {
    const double slack = (2 * forces * round_off + least) * terms * of.largest(i) + least * (forces + terms);
    margin_(i) = of.gap(i) - forcing.highest_rest(i) + static_cast<double>(sum_[i]) - slack;
    if (!std::isfinite(sum_[i])) margin_(i) = -std::numeric_limits<double>::infinity();
  }

  factor_.clear();
  for (const std::vector<int>& band : of.band) {
    double energy = 0;
    for (int n : band) {
      double y = motion.q()[n] - motion.load()[n] * of.softness[n], rate = motion.v()[n];
      if (forcing.forced) {
        y -= forcing.rest_q(n);
        rate -= forcing.rest_v(n);
      }
      energy += of.elastic.stiffness[n] * y * y + rate * rate;
    }
    factor_.push_back(rounded_up(std::sqrt(energy)));
  }
  combine(of, of.reach.data(), every_band_);
  for (int i = 0; i < of.contacts; ++i) {
    margin_(i) -= at_least(sum_[i], bands);
    if (of.rigid.empty()) continue;
    rigid_at_.noalias() = motion.rigid() * of.rigid_B.row(i).transpose();
    margin_(i) -= rigid_at_.maxCoeff();
  }
}

template <class T>
bool CandidateScreening<T>::raise_budgets(const BlockSystem<T>& system, std::span<const int> points,
                                          const Vector& change) noexcept {
  places_.clear();
  factor_.clear();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const int i = points[k];
    const double spent = spent_(i) + change(k);
    if (spent <= budget_(i)) continue;
    places_.push_back(system.matrices->place(i));
    factor_.push_back(rounded_up(growth * spent - budget_(i)));
    budget_(i) = growth * spent;
  }
  if (places_.empty()) return false;
  combine(system, system.matrices->influence(), places_);
  for (int i = 0; i < system.contacts; ++i) could_(i) += at_least(sum_[i], places_.size());
  return true;
}

template class CandidateScreening<double>;
template class CandidateScreening<float>;

}  // namespace ricochet::contact
