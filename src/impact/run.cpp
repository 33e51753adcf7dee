// SPDX-License-Identifier: BSD-2-Clause
#include "src/impact/run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <fstream>
#include <ostream>
#include <string>
#include <utility>

#include "base/atomic_file.hpp"
#include "ricochet/error.hpp"
#include "src/accuracy/scene_dial.hpp"
#include "src/impact/files.hpp"
#include "src/impact/motion.hpp"
#include "src/impact/report.hpp"
#include "src/scene/read.hpp"
#include "src/scene/write.hpp"

namespace ricochet::impact {

namespace fs = std::filesystem;

namespace {

/// Throws InputError if --fclib is given but the scheme does not pose complementarity problems.
void check_problems(const console::Options& options, const scene::Scene& scene) {
  if (!options.fclib.empty() &&
      (scene.contact.scheme != Scheme::compliant || scene.contact.kernel != scene::ContactKernel::modes))
    throw InputError(fmt::format(
        "{}: --fclib: only contact.scheme = \"compliant\" with kernel = \"modes\" solves one complementarity "
        "problem of all points each step: choose them, or leave --fclib out",
        options.scene.string()));
}

/// Writes a scene with the settings that were chosen for its accuracy.
void write_scene(scene::Scene scene, const fs::path& path) {
  const std::string accuracy = scene.accuracy ? fmt::format("{:g}", *scene.accuracy) : "";
  scene = accuracy::without_accuracy(std::move(scene));
  scene.file = path;
  base::AtomicFile temporary(path);
  std::ofstream file(temporary.path());
  if (!accuracy.empty()) file << "# With the settings chosen for accuracy = " << accuracy << ".\n";
  file << scene::to_toml(scene);
  file.close();
  if (!file) temporary.fail();
  temporary.commit();
}

}  // namespace

int run_contact(const console::Options& options, std::ostream& out) {
  const auto started = std::chrono::steady_clock::now();
  const scene::Scene scene = scene::read(options.scene, options.overrides);
  const fs::path folder = options.out.empty() ? options.scene.parent_path() / "out" : options.out;
  if (options.dry_run) {
    const scene::Scene known = accuracy::closed_if_known(scene, folder);
    out << scene::about_rotation(known) << scene::to_toml(known);
    return 0;
  }
  check_problems(options, scene);
  const bool motion = options.vtk || scene.output.vtk_every > 0;
  if (motion) check_motion(scene);

  console::Console console(options.quiet, console::peak_memory_mib, options.watch);
  store::KernelStore store;
  ImpactFiles files({folder, motion, options.snapshots_mb, options.fclib, options.fclib_every});
  auto [impact, summary] = run_impact({scene, folder, motion}, store, console, files);
  if (files.problems())
    console.say(fmt::format("{}: {} problems", options.fclib.string(), *files.problems()));

  console.begin("writing");
  const std::string replaced = files.commit(summary, started);
  if (!options.write_scene.empty()) write_scene(impact->scene, options.write_scene);
  if (!replaced.empty()) console.say(replaced);
  console.end(files.result().filename().string());
  console.total();

  const auto* const figures = std::get_if<contact::Summary>(&summary);
  if (!options.quiet) {
    out << (figures ? report(*figures, impact->scene)
                    : report(std::get<contact::EquilibriumSummary>(summary), scene))
        << fmt::format("\n{}\n{}\n", files.result().string(), files.summary().string());
    if (files.motion()) out << files.motion()->string() << '\n';
  }
  std::visit(
      [&](const auto& s) {
        for (const std::string& warning : s.warnings) console.warn(warning);
      },
      summary);
  return 0;
}

}  // namespace ricochet::impact
