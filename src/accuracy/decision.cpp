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
/// problem with two to three times as many unknowns; the others add vectors on the same mesh.
constexpr double cost_of_mesh = 3, cost_of_vectors = 1.3;

/// A cause is also refined if its share exceeds this part of the accuracy while kernels are computed anyway.
constexpr double worth_while = 0.25;

/// Ritz vectors that a contact-adapted basis holds for each candidate.
constexpr double blocks_of_vectors = 3;

/// After the pilot, another basis is also needed on the coarser mesh, and modes are certified on both.
constexpr double cost_of_a_change = 4;

bool is_open(const scene::Scene& scene) { return scene.modes.open(); }

/// Ritz vectors cost a few solves for each candidate, whatever the band; modes cost a solve or two for each
/// mode in it. With few modes and many candidates, as in flat contact, modes are therefore cheaper.
/// The ends of rods meet with a shock, whose resonances only modes have. A body that turns has its whole
/// surface as candidates.
/// @param is_known  whether kernels of a coarser mesh have the basis of the settings
scene::Basis cheaper_basis(const scene::Scene& scene, const KernelSettings& settings,
                           const contact::Model& model, const std::vector<BodySize>& sizes, bool is_known) {
  if (scene.motion.is_finite()) return scene::Basis::modes;
  double modes = 0;
  for (const BodySize& size : sizes) modes += size.modes;
  const double candidates = settings.zone ? expected_candidates(model, settings, *settings.zone)
                                          : static_cast<double>(model.gap.size());
  const bool changes = is_known && settings.basis == scene::Basis::contact;
  const bool few = (changes ? cost_of_a_change : 1) * modes < blocks_of_vectors * candidates;
  const bool rods = std::ranges::all_of(sizes, [](const BodySize& size) { return size.dimension == 1; });
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

/// Unknowns that elements of a body near contact add, and the factor of those everywhere.
struct Growth {
  double factor = 1, near_contact = 0;
};

Growth growth_of(const MeshSettings& was, const MeshSettings& is, const BodySize& size) {
  const double finer = is.order * was.size_factor / (was.order * is.size_factor);  // along each axis
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

/// Whether the elements resolve the modes of the band. The upper half of the modes that elements have, far
/// less of solids, are those of the elements and not of the body.
bool is_resolved(const std::vector<BodySize>& sizes) {
  return std::ranges::all_of(sizes, [](const BodySize& size) { return 2 * size.modes <= size.unknowns; });
}

/// Number of candidates that the kernels of a round with these settings hold.
double candidates_of(const contact::Model& model, const KernelSettings& settings) {
  return expected_candidates(model, settings,
                             settings.zone.value_or(std::numeric_limits<double>::infinity()));
}

/// What a round with these settings would compute that is more than accuracy chooses; empty if it is
/// affordable.
std::string excess(const std::vector<BodySize>& sizes, double candidates) {
  const auto candidates_of_body = [&](const BodySize& size) { return std::max(candidates, size.candidates); };
  const auto work_of = [&](const BodySize& size) {
    return (size.vectors + candidates_of_body(size)) * size.unknowns;
  };
  double work = 0, turning = 0;  // candidates of bodies that turn
  for (const BodySize& size : sizes) {
    work += work_of(size);
    turning += size.candidates;
  }
  const BodySize& largest = *std::ranges::max_element(sizes, {}, work_of);
  if (work <= most_work && largest.unknowns <= most_unknowns && turning <= most_candidates) return "";
  candidates = candidates_of_body(largest);
  return fmt::format(
      "the next round would compute about {:.1g} modes{} of {:.1g} unknowns of \"{}\", which is more than "
      "accuracy chooses: give modes.up_to_hz and bodies.*.order to go on",
      largest.vectors,
      candidates > 0 ? fmt::format(" and the response to {:.1g} candidates", candidates) : "",
      largest.unknowns, largest.body);
}

/// The settings with which those of the next round are compared to estimate the error of its mesh. A body
/// whose order rises gets the smaller elements near contact at its former order too, because without them
/// most of the change would be their effect. A body without finer elements keeps its coarser ones, or its
/// share would be lost.
KernelSettings coarser_than(const Settings& last, const KernelSettings& next) {
  KernelSettings out = last.found;
  for (auto& [body, mesh] : out.mesh) {
    const MeshSettings& finer = next.mesh.at(body);
    if (mesh.order < finer.order && mesh.refine != finer.refine) {
      mesh.refine = finer.refine;
      out.zone = next.zone;
    } else if (mesh == finer && last.coarser && last.coarser->mesh.contains(body)) {
      mesh = last.coarser->mesh.at(body);
    }
  }
  return out;
}

/// Settings of the next round, with those of the last ones that the estimate of its mesh needs. Two levels of
/// the mesh have the same band and basis, so that they differ only in the mesh. Changes that follow each
/// other show a pace only if they are of the same elements.
Settings following(const Settings& last, Settings next, const contact::Dialled& round) {
  next.found.view = true;
  if (change_between(last.found, next.found) != MeshChange{}) {
    KernelSettings coarser = coarser_than(last, next.found);
    const MeshChange now = change_between(coarser, next.found);
    const contact::Errors change = round.mesh_change.value_or(contact::Errors{});
    if (now.near_contact && now.elsewhere)
      next.change_of_rest.clear();
    else if (now != last_change(last))
      next.change_of_rest = change;
    next.coarser_change = now == last_change(last) ? change : contact::Errors{};
    next.coarser = std::move(coarser);
  }
  if (next.coarser) {
    // A few candidates suffice for Ritz vectors on the coarser mesh, as they do for those of the round.
    if (next.coarser->basis != next.found.basis && next.found.basis == scene::Basis::contact &&
        round.quantities && !round.quantities->pressed.empty())
      if (const auto zone = zone_of(round.model, *round.quantities))
        next.coarser->zone = std::min(*zone, next.coarser->zone.value_or(*zone));
    next.coarser->basis = next.found.basis;
    next.coarser->up_to = next.found.up_to;
    next.coarser->flexibility_error = next.found.flexibility_error;
  }
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

/// @param fixed  bodies whose elements cannot be smaller
/// @return no value if there are none, or too many
std::optional<FinerNearContact> finer_near_contact(const scene::Scene& scene, const Settings& settings,
                                                   const contact::Dialled& round,
                                                   const std::vector<BodySize>& sizes,
                                                   const std::set<std::string>& fixed) {
  auto balls = balls_near_contact(scene, settings.found.mesh, round);
  for (const std::string& body : fixed) balls.erase(body);
  const KernelSettings finer = with_balls(settings.found, balls);
  if (finer == settings.found ||
      expected_candidates(round.model, finer, zone_near_contact(*round.quantities)) > most_candidates)
    return std::nullopt;
  const std::vector<BodySize> then = predicted(sizes, settings.found, finer);
  if (!excess(then, expected_candidates(round.model, finer,
                                        zone_with_finer_elements(round.model, *round.quantities)))
           .empty())
    return std::nullopt;
  return FinerNearContact{std::move(balls),
                          std::max(cost_of_vectors, unknowns_of(then) / unknowns_of(sizes))};
}

/// Bodies whose geometry fixes the number of elements, since smaller ones were asked for but not made.
std::set<std::string> with_fixed_elements(const Settings& settings, const std::vector<BodySize>& sizes) {
  std::set<std::string> out;
  if (!settings.coarser) return out;
  for (const BodySize& size : sizes) {
    const auto was = settings.coarser->mesh.find(size.body), is = settings.found.mesh.find(size.body);
    if (was != settings.coarser->mesh.end() && is != settings.found.mesh.end() && was->second != is->second &&
        was->second.order == is->second.order && size.unknowns == size.coarser_unknowns)
      out.insert(size.body);
  }
  return out;
}

/// A row of the table of causes.
struct Row {
  Cause cause;
  double share = 0;                             ///< that its refinement reduces
  bool unknown = false;                         ///< whether the share must be measured by a refinement first
  double cost = 1;                              ///< relative to that of the kernels of the last round
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
        (settings.coarser && settings.found.zone) ||
        (!round.quantities->pressed.empty() && zone_of(round.model, *round.quantities).has_value());
    if (concentrated) local_ = finer_near_contact(scene, settings, round, sizes, fixed_);
  }

  bool has_finer() const { return finer_; }
  bool has_local() const { return local_.has_value(); }
  bool has_coarser() const { return settings_.coarser.has_value(); }

  Settings with_finer_mesh(Settings settings) const {
    settings.found.mesh = finer_meshes(scene_, std::move(settings.found.mesh), fixed_);
    return settings;
  }

  Settings with_finer_elements_near_contact(Settings settings) const {
    settings.found = with_balls(std::move(settings.found), local_->balls);
    if (settings.found.zone && round_.quantities->nearer > 0)
      settings.found.zone = zone_with_finer_elements(round_.model, *round_.quantities);
    if (is_open(scene_))
      settings.found.basis = cheaper_basis(scene_, settings.found, round_.model, sizes_, has_coarser());
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
  double share(Cause cause) const { return round_.estimate->share(cause).value_or(0); }

  Row row_of(Cause cause) const {
    Row row{.cause = cause, .share = share(cause), .cost = cost_of_vectors};
    const bool open = is_open(scene_);
    switch (cause) {
      case Cause::mesh:
        row.cost = cost_of_mesh;
        if (finer_) row.refined = [this](Settings next) { return with_finer_mesh(std::move(next)); };
        break;
      case Cause::spacing:
      case Cause::rotation:  // of linear rotations with coarse patches, above all
        if (local_) {
          row.cost = local_->cost;
          row.refined = [this](Settings next) { return with_finer_elements_near_contact(std::move(next)); };
        }
        break;
      case Cause::modes:
        if (open)
          row.refined = [](Settings next) {
            next.found.up_to.value *= 2;
            return next;
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

  /// The first smaller elements near contact reduce the share of the spacing and most of that of the mesh.
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
    const bool first = std::ranges::all_of(settings_.found.mesh,
                                           [](const auto& of_body) { return of_body.second.refine.empty(); });
    if (local_ && first && !mesh->unknown) {
      give(*mesh, *spacing);
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

Decision after_no_touch(const Table& table, const Settings& settings, const contact::Dialled& round) {
  if (!round.quantities || !(round.quantities->missed_by < round.quantities->spacing_there))
    return {{}, "nothing touches, so the settings are those of the start"};
  // On coarse elements, rounded surfaces and edges lie farther apart than in the drawing.
  const std::string missed = fmt::format("nothing touches, by {:.2g} m at candidates {:.2g} m apart",
                                         round.quantities->missed_by, round.quantities->spacing_there);
  if (!table.has_finer()) return {{}, missed + ", and their elements are the finest that accuracy chooses"};
  if (settings.missed_by > 0 && round.quantities->missed_by > still_there * settings.missed_by)
    return {{}, missed + ", and finer elements bring them no nearer"};
  Settings next = table.with_finer_mesh(settings);
  next.missed_by = round.quantities->missed_by;
  return {following(settings, std::move(next), round), "mesh (" + missed + ")"};
}

/// With few candidates, the share of their spacing is uncertain. Corners and edges may be touched by few,
/// however close they are, so that their elements do not become smaller more often than this for that reason
/// alone.
constexpr int most_for_few_candidates = 3;

bool refines_for_few(const Table& table, const Settings& settings, const contact::Dialled& round) {
  return table.has_local() && settings.for_few_candidates < most_for_few_candidates &&
         few_pressed(round.model, *round.quantities);
}

Decision after_pilot(const scene::Scene& scene, const Table& table, const Settings& settings,
                     const contact::Dialled& round, const std::vector<BodySize>& sizes) {
  const double accuracy = *scene.accuracy / round.estimate->scatter();
  Settings next = settings;
  if (has_zone(scene)) next.found.zone = zone_of(round.model, *round.quantities);
  if (is_open(scene)) {
    next.found.basis = cheaper_basis(scene, next.found, round.model, sizes, false);
    next.found.up_to = band_after_pilot(settings, round, accuracy);
  }
  const auto spacing = round.estimate->by_cause.find(Cause::spacing);
  const bool unknown = spacing != round.estimate->by_cause.end() && !spacing->second;
  const bool local =
      table.has_local() && (unknown || refines_for_few(table, settings, round) ||
                            round.estimate->share(Cause::spacing).value_or(0) > worth_while * accuracy);
  if (local) next = table.with_finer_elements_near_contact(std::move(next));
  return {following(settings, table.with_finer_mesh(std::move(next)), round),
          local ? "mesh, spacing" : "mesh"};
}

}  // namespace

Decision decide(const scene::Scene& scene, const Settings& settings, const contact::Dialled& round,
                const std::vector<BodySize>& sizes) {
  const Table table(scene, settings, round, sizes);
  if (!round.estimate) return after_no_touch(table, settings, round);
  if (!settings.coarser && table.has_finer()) return after_pilot(scene, table, settings, round, sizes);

  const double accuracy = *scene.accuracy / round.estimate->scatter();
  std::vector<Row> rows = table.rows();
  Settings next = settings;
  if (round.quantities && refines_for_few(table, settings, round))
    if (const auto spacing = std::ranges::find(rows, Cause::spacing, &Row::cause); spacing != rows.end()) {
      spacing->unknown = true;
      ++next.for_few_candidates;
    }
  const bool measured = std::ranges::none_of(rows, &Row::unknown);
  if (round.estimate->total() <= accuracy && measured) return {{}, ""};

  // What cannot be reduced may exceed the accuracy. The rest is then refined only until it matters less.
  std::vector<double> left, fixed;  // shares
  for (const Row& row : rows) {
    left.push_back(row.share);
    fixed.push_back(row.refined ? 0 : row.share);
  }
  const auto above_wanted = [&] {
    return round.estimate->combined(left) - std::max(accuracy, 2 * round.estimate->combined(fixed));
  };
  std::set<Cause> chosen;
  const auto choose = [&](Row& row) {
    Settings refined = row.refined(next);
    const bool wider =
        row.cause == Cause::modes && !is_resolved(predicted(sizes, settings.found, refined.found));
    if (wider && !table.has_finer()) {
      row.obstacle =
          "its elements have no modes in a wider band, and they are the finest that accuracy chooses";
      return false;
    }
    if (wider) refined = table.with_finer_mesh(std::move(refined));
    row.obstacle =
        excess(predicted(sizes, settings.found, refined.found), candidates_of(round.model, refined.found));
    if (!row.obstacle.empty()) return false;
    if (change_between(next.found, refined.found).elsewhere) chosen.insert(Cause::mesh);
    next = std::move(refined);
    chosen.insert(row.cause);
    return true;
  };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Row& row = rows[k];
    if (!row.refined) continue;
    const bool matters = above_wanted() > 0 && row.share > worth_while * above_wanted();
    if (!row.unknown && !matters) continue;
    if (choose(row))
      left[k] *= expected;
    else
      fixed[k] = row.share;
  }
  if (chosen.contains(Cause::mesh) || chosen.contains(Cause::spacing))  // new kernels anyway
    for (Row& row : rows)
      if (row.refined && !chosen.contains(row.cause) && row.share > worth_while * accuracy) choose(row);
  std::string refined;
  for (const Cause cause : chosen) refined += (refined.empty() ? "" : ", ") + std::string(name_of(cause));
  if (!refined.empty()) return {following(settings, std::move(next), round), refined};
  // Without the rows that were left because others matter more.
  std::erase_if(rows, [](const Row& row) { return row.obstacle.empty(); });
  return {{}, hindrance(rows, accuracy)};
}

}  // namespace ricochet::accuracy
