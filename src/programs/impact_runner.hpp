// SPDX-License-Identifier: BSD-2-Clause
// The impact of a scene: kernels → pairs → model → accuracy → rest or steps → summary, for every program.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <variant>

#include "contact/model/model.hpp"
#include "contact/output/summary.hpp"
#include "contact/static/equilibrium.hpp"
#include "contact/stepping/stepper.hpp"
#include "contact/table/table.hpp"
#include "src/console/console.hpp"
#include "src/programs/stored_kernels.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::programs {

struct ImpactRequest {
  scene::Scene scene;
  std::filesystem::path folder;  ///< of the kernels
  bool skins = false;            ///< also read the visualisation surfaces, for pictures of the motion
};

/// The data of one impact.
struct Impact {
  scene::Scene scene;                     ///< later with the settings that its accuracy chose
  Kernels kernels{};                      ///< none with a table from a file
  std::optional<contact::Model> model{};  ///< none with a table from a file
  std::optional<contact::Table> table{};  ///< with table kernels
  StepOptions options{};
  std::int64_t steps = 0;  ///< 0 at rest
};

/// Follows an impact. A function that throws ends the run.
class ImpactObserver {
 public:
  virtual ~ImpactObserver() = default;
  virtual void prepared(const Impact&) {}  ///< the kernels are read; no setting is chosen yet
  virtual void started(const Impact&, const contact::Stepper&) {}      ///< before the first step
  virtual void stepped(const contact::Stepper&) {}                     ///< after each step
  virtual void at_rest(const Impact&, const contact::Equilibrium&) {}  ///< in place of steps
};

using ImpactSummary = std::variant<contact::Summary, contact::EquilibriumSummary>;

struct ImpactResult {
  std::unique_ptr<const Impact> impact;  ///< observers may refer to it
  ImpactSummary summary;
};

/// Runs the scene without writing or printing anything; `console` shows the phases.
///
/// Throws InputError, one line that starts with the name of the scene or of another file: kernels that are
/// missing or belong to another scene; bodies that overlap or do not meet; contact problems without a
/// solution; unsupported bodies at rest. Throws SolverError if the motion stops being finite or Uzawa's
/// iteration does not converge.
ImpactResult run_impact(ImpactRequest request, KernelStore& store, console::Console& console,
                        ImpactObserver& observer);

/// Throws the error of a step that failed at `time` [s]; returns if it succeeded.
void check(StepStatus status, const scene::Scene& scene, double time);

}  // namespace ricochet::programs
