// SPDX-License-Identifier: BSD-2-Clause
// Runs the impact of a scene, for all programs: kernels → pairs → model → accuracy → equilibrium or steps →
// summary.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "contact/figures/equilibrium_summary.hpp"
#include "contact/figures/motion_source.hpp"
#include "contact/figures/summary.hpp"
#include "contact/model/model.hpp"
#include "contact/static/equilibrium.hpp"
#include "contact/stepping/stepper.hpp"
#include "contact/table/table.hpp"
#include "ricochet/material_limits.hpp"
#include "src/console/console.hpp"
#include "src/scene/scene.hpp"
#include "src/store/stored_kernels.hpp"

namespace ricochet::impact {

struct ImpactRequest {
  scene::Scene scene;
  std::filesystem::path folder;  ///< contains the kernels
  bool views = false;            ///< also read the visualisation surfaces, for pictures of the motion
};

/// The data of one impact.
struct Impact {
  scene::Scene scene;        ///< at first as read, later with the settings chosen for its accuracy
  store::Kernels kernels{};  ///< empty if the responses come from a file
  std::shared_ptr<const contact::Model> model{};  ///< folded; null if the responses come from a file
  std::optional<contact::Table> table{};          ///< with sampled responses only
  StepOptions options{};
  std::int64_t steps = 0;  ///< contact steps, of a run that ends when bodies have parted: at most; 0 at rest
  std::int64_t samples() const { return steps / options.steps_per_sample; }
  contact::MotionSource source() const {
    return table ? contact::MotionSource(*table, model.get()) : contact::MotionSource(*model);
  }
};

/// Observes an impact. The run ends if a function throws.
class ImpactObserver {
 public:
  virtual ~ImpactObserver() = default;
  virtual void prepared(const Impact&) {}  ///< the kernels are read, but no setting is chosen yet
  /// Whether Impact::steps must be those of the run before it starts, also if it ends when bodies have
  /// parted. The steps up to there are then made twice.
  virtual bool needs_steps(const Impact&) const { return false; }
  /// Before the first step; again if the run is repeated from there, in place of what was observed so far.
  virtual void started(const Impact&, const contact::Stepper&) {}
  virtual void stepped(const contact::Stepper&) {}                     ///< after each step
  virtual void at_rest(const Impact&, const contact::Equilibrium&) {}  ///< at each knot
};

using ImpactSummary = std::variant<contact::Summary, contact::EquilibriumSummary>;

struct ImpactResult {
  std::unique_ptr<const Impact> impact;  ///< observers may refer to it
  ImpactSummary summary;
};

/// Runs the scene without writing files or printing results; `console` shows the phases. If the scene leaves
/// its rotations open and a free body turns by more than scene::most_linear_turn, repeats the run with
/// finite ones, unless its kernels do not serve them.
///
/// Throws a one-line InputError that begins with the name of the scene or of another file: for kernels that
/// are missing or belong to another scene, for bodies that overlap or do not meet, for contact problems
/// without a solution, and for unsupported bodies at rest. Throws SolverError if the motion becomes infinite
/// or undefined, or if Uzawa's iteration does not converge.
ImpactResult run_impact(ImpactRequest request, store::KernelStore& store, console::Console& console,
                        ImpactObserver& observer);

/// Limits of the weakest material of each body.
std::vector<MaterialLimits> limits_of(const scene::Scene& scene);

/// √(E/ρ) of the slowest material, in its softest direction [m/s]; 0 without bodies.
double slowest_wave(const scene::Scene& scene);

/// Throws the error of a step that failed at `time` [s]. Does nothing if the step succeeded.
void check(StepStatus status, const scene::Scene& scene, double time);

}  // namespace ricochet::impact
