// SPDX-License-Identifier: BSD-2-Clause
// Error estimates of the quantities of interest (quantities.hpp): the scene is run again with one
// approximation at a time made coarser or finer.
//
// With r the quantities and |·| their relative distance, Δ the step and ⟨·⟩ the mean over the steps Δ and
// Δ/2, which averages out the dependence on the step in which a point happens to touch:
//
//   step         max(4/3 |r(Δ) − r(Δ/4)|, |r(Δ) − r(Δ/2)|): exact for errors of first order in Δ
//   modes        |⟨r⟩ − ⟨r of the modes up to half, or three quarters, of the highest⟩| times ρ/(1 − ρ)
//   spacing      |⟨r⟩ − ⟨r of points twice as far apart⟩| times ρ/(1 − ρ)
//   mesh         |⟨r⟩ − ⟨r of elements of another order⟩| times the share of it that these elements keep
//   eigensolver  |⟨r⟩ − ⟨r with frequencies off by A times their errors⟩| / A, A making the largest 1e-3
//   precision    |⟨r⟩ − ⟨r in single precision⟩|; in double precision 2⁻²⁹ of it, the ratio of the round-offs
//
// ρ is that change over the one that halving the modes, or doubling the distance, once more makes; at most ½,
// and where it is below ¼ the change is replaced by a quarter of the other one. For a contact-adapted basis
// the vectors above half of its band are truncated, and ρ/(1 − ρ) is replaced by the error of the flexibility
// over the band (kernels/band.hpp) that the basis was made with, over the one that this truncation makes;
// changes by vectors above the band count in full and, for rods, those by vectors above its half.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "contact/accuracy/quantities.hpp"
#include "contact/output/summary.hpp"
#include "ricochet/kernel.hpp"

namespace ricochet::contact {

/// Share of the change from the next lower order of elements that these still have as an error, as measured;
/// elements of order 1, which are compared with those of order 2, have all of it.
double left_by_order(int order);

/// The scene that is run again.
struct Subject {
  /// The model with these kernels in place of `kernels`, in the same positions; it may refer to them.
  std::function<Model(const std::vector<kernels::Kernel>&)> rebuild;
  std::vector<kernels::Kernel> kernels;
  std::function<Model()> other_order{};  ///< the model of the bodies in elements of another order; null: none
  double left_of_other = 1;              ///< left_by_order of these kernels' elements
  double low_rank = 0;  ///< of a contact-adapted basis: threshold of the factors that it was solved with
  bool at_rest = false;
  double duration = 0;           ///< [s]; not at rest
  std::function<void()> poll{};  ///< called after each step; may throw to end the run
};

/// Runs a subject again and keeps the quantities of each run.
class Estimator {
 public:
  /// @param model  of the subject's kernels, its points coarsened `coarsenings` times. `subject` outlives the
  /// estimator.
  Estimator(const Subject& subject, Model model, int coarsenings = 0);

  const Model& model() const { return model_; }
  Model take_model() && { return std::move(model_); }

  /// The subject with its points coarsened once more; null where that leaves as many. Made once.
  std::unique_ptr<Estimator>& coarser();

  /// Quantities of the subject itself. @return none when a step has no solution
  const std::optional<Quantities>& quantities(const StepOptions& options);

  /// Share of the step; 0 at rest.
  std::optional<double> step(const StepOptions& options);
  std::optional<double> precision(const StepOptions& options);
  /// All shares. Requires that the subject touches (`Quantities::touched`).
  ErrorEstimate estimate(const StepOptions& options);

 private:
  std::optional<Quantities> run(const Model& model, const StepOptions& options) const;
  std::optional<Quantities> mean(const Model& model, const StepOptions& options) const;
  std::optional<Quantities> mean(const std::vector<kernels::Kernel>& kernels,
                                 const StepOptions& options) const;
  std::optional<double> modes(const StepOptions& options, const Quantities& base);
  std::optional<double> spacing(const StepOptions& options, const Quantities& base);
  std::optional<double> mesh(const StepOptions& options, const Quantities& base) const;
  std::optional<double> eigensolver(const StepOptions& options, const Quantities& base) const;
  std::optional<Quantities> base(const StepOptions& options);

  const Subject& subject_;
  Model model_;
  int coarsenings_;
  std::optional<std::unique_ptr<Estimator>> coarser_;                             ///< none: not sought yet
  std::map<std::pair<double, Precision>, std::optional<Quantities>> quantities_;  ///< by step
};

}  // namespace ricochet::contact
