// The loops of block stepping, compiled once for each instruction set and chosen at run time. None allocates,
// locks or calls anything. Arrays are padded with zeros: `modes` is a multiple of simd::pad.
#pragma once

#include <cstddef>

namespace ricochet::contact::simd {

/// Modes come in multiples of this.
constexpr std::size_t pad = 16;
/// Steps of a block come in multiples of this.
constexpr std::size_t step_pad = 8;

constexpr std::size_t padded(std::size_t n, std::size_t to = pad) { return (n + to - 1) / to * to; }

/// One step of each mode under the force f held over it: g = f − ω²q, q += b q̇ + c g, q̇ = e q̇ + h g.
struct Modes {
  std::size_t modes;
  const double *stiffness, *load, *b, *c, *e, *h;  ///< (modes)
};

/// A and B of one precision.
template <class T>
struct Loops {
  /// Motion without contact: x (steps, modes) = q after each step.
  void (*free_motion)(const Modes& m, std::size_t steps, const double* q, const double* v, T* x);
  /// Motion under the modal forces `push` (steps, modes), taken off the load: q and v (modes) in place.
  void (*pushed_motion)(const Modes& m, std::size_t steps, const T* push, double* q, double* v);
  /// u[row[i]][l] += B[row[i]] · x[l] for l < steps; B (·, modes), x (steps, modes), u (·, stride).
  void (*displacement)(std::size_t modes, const T* B, const int* row, std::size_t rows, const T* x,
                       std::size_t steps, double* u, std::size_t stride);
  /// push (steps, modes) = Σ_i force[row[i]][l] B[row[i]]; force (·, stride).
  void (*push)(std::size_t modes, const T* B, const int* row, std::size_t rows, const T* force,
               std::size_t stride, std::size_t steps, T* push);
  /// u[row[i]][l] −= Σ_k force[k] lag[pushing[k]][row[i]][l] for l < steps, a multiple of step_pad;
  /// lag (points, points, lags), u (·, stride), `sum` (rows, lags) is scratch.
  void (*near)(const T* lag, std::size_t points, std::size_t lags, std::size_t steps, const int* pushing,
               const T* force, std::size_t pushed, const int* row, std::size_t rows, T* sum, double* u,
               std::size_t stride);
};

struct InstructionSet {
  const char* name;
  Loops<double> in_double;
  Loops<float> in_float;
};

/// Those that this processor has, `count` of them, the widest last.
const InstructionSet* const* available(std::size_t& count) noexcept;
/// The widest.
const InstructionSet& best() noexcept;

}  // namespace ricochet::contact::simd
