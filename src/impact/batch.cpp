// SPDX-License-Identifier: BSD-2-Clause
#include "src/impact/batch.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <istream>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "contact/files/records.hpp"
#include "contact/files/summary_file.hpp"
#include "kernels/read.hpp"
#include "kernels/write.hpp"
#include "ricochet/error.hpp"
#include "src/accuracy/scene_dial.hpp"
#include "src/impact/runner.hpp"
#include "src/scene/derive.hpp"
#include "src/scene/near_miss.hpp"
#include "src/scene/read.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"
#include "src/scene/write.hpp"
#include "src/store/surfaces.hpp"

namespace ricochet::impact {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// Greatest allowed nesting of lists and objects in a request.
constexpr int most_nested = 16;

constexpr std::array<std::pair<const char*, bool contact::RecordOptions::*>, 6> record_words{
    {{"force", &contact::RecordOptions::force},
     {"receivers", &contact::RecordOptions::receivers},
     {"acceleration", &contact::RecordOptions::acceleration},
     {"gauges", &contact::RecordOptions::gauges},
     {"bodies", &contact::RecordOptions::bodies},
     {"energy", &contact::RecordOptions::energy}}};

/// Throws InputError for a word of "keep" that needs a table of the scene.
void refuse_without(const std::string& key, const std::string& word, const scene::Scene& scene) {
  throw InputError(fmt::format(
      "{0}: output.{1}: is missing: keep = [\"{2}\"] needs a [[output.{1}]]; add one, or keep other records",
      scene.file.filename().string(), key, word));
}

/// The records that a request keeps; no value: none. Throws InputError for an unknown word, and for
/// receivers and gauges of a scene without any.
std::optional<contact::RecordOptions> kept(const Json& request, const scene::Scene& scene) {
  if (!request.contains("keep")) return std::nullopt;
  contact::RecordOptions out;
  for (const auto& word : request["keep"].get<std::vector<std::string>>()) {
    const auto found = std::ranges::find(record_words, word, [](const auto& known) { return known.first; });
    if (found == record_words.end()) {
      std::vector<std::string> names;
      for (const auto& [name, option] : record_words) names.emplace_back(name);
      throw InputError(
          fmt::format("keep: there is no record \"{}\"{}", word, scene::existing_names(word, names)));
    }
    out.*found->second = true;
  }
  if ((out.receivers || out.acceleration) && scene.output.receivers.empty())
    refuse_without("receiver", out.receivers ? "receivers" : "acceleration", scene);
  if (out.gauges && scene.output.gauges.empty()) refuse_without("gauge", "gauges", scene);
  return out;
}

/// Observes the records that a request keeps.
class Keeper : public ImpactObserver {
 public:
  explicit Keeper(const std::optional<contact::RecordOptions>& options) : options_(options) {}

  void started(const Impact& impact, const contact::Stepper&) override {
    if (options_) records_.emplace(impact.source(), impact.options, settled(impact));
  }
  void stepped(const contact::Stepper& stepper) override {
    if (records_) records_->record(stepper);
  }
  void at_rest(const Impact& impact, const contact::Equilibrium& equilibrium) override {
    if (options_ && !records_) records_.emplace(*impact.model, settled(impact));
    if (records_) records_->record(equilibrium);
  }
  /// An HDF5 file; empty if none is kept.
  std::string file() { return records_ ? records_->file() : ""; }

 private:
  /// With the rates that may have been chosen for the accuracy of the scene.
  contact::RecordOptions settled(const Impact& impact) const {
    contact::RecordOptions out = *options_;
    out.every = impact.scene.output.every;
    out.receivers_every = impact.scene.output.receivers_every(impact.scene.time.rate_hz);
    return out;
  }

  std::optional<contact::RecordOptions> options_;
  std::optional<contact::Records> records_;
};

struct Answer {
  Json json;
  std::string records{};  ///< an HDF5 file, or empty
};

class Batch {
 public:
  explicit Batch(const console::Options& options) : options_(options) {}

  Answer answer(const std::string& line) {
    try {
      const Json request = Json::parse(
          line,
          [](int depth, Json::parse_event_t, const Json&) {
            // Copying deeply nested values would overflow the stack.
            if (depth > most_nested) throw InputError("--batch: a request is nested too deep");
            return true;
          },
          false);
      if (!request.is_object())
        throw InputError("--batch: a request must be a line with a JSON object, as in {\"set\": []}");
      std::vector<std::string> overrides = options_.overrides;
      for (const Json& word : request.value("set", Json::array()))
        overrides.push_back(word.get<std::string>());
      scene::Scene scene = scene::read(options_.scene, overrides);
      if (request.contains("derive"))
        for (const Json& file : request["derive"]) derive(scene, options_.out / file.get<std::string>());
      const auto records = kept(request, scene);
      if (request.value("kernels", false)) {
        Answer out{{{"status", 0}, {"kernels", needed(scene)}, {"reads", other_files(scene)}}};
        if (scene.accuracy && scene.settings.empty())
          out.json["settings"] =
              accuracy::settings_path(options_.out, scene, &store_.meshes).filename().string();
        return out;
      }
      return impact(std::move(scene), records, std::move(overrides));
    } catch (const InputError& error) {
      return {{{"status", 2}, {"error", error.what()}}};
    } catch (const Json::exception&) {
      return {{{"status", 2},
               {"error",
                "--batch: \"set\" must be a list of texts KEY=VALUE, \"kernels\" true or false, \"derive\" a "
                "list of file names, \"keep\" a list of records"}}};
    } catch (const std::exception& error) {
      return {{{"status", 1}, {"error", error.what()}}};
    }
  }

 private:
  /// A file of settings or of a surface without which the kernels of the scene are not known.
  std::optional<fs::path> missing_file(const scene::Scene& scene) {
    const auto surface = store::missing_surface(scene, options_.out);
    return surface ? surface : accuracy::missing_settings(scene, options_.out, store_);
  }

  /// Writes the missing kernels of the scene that can be derived from `file`.
  void derive(const scene::Scene& scene, const fs::path& file) {
    if (missing_file(scene)) return;
    derive_kernels(accuracy::closed(scene, options_.out, store_).scene, file);
  }

  void derive_kernels(const scene::Scene& scene, const fs::path& file) {
    const auto header = kernels::read_header(file);
    if (!header) return;
    const std::vector<store::StoredKernel> stored = store::find_kernels(scene, options_.out, store_);
    for (std::size_t k = 0; k < stored.size(); ++k) {
      if (stored[k].enough) continue;
      auto request = scene::kernel_request(scene, scene.bodies[k], &store_.meshes);
      request.normal_residual = header->normal_residual && scene::may_be_normal(request);
      // Whether its candidates suffice depends on the placement.
      request.points = header->held;
      request.within_reach = header->held.has_value();
      if (request.within_reach && !store::is_limited(scene, scene.bodies[k])) continue;
      scene::seal(request);
      const fs::path path = scene::kernel_path(options_.out, request);
      if (fs::exists(path)) continue;
      if (const auto kernel = scene::derive_from(file, request)) kernels::write(*kernel, path);
    }
  }

  Json needed(const scene::Scene& scene) {
    store::check_histories(scene);
    Json out = Json::array();
    if (const auto missing = missing_file(scene)) {
      out.push_back({{"file", missing->filename().string()}, {"there", false}});
      return out;
    }
    const scene::Scene closed = accuracy::closed(scene, options_.out, store_).scene;
    for (const store::StoredKernel& kernel : store::find_kernels(closed, options_.out, store_)) {
      const fs::path& path = kernel.enough ? kernel.path : kernel.whole;
      if (!kernel.enough && kernels::has_newer_format(path)) kernels::read(path);  // throws
      out.push_back({{"file", path.filename().string()}, {"there", kernel.enough}});
    }
    return out;
  }

  /// The overrides that give a scene the settings chosen for its accuracy, so that other impacts with the
  /// same ones need no estimate. No value if it cannot be read with them: a key of one pair may exclude what
  /// is chosen for the others.
  /// @param overrides  with which `open` was read
  std::optional<std::vector<std::string>> overrides_of(const scene::Scene& open, const scene::Scene& chosen,
                                                       std::vector<std::string> overrides) const {
    std::vector<std::string> out = scene::differences(open, chosen);
    out.insert(out.begin(), "accuracy=off");
    overrides.insert(overrides.end(), out.begin(), out.end());
    if (scene::read(options_.scene, overrides).contact != chosen.contact) return std::nullopt;
    return out;
  }

  /// Size and time of the last change, which identify a version, of each file that an impact reads besides
  /// kernels.
  static Json other_files(const scene::Scene& scene) {
    std::vector<fs::path> paths{scene.contact.table};
    for (const auto* loads : {&scene.loads.tractions, &scene.loads.points, &scene.loads.motions})
      for (const scene::Forcing& driven : *loads) paths.push_back(driven.history);
    Json out = Json::object();
    for (const scene::Obstacle& obstacle : scene.obstacles) paths.push_back(obstacle.surface);
    for (const fs::path& path : paths) {
      std::error_code missing;  // reported when the impact reads the file
      const std::uintmax_t size = fs::file_size(path, missing);
      if (missing) continue;
      out[path.string()] = {size, fs::last_write_time(path, missing).time_since_epoch().count()};
    }
    return out;
  }

  /// @param overrides  with which the scene was read
  Answer impact(scene::Scene scene, const std::optional<contact::RecordOptions>& kept,
                std::vector<std::string> overrides) {
    console::Console quiet(true);
    Keeper keeper(kept);
    scene.motion.second_run = false;  // a sweep uses all cores, and its points show how figures scatter
    const ImpactResult result = run_impact({scene, options_.out}, store_, quiet, keeper);
    Answer out{{{"status", 0}}, keeper.file()};
    std::visit(
        [&](const auto& figures) {
          out.json["summary"] = Json::parse(contact::json_text(figures));
          if (scene.accuracy)
            out.json["meets"] = !figures.error_estimate || figures.error_estimate->meets(*scene.accuracy);
        },
        result.summary);
    if (scene.accuracy)
      if (const auto chosen = overrides_of(scene, result.impact->scene, std::move(overrides)))
        out.json["chosen"] = *chosen;
    if (!out.records.empty()) out.json["histories"] = out.records.size();
    return out;
  }

  const console::Options& options_;
  store::KernelStore store_;
};

/// The answer as one line. Bytes of a path that are not UTF-8 become U+FFFD.
std::string text_of(const Json& answer) {
  return answer.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

int run_batch(const console::Options& options, std::istream& in, std::ostream& out) {
  Batch batch(options);
  for (std::string line; out && std::getline(in, line);) {
    if (line.empty()) continue;
    const Answer answer = batch.answer(line);
    out << text_of(answer.json) << '\n' << answer.records << std::flush;  // the caller waits for it
  }
  return 0;
}

}  // namespace ricochet::impact
