// SPDX-License-Identifier: BSD-2-Clause
// The modes over a look-ahead block: the force that is held in it, changes of this force, the forcing, and
// the motion under all of them.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <span>
#include <vector>

#include "contact/stepping/block_system.hpp"
#include "contact/stepping/forced_response.hpp"

namespace ricochet::contact {

/// Loads with histories and moving supports over a block.
struct BlockForcing {
  /// @param any  whether there are any
  template <class T>
  BlockForcing(const BlockSystem<T>& system, bool any);

  /// Sets a block from piece.at or later to `end` [s]. If it is forced afterwards, `set_response` must be
  /// called for all its steps. @param gravity  (N) constant modal force without loads  @param s  (n) at the
  /// start; it jumps within the first step if a push from outside has changed since
  void set(const ForcedResponse::Piece& piece, double end, const Vector& gravity, const Vector& s) noexcept;
  /// Sets the response of q, q̇ (N) to the forcing in step l = 1…L, and s (n) at the end of that step.
  void set_response(int l, const Vector& q, const Vector& v, const Vector& s) noexcept;

  /// (L, 2, modes) of q and q̇ in each step, or null.
  const double* response() const { return forced ? response_.data() : nullptr; }
  /// Response of q and q̇ of mode n in step l = 1…L.
  double of_q(int l, std::size_t n) const { return response_[2 * (l - 1) * modes_ + n]; }
  double of_v(int l, std::size_t n) const { return response_[(2 * (l - 1) + 1) * modes_ + n]; }
  /// s of a row at the end of step l, 0…L [m].
  double s(int l, int row) const { return s_(forced ? l : std::min(l, 1), row); }

  bool forced = false;    ///< whether the forcing changes in this block
  bool has_knot = false;  ///< whether a history has a knot in it
  bool jumps = false;     ///< whether s jumps in the first step, and nothing else changes
  Vector load;            ///< (N) constant modal force; forced: of gravity alone
  Vector highest_rest;    ///< (n) bound on u with elastic modes at rest
  Vector rest_q, rest_v;  ///< (N) forced: of the rest position under loads

  void archive(auto& a) { a(forced, has_knot, jumps, load, highest_rest, rest_q, rest_v, response_, s_); }

 private:
  std::size_t modes_;
  base::AlignedVector<double> response_;
  Matrix s_;  ///< (2, n): at the start, then; with forcing (L + 1, n)
};

/// The mean force λ̂ of the step before a block, which the block holds.
template <class T>
struct BlockForce {
  explicit BlockForce(const BlockSystem<T>& system);

  /// Computes the matrices of the rows that carry it. @param mean  (n)
  void set(const BlockSystem<T>& system, const Vector& mean) noexcept;
  /// R λ̂ at a row [m].
  double yielded(const BlockSystem<T>& system, int row) const noexcept;

  Vector force;                          ///< (n) λ̂
  base::AlignedVector<double> on_modes;  ///< (modes) Bᵀ λ̂ on elastic modes
  std::vector<double> on_rigid;          ///< (rigid) the same on rigid modes
  std::vector<int> rows, places;         ///< with λ̂ ≠ 0; of them in the matrices

  void archive(auto& a, const BlockSystem<T>& system) {
    a(force, on_modes, on_rigid, rows);
    if (!a.reads() || a.failed()) return;
    places.clear();
    for (const int row : rows) {
      system.matrices->need(row);
      places.push_back(system.matrices->place(row));
    }
  }

 private:
  std::vector<T> factor_;  ///< scratch
  base::AlignedVector<T> sum_;
};

/// The changes λ̄ − λ̂ so far in a block.
template <class T>
class ForceChanges {
 public:
  explicit ForceChanges(const BlockSystem<T>& system);

  void clear() noexcept;
  /// @param step  0…L − 1
  void add(int row, int step, T change) noexcept;

  std::span<const int> rows() const { return rows_; }  ///< that have any
  /// (L) of a row.
  const T* of(int row) const { return &change_[static_cast<std::size_t>(row) * length_]; }
  void archive(auto& a) { a(change_, rows_, has_); }

  /// Of the rows (·, L), from a step on.
  simd::Pushes<T> pushes(const T* B, int from) const {
    return {B, rows_.data(), rows_.size(), change_.data() + from, length_};
  }

 private:
  std::size_t length_;
  std::vector<T> change_;  ///< (n, L)
  std::vector<int> rows_;
  std::vector<char> has_;  ///< (n)
};

/// q and q̇ of all modes over a block.
template <class T>
class BlockMotion {
 public:
  explicit BlockMotion(const BlockSystem<T>& system);

  /// Computes the motion over the block from q, q̇ (N) under the held force and the forcing.
  void start(const BlockSystem<T>& system, const Vector& q, const Vector& v, const BlockForcing& forcing,
             const BlockForce<T>& held) noexcept;
  /// Advances q and q̇ from one step to another, under the changes of force, too. Without forcing.
  /// @param keep_rates  whether to record q̇ after each of these steps for rate()
  simd::Sums advance(const BlockSystem<T>& system, const BlockForcing& forcing, const BlockForce<T>& held,
                     const ForceChanges<T>& changes, int from, int to, bool keep_rates) noexcept;

  const base::AlignedVector<double>& q() const { return q_; }  ///< (modes)
  const base::AlignedVector<double>& v() const { return v_; }  ///< (modes) q̇
  /// (modes) q̇ after step l = 1…L.
  const double* rate(int l) const { return &rates_[(l - 1) * q_.size()]; }
  /// Of elastic modes, without changes of force: (modes) the constant load, and (L, modes) q after each step.
  const double* load() const { return load_.data(); }
  const T* predicted() const { return predicted_.data(); }
  const Matrix& rigid() const { return rigid_; }  ///< (L, rigid) q of the rigid modes, likewise

  /// Without the rates, which only the block of steps records that asks for them.
  void archive(auto& a) { a(q_, v_, load_, rigid_v_, predicted_, rigid_); }

 private:
  simd::Modes modes(const BlockSystem<T>& system, const BlockForce<T>& held) const noexcept;
  void predict_rigid(const BlockSystem<T>& system, const BlockForcing& forcing,
                     const BlockForce<T>& held) noexcept;

  base::AlignedVector<double> q_, v_, load_;
  std::vector<double> rigid_v_;
  base::AlignedVector<T> predicted_;
  Matrix rigid_;
  base::AlignedVector<double> rates_;  ///< (L, modes)
};

}  // namespace ricochet::contact
