// What runs by modes and runs by table kernels share.
#pragma once

#include <chrono>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/output/summary.hpp"
#include "contact/static/equilibrium.hpp"
#include "contact/stepping/stepper.hpp"
#include "src/console/console.hpp"
#include "src/console/options.hpp"
#include "src/programs/placing.hpp"
#include "src/programs/stored_kernels.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::programs {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start);

/// √(E/ρ) [m/s], the least of all bodies; 0 without bodies.
double slowest_wave(const scene::Scene& scene);

/// @param kernels  of the scene's bodies; the model refers to them
/// @param known  as of contact::pair
contact::Model model_of(const scene::Scene& scene, const std::vector<const kernels::Kernel*>& kernels,
                        contact::Pairings& known);
StepOptions step_options(const scene::Scene& scene);

/// Of a scene with the scheme "static".
contact::Equilibrium equilibrium_of(const scene::Scene& scene, const contact::Model& model);

/// Throws what a step that failed at `time` [s] means.
void check(StepStatus status, const scene::Scene& scene, double time);

/// Adds a warning to those of a run under "compliant" whose touches all have so few steps that peak force and
/// rebound hang on the step; with an accuracy the estimate tells.
void judge_steps(const scene::Scene& scene, contact::Summary& summary);

/// The main figures, a line each.
std::string report(const contact::Summary& summary);

/// The part of run_contact that is for table kernels (table_run.cpp).
int run_table(const console::Options& options, const scene::Scene& scene, const std::filesystem::path& folder,
              console::Console& console, std::ostream& out);

/// The same run without a result file, `wall_s` left to the caller.
contact::Summary summary_by_table(const scene::Scene& scene, const std::filesystem::path& folder,
                                  KernelCache& cache);

}  // namespace ricochet::programs
