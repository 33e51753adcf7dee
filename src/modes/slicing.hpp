// SPDX-License-Identifier: BSD-2-Clause
// Spectrum slicing: the choice of shifts, and the proof of completeness from their results. It uses no MPI;
// results are the same on every rank.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "src/modes/lanczos.hpp"

namespace ricochet::modes {

/// A shift and the number of eigenvalues below it.
struct Probe {
  double sigma = 0;
  std::int64_t below = 0;
};

/// Interpolates eigenvalue counts: between probes, N(λ) − r is a power of its estimate. It never decreases.
class CountModel {
 public:
  /// @param rigid  number r of zero eigenvalues
  CountModel(std::int64_t rigid, std::vector<Probe> probes, ExpectedCount expected);
  double count_at(double lambda) const;
  double lambda_at(double count) const;

 private:
  /// Logarithms of the estimate at a shift, and of the count there.
  struct Known {
    double expected, count;
  };
  double rigid_, highest_ = 1;  ///< the highest shift of a probe
  std::vector<Known> known_;    ///< ascending
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

/// Largest number of Lanczos vectors for each mode of a full slice, for which memory is planned.
inline constexpr double most_vectors = 3.2;

/// The number of vectors that a Lanczos iteration about the middle of an interval needs, about 1.9 for each
/// eigenvalue within 1.5 half-widths. Measured: 1.8 to 1.95, for plates and solids, from zero and from above.
double expected_vectors(const CountModel& model, const Interval& interval);

/// The same about the shift of a task, from which an iteration reaches as far on either side.
double expected_vectors(const CountModel& model, const Task& task);

/// Divides the eigenvalues up to `end` into intervals that take about the same time, with a shift in the
/// middle of each. Unless there are few eigenvalues, the number of intervals is a multiple of `teams`. On
/// average, an interval has at most about `modes_per_shift` eigenvalues. Neighbouring intervals overlap by a
/// few modes.
std::vector<Task> plan_shifts(const CountModel& model, double end, std::int64_t modes_per_shift, int teams);

/// Plans shifts where K − σM has been factored at one of them for each team, of which the plan makes use as
/// far as it can: the intervals are placed about these shifts.
/// @param factored  ascending; of one team, it becomes the highest shift
/// @return the tasks, ascending; nothing if the plan would take much more time than one with other shifts
std::optional<std::vector<Task>> plan_about(const CountModel& model, double end, std::int64_t modes_per_shift,
                                            const std::vector<double>& factored);

/// The order in which teams process tasks: first the last task of each of as many equal parts of the spectrum
/// as there are teams, then the one before it, and so on. The first counts are then spread over the spectrum.
std::vector<Task> in_order(const std::vector<Task>& ascending, int teams);

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
