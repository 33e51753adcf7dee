// SPDX-License-Identifier: BSD-2-Clause
// ricochet-contact: computes impacts of elastic bodies from their kernels.
#include <exception>
#include <iostream>

#include "src/console/ending.hpp"
#include "src/console/options.hpp"
#include "src/impact/batch.hpp"
#include "src/impact/run.hpp"
#include "src/scene/key_reference.hpp"

int main(int argc, char** argv) {
  using namespace ricochet;
  const console::Program program{
      .name = "ricochet-contact",
      .purpose =
          "Computes the impact of a scene from its bodies' kernels: <title>.result.h5 and "
          "<title>.summary.json.",
      .examples =
          "  ricochet-kernel two-disks.toml && ricochet-contact two-disks.toml\n"
          "  ricochet-contact --set title=fast --set 'bodies.upper.velocity=[0,-6,0]' two-disks.toml\n"
          "  ricochet-contact --set contact.scheme=impulse --set time.rate_hz=96000 two-disks.toml\n"
          "  ricochet-contact --vtk two-disks.toml\n"
          "  ricochet-contact --dry-run two-disks.toml",
      .impacts = true,
      .keys = scene::key_reference()};
  const console::Parsed parsed = console::parse(program, argc, argv);
  if (!parsed.options) return parsed.status;
  console::end_cleanly_on_signals();
  try {
    const int status = parsed.options->batch ? impact::run_batch(*parsed.options, std::cin, std::cout)
                                             : impact::run_contact(*parsed.options, std::cout);
    return console::all_printed(program.name) ? status : 1;
  } catch (const std::exception& failure) {
    return console::status_of(failure, program.name);
  }
}
