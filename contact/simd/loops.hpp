// SPDX-License-Identifier: BSD-2-Clause
// The loops of block stepping, compiled once for each instruction set and chosen at run time. They do not
// allocate, lock or call other functions. Arrays are padded with zeros: `modes` is a multiple of simd::pad.
#pragma once

#include <cstddef>

namespace ricochet::contact::simd {

/// The padded number of modes is a multiple of this.
constexpr std::size_t pad = 32;
/// The padded number of points is a multiple of this.
constexpr std::size_t point_pad = 16;

constexpr std::size_t padded(std::size_t n, std::size_t to = pad) { return (n + to - 1) / to * to; }

/// One step of each mode under the force f held over it: g = f − ω²q, q += b q̇ + c g, q̇ = e q̇ + h g.
struct Modes {
  std::size_t modes;
  const double *stiffness, *load, *b, *c, *e, *h;  ///< (modes); f without pushes: load − held
  // for the ledger
  const double *force, *held, *origin;        ///< (modes) constant load; part of contact in `load`; q0
  const double *damp_ss, *damp_sr, *damp_rr;  ///< (modes) 2δ∫S², 4δ∫SS', 2δ∫S'²
};

/// Changes of contact force that act on the modes in addition to the held force. Row k of `force` (·, stride)
/// contains the changes, by step, of the point with row[k] in B.
template <class T>
struct Pushes {
  const T* B;  ///< (·, modes)
  const int* row;
  std::size_t rows;
  const T* force;
  std::size_t stride;
};

/// Sums over some modes [J]: at the end, ½ q̇², ½ ω² q² and force · (q − origin); over the steps, the work of
/// damping and of contact.
struct Sums {
  double kinetic = 0, strain = 0, loads = 0, damping = 0, contact = 0;
};

/// Loops of one precision.
template <class T>
struct Loops {
  /// Motion without pushes: x (steps, modes) = q after each step. `forced` (steps, 2 modes), or null,
  /// contains the response of q and q̇ to the forcing in each step.
  void (*free_motion)(const Modes& m, std::size_t steps, const double* q, const double* v,
                      const double* forced, T* x);
  /// Motion under pushes: updates q and v (modes) in place, and stores q̇ after each step in `rates` (steps,
  /// modes) unless it is null.
  void (*pushed_motion)(const Modes& m, const Pushes<T>& pushes, std::size_t steps, double* q, double* v,
                        double* rates, Sums& sums);
  /// u[l][row[i]] += B[row[i]] · x[l] for l < steps; B (·, modes), x (steps, modes), u (·, stride).
  void (*displacement)(std::size_t modes, const T* B, const int* row, std::size_t rows, const T* x,
                       std::size_t steps, double* u, std::size_t stride);
  /// sum (width) = Σ_k factor[k] A[row[k]]; A (·, stride), width a multiple of point_pad.
  void (*combine)(std::size_t width, const T* A, std::size_t stride, const int* row, std::size_t rows,
                  const T* factor, T* sum);
  /// u[l] −= Σ_k force[k] lag[block[k]][l] for l < steps; lag (·, lags, width), u (·, stride), width a
  /// multiple of point_pad.
  void (*near)(std::size_t width, const T* lag, std::size_t lags, const int* block, std::size_t blocks,
               const T* force, std::size_t steps, double* u, std::size_t stride);
};

struct InstructionSet {
  const char* name;
  Loops<double> in_double;
  Loops<float> in_float;
};

}  // namespace ricochet::contact::simd
