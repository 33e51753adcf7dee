// SPDX-License-Identifier: BSD-2-Clause
// Computes modes of a body of a scene once, with a solver of this program or another solver, and measures the
// time from assembled matrices to mode shapes in memory:
//
//   mpirun -n 2 bench_modes SOLVER SCENE.toml BODY [--set KEY=VALUE]... [--upto-hz HZ] [--frequencies FILE]
//   bench_modes calculix-input SCENE.toml BODY OUT.inp [--set KEY=VALUE]...
//
// SOLVER is one of: ricochet; contact (the contact-adapted basis and its residual flexibility); krylov-schur
// (that of SLEPc, with one shift and its defaults); slicing (spectrum slicing of SLEPc, all modes in (1,
// HZ)). [modes] of the scene determines which modes are computed. Prints one line of JSON. scripts/bench
// modes runs it for each solver in turn, and runs ccx on the input that calculix-input writes.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <bit>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <optional>

#include "benchmarks/calculix.hpp"
#include "benchmarks/solvers.hpp"
#include "src/console/console.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/partition.hpp"
#include "src/mesh/read.hpp"
#include "src/modes/eps_solve.hpp"
#include "src/parallel/blas.hpp"
#include "src/scene/read.hpp"
#include "src/scene/request.hpp"

namespace {

using namespace ricochet;

struct Options {
  std::string solver, scene, body, deck, frequencies;
  std::vector<std::string> overrides;
  std::optional<double> upto_hz;
};

/// Reads the request on every rank, because the scene file is small. An error on one rank is thrown on all
/// ranks.
scene::KernelRequest read_request(const Options& options) {
  scene::KernelRequest request;
  std::string complaint;
  try {
    const scene::Scene scene = scene::read(options.scene, options.overrides);
    const scene::Body* body = scene.find_body(options.body);
    if (body == nullptr)
      throw InputError(fmt::format("{}: there is no body \"{}\"", options.scene, options.body));
    request = scene::kernel_request(scene, *body);
    const bool fitted = request.modes.basis == scene::Basis::contact;
    if (fitted != (options.solver == "contact"))
      throw InputError(fmt::format("{}: {} needs modes.basis = \"{}\"", options.scene, options.solver,
                                   fitted ? "modes" : "contact"));
    const bool by_count = options.solver == "krylov-schur" || options.solver == "calculix-input";
    if (by_count && !request.modes.count)
      throw InputError(fmt::format("{}: {} needs modes.count", options.scene, options.solver));
    if (options.solver == "slicing" && !options.upto_hz) throw InputError("slicing needs --upto-hz");
    if (options.solver == "calculix-input" && options.deck.empty())
      throw InputError("calculix-input needs the name of the file to write, after the body");
  } catch (const InputError& error) {
    complaint = error.what();
  }
  parallel::agree(PETSC_COMM_WORLD, complaint);
  return request;
}

bench::Found solve(const Options& options, const bench::Problem& problem) {
  if (options.solver == "ricochet") return bench::by_ricochet(problem);
  if (options.solver == "contact") return bench::by_contact_basis(problem);
  if (options.solver == "slicing") return bench::by_slicing(problem, Hertz{*options.upto_hz});
  return bench::by_krylov_schur(problem, *problem.request.modes.count);
}

void write_deck(const scene::KernelRequest& request, const mesh::GlobalMesh& global,
                const std::filesystem::path& path) {
  bench::write_calculix(global, request.body, *request.modes.count, path);
  std::int64_t unknowns = 0;
  for (const unsigned fixed : global.fixed) unknowns += 3 - std::popcount(fixed);
  // CalculiX should use the same BLAS kernels as this program.
  const char* const kernels = std::getenv("OPENBLAS_CORETYPE");
  std::cout << fmt::format(R"({{"unknowns": {}, "openblas_coretype": "{}"}})", unknowns,
                           kernels == nullptr ? "" : kernels)
            << std::endl;
}

void write_frequencies(const std::vector<double>& frequency_hz, const std::string& path) {
  std::ofstream file(path);
  for (const double f : frequency_hz) file << fmt::format("{:.15g}\n", f);
  if (!file.flush()) throw InputError(fmt::format("{}: can't be written", path));
}

void run(const Options& options) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  const scene::KernelRequest request = read_request(options);
  const mesh::GmshSession gmsh;
  mesh::GlobalMesh global;
  const bool deck = options.solver == "calculix-input";
  parallel::on_first_rank(world, [&] {
    global = mesh::read_mesh(request.body);
    if (deck) write_deck(request, global, options.deck);
  });
  if (deck) return;

  // In our own search, each rank is a team and searches on its own. All other solvers share the work of all
  // ranks.
  const bool in_teams = options.solver == "ricochet" && modes::works_in_teams(request.modes.solver);
  const parallel::Teams teams(world, in_teams ? parallel::size_of(world) : 1);
  if (parallel::rank_of(teams.team()) == 0) mesh::broadcast(global, teams.peers());
  const mesh::Mesh mesh = mesh::distribute(std::move(global), teams.team(), teams.peers());
  const double started = MPI_Wtime();
  const elasticity::Body body =
      elasticity::assemble(mesh, request.body.materials, request.body.mesh.filename().string());
  const double assembly = parallel::largest(world, MPI_Wtime() - started);

  const bench::Found found = solve(options, {teams, request, mesh, body});
  const double peak = parallel::largest(world, console::peak_memory_mib());
  std::string phases;
  for (const auto& [phase, begin] : found.phases)
    phases += fmt::format(R"({}["{}", {:.3f}])", phases.empty() ? "" : ", ", phase, begin);
  parallel::on_first_rank(world, [&] {
    if (!options.frequencies.empty()) write_frequencies(found.frequency_hz, options.frequencies);
    std::cout
        << fmt::format(
               R"({{"solver": "{}", "unknowns": {}, "assembly_seconds": {:.3f}, "seconds": {:.3f}, )"
               R"("peak_mib": {:.0f}, "elastic": {}, "worst_residual": {:.2e}, "upto_hz": {:.6f}, )"
               R"("flexibility_error": {:.3e}, "factor_seconds": {:.3f}, "factor_mib": {:.0f}, "phases": [{}]}})",
               options.solver, body.free_rows, assembly, found.seconds, peak, found.frequency_hz.size(),
               found.worst_residual, found.upto_hz, found.flexibility_error, found.factor_seconds,
               found.factor_mib, phases)
        << std::endl;
  });
}

/// Returns the exit status if the program should end.
std::optional<int> parse(int argc, char** argv, bool speak, Options& options) {
  CLI::App app{"Times one search for modes of a body of a scene.", "bench_modes"};
  app.add_option("SOLVER", options.solver)
      ->required()
      ->check(CLI::IsMember({"ricochet", "contact", "krylov-schur", "slicing", "calculix-input"}));
  app.add_option("SCENE", options.scene, "Scene file (TOML)")->required();
  app.add_option("BODY", options.body, "Its name in the scene")->required();
  app.add_option("OUT", options.deck, "calculix-input: the file to write");
  app.add_option("--set", options.overrides, "Override a scene key: KEY=VALUE; repeatable")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  app.add_option("--upto-hz", options.upto_hz, "slicing: upper end");
  app.add_option("--frequencies", options.frequencies, "Write the elastic frequencies [Hz] to this file");
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    if (speak) std::cout << app.help();
    return 0;
  } catch (const CLI::ParseError& error) {
    if (speak) std::cerr << "bench_modes: " << error.what() << " (see bench_modes --help)\n";
    return 2;
  }
  return std::nullopt;
}

}  // namespace

int main(int argc, char** argv) {
  parallel::prepare_blas();
  const parallel::Session session;
  const bool first = parallel::rank_of(PETSC_COMM_WORLD) == 0;
  try {
    Options options;
    if (const auto status = parse(argc, argv, first, options)) return *status;
    run(options);
    return 0;
  } catch (const InputError& error) {
    // The error is the same on every rank.
    if (first) std::cerr << "bench_modes: " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "bench_modes: " << error.what() << std::endl;
    MPI_Abort(PETSC_COMM_WORLD, 1);
    return 1;
  }
}
