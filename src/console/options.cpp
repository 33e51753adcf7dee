// SPDX-License-Identifier: BSD-2-Clause
#include "src/console/options.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <sstream>
#include <vector>

#include "src/console/cli.hpp"

namespace ricochet::console {

std::optional<int> status_of_parsing(CLI::App& app, int argc, const char* const* argv, bool speak,
                                     const Elsewhere& elsewhere) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      std::ostringstream text, ignored;
      app.exit(error, text, ignored);
      if (speak) fmt::print("{}", text.str());
      return 0;
    }
    if (speak)
      fmt::print(stderr, "{}: {} (see {} --help)\n", app.get_name(),
                 complaint(app, error, {argv + 1, argv + argc}, elsewhere), app.get_name());
    return 2;
  }
}

CLI::Validator above_zero() {
  return CLI::Validator(
      [](const std::string& word) {
        double value = 0;
        const bool good = CLI::detail::lexical_cast(word, value) && value > 0 && value <= 1e18;
        return good ? std::string() : fmt::format("{}: must be a number above 0", word);
      },
      "> 0");
}

namespace {

/// The texts of options whose values are paths or part of an override.
struct Texts {
  std::string scene, out, accuracy, fclib, write_scene;
};

void add_scene_options(CLI::App& app, const Program& program, Options& options, Texts& texts) {
  app.set_version_flag("--version", program.name + " " RICOCHET_VERSION);
  app.add_flag_callback(
      "--keys", [&program] { throw CLI::CallForVersion(program.keys, 0); },
      "Print the reference of all keys of a scene and stop");
  app.add_option("SCENE", texts.scene, "Scene file (TOML)")->required();
  // Each option takes its one value verbatim, because vectors contain commas and brackets.
  app.add_option(
         "--set", options.overrides,
         "Override a scene key: KEY=VALUE, dotted, [i] for list entries, in quotes if it has brackets "
         "or blanks; repeatable")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  app.add_option(
         "--accuracy", texts.accuracy,
         "Relative error allowed in the main results: chooses the settings that the scene leaves open, "
         "and estimates errors; like --set accuracy=X")
      ->type_name("X");
  app.add_option("--out", texts.out, "Folder of kernels and results (default: out/ beside the scene)")
      ->type_name("DIR");
  app.add_flag("--dry-run", options.dry_run, "Print the resolved scene and stop");
  app.add_flag("--quiet", options.quiet, "No progress, no table");
}

void add_impact_options(CLI::App& app, Options& options, Texts& texts) {
  CLI::Option* vtk =
      app.add_flag("--vtk", options.vtk,
                   "Write the motion for ParaView: <title>.motion.xdmf, about 200 frames, or one "
                   "every output.vtk_every steps");
  app.add_option("--snapshots-up-to", options.snapshots_mb,
                 "Keep up to 400 snapshots of at most this many MB, although the scene has no "
                 "output.snapshot_every (default: 0)")
      ->type_name("MB")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--batch", options.batch, "Answer requests on standard input, a line of JSON each")
      ->excludes(vtk);
  app.add_option("--fclib", texts.fclib,
                 "Write the complementarity problems of steps into this folder, for FCLIB")
      ->type_name("DIR");
  app.add_option("--write-scene", texts.write_scene,
                 "Write the scene with the settings that were chosen for its accuracy into this file")
      ->type_name("FILE");
  app.add_option("--fclib-every", options.fclib_every, "Write every N-th step with contact (default: 1)")
      ->type_name("N")
      ->check(above_zero());
}

void add_kernel_options(CLI::App& app, Options& options) {
  CLI::Option* check = app.add_flag(
      "--check", options.check,
      "Check scene, meshes, groups, loads and receivers of the kernels that are missing, and stop");
  app.add_flag(
         "--verify", options.verify,
         "Count the modes of the stored kernels again with K and M, and stop: status 1 if a count differs")
      ->excludes(check);
  app.add_flag("--plan", options.plan,
               "State memory and time on 1, 2, 4, … ranks from measured work, with a job for SLURM, and stop")
      ->excludes("--check")
      ->excludes("--verify");
  app.add_option("--view-up-to", options.view_mib,
                 "Keep the visualisation surface of a body if it takes at most this many MiB, although the "
                 "scene has no output.view (default: 0)")
      ->type_name("MIB")
      ->check(CLI::NonNegativeNumber);
}

/// The options of other commands, with these commands.
Elsewhere elsewhere_of(const Program& program) {
  Elsewhere elsewhere{{"-n", "ricochet kernel, modes and run"},
                      {"--ranks", "ricochet kernel, modes and run"}};
  const std::vector<const char*> of_others =
      program.impacts
          ? std::vector{"--check", "--verify", "--plan", "--view-up-to"}
          : std::vector{"--vtk", "--batch", "--fclib", "--fclib-every", "--write-scene", "--snapshots-up-to"};
  for (const char* option : of_others)
    elsewhere[option] = program.impacts ? "ricochet kernel" : "ricochet impact";
  return elsewhere;
}

}  // namespace

Parsed parse(const Program& program, int argc, const char* const* argv, bool speak) {
  Options options;
  Texts texts;
  CLI::App app{program.purpose, program.name};
  add_scene_options(app, program, options, texts);
  if (program.impacts)
    add_impact_options(app, options, texts);
  else
    add_kernel_options(app, options);
  app.footer("Examples:\n" + program.examples);
  if (const auto status = status_of_parsing(app, argc, argv, speak, elsewhere_of(program)))
    return {std::nullopt, *status};
  if (!texts.accuracy.empty()) options.overrides.push_back("accuracy=" + texts.accuracy);
  options.scene = texts.scene;
  options.fclib = texts.fclib;
  options.write_scene = texts.write_scene;
  options.out = texts.out.empty() ? options.scene.parent_path() / "out" : std::filesystem::path(texts.out);
  return {options, 0};
}

}  // namespace ricochet::console
