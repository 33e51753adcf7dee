// SPDX-License-Identifier: BSD-2-Clause
#include "src/console/options.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <sstream>

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

Parsed parse(const Program& program, int argc, const char* const* argv, bool speak) {
  Options options;
  std::string scene, out, accuracy, fclib;
  CLI::App app{program.purpose, program.name};
  app.set_version_flag("--version", program.name + " " RICOCHET_VERSION);
  app.add_flag_callback(
      "--keys", [&] { throw CLI::CallForVersion(program.keys, 0); },
      "Print the reference of all keys of a scene and stop");
  app.add_option("SCENE", scene, "Scene file (TOML)")->required();
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
         "--accuracy", accuracy,
         "Relative error allowed in the main results: chooses the settings that the scene leaves open, "
         "and estimates errors; like --set accuracy=X")
      ->type_name("X");
  app.add_option("--out", out, "Folder of kernels and results (default: out/ beside the scene)")
      ->type_name("DIR");
  app.add_flag("--dry-run", options.dry_run, "Print the resolved scene and stop");
  app.add_flag("--quiet", options.quiet, "No progress, no table");
  if (program.impacts) {
    CLI::Option* vtk =
        app.add_flag("--vtk", options.vtk,
                     "Write the motion for ParaView: <title>.motion.xdmf, about 200 frames, or one "
                     "every output.vtk_every steps");
    app.add_flag("--batch", options.batch, "Answer requests on standard input, a line of JSON each")
        ->excludes(vtk);
    app.add_option("--fclib", fclib,
                   "Write the complementarity problems of steps into this folder, for FCLIB")
        ->type_name("DIR");
    app.add_option("--fclib-every", options.fclib_every, "Write every N-th step with contact (default: 1)")
        ->type_name("N")
        ->check(above_zero());
  }
  if (!program.impacts) {
    CLI::Option* check = app.add_flag(
        "--check", options.check,
        "Check scene, meshes, groups, loads and receivers of the kernels that are missing, and stop");
    app.add_flag(
           "--verify", options.verify,
           "Count the modes of the stored kernels again with K and M, and stop: status 1 if a count differs")
        ->excludes(check);
  }
  Elsewhere elsewhere{{"-n", "ricochet kernel, modes and run"},
                      {"--ranks", "ricochet kernel, modes and run"}};
  const std::string other = program.impacts ? "ricochet kernel" : "ricochet impact";
  for (const char* option : {"--check", "--verify"})
    if (program.impacts) elsewhere[option] = other;
  for (const char* option : {"--vtk", "--batch", "--fclib", "--fclib-every"})
    if (!program.impacts) elsewhere[option] = other;
  app.footer("Examples:\n" + program.examples);
  if (const auto status = status_of_parsing(app, argc, argv, speak, elsewhere))
    return {std::nullopt, *status};
  if (!accuracy.empty()) options.overrides.push_back("accuracy=" + accuracy);
  options.scene = scene;
  options.fclib = fclib;
  options.out = out.empty() ? options.scene.parent_path() / "out" : std::filesystem::path(out);
  return {options, 0};
}

}  // namespace ricochet::console
