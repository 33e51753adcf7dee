// SPDX-License-Identifier: BSD-2-Clause
// Which shifts to work at, and what their results prove together. No MPI: the same on every rank.
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

/// Eigenvalue counts between the known ones: N(λ) − r as a power law through neighbouring probes.
class CountModel {
 public:
  /// @param rigid  zero eigenvalues
  CountModel(std::int64_t rigid, std::vector<Probe> probes);
  double count_at(double lambda) const;
  double lambda_at(double count) const;

 private:
  double rigid_;
  std::vector<Probe> probes_;  ///< by shift
};

/// A shift to work at and the eigenvalues wanted from it.
struct Task {
  double sigma = 0;
  Interval wanted;
};

/// What a shift gave.
struct Slice {
  Probe probe;
  Interval covered;
  std::vector<double> lambda;  ///< all eigenvalues in `covered`, ascending
};

/// The eigenvalues up to the highest probe, cut into intervals of about equal count, a shift in the middle of
/// each: a multiple of `teams` intervals, none with many more than `modes_per_shift` unless it is alone.
/// Wanted intervals of neighbours overlap by a few modes.
std::vector<Task> plan_shifts(const CountModel& model, double end, std::int64_t modes_per_shift, int teams);

/// Which of its modes each slice keeps: [first, behind) of Slice::lambda.
struct Share {
  std::size_t first = 0, behind = 0;
};

/// Where neighbouring slices meet, and what is still missing there.
struct Stitched {
  std::vector<Share> share;   ///< per slice; together each eigenvalue in (0, end) once
  std::vector<Task> missing;  ///< empty: every count between neighbouring shifts agrees with inertia
};

/// @param slices  by shift, ascending
/// @param end     where the search ends, with its count
/// Neighbours meet in the widest gap of the spectrum where both have all eigenvalues. As the inertia at both
/// shifts gives the number between them, agreement proves that none is missing.
Stitched stitch(std::int64_t rigid, const std::vector<Slice>& slices, const Probe& end);

}  // namespace ricochet::modes
