// SPDX-License-Identifier: BSD-2-Clause
// Error estimates of the quantities of interest (quantities.hpp): the scene is run again with one
// approximation at a time made coarser or finer.
//
// Notation: r are the quantities, |·| is their relative distance, and Δ is the step. ⟨·⟩ is the mean over
// runs at Δ and Δ/2, because results depend slightly on the step in which a point happens to touch.
//
//   step         max(4/3 |r(Δ) − r(Δ/4)|, |r(Δ) − r(Δ/2)|): exact for errors of first order in Δ
//   modes        d ρ/(1 − ρ),  d = |⟨r⟩ − ⟨r of the modes up to half of the highest frequency⟩|
//                (up to three quarters of it, if that changes more)
//   spacing      d ρ/(1 − ρ),  d = |⟨r⟩ − ⟨r of points twice as far apart⟩|
//   mesh         left_by_order() · |⟨r⟩ − ⟨r of elements of another order⟩|
//   eigensolver  |⟨r⟩ − ⟨r with frequencies changed by A times their errors⟩| / A,  A · largest error = 1e-3
//   precision    |⟨r⟩ − ⟨r in single precision⟩|; in double precision 2⁻²⁹ of it, the ratio of the round-offs
//
// ρ is the ratio of d to the change that follows when the modes are halved, or the distance is doubled, once
// more. Either change may be small by chance. Therefore ρ is at most ½, and if it is below ¼, d is replaced
// by a quarter of the other change.
//
// Contact-adapted bases have their own estimate of `modes`, d e/e' but at most d. Here d is the change due to
// truncating the vectors above half of the band, e' the flexibility error (kernels/band.hpp) of this
// truncation, and e the flexibility error with which the basis was made. The estimate is at least the change
// due to truncating the vectors above the band. For rods, d counts in full.
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

/// Error of elements of this order, as a share of the change of results between them and elements of the next
/// lower order, as measured. Elements of order 1 are compared with those of order 2 and have a share of 1.
double left_by_order(int order);

/// The scene that is run several times.
struct Subject {
  /// Returns the model with the given kernels in place of `kernels`, in the same placement. The model may
  /// refer to the given kernels.
  std::function<Model(const std::vector<kernels::Kernel>&)> rebuild;
  std::vector<kernels::Kernel> kernels;
  std::function<Model()> other_order{};  ///< returns the model in elements of another order; may be null
  double left_of_other = 1;              ///< left_by_order of the elements of `kernels`
  double low_rank = 0;  ///< threshold of the low-rank factors with which a contact-adapted basis was solved
  bool at_rest = false;
  double duration = 0;           ///< [s]; unused at rest
  std::function<void()> poll{};  ///< called after each step; may throw to end the run
};

/// Runs a subject again and keeps the quantities of each run.
class Estimator {
 public:
  /// @param model  built from the subject's kernels, with points coarsened `coarsenings` times
  /// `subject` must outlive the estimator.
  Estimator(const Subject& subject, Model model, int coarsenings = 0);

  const Model& model() const { return model_; }
  Model take_model() && { return std::move(model_); }

  /// An estimator of the subject with points coarsened once more, created by the first call; null if
  /// coarsening removes no point.
  std::unique_ptr<Estimator>& coarser();

  /// Quantities of the subject itself. @return no value if a step fails
  const std::optional<Quantities>& quantities(const StepOptions& options);

  /// Share of the time step; 0 at rest.
  std::optional<double> step(const StepOptions& options);
  std::optional<double> precision(const StepOptions& options);
  /// All shares. The subject must touch (`Quantities::touched`).
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
  std::optional<std::unique_ptr<Estimator>> coarser_;  ///< no value before coarser() is called
  std::map<std::pair<double, Precision>, std::optional<Quantities>> quantities_;  ///< by step and precision
};

}  // namespace ricochet::contact
