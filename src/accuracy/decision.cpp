// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/decision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "contact/accuracy/error_report.hpp"
#include "contact/accuracy/spectrum.hpp"
#include "src/accuracy/contact_zone.hpp"
#include "src/accuracy/local_refinement.hpp"
#include "src/accuracy/mesh_levels.hpp"

namespace ricochet::accuracy {

using contact::Cause;

namespace {

/// Factor by which a refinement is expected to reduce its share. The next round measures it.
constexpr double expected = 1.0 / 3;

/// Cost of refining a cause, relative to that of the kernels of the last round. Another mesh is a new
/// problem with two to three times as many unknowns; the others add vectors on the same mesh.
constexpr double cost_of_mesh = 3, cost_of_vectors = 1.3;

/// A cause is also refined if its share exceeds this part of the accuracy while kernels are computed anyway.
constexpr double worth_while = 0.25;

bool is_open(const scene::Scene& scene) { return scene.modes.open(); }

/// Ritz vectors cost a few solves for each candidate, whatever the band; modes cost a solve or two for each
/// mode in it. With few modes and many candidates, as in flat contact, modes are therefore cheaper.
/// The ends of rods meet with a shock, whose resonances only modes have.
scene::Basis cheaper_basis(const KernelSettings& settings, const contact::Model& model) {
  constexpr double blocks = 3;
  const double candidates = settings.zone ? expected_candidates(model, settings, *settings.zone)
                                          : static_cast<double>(model.gap.size());
  const bool few = static_cast<double>(model.omega.size()) < blocks * candidates;
  const bool rods = std::ranges::all_of(model.bodies, [](const contact::Model::BodyBlock& body) {
    return body.kernel->surface.corners() == 1;
  });
  return few || rods ? scene::Basis::modes : scene::Basis::contact;
}

/// Number of times that the band is doubled after the pilot.
constexpr int most_doublings = 2;

/// The band after the pilot: it is doubled as often as its share of the error suggests, but not beyond the
/// band that the force fills, below which all but ε² of the energy of the force lies.
Hertz band_after_pilot(const Settings& settings, const contact::Dialled& pilot, double accuracy) {
  Hertz band = settings.found.up_to;
  const double share = pilot.estimate->share(Cause::modes).value_or(0);
  // Where other shares are far larger, that of the band is not yet known.
  if (share <= worth_while * accuracy || share <= 0.1 * pilot.estimate->total() ||
      pilot.quantities->force.empty())
    return band;
  const double filled =
      contact::band_filled(pilot.quantities->force, 1 / settings.rate.value, accuracy * accuracy).value;
  double left = share;
  for (int k = 0; k < most_doublings && left > worth_while * accuracy && band.value < filled; ++k) {
    band.value *= 2;
    left *= expected;
  }
  return band;
}

/// The sizes that settings lead to, from those of the round with `before`. Unknowns of a solid grow with the
/// cube of order / size, and its modes with that of the band. Ritz vectors grow with the band and with the
/// candidates, which are nodes of a surface.
std::vector<BodySize> predicted(std::vector<BodySize> sizes, const KernelSettings& before,
                                const KernelSettings& after) {
  const double wider = after.up_to.value / before.up_to.value;
  const bool vectors = after.basis == scene::Basis::contact;
  for (BodySize& size : sizes) {
    double finer = 1;  // along each axis
    double local = 0;
    if (const auto was = before.mesh.find(size.body), is = after.mesh.find(size.body);
        was != before.mesh.end() && is != after.mesh.end()) {
      finer = is->second.order * was->second.size_factor / (was->second.order * is->second.size_factor);
      if (is->second.refine != was->second.refine) local = unknowns_in(is->second.refine, is->second.order);
    }
    size.unknowns = size.unknowns * finer * finer * finer + local;
    size.modes *= vectors ? wider * finer * finer : wider * wider * wider;
    size.modes = std::min(size.modes, size.unknowns);
  }
  return sizes;
}

/// Whether the elements have more unknowns than the band has modes.
bool is_resolved(const std::vector<BodySize>& sizes) {
  return std::ranges::all_of(sizes, [](const BodySize& size) { return size.modes < size.unknowns; });
}

bool is_affordable(const std::vector<BodySize>& sizes) {
  double work = 0;
  for (const BodySize& size : sizes) work += size.modes * size.unknowns;
  return work <= most_work;
}

std::string too_much(const std::vector<BodySize>& sizes) {
  const BodySize& largest =
      *std::ranges::max_element(sizes, {}, [](const BodySize& size) { return size.modes * size.unknowns; });
  return fmt::format(
      "the next round would compute about {:.1g} modes of {:.1g} unknowns of \"{}\", which is more than "
      "accuracy chooses: give modes.up_to_hz and bodies.*.order to go on",
      largest.modes, largest.unknowns, largest.body);
}

/// Settings of the next round, with what the estimate of its mesh needs to know of the last ones. Changes
/// that follow each other show a pace only if they are of the same elements.
Settings following(const Settings& last, Settings next, const contact::Dialled& round) {
  const MeshChange now = change_between(last.found, next.found);
  if (now == MeshChange{}) return next;
  next.coarser = last.found;
  const contact::Errors change = round.mesh_change.value_or(contact::Errors{});
  if (now.near_contact)
    next.change_near_contact.clear();
  else if (last_change(last) == only_near_contact)
    next.change_near_contact = change;
  next.coarser_change = now == last_change(last) ? change : contact::Errors{};
  return next;
}

/// Smaller elements near contact, and what follows from them.
struct FinerNearContact {
  std::map<std::string, std::vector<scene::FineBall>> balls;
  double cost;  ///< relative to that of the kernels of the last round
};

KernelSettings with_balls(KernelSettings settings,
                          const std::map<std::string, std::vector<scene::FineBall>>& balls) {
  for (const auto& [body, of_body] : balls) settings.mesh[body].refine = of_body;
  return settings;
}

double unknowns_of(const std::vector<BodySize>& sizes) {
  double sum = 0;
  for (const BodySize& size : sizes) sum += size.unknowns;
  return sum;
}

/// @return no value if there are none, or too many
std::optional<FinerNearContact> finer_near_contact(const scene::Scene& scene, const Settings& settings,
                                                   const contact::Dialled& round,
                                                   const std::vector<BodySize>& sizes) {
  auto balls = balls_near_contact(scene, settings.found.mesh, round);
  const KernelSettings finer = with_balls(settings.found, balls);
  if (finer == settings.found ||
      expected_candidates(round.model, finer, zone_near_contact(*round.quantities)) > most_candidates)
    return std::nullopt;
  const std::vector<BodySize> then = predicted(sizes, settings.found, finer);
  if (!is_affordable(then)) return std::nullopt;
  return FinerNearContact{std::move(balls),
                          std::max(cost_of_vectors, unknowns_of(then) / unknowns_of(sizes))};
}

/// Whether smaller elements were asked for but not made, as for a geometry that fixes their number.
bool size_is_fixed(const Settings& settings, const std::vector<BodySize>& sizes) {
  if (!settings.coarser) return false;
  return std::ranges::all_of(sizes, [&](const BodySize& size) {
    const auto was = settings.coarser->mesh.find(size.body), is = settings.found.mesh.find(size.body);
    return was != settings.coarser->mesh.end() && is != settings.found.mesh.end() &&
           was->second.order == is->second.order && size.unknowns == size.coarser_unknowns;
  });
}

struct Option {
  Cause cause;
  double share, cost;
};

/// What can be refined besides the basis.
struct Possible {
  bool finer = false;                     ///< elements everywhere
  std::optional<FinerNearContact> local;  ///< elements near contact, which also have more candidates
};

/// The options of a round, those that gain most for their cost first. Elements near contact reduce the share
/// of the spacing and, unless they were the last to be refined, most of that of the mesh. Where they cannot
/// be refined alone, finer elements everywhere also have more candidates, unless the scene gives their
/// spacing.
std::vector<Option> options_of(const scene::Scene& scene, const Possible& possible, const Settings& settings,
                               const contact::ErrorEstimate& estimate) {
  std::vector<Option> out;
  const auto share = [&](Cause cause) { return estimate.share(cause).value_or(0); };
  const double mesh = share(Cause::mesh), spacing = gives_spacing(scene) ? 0 : share(Cause::spacing);
  if (possible.local && last_change(settings) != only_near_contact) {
    out.push_back({Cause::spacing, spacing + mesh, possible.local->cost});
  } else if (possible.local) {
    out.push_back({Cause::spacing, spacing, possible.local->cost});
    if (possible.finer) out.push_back({Cause::mesh, mesh, cost_of_mesh});
  } else if (possible.finer) {
    out.push_back({Cause::mesh, mesh + spacing, cost_of_mesh});
  }
  if (is_open(scene)) out.push_back({Cause::modes, share(Cause::modes), cost_of_vectors});
  if (is_open(scene) && !scene.modes.flexibility_error)
    out.push_back({Cause::basis, share(Cause::basis), cost_of_vectors});
  if (settings.found.zone) out.push_back({Cause::zone, share(Cause::zone), cost_of_vectors});
  std::ranges::sort(out, std::greater{}, [](const Option& option) { return option.share / option.cost; });
  return out;
}

/// Why the largest cause cannot be refined.
std::string obstacle(const scene::Scene& scene, Cause cause) {
  const auto given = [](const std::string& key) { return key + " is given"; };
  switch (cause) {
    case Cause::mesh:
      return std::ranges::any_of(scene.bodies, &scene::Body::order_open)
                 ? "its elements are the finest that accuracy chooses"
             : std::ranges::any_of(scene.bodies, &scene::Body::meshable) ? given("bodies.*.order")
                                                                         : "the mesh is read as it is";
    case Cause::modes:
      return given(scene.modes.count ? fmt::format("modes.count = {}", *scene.modes.count)
                                     : fmt::format("modes.up_to_hz = {:g}", scene.modes.up_to->value));
    case Cause::basis:
      return given("modes.flexibility_error");
    case Cause::step:
      return scene.time.rate_by_accuracy
                 ? "the shortest step is reached"
                 : given(fmt::format("time.{}rate_hz = {:g}", scene.time.contact_rate ? "contact_" : "",
                                     1 / scene.time.step()));
    case Cause::eigensolver:
      return "of modes.relative_residual and modes.low_rank";
    case Cause::precision:
      return given("time.precision");
    case Cause::spacing:
      return gives_spacing(scene) ? given("contact.spacing")
                                  : "its elements are the finest that accuracy chooses";
    case Cause::zone:
      return given("contact.reach");
  }
  return "";
}

}  // namespace

bool gives_spacing(const scene::Scene& scene) {
  return !scene.contact.pairs.empty() &&
         std::ranges::all_of(scene.contact.pairs,
                             [](const scene::Pair& pair) { return pair.spacing.has_value(); });
}

Decision decide(const scene::Scene& scene, const Settings& settings, const contact::Dialled& round,
                const std::vector<BodySize>& sizes) {
  const int level = level_of(scene, settings.found).value_or(0);
  Settings next = settings;
  const auto with_finer_mesh = [&](Settings finer) {
    finer.found = at_level(finer.found, scene, level + 1);
    return finer;
  };
  const auto decided = [&](Settings chosen, std::string reason) {
    return Decision{following(settings, std::move(chosen), round), std::move(reason)};
  };
  if (!round.estimate) {
    if (!settings.coarser && has_finer(scene, level)) {
      return decided(with_finer_mesh(next), "nothing touches; the mesh");
    }
    return {{}, "nothing touches, so the settings are those of the start"};
  }
  const contact::ErrorEstimate& estimate = *round.estimate;
  const double accuracy = *scene.accuracy;
  Possible possible;
  const bool sizes_fixed = size_is_fixed(settings, sizes);
  possible.finer = has_finer(scene, level) && !sizes_fixed;
  // The zone of the pilot contains all that might touch, not only what did.
  const bool concentrated =
      (settings.coarser && settings.found.zone) ||
      (!round.quantities->pressed.empty() && zone_of(round.model, *round.quantities).has_value());
  if (concentrated && !sizes_fixed) possible.local = finer_near_contact(scene, settings, round, sizes);
  const auto with_finer_elements_near_contact = [&](Settings finer) {
    finer.found = with_balls(std::move(finer.found), possible.local->balls);
    if (finer.found.zone && round.quantities->nearer > 0)
      finer.found.zone = zone_near_contact(*round.quantities);
    if (is_open(scene)) finer.found.basis = cheaper_basis(finer.found, round.model);
    return finer;
  };
  if (!settings.coarser && has_finer(scene, level)) {
    if (scene.contact.scheme != Scheme::at_rest) next.found.zone = zone_of(round.model, *round.quantities);
    if (is_open(scene)) {
      next.found.basis = cheaper_basis(next.found, round.model);
      next.found.up_to = band_after_pilot(settings, round, accuracy);
    }
    if (!possible.local || estimate.share(Cause::spacing).value_or(0) <= worth_while * accuracy)
      return decided(with_finer_mesh(next), "mesh");
    return decided(with_finer_mesh(with_finer_elements_near_contact(next)), "mesh, spacing");
  }
  double total = estimate.total();
  if (total <= accuracy) return {{}, ""};

  const std::vector<Option> options = options_of(scene, possible, settings, estimate);
  double refinable = 0;
  for (const Option& option : options) refinable += option.share;
  // What cannot be reduced may exceed the accuracy. The rest is then refined only until it matters less.
  double fixed = total - refinable;
  const auto wanted = [&] { return std::max(accuracy, 2 * fixed); };
  std::set<Cause> chosen;
  std::map<Cause, std::string> excess;
  const auto choose = [&](Cause cause) {
    Settings refined = next;
    if (cause == Cause::mesh) refined = with_finer_mesh(refined);
    if (cause == Cause::spacing) refined = with_finer_elements_near_contact(refined);
    if (cause == Cause::modes) refined.found.up_to.value *= 2;
    if (cause == Cause::zone) *refined.found.zone *= 4;
    if (cause == Cause::basis) refined.found.flexibility_error /= 4;
    if (cause == Cause::modes && !is_resolved(predicted(sizes, settings.found, refined.found))) {
      if (!possible.finer) {
        excess[cause] =
            "its elements have no modes in a wider band, and they are the finest that accuracy chooses";
        return false;
      }
      refined = with_finer_mesh(refined);
    }
    const auto sizes_then = predicted(sizes, settings.found, refined.found);
    if (!is_affordable(sizes_then)) {
      excess[cause] = too_much(sizes_then);
      if (cause == Cause::mesh && !possible.local && !gives_spacing(scene))
        excess[Cause::spacing] = excess[cause];
      return false;
    }
    if (change_between(next.found, refined.found).elsewhere) chosen.insert(Cause::mesh);
    next = refined;
    chosen.insert(cause);
    return true;
  };
  for (const Option& option : options) {
    if (total <= wanted() || option.share <= worth_while * (total - wanted())) continue;
    if (choose(option.cause))
      total -= (1 - expected) * option.share;
    else
      fixed += option.share;
  }
  if (chosen.contains(Cause::mesh) || chosen.contains(Cause::spacing))  // new kernels anyway
    for (const Option& option : options)
      if (!chosen.contains(option.cause) && option.share > worth_while * accuracy) choose(option.cause);
  std::string refined;
  for (const Cause cause : chosen) refined += (refined.empty() ? "" : ", ") + std::string(name_of(cause));
  if (!refined.empty()) return decided(next, refined);
  contact::ErrorEstimate hindered = estimate;  // without the causes that were left because others matter more
  for (const Option& option : options)
    if (!excess.contains(option.cause)) {
      hindered.by_cause.erase(option.cause);
      if (option.cause == Cause::mesh && !possible.local && !gives_spacing(scene))
        hindered.by_cause.erase(Cause::spacing);
    }
  const auto largest = largest_cause(hindered);
  return {{},
          fmt::format("{} contributes {:.2g}: {}", name_of(*largest), *estimate.share(*largest),
                      excess.contains(*largest) ? excess[*largest] : obstacle(scene, *largest))};
}

}  // namespace ricochet::accuracy
