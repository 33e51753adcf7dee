// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "contact/accuracy/error_report.hpp"
#include "src/accuracy/contact_zone.hpp"
#include "src/accuracy/decision.hpp"
#include "src/accuracy/mesh_levels.hpp"
#include "src/accuracy/pilot.hpp"
#include "src/accuracy/round.hpp"
#include "src/accuracy/scene_dial.hpp"
#include "src/accuracy/settings.hpp"
#include "src/parallel/parallel.hpp"
#include "src/store/body_warnings.hpp"

namespace ricochet::accuracy {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int most_rounds = 12;

std::string text_of(const KernelSettings& settings, const scene::Scene& scene) {
  std::string text;
  std::set<std::pair<int, double>> seen;
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto& [body, mesh] : settings.mesh)
    if (seen.insert({mesh.order, mesh.size_factor}).second)
      text += fmt::format(
          "order {}{}, ", mesh.order,
          mesh.size_factor == 1 ? "" : fmt::format(" at {:.2g} times the size", mesh.size_factor));
  for (const auto& [body, mesh] : settings.mesh)
    for (const scene::FineBall& ball : mesh.refine) smallest = std::min(smallest, ball.size);
  if (std::isfinite(smallest)) text += fmt::format("{:.2g} m near contact, ", smallest);
  if (settings.zone) text += fmt::format("zone of {:.2g} m, ", *settings.zone);
  if (scene.modes.open())
    text += fmt::format("up to {:.3g} Hz{}", settings.up_to.value,
                        settings.basis == scene::Basis::contact
                            ? fmt::format(" within {:.2g}", settings.flexibility_error)
                            : "");
  else
    text += "modes as given";
  return text;
}

/// The outcome of a round, the same on all ranks.
struct Outcome {
  Settings settings;             ///< of the round, with the rate
  std::optional<Settings> next;  ///< no value: the search ends
  std::string line;              ///< for the user
  std::string turning{};         ///< body that turns too far for linear rotations; empty: none
};

/// Settings that another rank wrote as text.
Settings received(const std::string& text) {
  auto settings = parse_settings(text);
  if (!settings) throw std::logic_error("these settings cannot be read back:\n" + text);
  return std::move(*settings);
}

/// @param paired  set on the first rank
Outcome outcome_of_round(const scene::Scene& scene, Settings settings, std::optional<PairedRound> paired,
                         MPI_Comm comm) {
  std::string found, next, line, turning;
  parallel::on_first_rank(comm, [&] {
    const std::vector<BodySize> sizes = sizes_of(*paired, settings.found.up_to);
    const Dialled dialled = dialled_of(*paired, settings.rate);
    settings.rate = dialled.rate.value_or(Hertz{1 / scene.time.step()});
    if (scene.motion.rotation_open && dialled.quantities)
      if (const auto [body, angle] = dialled.quantities->turn; angle > scene::most_linear_turn) {
        turning = scene.bodies[body].name;
        line = turning + " turns by more than 1 degree";
        found = to_toml(settings);
        return;
      }
    const Decision decision = decide(scene, settings, dialled, sizes);
    settings.error = dialled.estimate ? dialled.estimate->total() : 0;
    if (dialled.estimate) line = "error " + contact::formatted(*dialled.estimate);
    line += line.empty() ? "" : "; ";
    const auto few = dialled.quantities ? few_pressed(dialled.model, *dialled.quantities) : std::nullopt;
    if (few && !decision.next)
      line +=
          fmt::format("only {} candidate{} touch{}, so peak force and duration depend on their distance; ",
                      *few, *few > 1 ? "s" : "", *few > 1 ? "" : "es");
    if (decision.next)
      line += "refines " + decision.reason;
    else if (decision.reason.empty())
      line += fmt::format("meets accuracy = {:g}", *scene.accuracy);
    else
      line += "stops: " + decision.reason;
    found = to_toml(settings);
    if (decision.next) next = to_toml(*decision.next);
  });
  for (std::string* text : {&found, &next, &line, &turning}) parallel::broadcast(comm, *text);
  Outcome out{received(found), {}, line, turning};
  if (!next.empty()) out.next = received(next);
  return out;
}

}  // namespace

scene::Scene closed_for_check(const scene::Scene& scene, MPI_Comm comm) {
  return with_settings(scene, pilot_settings(scene, comm).found);
}

namespace {

/// The outcome of a search, the same on all ranks.
struct Found {
  scene::Scene scene;        ///< that has been searched, with its sizes of elements
  Settings settings;         ///< of the last round that succeeded
  std::string turning = {};  ///< body that turns too far for the linear rotations of the search; empty: none
};

class Search {
 public:
  /// @param compute  must outlive the search
  Search(const fs::path& folder, MPI_Comm comm, console::Console& console, const ComputeKernels& compute)
      : folder_(folder), comm_(comm), console_(console), compute_(compute) {}

  /// Makes rounds from these settings on. Collective. @param known  whether they are those of an earlier
  /// search. Throws InputError if no round succeeds.
  Found run(scene::Scene scene, Settings settings, bool known) {
    std::optional<Settings> last;  // of a round that succeeded
    std::string first_error;
    for (int round = 1; round <= most_rounds; ++round) {
      const Clock::time_point start = Clock::now();
      std::optional<Outcome> outcome;
      try {
        const scene::Scene closed = with_settings(scene, settings.found);
        compute(closed, round);
        console_.begin(fmt::format("round {}: pairing", round));
        std::optional<PairedRound> paired;
        parallel::on_first_rank(comm_, [&] { paired = pair_round(closed, folder_); });
        console_.end(paired ? paired->memory : "");
        console_.begin(fmt::format("round {}: estimates", round));
        outcome = outcome_of_round(scene, settings, std::move(paired), comm_);
        console_.end();
      } catch (const InputError& error) {  // the same on every rank
        if (!last) {
          // Elements of the first level may be too coarse for the geometry, and then for the modes.
          const bool first = first_error.empty();
          if (first) first_error = error.what();
          scene::Scene own = with_own_sizes(scene);
          const bool larger = first && own != scene;
          if (known || (!larger && !has_finer(scene, settings.found.mesh))) throw InputError(first_error);
          scene = std::move(own);
          settings.found.mesh =
              larger ? coarsest_meshes(scene) : finer_meshes(scene, std::move(settings.found.mesh));
          continue;
        }
        console_.say(fmt::format("accuracy, round {}: {}; stops: {}", round, text_of(settings.found, scene),
                                 error.what()));
        break;
      }
      last = outcome->settings;
      console_.say(fmt::format("accuracy, round {}: {}: {} ({:.1f} s)", round, text_of(settings.found, scene),
                               outcome->line, std::chrono::duration<double>(Clock::now() - start).count()));
      if (!outcome->turning.empty()) return {std::move(scene), *last, outcome->turning};
      if (!outcome->next) break;
      if (round == most_rounds)
        console_.say(fmt::format("accuracy: stops after {} rounds, the most that it makes", most_rounds));
      settings = *outcome->next;
    }
    if (!last->found.view) {  // the pilot is the last round that succeeded
      last->found.view = true;
      compute(with_settings(scene, last->found), most_rounds);
    }
    return {std::move(scene), *last};
  }

  /// Kernels of all rounds.
  const std::vector<fs::path>& written() const { return written_; }

 private:
  void compute(const scene::Scene& closed, int round) {
    std::ranges::copy(compute_(closed, round == 1), std::back_inserter(written_));
  }

  const fs::path& folder_;
  MPI_Comm comm_;
  console::Console& console_;
  const ComputeKernels& compute_;
  std::vector<fs::path> written_;
};

/// Searches again with finite rotations; with linear ones, from the settings found so far, if no round
/// succeeds.
Found search_with_finite_rotation(const Found& linear, Search& search, MPI_Comm comm,
                                  console::Console& console) {
  console.say(
      "accuracy: searches with finite rotation (motion.rotation = \"linear\" keeps the axes of the start)");
  const scene::Scene turning = scene::with_finite_rotation(linear.scene, "");
  try {
    return search.run(turning, pilot_settings(turning, comm), false);
  } catch (const InputError& error) {  // the same on every rank
    console.say(fmt::format("accuracy: goes on with linear rotation: {}", error.what()));
  }
  scene::Scene scene = linear.scene;
  scene.motion.rotation_open = false;
  return search.run(std::move(scene), linear.settings, true);
}

}  // namespace

scene::Scene close_by_accuracy(const scene::Scene& scene, const fs::path& folder, MPI_Comm comm,
                               console::Console& console, const ComputeKernels& compute) {
  const fs::path path = settings_path(folder, scene);
  std::string stored;
  parallel::on_first_rank(comm, [&] {
    if (const auto known = read_settings(path)) stored = to_toml(*known);
  });
  parallel::broadcast(comm, stored);
  const auto known = parse_settings(stored);
  Search search(folder, comm, console, compute);
  const bool turns = known && known->found.rotation == Rotation::finite && scene.motion.rotation_open;
  Found found = search.run(turns ? scene::with_finite_rotation(scene, "") : scene,
                           known ? *known : pilot_settings(scene, comm), known.has_value());
  if (!found.turning.empty()) found = search_with_finite_rotation(found, search, comm, console);
  parallel::on_first_rank(comm, [&] {
    write_settings(found.settings, found.scene, path);
    // Kernels of earlier rounds would only take space.
    std::set<fs::path> needed;
    store::KernelStore store;
    for (const store::StoredKernel& kernel :
         store::find_kernels(with_settings(found.scene, found.settings.found), folder, store))
      needed.insert(kernel.path);
    for (const fs::path& file : search.written())
      if (!needed.contains(file)) fs::remove(file);
  });
  console.say(path.string());
  return with_settings(found.scene, found.settings.found);
}

}  // namespace ricochet::accuracy
