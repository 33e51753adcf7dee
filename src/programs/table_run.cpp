#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <optional>
#include <ostream>

#include "base/atomic_file.hpp"
#include "contact/input/table_file.hpp"
#include "contact/output/recorder.hpp"
#include "contact/output/summary_observer.hpp"
#include "contact/table/modal_table.hpp"
#include "contact/table/table.hpp"
#include "contact/table/table_stepper.hpp"
#include "src/programs/contact_parts.hpp"
#include "src/scene/write.hpp"

namespace ricochet::programs {
namespace {

namespace fs = std::filesystem;

/// A table from modes, its copy in the convolution and the spectra.
void check_memory(const scene::Scene& scene, Eigen::Index points, std::int64_t steps) {
  const double kernels = scene.contact.scheme == Scheme::impulse ? 2 : 1,
               needed = 4 * kernels * 8 * static_cast<double>(steps) * static_cast<double>(points * points),
               there =
                   static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  if (needed > 0.8 * there)
    throw InputError(
        fmt::format("{}: contact.kernel = \"table\": {} steps of {} x {} points need {:.3g} GB, and this "
                    "machine has {:.3g}. "
                    "Set a shorter time.duration, fewer candidates (contact.spacing), or kernel = \"modes\".",
                    scene.file.string(), steps, points, points, needed * 1e-9, there * 1e-9));
}

void check_length(const scene::Scene& scene, const contact::TableStepper& stepper, std::int64_t steps) {
  if (steps <= stepper.available()) return;
  const double longest = static_cast<double>(stepper.available()) / scene.time.rate.value;
  throw InputError(
      fmt::format("{}: time.duration = {:.6g} s: {} has samples for {:.6g} s. Shorten the run, or make the "
                  "table longer (tail = "
                  "\"linear\" if its kernels have died out).",
                  scene.file.string(), scene.time.duration, scene.contact.table.string(), longest));
}

struct Tabled {
  Kernels kernels;  ///< none where the table is a file
  std::optional<contact::Model> model;
  contact::Table table;
};

Tabled tabled(const scene::Scene& scene, const fs::path& folder, KernelCache& cache, std::int64_t steps) {
  Tabled out;
  if (!scene.contact.table.empty()) {
    out.table = contact::read_table(scene.contact.table);
    return out;
  }
  out.kernels = read_kernels(scene, folder, cache);
  out.model = in_scene(scene, [&] { return model_of(scene, out.kernels.pointers(), cache.pairings); });
  check_memory(scene, out.model->gap.size(), steps);
  out.table =
      in_scene(scene, [&] { return contact::table_from_modes(*out.model, step_options(scene), steps); });
  return out;
}

std::int64_t steps_of(const scene::Scene& scene) {
  return std::llround(scene.time.duration * scene.time.rate.value);
}

/// All steps, `after` each; `wall_s` is left to the caller.
template <class After>
contact::Summary run(const scene::Scene& scene, const Tabled& tabled, contact::TableStepper& stepper,
                     After after) {
  const StepOptions step = step_options(scene);
  contact::SummaryObserver observer(tabled.table, tabled.model ? &*tabled.model : nullptr, step);
  const Clock::time_point started = Clock::now();
  for (std::int64_t k = 1, steps = steps_of(scene); k <= steps; ++k) {
    check(stepper.step(), scene, static_cast<double>(k) * step.step);
    observer.observe(stepper);
    after(k);
  }
  const double elapsed = seconds_since(started);
  contact::Summary summary = observer.summary();
  summary.real_time_factor = elapsed > 0 ? stepper.time() / elapsed : 0;
  return summary;
}

contact::TableStepper stepper_of(const scene::Scene& scene, const Tabled& tabled) {
  contact::TableStepper out =
      in_scene(scene, [&] { return contact::TableStepper(tabled.table, step_options(scene)); });
  check_length(scene, out, steps_of(scene));
  return out;
}

}  // namespace

contact::Summary summary_by_table(const scene::Scene& scene, const fs::path& folder, KernelCache& cache) {
  const Tabled table = tabled(scene, folder, cache, steps_of(scene));
  contact::TableStepper stepper = stepper_of(scene, table);
  return run(scene, table, stepper, [](std::int64_t) {});
}

int run_table(const console::Options& options, const scene::Scene& scene, const fs::path& folder,
              console::Console& console, std::ostream& out) {
  const Clock::time_point started = Clock::now();
  const std::int64_t steps = steps_of(scene);
  KernelCache none;
  console.begin("table");
  const Tabled source = tabled(scene, folder, none, steps);
  console.end(fmt::format("{} samples, {} contact points", source.table.samples(), source.table.points()));

  const fs::path stem = folder / scene::slug(scene.title);
  fs::path result = stem, summary_file = stem;
  result += ".result.h5";
  summary_file += ".summary.json";
  base::check_place(result);

  console.begin("steps", steps);
  contact::TableStepper stepper = stepper_of(scene, source);
  contact::Recorder recorder(source.table, source.model ? &*source.model : nullptr, step_options(scene),
                             {.path = result,
                              .title = scene.title,
                              .scene = scene::to_toml(scene),
                              .created_by = std::string("ricochet-contact ") + RICOCHET_VERSION,
                              .kernel_files = source.kernels.file,
                              .every = scene.output.every});
  contact::Summary summary = run(scene, source, stepper, [&](std::int64_t k) {
    recorder.record(stepper);
    console.advance(k);
  });
  console.end(fmt::format("{} steps of {:.4g} s", steps, step_options(scene).step));

  console.begin("writing");
  recorder.commit(summary_file);
  summary.wall_s = seconds_since(started);
  contact::write_json(summary, summary_file);
  console.end(result.filename().string());

  if (!options.quiet) {
    out << console::Console::table(console.phases()) << '\n' << report(summary);
    out << fmt::format("\n{}\n{}\n", result.string(), summary_file.string());
  }
  return 0;
}

}  // namespace ricochet::programs
