// What runs by modes and runs by table kernels share.
#pragma once

#include <chrono>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "contact/integrator.hpp"
#include "contact/model.hpp"
#include "contact/summary.hpp"
#include "kernels/kernel.hpp"
#include "src/console/console.hpp"
#include "src/console/options.hpp"
#include "src/programs/placing.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::programs {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start);

/// Kernels of the scene's bodies, in their order.
struct Kernels {
  std::vector<kernels::Kernel> kernel;
  std::vector<std::string> file;
};

/// Of several kernels that differ in the candidates that they hold, the one with the fewest that are enough.
Kernels read_kernels(const scene::Scene& scene, const std::filesystem::path& folder);

contact::Model model_of(const scene::Scene& scene, const Kernels& kernels);
contact::StepOptions step_options(const scene::Scene& scene);

/// Throws what a step that failed at `time` [s] means.
void check(contact::StepStatus status, const scene::Scene& scene, double time);

/// The main figures, a line each.
std::string report(const contact::Summary& summary);

/// The part of run_contact that is for table kernels (table_run.cpp).
int run_table(const console::Options& options, const scene::Scene& scene, const std::filesystem::path& folder,
              console::Console& console, std::ostream& out);

}  // namespace ricochet::programs
