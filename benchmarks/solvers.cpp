// SPDX-License-Identifier: BSD-2-Clause
#include "benchmarks/solvers.hpp"
#include "src/scene/request.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "src/reduction/contact_basis.hpp"
#include "src/reduction/residual.hpp"
#include "src/surface/patches.hpp"

namespace ricochet::bench {

namespace {

using parallel::check;

/// Seconds since the last rank became ready.
class Stopwatch {
 public:
  explicit Stopwatch(MPI_Comm comm) : comm_(comm) {
    MPI_Barrier(comm_);
    started_ = std::chrono::steady_clock::now();
  }
  /// Seconds on the slowest rank. Collective.
  double seconds() const {
    return parallel::largest(
        comm_, std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count());
  }

 private:
  MPI_Comm comm_;
  std::chrono::steady_clock::time_point started_;
};

Found found_by_us(const modes::ModeSet& set, double seconds) {
  Found found{.seconds = seconds,
              .upto_hz = set.certificate.upto_hz,
              .flexibility_error = set.certificate.flexibility_error};
  for (std::size_t n = 0; n < set.residual.size(); ++n)
    if (set.angular_frequency[n] > 0) {
      found.frequency_hz.push_back(to_hertz(RadPerSecond{set.angular_frequency[n]}).value);
      found.worst_residual = std::max(found.worst_residual, set.residual[n]);
    }
  return found;
}

double lambda(Hertz frequency) { return std::pow(2 * std::numbers::pi * frequency.value, 2); }

/// Modes below this frequency are rigid.
constexpr Hertz rigid_below{1};

/// Selects shift-and-invert by MUMPS. The type of the solver and, for slicing, its interval must
/// already be set.
void set_inverse(EPS eps, bool slicing) {
  ST st = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  check(EPSGetST(eps, &st));
  check(STSetType(st, STSINVERT));
  check(STSetMatStructure(st, SUBSET_NONZERO_PATTERN));
  if (slicing) {
    check(EPSKrylovSchurGetKSP(eps, &ksp));
  } else {
    check(STGetKSP(st, &ksp));
  }
  check(KSPSetType(ksp, KSPPREONLY));
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCCHOLESKY));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

/// Solves the problem and returns at most `most` pairs.
Found solve(const Problem& problem, EPS eps, const Stopwatch& watch, PetscInt most) {
  check(EPSSetFromOptions(eps));
  check(EPSSolve(eps));
  PetscInt converged = 0;
  check(EPSGetConverged(eps, &converged));
  Found found{.seconds = watch.seconds()};

  const modes::Operators operators(problem.mesh, problem.body);
  for (PetscInt i = 0; i < std::min(converged, most); ++i) {
    Eigen::MatrixXd shape(problem.body.local_rows, 1);
    parallel::Vector x;
    check(VecCreateMPIWithArray(problem.mesh.comm, problem.mesh.components(),
                                static_cast<PetscInt>(problem.body.local_rows), PETSC_DECIDE, shape.data(),
                                x.out()));
    double value = 0;
    check(EPSGetEigenpair(eps, i, &value, nullptr, x, nullptr));
    if (value < lambda(rigid_below)) continue;
    found.frequency_hz.push_back(std::sqrt(value) / (2 * std::numbers::pi));
    found.worst_residual =
        std::max(found.worst_residual, operators.residuals(shape, Eigen::VectorXd::Constant(1, value))[0]);
  }
  std::sort(found.frequency_hz.begin(), found.frequency_hz.end());
  if (!found.frequency_hz.empty()) found.upto_hz = found.frequency_hz.back();
  return found;
}

void set_problem(EPS eps, const Problem& problem) {
  check(EPSSetOperators(eps, problem.body.stiffness, problem.body.mass));
  check(EPSSetProblemType(eps, EPS_GHEP));
  check(EPSSetType(eps, EPSKRYLOVSCHUR));
}

}  // namespace

Found by_ricochet(const Problem& problem) {
  const scene::Modes& wanted = problem.request.modes;
  const Stopwatch watch(problem.teams.world());
  modes::Factorisation factor(problem.body.stiffness, problem.body.mass);
  std::vector<std::pair<std::string, double>> phases;
  modes::Progress progress;
  progress.begin = [&](const std::string& phase) { phases.emplace_back(phase, watch.seconds()); };
  const modes::ModeSet set = modes::compute_modes(problem.teams, problem.mesh, problem.body, factor,
                                                  {.up_to = wanted.up_to,
                                                   .count = wanted.count,
                                                   .relative_residual = wanted.relative_residual,
                                                   .eps_type = wanted.solver},
                                                  progress);
  Found found = found_by_us(set, watch.seconds());
  found.phases = std::move(phases);
  const Stopwatch again(problem.teams.world());
  factor.factor(0.9 * set.cut);
  found.factor_seconds = again.seconds();
  found.factor_mib = factor.expected_mib();
  return found;
}

Found by_contact_basis(const Problem& problem) {
  const scene::KernelRequest& request = problem.request;
  const scene::Modes& wanted = request.modes;
  const surface::Patches patches = surface::make_patches(
      problem.mesh, request.body.contact,
      {.direction = request.direction, .along = request.along, .spacing = request.spacing});
  const Eigen::MatrixXd loads = surface::patch_loads(problem.mesh, patches);
  // Gravity also moves the surface of a supported body.
  Eigen::MatrixXd all(loads.rows(), loads.cols() + 3);
  all << loads, problem.body.rigid_load.leftCols(3);

  const Stopwatch watch(problem.teams.world());
  modes::Factorisation factor(problem.body.stiffness, problem.body.mass);
  const modes::ModeSet set =
      reduction::contact_basis(problem.teams, problem.mesh, problem.body, factor, all, loads.cols(),
                               {.band = *wanted.up_to,
                                .flexibility_error = wanted.flexibility_error.value_or(0),
                                .count = wanted.count,
                                .residual_flexibility = wanted.residual_flexibility});
  if (wanted.residual_flexibility)
    reduction::residual_response(problem.teams, problem.mesh, problem.body, factor, set, all.sparseView());
  return found_by_us(set, watch.seconds());
}

Found by_krylov_schur(const Problem& problem, std::int64_t count) {
  const Stopwatch watch(problem.teams.world());
  parallel::Handle<EPS, EPSDestroy> eps;
  check(EPSCreate(problem.mesh.comm, eps.out()));
  set_problem(eps, problem);
  check(EPSSetWhichEigenpairs(eps, EPS_TARGET_MAGNITUDE));
  check(EPSSetTarget(eps, -lambda(rigid_below)));
  check(EPSSetDimensions(eps, parallel::petsc_int(count), PETSC_DEFAULT, PETSC_DEFAULT));
  set_inverse(eps, false);
  return solve(problem, eps, watch, parallel::petsc_int(count));
}

Found by_slicing(const Problem& problem, Hertz upto) {
  const Stopwatch watch(problem.teams.world());
  parallel::Handle<EPS, EPSDestroy> eps;
  check(EPSCreate(problem.mesh.comm, eps.out()));
  set_problem(eps, problem);
  check(EPSSetWhichEigenpairs(eps, EPS_ALL));
  check(EPSSetInterval(eps, lambda(rigid_below), lambda(upto)));
  set_inverse(eps, true);
  // As in SLEPc's own example: no ScaLAPACK at the root, and null pivots are detected.
  check(PetscOptionsInsertString(
      nullptr, "-st_mat_mumps_icntl_13 1 -st_mat_mumps_icntl_24 1 -st_mat_mumps_cntl_3 1e-12"));
  return solve(problem, eps, watch, PETSC_MAX_INT);
}

}  // namespace ricochet::bench
