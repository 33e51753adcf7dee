// How far a run's main results (outcome.hpp) may be off, and through what: the scene is run again with one
// approximation made coarser or finer at a time.
//
// With r the outcome and |·| its relative distance, Δ the step and ⟨·⟩ the mean over the steps Δ and Δ/2,
// which averages what hangs on the step in which a point happens to touch:
//
//   step         max(4/3 |r(Δ) − r(Δ/4)|, |r(Δ) − r(Δ/2)|): exact for errors of first order in Δ
//   modes        |⟨r⟩ − ⟨r of the modes up to half, or three quarters, of the highest⟩| times ρ/(1 − ρ)
//   spacing      |⟨r⟩ − ⟨r of points twice as far apart⟩| times ρ/(1 − ρ)
//   mesh         |⟨r⟩ − ⟨r of elements of another order⟩| times what is left of it
//   eigensolver  |⟨r⟩ − ⟨r with frequencies off by A times their errors⟩| / A, A making the largest 1e-3
//   precision    |⟨r⟩ − ⟨r in single precision⟩|; in double precision 2⁻²⁹ of it, the ratio of their
//   round-offs
//
// ρ is that change over the one that halving the modes, or doubling the distance, once more makes; at most ½,
// and where it is below ¼ the change is taken for a quarter of the other one. Of vectors
// fitted to contact those above half of their band go, and instead of ρ/(1 − ρ) stands the error of the
// flexibility over the band (kernels/band.hpp) that they were made with, over the one that leaving these out
// makes; in full counts what vectors above the band change and, of rods, those above its half.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "contact/accuracy/quantities.hpp"
#include "contact/output/summary.hpp"
#include "ricochet/kernel.hpp"

namespace ricochet::contact {

/// Share of what the next lower order of elements changed that these still have, as measured; of elements of
/// order 1, which are compared with those of order 2: all.
double left_by_order(int order);

/// The scene that is run again.
struct Subject {
  /// The model with these kernels in the place of `kernels`, which it may refer to.
  std::function<Model(const std::vector<kernels::Kernel>&)> place;
  std::vector<kernels::Kernel> kernels;
  /// Of the same bodies in elements of another order; empty: there are none.
  std::vector<kernels::Kernel> other_order{};
  double left_of_other = 1;  ///< share of what the other order changes that is left in these: left_by_order
  double low_rank = 0;       ///< of vectors fitted to contact: threshold of the factors they were solved with
  bool at_rest = false;
  double duration = 0;  ///< [s]; not at rest
};

/// Runs a subject again and keeps what it came to.
class Estimator {
 public:
  /// Throws InputError as building the model does.
  explicit Estimator(Subject subject);
  Estimator(const Estimator&) = delete;  // the model refers to its subject's kernels
  Estimator& operator=(const Estimator&) = delete;

  const Model& model() const { return model_; }

  /// The subject itself. @return none when a step has no solution
  const std::optional<Outcome>& outcome(const StepOptions& options);

  /// Share of the step; 0 at rest.
  std::optional<double> step(const StepOptions& options);
  std::optional<double> precision(const StepOptions& options);
  /// All shares. The subject has touched (`Outcome::touched`), else there is nothing to estimate.
  ErrorEstimate estimate(const StepOptions& options);

 private:
  std::optional<Outcome> run(const Model& model, const StepOptions& options) const;
  std::optional<Outcome> mean(const Model& model, const StepOptions& options) const;
  std::optional<Outcome> mean(const std::vector<kernels::Kernel>& kernels, const StepOptions& options) const;
  std::optional<double> modes(const StepOptions& options, const Outcome& base);
  std::optional<double> spacing(const StepOptions& options, const Outcome& base) const;
  std::optional<double> mesh(const StepOptions& options, const Outcome& base) const;
  std::optional<double> eigensolver(const StepOptions& options, const Outcome& base) const;
  std::optional<Outcome> base(const StepOptions& options);

  Subject subject_;
  Model model_;
  std::map<std::pair<double, Precision>, std::optional<Outcome>> outcomes_;  ///< by step
};

}  // namespace ricochet::contact
