// SPDX-License-Identifier: BSD-2-Clause
// ricochet-recast KERNEL: rescales or truncates a kernel without computing modes.
#include <exception>
#include <iostream>

#include "src/console/cli.hpp"
#include "src/console/ending.hpp"
#include "src/store/recast.hpp"

namespace {

using namespace ricochet;

/// The command line of ricochet-recast.
struct CommandLine {
  store::RecastOptions options;
  std::string kernel, out;
  std::vector<std::int64_t> points;
  double up_to = 0, error = 0;
  std::int64_t count = 0;
  CLI::Option *band = nullptr, *number = nullptr, *bound = nullptr, *places = nullptr;

  void describe(CLI::App& app) {
    app.add_option("KERNEL", kernel, "Kernel file of ricochet-kernel")->required();
    app.add_option("--young-factor", options.young,
                   "Multiplies Young's modulus, or the whole stiffness, of each material")
        ->check(console::above_zero());
    app.add_option("--density-factor", options.density, "Multiplies the density of each material")
        ->check(console::above_zero());
    app.add_option("--scale-factor", options.scale, "Multiplies all lengths (not the cross-section of a rod)")
        ->check(console::above_zero());
    band = app.add_option("--up-to-hz", up_to,
                          "Keep the modes up to this frequency of the new body; with "
                          "--flexibility-error: the end of the band")
               ->check(console::above_zero());
    number = app.add_option("--count", count, "Keep so many of the lowest modes, rigid included")
                 ->check(console::above_zero())
                 ->excludes(band);
    bound = app.add_option("--flexibility-error", error,
                           "Leave modes to the residual flexibility that contact hardly feels in the band")
                ->check(CLI::Range(1e-6, 0.5))
                ->excludes(number);
    places = app.add_option("--points", points, "Keep these candidate points, by their numbers from 0: 0,3,4")
                 ->delimiter(',')
                 ->check([](const std::string& word) { return word.empty() ? "names no point" : ""; })
                 ->allow_extra_args(false)
                 ->type_name("I,J,…");
    app.add_flag("--vtk", options.vtk,
                 "Write the modes for ParaView, <body>-<hash>.modes.xdmf, in the place of a kernel");
    app.add_option("--out", out, "Folder of the new kernel (default: that of KERNEL)")->type_name("DIR");
    app.footer(
        "Examples:\n"
        "  ricochet-recast out/upper-0123456789ab.kernel.h5 --young-factor 2 --scale-factor 0.5\n"
        "  ricochet-recast out/upper-0123456789ab.kernel.h5 --up-to-hz 800 --points 0,2,4\n"
        "  ricochet-recast out/upper-0123456789ab.kernel.h5 --flexibility-error 1e-2 --up-to-hz 500\n"
        "  ricochet-recast out/upper-0123456789ab.kernel.h5 --vtk");
  }

  /// The options after parsing.
  store::RecastOptions given() {
    options.kernel = kernel;
    options.out = out;
    if (*band) options.up_to = Hertz{up_to};
    if (*number) options.count = count;
    if (*bound) options.flexibility_error = error;
    if (*places) options.points = points;
    return options;
  }
};

}  // namespace

int main(int argc, char** argv) {
  const std::string name = "ricochet-recast";
  CLI::App app{
      "Writes the kernel of a body of another stiffness, density or size, or a kernel cut to less, "
      "without computing modes. Scaling comes before cuts.",
      name};
  app.set_version_flag("--version", name + " " RICOCHET_VERSION);
  CommandLine line;
  line.describe(app);
  if (const auto status = console::status_of_parsing(app, argc, argv)) return *status;
  console::end_cleanly_on_signals();
  try {
    const int status = store::run_recast(line.given(), std::cout);
    return console::all_printed(name) ? status : 1;
  } catch (const std::exception& failure) {
    return console::status_of(failure, name);
  }
}
