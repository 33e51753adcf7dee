// SPDX-License-Identifier: BSD-2-Clause
#include "src/kernel/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <utility>

#include "base/atomic_file.hpp"
#include "kernels/write.hpp"
#include "src/accuracy/loop.hpp"
#include "src/kernel/compute.hpp"
#include "src/kernel/discretise.hpp"
#include "src/kernel/verify.hpp"
#include "src/scene/derive.hpp"
#include "src/scene/read.hpp"
#include "src/scene/write.hpp"
#include "src/store/body_warnings.hpp"

namespace ricochet::kernel {

namespace {

/// Prints mass, size and wave speed of a body, and warnings about them.
void report_body(const scene::Body& body, const kernels::Kernel& kernel, console::Console& console) {
  console.say(fmt::format("{}: {}", body.name, store::figures_of(body, kernel)));
  for (const std::string& warning : store::warnings_of(body, kernel)) console.warn(warning);
}

/// Derives the kernel from another one in the folder, if one is suitable, and writes it. Collective. @return
/// a note for the user; empty if the kernel must be computed
std::string derive_if_possible(const scene::KernelRequest& request, const std::filesystem::path& folder,
                               const std::filesystem::path& path, MPI_Comm comm, console::Console& console) {
  std::string from;
  parallel::on_first_rank(comm, [&] {
    const auto derived = scene::derive_from_any(folder, request);
    if (!derived) return;
    kernels::write(derived->kernel, path);
    report_body(request.body, derived->kernel, console);
    from = fmt::format("derived from {}: ", derived->from.filename().string());
  });
  parallel::broadcast(comm, from);
  return from;
}

/// The folder of finished slices. It is kept until the kernel is written, so that an interrupted run can be
/// resumed.
std::filesystem::path checkpoint_of(std::filesystem::path kernel) {
  return kernel.replace_extension().replace_extension(".slices");
}

void forget(const std::filesystem::path& checkpoint) {
  std::error_code ignored;
  std::filesystem::remove_all(checkpoint, ignored);
}

/// Computes the kernels of a closed scene that are not there yet. Collective.
/// @param check  whether to check all bodies before the first one is computed
/// @return the files written
std::vector<std::filesystem::path> compute_kernels(const scene::Scene& scene, bool check,
                                                   const console::Options& options, MPI_Comm comm,
                                                   console::Console& console) {
  const bool first = parallel::rank_of(comm) == 0;
  std::vector<scene::KernelRequest> requests;
  parallel::on_all_ranks(comm, [&] {
    for (const scene::Body& body : scene.bodies) requests.push_back(scene::kernel_request(scene, body));
  });
  OpenedMeshes meshes(comm, console);
  const std::vector<Need> needs = needs_of(scene, requests, options.out, meshes, comm, console);
  const auto stored = [&](std::size_t k) {
    std::string found;
    if (first)
      for (const store::KernelFile& file : store::kernel_files(options.out, requests[k]))
        if (found.empty() && file.holds(needs[k].points, needs[k].normals)) found = file.path.string();
    parallel::broadcast(comm, found);
    return found;
  };
  const auto check_missing = [&](std::size_t from) {
    for (std::size_t k = from; k < scene.bodies.size(); ++k) {
      const auto alike = [&](const scene::KernelRequest& other) {
        return other.hash == requests[k].hash || scene::similarity(other, requests[k]);
      };
      const auto earlier = requests.begin() + static_cast<std::ptrdiff_t>(k);
      if (std::none_of(requests.begin(), earlier, alike) && stored(k).empty())
        check_body(requests[k], meshes, comm, console);
    }
  };
  std::vector<std::filesystem::path> written;
  if (options.check) {
    check_missing(0);
    return written;
  }
  // Errors of later bodies are reported early.
  auto check_later = [&, checked = !check](std::size_t k) mutable {
    if (!std::exchange(checked, true)) check_missing(k + 1);
  };
  for (std::size_t k = 0; k < requests.size(); ++k) {
    scene::KernelRequest request = limited_to(requests[k], needs[k]);
    const std::string there = stored(k);
    if (!there.empty() && !scene.bodies[k].copy_of.empty()) continue;
    if (!there.empty()) {
      if (first) forget(checkpoint_of(there));
      console.say(fmt::format("{}: already there: {}", request.body.name, there));
      continue;
    }
    std::filesystem::path path = scene::kernel_path(options.out, request);
    parallel::on_first_rank(comm, [&] { base::check_place(path); });
    const std::string from = derive_if_possible(request, options.out, path, comm, console);
    if (from.empty()) {
      request = limited_to(requests[k], worth_computing(requests, needs, k));
      path = scene::kernel_path(options.out, request);
    }
    const std::filesystem::path checkpoint = checkpoint_of(path);
    if (from.empty()) {
      check_later(k);
      const kernels::Kernel kernel = compute(request, checkpoint, meshes, comm, console);
      parallel::on_first_rank(comm, [&] { kernels::write(kernel, path); });
      if (first && check) report_body(request.body, kernel, console);
    }
    written.push_back(path);
    if (first) forget(checkpoint);
    console.say(fmt::format("{}: {}{}", request.body.name, from, path.string()));
  }
  return written;
}

}  // namespace

int run_kernel(const console::Options& options, MPI_Comm comm) {
  const bool first = parallel::rank_of(comm) == 0;
  scene::Scene scene;
  parallel::on_all_ranks(comm, [&] {  // the scene file is small, so each rank reads it
    scene = scene::read(options.scene, options.overrides, scene::Purpose::kernels);
  });
  if (options.dry_run) {
    if (first) std::cout << scene::to_toml(scene);
    return 0;
  }
  if (options.verify) {
    console::Console console(options.quiet || !first);
    return verify_kernels(scene, options, comm, console);
  }
  // Before the computation starts.
  parallel::on_first_rank(comm, [&] { store::check_histories(scene); });

  console::Console console(options.quiet || !first,
                           [comm] { return parallel::largest(comm, console::peak_memory_mib()); });
  if (scene.bodies.empty()) console.say("the scene takes its kernels from contact.table: nothing to compute");
  const auto compute = [&](const scene::Scene& closed, bool check) {
    return compute_kernels(closed, check, options, comm, console);
  };
  if (!scene.accuracy)
    compute(scene, true);
  else if (options.check)
    compute(accuracy::closed_for_check(scene, comm), true);
  else
    accuracy::close_by_accuracy(scene, options.out, comm, console, compute);
  // The peak memory of each phase is the maximum over the ranks.
  console.total();
  return 0;
}

}  // namespace ricochet::kernel
