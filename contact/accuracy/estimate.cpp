// SPDX-License-Identifier: BSD-2-Clause
#include "contact/accuracy/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "contact/accuracy/inertia.hpp"
#include "contact/model/coarsening.hpp"
#include "contact/model/folding.hpp"
#include "contact/stepping/run_steps.hpp"
#include "kernels/algebra.hpp"
#include "kernels/band.hpp"
#include "kernels/mesh_error.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

/// Relative change of frequencies that makes their small errors visible.
constexpr double visible = 1e-3;

/// Ratio of the unit round-off of double precision to that of single precision, and the latter.
constexpr double double_over_single = 0x1p-29, single_round_off = 0x1p-24;

/// The change before, if it is known and finite.
std::optional<double> previous(const std::optional<Errors>& before, Quantity quantity) {
  if (!before || !before->contains(quantity) || !std::isfinite(before->at(quantity))) return std::nullopt;
  return before->at(quantity);
}

/// e(d, d') of the header for each quantity.
Errors remaining_of_proven_order(Errors change, const std::optional<Errors>& before) {
  for (auto& [quantity, d] : change) {
    const double earlier = previous(before, quantity).value_or(0);
    const double last = std::max(d, earlier / 4), pace = earlier > 0 ? std::min(last / earlier, 0.5) : 0.5;
    d = last * pace / (1 - pace);
  }
  return change;
}

/// Ratios of successive errors that are assumed where nothing proves an order.
struct Assumed {
  double pace;   ///< smallest ρ of e_q
  double floor;  ///< 2^−q: d counts at least as this part of d'
};

/// Of modes, and of points on edges and faces; of points on smooth surfaces, 2^(−3/2).
constexpr Assumed of_series{0.5, 0.5}, of_smooth_points{0.354, 0.354};

/// Largest ρ of e_q.
constexpr double slowest = 0.6;

/// e_q(d, d') of the header for each quantity.
Errors remaining(Errors change, const std::optional<Errors>& before, const Assumed& assumed) {
  for (auto& [quantity, d] : change) {
    const double earlier = previous(before, quantity).value_or(0);
    const double pace = d > 0 && earlier > 0 ? std::clamp(d / earlier, assumed.pace, slowest) : assumed.pace;
    d = std::max(d, assumed.floor * earlier) * pace / (1 - pace);
  }
  return change;
}

/// A series whose last change is more than this many times each change before has not begun to converge.
constexpr double growing = 2;

/// The largest last change of those requested quantities whose changes still grow; 0 if none does.
double largest_growing(const Errors& last, const std::optional<Errors>& before,
                       const std::optional<Errors>& first, const std::vector<Quantity>& requested) {
  double out = 0;
  for (const Quantity quantity : requested) {
    const double earlier =
        std::max(previous(before, quantity).value_or(0), previous(first, quantity).value_or(0));
    if (const auto d = previous(last, quantity); d && *d > growing * earlier) out = std::max(out, *d);
  }
  return out;
}

/// Frequencies at which the modes of the octave above a band are tried, and the part of R that they have.
constexpr int tried = 4;
constexpr double of_octave = 0.5;

/// Fewer modes in the upper half of a band do not represent those above it.
constexpr double fewest_excited = 2;

/// Whether the impulses of a pair excite fewer modes in the upper half of its band: (Σ b²)²/Σ b⁴ of their
/// participations b, which is N if N modes take part alike. @param end  of the band of each pair [rad/s]
bool excites_few(const Model& model, const Vector& impulse, const Vector& end) {
  for (std::size_t p = 0; p < model.pairs.size(); ++p) {
    const Vector w = model.pairs[p].part_of(impulse);
    const Eigen::ArrayXd square = (model.B.transpose() * w).array().square(),
                         top =
                             (model.omega.array() > end[static_cast<Eigen::Index>(p)] / 2).select(square, 0);
    if (!w.isZero(0) && !(std::pow(top.sum(), 2) >= fewest_excited * top.square().sum() && top.sum() > 0))
      return true;
  }
  return false;
}

/// A lever arm that is this part of the radius of gyration changes the effective mass of a body by 1 %.
constexpr double short_arm = 0.1;

/// How the pressed points of a pair hold its bodies.
struct Support {
  int points = 0;
  int kind = 0;  ///< 1: at one place, 2: along a line, 3: on a surface; 0 without points
};

/// At rest, no point is known not to be pressed.
bool is_pressed(const Quantities& run, Eigen::Index i) {
  return run.pressed.empty() || run.pressed[static_cast<std::size_t>(i)];
}

/// A patch that bulges by more than this part of its side is curved; flat ones do by round-off.
constexpr double curved = 1e-6;

bool is_curved(const Model& model, Eigen::Index i) {
  return model.bulge.size() > 0 && model.bulge(i) > curved * std::sqrt(model.area(i));
}

std::vector<Support> supports(const Model& model, const Quantities& run) {
  std::vector<Support> out;
  for (const Model::PairBlock& pair : model.pairs) {
    std::vector<Eigen::Index> pressed;
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i)
      if (is_pressed(run, i)) pressed.push_back(i);
    Support& here = out.emplace_back();
    if (pressed.empty()) continue;
    here = {static_cast<int>(pressed.size()), 1};
    double arm = std::numeric_limits<double>::infinity();
    for (const int k : {pair.a, pair.b})
      if (k >= 0) {
        const Bodies::Block& body = model.bodies[static_cast<std::size_t>(k)];
        if (body.supported || !(body.inertia.trace() > 0)) continue;  // it does not turn
        arm = std::min(arm, short_arm * std::sqrt(body.inertia.trace() / (2 * body.mass)));
      }
    Matrix at = model.point_a(pressed, Eigen::all);
    at.rowwise() -= at.colwise().mean().eval();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(Eigen::Matrix3d(at.transpose() * at),
                                                                Eigen::EigenvaluesOnly);
    const Eigen::Index wide = (spread.eigenvalues().array() > arm * arm * here.points).count();
    here.kind = static_cast<int>(std::min<Eigen::Index>(1 + wide, 3));
  }
  return out;
}

/// Whether fewer points hold the bodies as those of the finer model do: not one point of two on an edge.
bool holds_alike(const std::vector<Support>& fine, const std::vector<Support>& wide) {
  return std::ranges::equal(fine, wide, [](const Support& a, const Support& b) { return b.kind >= a.kind; });
}

/// Whether equilibrium alone gives the forces of a pair: of one point, two along a line or three on a
/// surface.
bool is_determinate(const std::vector<Support>& supports) {
  return std::ranges::any_of(supports, [](const Support& s) { return s.points > 0 && s.points <= s.kind; });
}

/// Whether bodies meet at one place of smooth surfaces, where the pressure falls to 0 like a square root, as
/// in Hertz's theory, and patches follow it with the order 3/2.
bool is_smooth(const Model& model, const Quantities& run, const std::vector<Support>& supports) {
  if (std::ranges::any_of(supports, [](const Support& s) { return s.kind > 1; })) return false;
  for (Eigen::Index i = 0; i < model.points(); ++i)
    if (is_pressed(run, i) && !is_curved(model, i)) return false;
  return true;
}

/// Whether bodies meet along an edge between flat faces.
bool is_sharp_edge(const Model& model, const Quantities& run, const std::vector<Support>& supports) {
  if (std::ranges::none_of(supports, [](const Support& s) { return s.kind == 2; })) return false;
  for (Eigen::Index i = 0; i < model.points(); ++i)
    if (is_pressed(run, i) && is_curved(model, i)) return false;
  return true;
}

bool is_rod(const kernels::Kernel& kernel) { return kernel.surface.corners() == 1; }

bool are_rods(const Model& model) {
  return std::ranges::all_of(model.bodies, [](const Bodies::Block& body) { return is_rod(*body.kernel); });
}

Errors scaled(Errors errors, double factor) {
  for (auto& [quantity, error] : errors) error *= factor;
  return errors;
}

/// No value if one of the runs failed.
std::optional<Errors> change(const std::optional<Quantities>& a, const std::optional<Quantities>& b) {
  if (!a || !b) return std::nullopt;
  return distances(*a, *b);
}

/// No error in any of these quantities.
Errors none(const Quantities& quantities) {
  Errors out;
  for (const auto& [quantity, figure] : quantities.figures) out[quantity] = 0;
  return out;
}

/// Relative errors of ω: half of Kato and Temple's bound r² λ/gap for λ, but at most half of the residual r.
std::vector<double> frequency_errors(const kernels::Modes& modes, double low_rank) {
  const std::vector<double>& omega = modes.angular_frequency;
  std::vector<double> error(omega.size(), 0.0);
  for (std::size_t n = 0; n < omega.size(); ++n) {
    if (omega[n] == 0) continue;
    if (modes.contact_adapted()) {
      error[n] = low_rank / 2;
      continue;
    }
    const double lambda = omega[n] * omega[n], r = modes.residual.empty() ? 0 : modes.residual[n];
    double gap = lambda;
    for (std::size_t other : {n - 1, n + 1})
      if (other < omega.size()) {
        const double apart = std::abs(omega[other] * omega[other] - lambda);
        if (apart > kernels::multiple_mode * lambda) gap = std::min(gap, apart);
      }
    error[n] = std::min(r, r * r * lambda / gap) / 2;
  }
  return error;
}

/// A share of the highest frequency that the elements resolve or, for a contact-adapted basis, of its band.
RadPerSecond end_of(const kernels::Kernel& kernel, double share) {
  const kernels::Modes& modes = kernel.modes;
  if (modes.contact_adapted())
    return RadPerSecond{share * RadPerSecond(Hertz{modes.certificate.upto_hz}).value};
  const std::size_t resolved = kernels::resolved_modes(kernel);
  return RadPerSecond{resolved > 0 ? share * modes.angular_frequency[resolved - 1] : 0};
}

/// Changes each frequency by `factor` times its error, up or down at random.
void detune(kernels::Modes& modes, const std::vector<double>& error, double factor) {
  std::minstd_rand random;
  for (std::size_t n = 0; n < error.size(); ++n)
    modes.angular_frequency[n] *= 1 + (random() % 2 == 0 ? factor : -factor) * error[n];
}

/// Share of the reach beyond which a pressed point shows that the reach may be too small.
constexpr double near_reach = 0.9;

}  // namespace

StepOptions with_step(StepOptions options, double step) {
  const double sample = options.steps_per_sample * options.step;
  options.step = step;
  if (options.contact.scheme == Scheme::compliant)
    options.steps_per_sample = std::max(1, static_cast<int>(std::lround(sample / step)));
  return options;
}

Estimator::Estimator(const Subject& subject, Model model, Estimator* finer)
    : subject_(subject),
      model_(std::move(model)),
      finer_(finer),
      coarsenings_(finer != nullptr ? finer->coarsenings_ + 1 : 0) {}

Estimator* Estimator::coarser() {
  if (!coarser_) {
    coarser_.emplace();
    Model wide = coarsened(model_);
    if (wide.gap.size() < model_.gap.size())
      *coarser_ = std::make_unique<Estimator>(subject_, std::move(wide), this);
  }
  return coarser_->get();
}

std::optional<Quantities> Estimator::run(const Model& model, const StepOptions& options) const {
  if (subject_.at_rest) return rest_quantities(model);
  const bool receivers = std::ranges::count(subject_.requested, Quantity::receivers) > 0;
  return impact_quantities(model, options, step_count(subject_.duration, 1 / options.step), receivers,
                           subject_.poll);
}

std::optional<Quantities> Estimator::run(const std::vector<kernels::Kernel>& kernels,
                                         const StepOptions& options) const {
  return run(coarsened(subject_.rebuild(kernels), coarsenings_), options);
}

const std::optional<Quantities>& Estimator::quantities(const StepOptions& options) {
  const std::pair key{options.step, options.precision};
  const auto known = quantities_.find(key);
  if (known != quantities_.end()) return known->second;
  const auto& found = quantities_.emplace(key, run(model_, options)).first->second;
  if (found && found->turn.angle > subject_.most_turn) throw TurnsTooFar{*found};
  return found;
}

const std::optional<Quantities>& Estimator::up_to(double share, const StepOptions& options) {
  const std::pair key{share, options.step};
  const auto known = up_to_.find(key);
  if (known != up_to_.end()) return known->second;
  std::vector<kernels::Kernel> fewer;
  for (const kernels::Kernel& kernel : subject_.kernels)
    fewer.push_back(kernels::truncated_above(kernel, end_of(kernel, share)));
  return up_to_.emplace(key, run(fewer, options)).first->second;
}

std::optional<Errors> Estimator::step(const StepOptions& options) {
  const auto whole = quantities(options);
  if (!whole) return std::nullopt;
  if (subject_.at_rest) return none(*whole);
  const auto last = change(whole, quantities(with_step(options, options.step / 2)));
  if (!last) return std::nullopt;
  // Steps of the impulse scheme may be unstable at 2Δ.
  const bool unstable = options.contact.scheme == Scheme::impulse;
  const auto before =
      unstable ? std::nullopt : change(whole, quantities(with_step(options, 2 * options.step)));
  // Shorter steps also sample more modes, unless they all are.
  Errors out = sampled(model_.omega.maxCoeff(), options.step) ? remaining_of_proven_order(*last, before)
                                                              : remaining(*last, before, of_series);
  for (auto& [quantity, error] : out) error += last->at(quantity);
  return out;
}

std::optional<Errors> Estimator::precision(const StepOptions& options) {
  const bool is_single = options.precision == Precision::float32;
  StepOptions other = options;
  other.precision = is_single ? Precision::float64 : Precision::float32;
  const auto here = quantities(options);
  std::optional<Quantities> there;
  if (options.contact.scheme == Scheme::compliant && !subject_.at_rest) {
    there = quantities(other);
  } else {
    // These schemes have no products in single precision, so the frequencies are rounded instead.
    std::vector<kernels::Kernel> kernels = subject_.kernels;
    for (kernels::Kernel& kernel : kernels)
      detune(kernel.modes, std::vector(kernel.modes.size(), single_round_off), 1);
    there = run(kernels, options);
  }
  const auto found = change(here, there);
  if (!found) return std::nullopt;
  return scaled(*found, is_single ? 1 : double_over_single);
}

std::optional<Vector> Estimator::ends_of_bands() const {
  const bool known = model_.has_residual && std::ranges::none_of(subject_.kernels, [](const auto& kernel) {
                       return is_rod(kernel) || kernel.modes.contact_adapted();
                     });
  if (!known) return std::nullopt;
  Vector end(std::ssize(model_.pairs));
  for (std::size_t p = 0; p < model_.pairs.size(); ++p) {
    double& lowest = end[static_cast<Eigen::Index>(p)] = std::numeric_limits<double>::infinity();
    for (const int k : {model_.pairs[p].a, model_.pairs[p].b})
      if (k >= 0) lowest = std::min(lowest, end_of(subject_.kernels[static_cast<std::size_t>(k)], 1).value);
    if (!(lowest > 0)) return std::nullopt;
  }
  return end;
}

std::optional<Errors> Estimator::above_band(const StepOptions& options, const Quantities& base,
                                            const Vector& end) const {
  Errors out = none(base);
  for (int k = 0; k < tried; ++k) {
    const auto found =
        change(base, run(with_inertia(model_, base.impulse, std::exp2((k + 0.5) / tried) * end), options));
    if (!found) return std::nullopt;
    for (auto& [quantity, square] : out) square += std::pow(found->at(quantity), 2) / tried;
  }
  for (auto& [quantity, error] : out) error = std::sqrt(error) / of_octave;
  return out;
}

std::optional<Errors> Estimator::modes(const StepOptions& options, const Quantities& base) {
  if (subject_.at_rest && model_.has_residual) return none(base);
  const auto end = options.contact.scheme == Scheme::compliant ? ends_of_bands() : std::nullopt;
  if (end && excites_few(model_, base.impulse, *end))
    if (const auto above = above_band(options, base, *end)) return above;
  const bool fewer = std::ranges::any_of(subject_.kernels, [](const kernels::Kernel& kernel) {
    return kernel.modes.size() > 0 && kernel.modes.angular_frequency.back() > end_of(kernel, 0.5).value;
  });
  if (!fewer) return std::nullopt;
  const auto half = up_to(0.5, options);
  auto last = change(base, half);
  if (!last) return std::nullopt;
  if (const auto nearly = change(base, up_to(0.75, options)))
    for (auto& [quantity, d] : *last) d = std::max(d, nearly->at(quantity));
  const auto quarter = up_to(0.25, options);
  const auto before = change(half, quarter);
  growing_change_ =
      largest_growing(*last, before, change(quarter, up_to(0.125, options)), subject_.requested);
  if (end && growing_change_ > 0)
    if (const auto above = above_band(options, base, *end)) {
      growing_change_ = 0;
      return above;
    }
  return remaining(*last, before, of_series);
}

std::optional<Errors> Estimator::basis(const StepOptions& options, const Quantities& base) {
  double left = 0, made = 0;
  for (const kernels::Kernel& kernel : subject_.kernels) {
    if (!kernel.modes.contact_adapted()) continue;
    if (is_rod(kernel) && !subject_.at_rest) return std::nullopt;
    left = std::max(left, kernel.modes.certificate.flexibility_error);
    made = std::max(made, kernels::truncation_error(kernel, end_of(kernel, 0.5), end_of(kernel, 1)));
  }
  if (left == 0 || (subject_.at_rest && model_.has_residual)) return none(base);
  const auto last = change(base, up_to(0.5, options));
  if (!last) return std::nullopt;
  return scaled(*last, left < made ? left / made : 1);
}

std::optional<Errors> Estimator::spacing(StepOptions options) {
  options.precision = Precision::float64;  // runs that the choice of points has made
  const auto base = quantities(options);
  if (!base) return std::nullopt;
  if (finer_ != nullptr) {
    auto out = finer_->spacing(options);
    const auto last = change(finer_->quantities(options), base);
    if (!out || !last) return std::nullopt;
    for (auto& [quantity, error] : *out) error += last->at(quantity);
    return out;
  }
  const bool rods =
      std::ranges::all_of(model_.bodies, [](const Bodies::Block& body) { return is_rod(*body.kernel); });
  if (rods) return none(*base);  // their ends are points
  const bool single = std::ranges::any_of(model_.pairs, [&](const Model::PairBlock& pair) {
    return pair.points == 1 &&
           (base->pressed.empty() || base->pressed[static_cast<std::size_t>(pair.first_point)]);
  });
  Estimator* const wide = coarser();
  if (single || !wide) return std::nullopt;
  const auto once = wide->quantities(options);
  const auto last = change(base, once);
  const std::vector<Support> support = supports(model_, *base);
  if (!last || !holds_alike(support, supports(wide->model_, *once))) return std::nullopt;
  // The flexibility of an edge grows by as much with each halving of the distance, down to the width of its
  // contact. Where bodies land again, it also shifts the touches that follow, and the change by one halving
  // may be small by accident.
  on_sharp_edge_ = base->touches_repeat() && is_sharp_edge(model_, *base, support);
  if (on_sharp_edge_) return std::nullopt;
  Estimator* const wider = wide->coarser();
  const auto twice = wider ? wider->quantities(options) : std::nullopt;
  const std::vector<Support> left = twice ? supports(wider->model_, *twice) : std::vector<Support>{};
  const bool comparable = twice && holds_alike(support, left) && !is_determinate(left);
  return remaining(*last, comparable ? change(once, twice) : std::nullopt,
                   is_smooth(model_, *base, support) ? of_smooth_points : of_series);
}

std::optional<Errors> Estimator::mesh(const StepOptions& options, const Quantities& base) {
  if (!std::ranges::all_of(subject_.kernels, kernels::has_mesh_error)) return std::nullopt;
  const auto changed = [&](const auto& changed_kernel) {
    std::vector<kernels::Kernel> others;
    for (const kernels::Kernel& kernel : subject_.kernels) others.push_back(changed_kernel(kernel));
    return change(base, run(others, options));
  };
  mesh_near_contact_ = changed(kernels::without_flexibility_error);
  const auto modes = changed(kernels::without_stiffness_error);
  if (!mesh_near_contact_ || !modes) return std::nullopt;
  Errors out = *mesh_near_contact_;
  for (auto& [quantity, error] : out) error += modes->at(quantity);
  return out;
}

std::optional<Errors> Estimator::eigensolver(const StepOptions& options, const Quantities& base) const {
  std::vector<kernels::Kernel> kernels = subject_.kernels;
  double largest = 0;
  for (const kernels::Kernel& kernel : kernels) {
    // A residual of 1 bounds nothing; imported modes without known residuals have this value.
    const auto unknown = [](double r) { return r >= 1; };
    if (!kernel.modes.contact_adapted() && std::ranges::any_of(kernel.modes.residual, unknown))
      return std::nullopt;
    for (const double error : frequency_errors(kernel.modes, subject_.low_rank))
      largest = std::max(largest, error);
  }
  if (largest == 0) return none(base);
  const double factor = visible / largest;
  for (kernels::Kernel& kernel : kernels)
    detune(kernel.modes, frequency_errors(kernel.modes, subject_.low_rank), factor);
  const auto found = change(base, run(kernels, options));
  if (!found) return std::nullopt;
  return scaled(*found, 1 / factor);
}

Errors Estimator::zone(const Quantities& base) const {
  Errors out = none(base);
  for (const Model::PairBlock& pair : model_.pairs) {
    if (!pair.reach || base.pressed.empty()) continue;
    const auto gap = model_.gap.segment(pair.first_point, pair.points);
    const double closest = gap.minCoeff();
    for (int i = 0; i < pair.points; ++i)
      if (base.pressed[static_cast<std::size_t>(pair.first_point + i)] &&
          gap[i] - closest > near_reach * (*pair.reach - closest))
        for (auto& [quantity, error] : out) error = 1;
  }
  return out;
}

ErrorEstimate Estimator::estimate(const StepOptions& options) {
  ErrorEstimate out{.requested = subject_.requested, .by_cause = {}};
  const auto base = quantities(options);
  if (!base) return out;
  out.front = are_rods(model_) && !subject_.at_rest;
  out.by_cause = {{Cause::mesh, mesh(options, *base)},
                  {Cause::modes, modes(options, *base)},
                  {Cause::basis, basis(options, *base)},
                  {Cause::step, step(options)},
                  {Cause::eigensolver, eigensolver(options, *base)},
                  {Cause::precision, precision(options)},
                  {Cause::spacing, spacing(options)},
                  {Cause::zone, zone(*base)}};
  return out;
}

}  // namespace ricochet::contact
