// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/decision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "contact/accuracy/error_report.hpp"
#include "contact/figures/spectrum.hpp"
#include "kernels/band.hpp"
#include "src/accuracy/contact_zone.hpp"
#include "src/accuracy/local_refinement.hpp"
#include "src/accuracy/mesh_levels.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::accuracy {

using contact::Cause;

namespace {

/// Factor by which a refinement is expected to reduce its share. The next round measures it.
constexpr double expected = 1.0 / 3;

/// Cost of refining a cause, relative to that of the kernels of the last round. Another mesh is a new
/// problem with two to three times as many unknowns; the others add vectors on the same mesh, eight times as
/// many if they are modes of solids.
constexpr double cost_of_mesh = 3, cost_of_vectors = 1.3, cost_of_modes_of_solids = 4;

/// Factor by which the next order is expected to reduce the share of the mesh. From order 2 to 3, errors of
/// frequencies fell to between a seventh and a seventeenth on three bodies, those of flexibilities to between
/// an eighth and two thirds.
constexpr double expected_of_level = 4;

/// A cause is also refined if its share exceeds this part of the accuracy while kernels are computed anyway.
constexpr double worth_while = 0.25;

/// Ritz vectors that a contact-adapted basis holds for each candidate.
constexpr double blocks_of_vectors = 3;

bool is_open(const scene::Scene& scene) { return scene.modes.open(); }

/// Ritz vectors cost a few solves for each candidate, whatever the band; modes cost a solve or two for each
/// mode in it. With few modes and many candidates, as in flat contact, modes are therefore cheaper.
/// The ends of rods meet with a shock, whose resonances only modes have. A body that turns has its whole
/// surface as candidates. Where touches repeat, bodies still ring from the touch before, Ritz vectors at
/// frequencies of their own, and what follows is chaotic: for a bracket on an edge, a change of a velocity by
/// 1e-12 changed the impulse by up to 0.008; of modes, by less than 1e-4.
scene::Basis basis_of_next(const scene::Scene& scene, const KernelSettings& settings,
                           const contact::Dialled& round, const std::vector<BodySize>& sizes) {
  const contact::Model& model = round.model;
  if (scene.motion.is_finite() || round.quantities->touches_repeat()) return scene::Basis::modes;
  double modes = 0;
  for (const BodySize& size : sizes) modes += size.modes;
  const double candidates = settings.zone ? expected_candidates(model, settings, *settings.zone)
                                          : static_cast<double>(model.gap.size());
  const bool few = modes < blocks_of_vectors * candidates;
  const bool rods = std::ranges::all_of(sizes, [](const BodySize& size) { return size.dimension == 1; });
  return few || rods ? scene::Basis::modes : scene::Basis::contact;
}

/// Whether twice the band has eight times as many vectors, and not twice as many.
bool has_modes_of_solids(scene::Basis basis, const std::vector<BodySize>& sizes) {
  return basis == scene::Basis::modes &&
         std::ranges::any_of(sizes, [](const BodySize& size) { return size.dimension == 3; });
}

/// The band after the pilot: it is doubled as often as its share of the error suggests, but at most twice,
/// modes of solids once, and not beyond the band that the force fills, below which all but ε² of the energy
/// of the force lies.
Hertz band_after_pilot(const Settings& settings, const contact::Dialled& pilot,
                       const std::vector<BodySize>& sizes, double accuracy) {
  const int most_doublings = has_modes_of_solids(settings.found.basis, sizes) ? 1 : 2;
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

/// Unknowns that elements of a body near contact add, and the factor of those everywhere.
struct Growth {
  double factor = 1, near_contact = 0;
};

/// How much closer the nodes of a body are along each axis, apart from those near contact.
double finer_everywhere(const MeshSettings& was, const MeshSettings& is) {
  return is.order * was.size_factor / (was.order * is.size_factor);
}

Growth growth_of(const MeshSettings& was, const MeshSettings& is, const BodySize& size) {
  const double finer = finer_everywhere(was, is);
  const auto near_contact = [&](const auto& balls) { return unknowns_in(balls, is.order, size.width); };
  return {std::pow(finer, size.dimension), std::max(0.0, near_contact(is.refine) - near_contact(was.refine))};
}

/// The sizes that settings lead to, from those of the round. Unknowns of a solid grow with the cube of order
/// / size, and its modes with that of the band. Ritz vectors grow with the band and with the candidates,
/// which are nodes of a surface.
std::vector<BodySize> predicted(std::vector<BodySize> sizes, const KernelSettings& before,
                                const KernelSettings& after) {
  const double wider = after.up_to.value / before.up_to.value;
  const bool adapted = after.basis == scene::Basis::contact;
  for (BodySize& size : sizes) {
    Growth growth;
    const auto was = before.mesh.find(size.body), is = after.mesh.find(size.body);
    if (was != before.mesh.end() && is != after.mesh.end()) growth = growth_of(was->second, is->second, size);
    size.unknowns = size.unknowns * growth.factor + growth.near_contact;
    size.modes = std::min(size.modes * std::pow(wider, size.dimension), size.unknowns);
    // The nodes of a surface grow with the power 2/3 of those of the body.
    if (size.candidates > 0)
      size.candidates =
          size.candidates * std::pow(growth.factor, 2.0 / 3) + std::pow(growth.near_contact / 3, 2.0 / 3);
    size.vectors = adapted ? std::min(size.vectors * wider * std::pow(growth.factor, 2.0 / 3), size.unknowns)
                           : size.modes;
  }
  return sizes;
}

/// Whether the elements resolve the modes of the band.
bool is_resolved(const std::vector<BodySize>& sizes) {
  return std::ranges::all_of(
      sizes, [](const BodySize& size) { return size.modes <= kernels::resolved_part * size.unknowns; });
}

/// Numbers of candidates that the kernels of a round hold.
struct Candidates {
  double count = 0;
  double refined = 0;  ///< with elements that are finer everywhere, if they become finer there; otherwise 0
};

/// Without a zone, kernels hold all candidates of their surfaces.
/// @param was  the settings of the model, @param is  those of the round
Candidates candidates_of(const contact::Model& model, const KernelSettings& was, const KernelSettings& is) {
  const double zone = is.zone.value_or(std::numeric_limits<double>::infinity());
  double finer = 1;
  for (const auto& [body, mesh] : is.mesh)
    if (const auto before = was.mesh.find(body); before != was.mesh.end())
      finer = std::max(finer, finer_everywhere(before->second, mesh));
  Candidates out{.count = expected_candidates(model, is, zone)};
  if (finer > 1) {
    const auto within = static_cast<double>(candidates_within(model, zone)),
               all = is.zone ? 0 : static_cast<double>(largest_surface(model));
    out.refined = finer * finer * std::max(within, all);
    out.count = std::max(out.count, out.refined);
  }
  return out;
}

/// What a round with these settings would compute that is more than accuracy chooses; empty if it is
/// affordable.
std::string excess(const std::vector<BodySize>& sizes, const Candidates& candidates) {
  const auto candidates_of_body = [&](const BodySize& size) {
    return std::max(candidates.count, size.candidates);
  };
  const auto work_of = [&](const BodySize& size) {
    return (size.vectors + candidates_of_body(size)) * size.unknowns;
  };
  double work = 0, turning = 0;  // candidates of bodies that turn
  for (const BodySize& size : sizes) {
    work += work_of(size);
    turning += size.candidates;
  }
  const BodySize& largest = *std::ranges::max_element(sizes, {}, work_of);
  if (work <= most_work && largest.unknowns <= most_unknowns &&
      std::max(turning, candidates.refined) <= most_candidates)
    return "";
  const double responses = candidates_of_body(largest);
  return fmt::format(
      "the next round would compute about {:.1g} modes{} of {:.1g} unknowns of \"{}\", which is more than "
      "accuracy chooses: give modes.up_to_hz and bodies.*.order to go on",
      largest.vectors, responses > 0 ? fmt::format(" and the response to {:.1g} candidates", responses) : "",
      largest.unknowns, largest.body);
}

/// Settings of the next round, and what it must know of this one.
Settings following(const Settings& last, Settings next, const std::vector<BodySize>& sizes) {
  next.pilot = false;
  next.found.view = true;
  next.elements_before.clear();
  for (const BodySize& size : sizes)
    if (last.found.mesh.contains(size.body)) {
      const MeshSettings &was = last.found.mesh.at(size.body), &is = next.found.mesh.at(size.body);
      if (was.size_factor != is.size_factor || was.refine != is.refine)
        next.elements_before[size.body] = size.elements;
    }
  return next;
}

/// Smaller elements near contact, and what follows from them.
struct FinerNearContact {
  double denser = 2;  ///< factor by which the distance of candidates falls
  std::map<std::string, std::vector<scene::FineBall>> balls{};
  double cost = 1;  ///< relative to that of the kernels of the last round
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

/// @param fixed  bodies whose elements cannot be smaller
/// @return no value if there are none, or too many
std::optional<FinerNearContact> finer_near_contact(const scene::Scene& scene, const Settings& settings,
                                                   const contact::Dialled& round,
                                                   const std::vector<BodySize>& sizes,
                                                   const std::set<std::string>& fixed, double denser) {
  FinerNearContact out{.denser = denser,
                       .balls = balls_near_contact(scene, settings.found.mesh, round, denser)};
  for (const std::string& body : fixed) out.balls.erase(body);
  const KernelSettings finer = with_balls(settings.found, out.balls);
  if (finer == settings.found ||
      expected_candidates(round.model, finer, zone_near_contact(*round.quantities)) > most_candidates)
    return std::nullopt;
  const std::vector<BodySize> then = predicted(sizes, settings.found, finer);
  const double zone = zone_with_finer_elements(round.model, *round.quantities, denser);
  if (!excess(then, {.count = expected_candidates(round.model, finer, zone)}).empty()) return std::nullopt;
  out.cost = std::max(cost_of_vectors, unknowns_of(then) / unknowns_of(sizes));
  return out;
}

/// Bodies whose geometry fixes the number of elements, since smaller ones were asked for but not made.
std::set<std::string> with_fixed_elements(const Settings& settings, const std::vector<BodySize>& sizes) {
  std::set<std::string> out;
  for (const BodySize& size : sizes)
    if (const auto before = settings.elements_before.find(size.body);
        before != settings.elements_before.end() && before->second == size.elements)
      out.insert(size.body);
  return out;
}

/// A row of the table of causes.
struct Row {
  Cause cause;
  double share = 0;                             ///< that its refinement reduces
  bool unknown = false;                         ///< whether the share must be measured by a refinement first
  double cost = 1;                              ///< relative to that of the kernels of the last round
  double leaves = expected;                     ///< part of the share that its refinement leaves
  std::function<Settings(Settings)> refined{};  ///< the settings with the refinement; null: there is none
  std::string obstacle{};                       ///< why there is none
};

/// The table of causes after a round.
class Table {
 public:
  Table(const scene::Scene& scene, const Settings& settings, const contact::Dialled& round,
        const std::vector<BodySize>& sizes)
      : scene_(scene),
        settings_(settings),
        round_(round),
        sizes_(sizes),
        fixed_(with_fixed_elements(settings, sizes)),
        finer_(accuracy::has_finer(scene, settings.found.mesh, fixed_)) {
    if (!round.quantities) return;
    // The zone of the pilot contains all that might touch, not only what did.
    const bool concentrated =
        (!settings.pilot && settings.found.zone) ||
        (!round.quantities->pressed.empty() && zone_of(round.model, *round.quantities).has_value());
    if (!concentrated) return;
    const auto with_distance = [&](double denser) {
      return finer_near_contact(scene, settings, round, sizes, fixed_, denser);
    };
    const bool quarter =
        round.estimate && expected * near_contact() > *scene.accuracy / round.estimate->scatter() / 2;
    if (quarter) local_ = with_distance(4);
    // A quarter that was asked for before has not been made, or did not help.
    const auto asked = balls_near_contact(scene, settings.found.mesh, round, 4);
    if (!local_ && !(quarter && with_balls(settings.found, asked) == settings.found))
      local_ = with_distance(2);
  }

  bool has_finer() const { return finer_; }
  bool has_local() const { return local_.has_value(); }

  Settings with_finer_mesh(Settings settings) const {
    settings.found.mesh = finer_meshes(scene_, std::move(settings.found.mesh), fixed_);
    return settings;
  }

  /// Elements that resolve the modes of the band, or the finest.
  Settings with_mesh_for_band(Settings settings) const {
    while (!resolves_band(settings)) {
      Settings finer = with_finer_mesh(settings);
      if (finer.found.mesh == settings.found.mesh) break;
      settings = std::move(finer);
    }
    return settings;
  }

  bool resolves_band(const Settings& settings) const {
    return is_resolved(predicted(sizes_, settings_.found, settings.found));
  }

  Settings with_finer_elements_near_contact(Settings settings) const {
    settings.found = with_balls(std::move(settings.found), local_->balls);
    if (settings.found.zone && round_.quantities->nearer > 0)
      settings.found.zone = zone_with_finer_elements(round_.model, *round_.quantities, local_->denser);
    if (is_open(scene_)) settings.found.basis = basis_of_next(scene_, settings.found, round_, sizes_);
    return settings;
  }

  /// One row for each cause that a round may have, those that gain most for their cost first.
  std::vector<Row> rows() const {
    std::vector<Row> out;
    for (const auto& [cause, errors] : round_.estimate->by_cause) {
      Row& row = out.emplace_back(row_of(cause));
      row.unknown = !errors;
      if (!row.refined) row.obstacle = obstacle(cause);
    }
    share_elements(out);
    std::ranges::stable_sort(out, std::greater{}, [](const Row& row) { return row.share / row.cost; });
    return out;
  }

 private:
  /// Elements everywhere that bring the share of the mesh to half of the accuracy, if they are affordable and
  /// the round before has reduced the error, so that the expectation holds.
  Settings with_mesh_for(double share, Settings settings) const {
    settings = with_finer_mesh(std::move(settings));
    if (settings_.idle_rounds > 0 ||
        share <= *scene_.accuracy / round_.estimate->scatter() / 2 * expected_of_level)
      return settings;
    Settings finest = with_finer_mesh(settings);
    const bool affordable = excess(predicted(sizes_, settings_.found, finest.found),
                                   candidates_of(round_.model, settings_.found, finest.found))
                                .empty();
    return affordable ? finest : settings;
  }

  double share(Cause cause) const { return round_.estimate->share(cause).value_or(0); }

  /// The part of the share of the mesh that elements near contact have.
  double mesh_near_contact() const {
    double near = 0;
    if (round_.mesh_near_contact)
      for (const Quantity quantity : round_.estimate->requested)
        near = std::max(near, round_.mesh_near_contact->at(quantity));
    return std::min(near, share(Cause::mesh));
  }

  /// What smaller elements near contact reduce.
  double near_contact() const {
    return round_.estimate->combined({share(Cause::spacing), mesh_near_contact()});
  }

  Row row_of(Cause cause) const {
    Row row{.cause = cause, .share = share(cause), .cost = cost_of_vectors};
    const bool open = is_open(scene_);
    switch (cause) {
      case Cause::mesh:
        row.cost = cost_of_mesh;
        if (finer_)
          row.refined = [this, share = row.share](Settings next) {
            return with_mesh_for(share, std::move(next));
          };
        break;
      case Cause::spacing:
      case Cause::rotation:  // of linear rotations with coarse patches, above all
        if (local_ && !(round_.on_sharp_edge && !settings_.pilot)) {
          row.cost = local_->cost;
          row.leaves = std::pow(expected, std::log2(local_->denser));
          row.refined = [this](Settings next) { return with_finer_elements_near_contact(std::move(next)); };
        }
        break;
      case Cause::modes:
        if (has_modes_of_solids(settings_.found.basis, sizes_)) row.cost = cost_of_modes_of_solids;
        if (open)
          row.refined = [this](Settings next) {
            next.found.up_to.value *= 2;
            return with_mesh_for_band(std::move(next));
          };
        break;
      case Cause::basis:
        if (open && !scene_.modes.flexibility_error)
          row.refined = [](Settings next) {
            next.found.flexibility_error /= 4;
            return next;
          };
        break;
      case Cause::zone:
        if (settings_.found.zone)
          row.refined = [](Settings next) {
            *next.found.zone *= 4;
            return next;
          };
        break;
      case Cause::step:
      case Cause::eigensolver:
      case Cause::precision:
        break;
    }
    return row;
  }

  /// Smaller elements near contact reduce the share of the spacing and the part of the mesh's that they have.
  /// Where they cannot be refined alone, finer elements everywhere also have more candidates, unless the
  /// scene gives their spacing; the share of rotation follows these.
  void share_elements(std::vector<Row>& rows) const {
    const auto mesh = std::ranges::find(rows, Cause::mesh, &Row::cause),
               spacing = std::ranges::find(rows, Cause::spacing, &Row::cause),
               rotation = std::ranges::find(rows, Cause::rotation, &Row::cause);
    if (mesh == rows.end() || spacing == rows.end()) return;
    const auto give = [this](Row& from, Row& to) {
      to.share = round_.estimate->combined({to.share, std::exchange(from.share, 0)});
      to.unknown |= from.unknown;
      from.refined = nullptr;
    };
    if (local_) {
      mesh->share -= mesh_near_contact();
      spacing->share = near_contact();
    } else if (!local_ && finer_ && !gives_spacing(scene_)) {
      give(*spacing, *mesh);
      if (rotation != rows.end()) give(*rotation, *mesh);
    }
  }

  /// Why a cause cannot be refined.
  std::string obstacle(Cause cause) const {
    const auto given = [](const std::string& key) { return key + " is given"; };
    switch (cause) {
      case Cause::mesh:
        return std::ranges::any_of(scene_.bodies, &scene::Body::order_open)
                   ? "its elements are the finest that accuracy chooses"
               : std::ranges::any_of(scene_.bodies, &scene::Body::meshable) ? given("bodies.*.order")
                                                                            : "the mesh is read as it is";
      case Cause::modes:
        return given(scene_.modes.count
                         ? fmt::format("modes.count = {}", *scene_.modes.count)
                         : fmt::format("modes.up_to_hz = {:g}", scene_.modes.up_to.value_or(Hertz{0}).value));
      case Cause::basis:
        return is_open(scene_) ? given("modes.flexibility_error") : given("modes.basis");
      case Cause::step:
        return scene_.time.rate_by_accuracy
                   ? "shorter steps do not reduce it"
                   : given(fmt::format("time.{}rate_hz = {:g}", scene_.time.contact_rate_hz ? "contact_" : "",
                                       1 / scene_.time.step()));
      case Cause::eigensolver:
        return "of modes.relative_residual and modes.low_rank";
      case Cause::precision:
        return given("time.precision");
      case Cause::spacing:
        return gives_spacing(scene_) ? given("contact.spacing")
               : round_.on_sharp_edge
                   ? "touches repeat on a sharp edge, which yields the more, the smaller its elements"
                   : "its elements are the finest that accuracy chooses";
      case Cause::zone:
        return scene_.motion.is_finite() ? "bodies approach faster after they touch" : given("contact.reach");
      case Cause::rotation:
        return "bodies that turn touch at points that move, and not on patches";
    }
    return "";
  }

  const scene::Scene& scene_;
  const Settings& settings_;
  const contact::Dialled& round_;
  const std::vector<BodySize>& sizes_;
  std::set<std::string> fixed_;
  bool finer_;                             ///< whether elements can be finer everywhere
  std::optional<FinerNearContact> local_;  ///< elements near contact, which also have more candidates
};

/// The rows that gain most for their cost, as many as bring the error to what is wanted, without those that
/// the others make unnecessary; and those whose share must be measured.
/// @param done  whether a row is not to be chosen again, @param left  shares
/// @param above_wanted  what shares are together above what is wanted
template <class AboveWanted>
std::vector<std::size_t> worth_refining(const std::vector<Row>& rows, const std::vector<bool>& done,
                                        std::vector<double> left, const AboveWanted& above_wanted) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!rows[k].refined || done[k]) continue;
    const double above = above_wanted(left);
    if (!rows[k].unknown && !(above > 0 && rows[k].share > worth_while * above)) continue;
    out.push_back(k);
    left[k] *= rows[k].leaves;
  }
  std::vector<std::size_t> smallest_first = out;
  std::ranges::sort(smallest_first, {}, [&](std::size_t k) { return rows[k].share; });
  for (const std::size_t k : smallest_first) {
    if (rows[k].unknown) continue;
    left[k] /= rows[k].leaves;
    if (above_wanted(left) > 0)
      left[k] *= rows[k].leaves;
    else
      std::erase(out, k);
  }
  return out;
}

/// The largest share of the rows, or an unknown one, with what prevents its refinement.
std::string hindrance(const std::vector<Row>& rows, double accuracy) {
  const auto largest = std::ranges::max_element(rows, {}, &Row::share);
  const auto unknown = std::ranges::find_if(rows, &Row::unknown);
  if (unknown != rows.end() && (largest->unknown || !(largest->share > accuracy / 2)))
    return fmt::format("the share of the {} is unknown: {}", name_of(unknown->cause), unknown->obstacle);
  return fmt::format("{} contributes {:.2g}: {}", name_of(largest->cause), largest->share, largest->obstacle);
}

}  // namespace

bool gives_spacing(const scene::Scene& scene) {
  return !scene.contact.pairs.empty() &&
         std::ranges::all_of(scene.contact.pairs,
                             [](const scene::Pair& pair) { return pair.spacing.has_value(); });
}

namespace {

/// Where candidates of coarse elements alone are apart, finer ones halve the distance that is left. More than
/// this share of it is also left between the surfaces.
constexpr double still_there = 0.75;

Decision after_no_touch(const Table& table, const Settings& settings, const contact::Dialled& round,
                        const std::vector<BodySize>& sizes) {
  if (!round.quantities || !(round.quantities->missed_by < round.quantities->spacing_there))
    return {{}, "nothing touches, so the settings are those of the start"};
  // On coarse elements, rounded surfaces and edges lie farther apart than in the drawing.
  const std::string missed = fmt::format("nothing touches, by {:.2g} m at candidates {:.2g} m apart",
                                         round.quantities->missed_by, round.quantities->spacing_there);
  if (!table.has_finer()) return {{}, missed + ", and their elements are the finest that accuracy chooses"};
  if (settings.missed_by > 0 && round.quantities->missed_by > still_there * settings.missed_by)
    return {{}, missed + ", and finer elements bring them no nearer"};
  Settings next = following(settings, table.with_finer_mesh(settings), sizes);
  next.pilot = settings.pilot;  // nothing has been chosen
  next.missed_by = round.quantities->missed_by;
  return {std::move(next), "mesh (" + missed + ")"};
}

/// With few candidates, the share of their spacing is uncertain. Corners and edges may be touched by few,
/// however close they are, so that their elements do not become smaller more often than this for that reason
/// alone.
constexpr int most_for_few_candidates = 3;

/// A round that leaves more than this part of the smallest error so far is idle, and the search ends after as
/// many of these in succession: estimates may grow once, on the first mesh that sees more of the contact.
constexpr double still_as_large = 0.7;
constexpr int most_idle_rounds = 2;

bool is_known(const contact::ErrorEstimate& estimate) {
  return std::ranges::all_of(estimate.by_cause, [](const auto& share) { return share.second.has_value(); });
}

/// The settings with what the error of their round adds to the history of the search. Stored settings may be
/// those of another impact, whose history says nothing of this one.
Settings with_error(Settings settings, const contact::Dialled& round) {
  const double stored = std::exchange(settings.error, 0);
  if (!round.estimate || !is_known(*round.estimate)) return settings;
  const double error = round.estimate->total();
  if (stored > 0 && std::abs(error - stored) > 1e-2 * stored) {
    settings.least_error = 0;
    settings.idle_rounds = 0;
  }
  const bool idle = settings.least_error > 0 && error > still_as_large * settings.least_error;
  settings.idle_rounds = idle ? settings.idle_rounds + 1 : 0;
  settings.least_error = settings.least_error > 0 ? std::min(settings.least_error, error) : error;
  return settings;
}

/// After the pilot, an error that is known and below this part of the accuracy is small enough, although few
/// candidates make it uncertain.
constexpr double certain = 0.1;

bool refines_for_few(const Table& table, const Settings& settings, const contact::Dialled& round,
                     double accuracy) {
  return table.has_local() && settings.for_few_candidates < most_for_few_candidates &&
         !(!settings.pilot && is_known(*round.estimate) && round.estimate->total() <= certain * accuracy) &&
         few_pressed(round.model, *round.quantities);
}

/// Zone, basis and band by the impact of the pilot.
Settings tuned_by_pilot(const scene::Scene& scene, Settings settings, const contact::Dialled& round,
                        const std::vector<BodySize>& sizes) {
  if (has_zone(scene)) settings.found.zone = zone_of(round.model, *round.quantities);
  if (!is_open(scene)) return settings;
  settings.found.basis = basis_of_next(scene, settings.found, round, sizes);
  settings.found.up_to =
      band_after_pilot(settings, round, sizes, *scene.accuracy / round.estimate->scatter());
  return settings;
}

}  // namespace

Decision decide(const scene::Scene& scene, const Settings& of_round, const contact::Dialled& round,
                const std::vector<BodySize>& sizes) {
  const Settings settings = with_error(of_round, round);
  const Table table(scene, settings, round, sizes);
  if (!round.estimate) return after_no_touch(table, settings, round, sizes);

  const double accuracy = *scene.accuracy / round.estimate->scatter();
  std::vector<Row> rows = table.rows();
  const bool pilot = settings.pilot && round.quantities;
  Settings next = pilot ? tuned_by_pilot(scene, settings, round, sizes) : settings;
  if (round.quantities && refines_for_few(table, settings, round, accuracy))
    if (const auto spacing = std::ranges::find(rows, Cause::spacing, &Row::cause); spacing != rows.end()) {
      spacing->unknown = true;
      ++next.for_few_candidates;
    }
  const bool measured = std::ranges::none_of(rows, &Row::unknown);
  if (round.estimate->total() <= accuracy && measured) return {{}, ""};
  if (measured && next.idle_rounds >= most_idle_rounds)
    return {{},
            fmt::format("{} rounds have not reduced the error of {:.2g} to {:g} of it", most_idle_rounds,
                        of_round.least_error, still_as_large)};

  // What cannot be reduced may exceed the accuracy. The rest is then refined only until it matters less.
  std::vector<double> left, fixed;  // shares
  for (const Row& row : rows) {
    left.push_back(row.share);
    fixed.push_back(row.refined ? 0 : row.share);
  }
  const auto above_wanted = [&](const std::vector<double>& shares) {
    return round.estimate->combined(shares) - std::max(accuracy, 2 * round.estimate->combined(fixed));
  };
  const auto end = [&]() -> Decision {
    // Without the rows that were left because others matter more.
    std::erase_if(rows, [](const Row& row) { return row.obstacle.empty(); });
    return {{}, hindrance(rows, accuracy)};
  };
  // Where no refinement measures a share, the others cannot show that the accuracy is met either.
  if ((measured && above_wanted(left) <= 0) || (round.on_sharp_edge && !pilot)) return end();
  std::set<Cause> chosen;
  const auto choose = [&](Row& row) {
    Settings refined = row.refined(next);
    if (row.cause == Cause::modes && !table.has_finer() && !table.resolves_band(refined)) {
      row.obstacle =
          "its elements have no modes in a wider band, and they are the finest that accuracy chooses";
      return false;
    }
    row.obstacle = excess(predicted(sizes, settings.found, refined.found),
                          candidates_of(round.model, settings.found, refined.found));
    if (!row.obstacle.empty()) return false;
    if (differs_elsewhere(next.found, refined.found)) chosen.insert(Cause::mesh);
    next = std::move(refined);
    chosen.insert(row.cause);
    return true;
  };
  std::vector<bool> done(rows.size(), false);
  for (std::size_t k = 0; pilot && k < rows.size(); ++k) {
    if (rows[k].cause != Cause::modes) continue;
    const double doublings = std::log2(next.found.up_to.value / settings.found.up_to.value);
    if (doublings > 0) chosen.insert(Cause::modes);
    left[k] *= std::pow(expected, doublings);
    done[k] = true;
  }
  for (bool again = true; std::exchange(again, false);)
    for (const std::size_t k : worth_refining(rows, done, left, above_wanted)) {
      done[k] = true;
      if (choose(rows[k])) {
        left[k] *= rows[k].leaves;
      } else {
        fixed[k] = rows[k].share;
        again = true;
      }
    }
  // New kernels anyway; but what multiplies their cost waits until it is needed.
  if (chosen.contains(Cause::mesh) || chosen.contains(Cause::spacing))
    for (Row& row : rows)
      if (row.refined && row.cost < cost_of_mesh && row.cause != Cause::modes &&
          !chosen.contains(row.cause) && row.share > worth_while * accuracy)
        choose(row);
  // The band of the pilot may have been doubled.
  if (pilot && !chosen.empty() && table.has_finer() && !table.resolves_band(next)) {
    next = table.with_mesh_for_band(std::move(next));
    chosen.insert(Cause::mesh);
  }
  std::string refined;
  for (const Cause cause : chosen) refined += (refined.empty() ? "" : ", ") + std::string(name_of(cause));
  if (!refined.empty()) return {following(settings, std::move(next), sizes), refined};
  return end();
}

}  // namespace ricochet::accuracy
