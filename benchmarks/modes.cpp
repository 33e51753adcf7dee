// One search for modes, timed from assembled matrices to shapes in hand, by this program's engine or one of
// its peers:
//
//   mpirun -n 2 bench_modes SOLVER FILE.geo SIZE ORDER COUNT [UPTO_HZ]
//
// SOLVER: ricochet; krylov-schur (SLEPc's, one shift, defaults); slicing (SLEPc's spectrum slicing, all in
// (1, UPTO_HZ)). Prints one line of JSON. scripts/bench-modes calls it in turn.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <numbers>
#include <optional>

#include "src/console/console.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/modes/modes.hpp"
#include "src/parallel/blas.hpp"

namespace {

using namespace ricochet;
using parallel::check;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Found {
  double seconds = 0;
  std::int64_t elastic = 0;
  double residual = 0, upto_hz = 0;
};

Found by_ricochet(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                  std::int64_t count) {
  const double started = now();
  modes::Factorisation factor(body.stiffness, body.mass);
  const modes::ModeSet set = modes::compute_modes(teams, mesh, body, factor, {.count = count});
  Found found{now() - started, 0, 0, set.certificate.upto_hz};
  for (std::size_t n = 0; n < set.residual.size(); ++n)
    if (set.angular_frequency[n] > 0) {
      ++found.elastic;
      found.residual = std::max(found.residual, set.residual[n]);
    }
  return found;
}

/// SLEPc with shift-and-invert by MUMPS; an interval asks for spectrum slicing.
Found by_slepc(const mesh::Mesh& mesh, const elasticity::Body& body, std::int64_t count,
               std::optional<double> upto_hz) {
  const auto lambda = [](double hertz) { return std::pow(2 * std::numbers::pi * hertz, 2); };
  const double started = now();
  parallel::EigenSolver eps;
  check(EPSCreate(mesh.comm, eps.out()));
  check(EPSSetOperators(eps, body.stiffness, body.mass));
  check(EPSSetProblemType(eps, EPS_GHEP));
  check(EPSSetType(eps, EPSKRYLOVSCHUR));
  ST st = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  if (upto_hz) {
    check(EPSSetWhichEigenpairs(eps, EPS_ALL));
    check(EPSSetInterval(eps, lambda(1), lambda(*upto_hz)));
  } else {
    check(EPSSetWhichEigenpairs(eps, EPS_TARGET_MAGNITUDE));
    check(EPSSetTarget(eps, -lambda(1)));
    check(EPSSetDimensions(eps, static_cast<PetscInt>(count), PETSC_DEFAULT, PETSC_DEFAULT));
  }
  check(EPSGetST(eps, &st));
  check(STSetType(st, STSINVERT));
  check(STSetMatStructure(st, SUBSET_NONZERO_PATTERN));
  if (upto_hz) {
    check(EPSKrylovSchurGetKSP(eps, &ksp));
  } else {
    check(STGetKSP(st, &ksp));
  }
  check(KSPSetType(ksp, KSPPREONLY));
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCCHOLESKY));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  // As SLEPc's own example has it for slicing: no ScaLAPACK at the root, null pivots detected.
  if (upto_hz)
    check(PetscOptionsInsertString(
        nullptr, "-st_mat_mumps_icntl_13 1 -st_mat_mumps_icntl_24 1 -st_mat_mumps_cntl_3 1e-12"));
  check(EPSSetFromOptions(eps));
  check(EPSSolve(eps));
  PetscInt converged = 0;
  check(EPSGetConverged(eps, &converged));
  Found found{now() - started, 0, 0, 0};

  const modes::Operators operators(mesh, body);
  const PetscInt wanted = upto_hz ? converged : std::min(converged, static_cast<PetscInt>(count));
  for (PetscInt i = 0; i < wanted; ++i) {
    Eigen::MatrixXd shape(body.local_rows, 1);
    parallel::Vector x;
    check(VecCreateMPIWithArray(mesh.comm, mesh.components(), static_cast<PetscInt>(body.local_rows),
                                PETSC_DECIDE, shape.data(), x.out()));
    double value = 0;
    check(EPSGetEigenpair(eps, i, &value, nullptr, x, nullptr));
    if (value < lambda(1)) continue;
    ++found.elastic;
    found.upto_hz = std::max(found.upto_hz, std::sqrt(value) / (2 * std::numbers::pi));
    found.residual =
        std::max(found.residual, operators.residuals(shape, Eigen::VectorXd::Constant(1, value))[0]);
  }
  return found;
}

int run(const std::vector<std::string>& words) {
  if (words.size() < 5) throw InputError("give SOLVER FILE.geo SIZE ORDER COUNT [UPTO_HZ]");
  const std::string& solver = words[0];
  const std::int64_t count = std::stoll(words[4]);
  const bool ours = solver == "ricochet";
  scene::Body given;
  given.name = "body";
  given.mesh = words[1];
  given.order = std::stoi(words[3]);
  // Table 1 of the paper.
  given.materials = {{.group = "", .density = 11.3e3, .young = 10.4e6, .poisson = 0.37, .area = 0}};
  const parallel::Teams teams(PETSC_COMM_WORLD, ours ? parallel::size_of(PETSC_COMM_WORLD) : 1);
  const mesh::GmshSession gmsh({"size", words[2]});
  mesh::GlobalMesh global;
  parallel::on_first_rank(PETSC_COMM_WORLD, [&] { global = mesh::read_mesh(given); });
  if (parallel::rank_of(teams.team()) == 0) mesh::broadcast(global, teams.peers());
  const mesh::Mesh mesh = mesh::distribute(std::move(global), teams.team());
  const elasticity::Body body = elasticity::assemble(mesh, given.materials, given.mesh.filename().string());

  MPI_Barrier(PETSC_COMM_WORLD);
  std::optional<double> upto;
  if (solver == "slicing" && words.size() > 5) upto = std::stod(words[5]);
  const Found found = ours ? by_ricochet(teams, mesh, body, count) : by_slepc(mesh, body, count, upto);
  const double peak = parallel::largest(PETSC_COMM_WORLD, console::peak_memory_mib());
  if (parallel::rank_of(PETSC_COMM_WORLD) == 0)
    std::cout
        << fmt::format(
               R"({{"solver": "{}", "unknowns": {}, "seconds": {:.3f}, "peak_mib": {:.0f}, "elastic": {}, )"
               R"("worst_residual": {:.2e}, "upto_hz": {:.6f}}})",
               solver, body.total_rows, found.seconds, peak, found.elastic, found.residual, found.upto_hz)
        << std::endl;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  parallel::prepare_blas(argv);
  const parallel::Session session;
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << "bench_modes: " << error.what() << std::endl;
    MPI_Abort(PETSC_COMM_WORLD, 1);
  }
}
