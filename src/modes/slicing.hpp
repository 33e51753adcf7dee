// SPDX-License-Identifier: BSD-2-Clause
// Spectrum slicing: the choice of shifts, and the proof of completeness from their results. It uses no MPI;
// results are the same on every rank.
#pragma once

#include <cstdint>
#include <vector>

#include "src/modes/lanczos.hpp"

namespace ricochet::modes {

/// A shift and the number of eigenvalues below it.
struct Probe {
  double sigma = 0;
  std::int64_t below = 0;
};

/// Interpolates eigenvalue counts. The ratio of N(λ) − r to its estimate follows power laws through the
/// probes.
class CountModel {
 public:
  /// @param rigid  number r of zero eigenvalues
  CountModel(std::int64_t rigid, std::vector<Probe> probes, ExpectedCount expected);
  double count_at(double lambda) const;
  double lambda_at(double count) const;

 private:
  /// Logarithms of a shift, and of the ratio there.
  struct Known {
    double place, ratio;
  };
  double rigid_;
  std::vector<Known> known_;  ///< ascending
  ExpectedCount expected_;
};

/// A shift, and the eigenvalues sought from it.
struct Task {
  double sigma = 0;
  Interval wanted;
};

/// The result of a shift.
struct Slice {
  Probe probe;
  Interval covered;
  std::vector<double> lambda;  ///< all eigenvalues in `covered`, ascending
};

/// The number of vectors that a Lanczos iteration about the middle of an interval needs, about 1.9 for each
/// eigenvalue within 1.5 half-widths. Measured: 1.8 to 1.95, for plates and solids, from zero and from above.
double expected_vectors(const CountModel& model, const Interval& interval);

/// Divides the eigenvalues up to `end` into intervals that take about the same time, with a shift in the
/// middle of each. Unless there are few eigenvalues, the number of intervals is a multiple of `teams`. On
/// average, an interval has at most about `modes_per_shift` eigenvalues. Neighbouring intervals overlap by a
/// few modes.
std::vector<Task> plan_shifts(const CountModel& model, double end, std::int64_t modes_per_shift, int teams);

/// Modes that a slice keeps: [first, end) of Slice::lambda.
struct Share {
  std::size_t first = 0, end = 0;
};

/// The division of the spectrum among the slices, and the gaps that remain.
struct Stitched {
  std::vector<Share> share;   ///< per slice; together they contain each eigenvalue in (0, end) once
  std::vector<Task> missing;  ///< empty if every count between neighbouring shifts agrees with the inertia
};

/// Divides the spectrum among the slices. Neighbours are divided at the widest gap of the spectrum in which
/// both have all eigenvalues. The inertia at both shifts gives the number of eigenvalues between them
/// (Sturm-sequence count). If the number found agrees, none is missing.
/// @param slices  by shift, ascending
/// @param end     end of the search, with its count; slices may have shifts above it
Stitched stitch(std::int64_t rigid, const std::vector<Slice>& slices, const Probe& end);

}  // namespace ricochet::modes
