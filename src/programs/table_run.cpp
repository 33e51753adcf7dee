#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <ostream>

#include "contact/table.hpp"
#include "contact/table_integrator.hpp"
#include "contact/table_results.hpp"
#include "kernels/temporary.hpp"
#include "src/programs/contact_parts.hpp"

namespace ricochet::programs {
namespace {

namespace fs = std::filesystem;

/// A table from modes, its copy in the convolution and the spectra.
void check_memory(const scene::Scene& scene, Eigen::Index points, std::int64_t steps) {
  const double kernels = scene.contact.scheme == scene::Scheme::impulse ? 2 : 1,
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

void check_length(const scene::Scene& scene, const contact::TableIntegrator& integrator, std::int64_t steps) {
  if (steps <= integrator.available()) return;
  const double longest = static_cast<double>(integrator.available()) / scene.time.rate.value;
  throw InputError(
      fmt::format("{}: time.duration = {:.6g} s: {} has samples for {:.6g} s. Shorten the run, or make the "
                  "table longer (tail = "
                  "\"linear\" if its kernels have died out).",
                  scene.file.string(), scene.time.duration, scene.contact.table.string(), longest));
}

}  // namespace

int run_table(const console::Options& options, const scene::Scene& scene, const fs::path& folder,
              console::Console& console, std::ostream& out) {
  const Clock::time_point started = Clock::now();
  const contact::StepOptions step = step_options(scene);
  const std::int64_t steps = std::llround(scene.time.duration * scene.time.rate.value);
  Kernels kernels;
  std::optional<contact::Model> model;
  contact::Table table;
  int unpaired = 0;
  console.begin("table");
  if (!scene.contact.table.empty()) {
    table = contact::read_table(scene.contact.table);
  } else {
    kernels = read_kernels(scene, folder);
    model = in_scene(scene, [&] { return model_of(scene, kernels.pointers()); });
    check_memory(scene, model->gap.size(), steps);
    table = in_scene(scene, [&] { return contact::table_from_modes(*model, step, steps); });
    for (const contact::Model::PairBlock& pair : model->pairs) unpaired += pair.unpaired;
  }
  console.end(fmt::format("{} samples, {} contact points", table.samples(), table.points()));

  const fs::path stem = folder / scene::slug(scene.title);
  fs::path result = stem, summary_file = stem;
  result += ".result.h5";
  summary_file += ".summary.json";
  kernels::check_place(result);

  console.begin("steps", steps);
  contact::TableIntegrator integrator =
      in_scene(scene, [&] { return contact::TableIntegrator(table, step); });
  check_length(scene, integrator, steps);
  contact::TableRecorder recorder(table, model ? &*model : nullptr, integrator,
                                  {.path = result,
                                   .title = scene.title,
                                   .scene = scene::to_toml(scene),
                                   .created_by = std::string("ricochet-contact ") + RICOCHET_VERSION,
                                   .kernel_files = kernels.file,
                                   .every = scene.output.every});
  contact::TableObserver observer(integrator, step.step, unpaired);
  const Clock::time_point stepping = Clock::now();
  for (std::int64_t k = 1; k <= steps; ++k) {
    check(integrator.step(), scene, static_cast<double>(k) * step.step);
    observer.observe(integrator);
    recorder.record(integrator);
    console.advance(k);
  }
  const double elapsed = seconds_since(stepping);
  console.end(fmt::format("{} steps of {:.4g} s", steps, step.step));

  console.begin("writing");
  recorder.commit(summary_file);
  contact::Summary summary = observer.summary();
  if (model) {
    for (const contact::Model::BodyBlock& body : model->bodies) summary.modes[body.name] = body.modes;
    if (step.scheme == contact::Scheme::compliant)
      summary.modes_in_residual =
          static_cast<int>((model->omega.array() * step.step > std::numbers::pi).count());
  }
  summary.real_time_factor = elapsed > 0 ? integrator.time() / elapsed : 0;
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
