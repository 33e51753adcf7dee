#include "src/programs/batch_run.hpp"

#include <cmath>
#include <filesystem>
#include <istream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "contact/output/summary_observer.hpp"
#include "contact/stepping/stepper.hpp"
#include "kernels/read.hpp"
#include "kernels/write.hpp"
#include "ricochet/error.hpp"
#include "src/programs/accuracy.hpp"
#include "src/programs/contact_parts.hpp"
#include "src/scene/derive.hpp"
#include "src/scene/read.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::programs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// Lists and objects within each other that a request may have.
constexpr int most_nested = 16;

class Batch {
 public:
  explicit Batch(const console::Options& options) : options_(options) {}

  Json answer(const std::string& line) {
    try {
      const Json request = Json::parse(
          line,
          [](int depth, Json::parse_event_t, const Json&) {
            // Copies of what is nested without end would end the stack.
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
      if (request.value("kernels", false))
        return {{"status", 0}, {"kernels", needed(scene)}, {"reads", other_files(scene)}};
      return {{"status", 0}, {"summary", Json::parse(impact(scene))}};
    } catch (const InputError& error) {
      return {{"status", 2}, {"error", error.what()}};
    } catch (const Json::exception&) {
      return {{"status", 2},
              {"error",
               "--batch: \"set\" must be a list of texts KEY=VALUE, \"kernels\" true or false, \"derive\" a "
               "list of file names"}};
    } catch (const std::exception& error) {
      return {{"status", 1}, {"error", error.what()}};
    }
  }

 private:
  /// Writes the kernels that the scene lacks and that follow from `file`.
  void derive(const scene::Scene& scene, const fs::path& file) {
    if (scene.accuracy) return;  // which takes kernels of another element order too
    const std::vector<StoredKernel> stored = find_kernels(scene, options_.out, cache_);
    for (std::size_t k = 0; k < stored.size(); ++k) {
      if (stored[k].enough || is_limited(scene, scene.bodies[k])) continue;
      const auto request = scene::kernel_request(scene, scene.bodies[k], &cache_.meshes);
      if (const auto kernel = scene::derive_from(file, request)) kernels::write(*kernel, stored[k].whole);
    }
  }

  Json needed(const scene::Scene& scene) {
    check_histories(scene);
    Json out = Json::array();
    for (const StoredKernel& kernel : find_kernels(scene, options_.out, cache_)) {
      const fs::path& path = kernel.enough ? kernel.path : kernel.whole;
      if (!kernel.enough && kernels::has_newer_format(path)) kernels::read(path);  // says so
      out.push_back({{"file", path.filename().string()}, {"there", kernel.enough}});
    }
    return out;
  }

  /// What tells versions of the files apart that an impact reads beside kernels: size and time of change.
  static Json other_files(const scene::Scene& scene) {
    std::vector<fs::path> paths{scene.contact.table};
    for (const auto* loads : {&scene.loads.tractions, &scene.loads.points, &scene.loads.motions})
      for (const scene::Forcing& driven : *loads) paths.push_back(driven.history);
    Json out = Json::object();
    for (const fs::path& path : paths) {
      std::error_code missing;  // refused when it is read
      const std::uintmax_t size = fs::file_size(path, missing);
      if (missing) continue;
      out[path.string()] = {size, fs::last_write_time(path, missing).time_since_epoch().count()};
    }
    return out;
  }

  std::string impact(scene::Scene& scene) {
    const Clock::time_point started = Clock::now();
    if (scene.contact.kernel == scene::ContactKernel::table) {
      contact::Summary summary = summary_by_table(scene, options_.out, cache_);
      summary.wall_s = seconds_since(started);
      return contact::json_text(summary);
    }
    const Kernels kernels = read_kernels(scene, options_.out, cache_);
    contact::Model model =
        in_scene(scene, [&] { return model_of(scene, kernels.pointers(), cache_.pairings); });
    Judged judged{.warnings = kernels.warnings};
    if (scene.accuracy) {
      judged = choose_and_judge(scene, kernels, options_.out, cache_.pairings);
      model = thinned(std::move(model), judged.thinnings);
    }
    if (scene.contact.scheme == Scheme::at_rest) {
      contact::EquilibriumSummary summary = contact::summarise(model, equilibrium_of(scene, model));
      judged.into(summary);
      summary.wall_s = seconds_since(started);
      return contact::json_text(summary);
    }
    const StepOptions step = step_options(scene);
    const std::int64_t steps = std::llround(scene.time.duration * scene.time.rate.value);
    const Clock::time_point stepping = Clock::now();
    const auto stepper = in_scene(scene, [&] { return contact::make_stepper(model, step); });
    contact::SummaryObserver observer(model, step.step, slowest_wave(scene));
    for (std::int64_t k = 1; k <= steps; ++k) {
      check(stepper->step(), scene, static_cast<double>(k) * step.step);
      observer.observe(*stepper);
    }
    const double elapsed = seconds_since(stepping);
    contact::Summary summary = observer.summary();
    judged.into(summary);
    judge_steps(scene, summary);
    summary.real_time_factor = elapsed > 0 ? stepper->time() / elapsed : 0;
    summary.wall_s = seconds_since(started);
    return contact::json_text(summary);
  }

  const console::Options& options_;
  KernelCache cache_;
};

/// In one line; what a path has that is not UTF-8 becomes U+FFFD.
std::string text_of(const Json& answer) {
  return answer.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

int run_batch(const console::Options& options, std::istream& in, std::ostream& out) {
  Batch batch(options);
  for (std::string line; out && std::getline(in, line);)
    if (!line.empty()) out << text_of(batch.answer(line)) << std::endl;  // flushed: the caller waits for it
  return 0;
}

}  // namespace ricochet::programs
