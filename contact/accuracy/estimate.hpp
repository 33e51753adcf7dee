// SPDX-License-Identifier: BSD-2-Clause
// Error estimates of the quantities of interest (quantities.hpp): the scene is run again with one
// approximation at a time made coarser, or finer.
//
// Notation: r is a quantity, |·| its relative distance, and Δ the step. Each quantity has its own error:
//
//   step         d + e(d, |r(Δ) − r(2Δ)|) with d = |r(Δ) − r(Δ/2)|; 2 d for the impulse scheme, which is of
//                first order and may be unstable at 2Δ. e₁ instead of e if Δ does not sample all modes:
//                shorter steps then also extend the series of modes
//   modes        e₁(d₂, d₄) with d₂ = |r − r of the modes up to half of the band|, or up to three quarters
//                of it if that changes more, and d₄ the change if the band is halved once more. e_a instead
//                if these changes grow, or if the upper half of the band has fewer than two modes that the
//                impulse excites: twice the root mean square of |r − r with a mode in the octave above the
//                band| over frequencies of this mode, which has half of the residual flexibility R
//                (inertia.hpp). e_a is unknown without R, of Ritz vectors, and of rods, whose modes end an
//                impact in the same phase; growing_change() then tells that nothing shows convergence
//   basis        d₂ ε/ε₂ for Ritz vectors that were made with a flexibility error ε; ε₂ is the error of those
//                up to half of the band (kernels/band.hpp). Unknown on rods: their vectors ring at
//                frequencies of their own, which no run with fewer vectors reveals
//   spacing      e_q(d₂, d₄) with points twice and four times as far apart; q = 3/2 where smooth surfaces
//                meet at one place, 1 elsewhere. Unknown if a pair of surfaces has one point, which cannot be
//                coarsened, or if the coarser points do not hold the bodies as before: not one point of two
//                on an edge. d₄ is unknown if only the wider ones do not. Coarsened points have the share of
//                the points before, and the change from them. Unknown where touches repeat on a sharp edge
//   mesh         |r − r with R less its error| + |r − r with modes less theirs|, with the errors that
//                kernels estimate on their own meshes (kernels/mesh_error.hpp); unknown if one has none
//   eigensolver  |r − r with frequencies changed by A times their errors| / A,  A · largest error = 1e-3
//   precision    |r − r in single precision|; in double precision 2⁻²⁹ of it, the ratio of the round-offs
//   zone         1 if a point whose initial gap is near the reach was pressed, as points beyond may touch too
//
// d ρ/(1 − ρ) is the sum of all further changes if each is ρ = d/d' times the one before it. Either change
// may be small by chance.
//
//   e(d, d')     of an order that is proven, 1 or 2: ρ is at most ½, the ratio of errors of first order (and
//                the value used if d' is unknown), and d counts at least as d'/4, the ratio of second order
//   e_q(d, d')   of an order that nothing proves: ρ is at least ½, or 2^−q if q < 2, and at most 0.6; d
//                counts at least as d'/2^q. The series of modes and of points converge with the first order
//                where a front meets them; their changes fluctuate (q = 1). Patches on smooth surfaces follow
//                the square root with which pressure falls to 0 (q = 3/2)
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "contact/figures/error_estimate.hpp"
#include "contact/figures/quantities.hpp"
#include "ricochet/kernel.hpp"

namespace ricochet::contact {

/// Options with another step Δ [s]. The compliant scheme keeps its output samples, up to rounding.
StepOptions with_step(StepOptions options, double step);

/// The scene that is run several times.
struct Subject {
  /// Returns the model with the given kernels in place of `kernels`, in the same placement. The model may
  /// refer to the given kernels.
  std::function<Model(const std::vector<kernels::Kernel>&)> rebuild;
  std::vector<kernels::Kernel> kernels;
  double low_rank = 0;  ///< threshold of the low-rank factors with which a contact-adapted basis was solved
  bool at_rest = false;
  double duration = 0;  ///< [s]; unused at rest
  std::vector<Quantity> requested{Quantity::impulse, Quantity::rebound};
  std::function<void()> poll{};  ///< called after each step; may throw to end the run
  double most_turn = std::numeric_limits<double>::infinity();  ///< of a body in a run to be estimated [rad]
};

/// A run turned a body farther than its subject allows.
struct TurnsTooFar {
  Quantities run;
};

/// Runs a subject again and keeps the quantities of each run.
class Estimator {
 public:
  /// @param model  built from the subject's kernels
  /// @param finer  of a model with points coarsened once less; null if they are not coarsened
  /// `subject` and `finer` must outlive the estimator.
  Estimator(const Subject& subject, Model model, Estimator* finer = nullptr);

  const Model& model() const { return model_; }
  Model take_model() && { return std::move(model_); }

  /// An estimator of the subject with points coarsened once more, created by the first call; null if
  /// coarsening removes no point.
  Estimator* coarser();

  /// Quantities of the subject itself. @return no value if a step fails. Throws TurnsTooFar.
  const std::optional<Quantities>& quantities(const StepOptions& options);

  std::optional<Errors> step(const StepOptions& options);
  std::optional<Errors> precision(const StepOptions& options);
  std::optional<Errors> spacing(StepOptions options);
  /// The part of the share of the mesh that elements near contact have; no value if unknown. Set by
  /// estimate().
  const std::optional<Errors>& mesh_near_contact() const { return mesh_near_contact_; }
  /// The largest change of a requested quantity by the upper half of the band, of those that exceed twice the
  /// changes by the bands below; 0 if there is none. Set by estimate().
  double growing_change() const { return growing_change_; }
  /// Whether bodies land on a sharp edge again and again. Set by spacing() of points that are not coarsened.
  bool on_sharp_edge() const { return on_sharp_edge_; }
  /// The errors of all causes. The subject must touch (`Quantities::touched`).
  ErrorEstimate estimate(const StepOptions& options);

 private:
  std::optional<Quantities> run(const Model& model, const StepOptions& options) const;
  std::optional<Quantities> run(const std::vector<kernels::Kernel>& kernels,
                                const StepOptions& options) const;
  /// The subject with modes up to a share of its band.
  const std::optional<Quantities>& up_to(double share, const StepOptions& options);
  /// Of the band of each pair [rad/s]; no value if R says nothing about the modes above one.
  std::optional<Vector> ends_of_bands() const;
  /// The error due to the modes above the bands, from R. @param end  of the band of each pair [rad/s]
  std::optional<Errors> above_band(const StepOptions& options, const Quantities& base,
                                   const Vector& end) const;
  std::optional<Errors> modes(const StepOptions& options, const Quantities& base);
  std::optional<Errors> basis(const StepOptions& options, const Quantities& base);
  std::optional<Errors> mesh(const StepOptions& options, const Quantities& base);
  std::optional<Errors> eigensolver(const StepOptions& options, const Quantities& base) const;
  Errors zone(const Quantities& base) const;

  const Subject& subject_;
  Model model_;
  Estimator* finer_;
  int coarsenings_;                                    ///< of the points
  std::optional<std::unique_ptr<Estimator>> coarser_;  ///< no value before coarser() is called
  std::map<std::pair<double, Precision>, std::optional<Quantities>> quantities_;  ///< by step and precision
  std::map<std::pair<double, double>, std::optional<Quantities>> up_to_;  ///< by share of the band and step
  std::optional<Errors> mesh_near_contact_;
  double growing_change_ = 0;
  bool on_sharp_edge_ = false;
};

}  // namespace ricochet::contact
