// SPDX-License-Identifier: BSD-2-Clause
#include "src/kernel/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <optional>
#include <utility>

#include "base/atomic_file.hpp"
#include "kernels/write.hpp"
#include "src/accuracy/loop.hpp"
#include "src/accuracy/scene_dial.hpp"
#include "src/kernel/compute.hpp"
#include "src/kernel/discretise.hpp"
#include "src/kernel/foreign.hpp"
#include "src/kernel/imported_modes.hpp"
#include "src/kernel/obstacles.hpp"
#include "src/kernel/plan.hpp"
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

/// The kernels of a closed scene: those in the folder, and those that are missing. All member functions are
/// collective.
class Kernels {
 public:
  Kernels(const scene::Scene& scene, const console::Options& options, MPI_Comm comm,
          console::Console& console)
      : scene_(scene),
        folder_(options.out),
        view_mib_(options.view_mib),
        comm_(comm),
        console_(console),
        meshes_(comm, console) {
    parallel::on_all_ranks(comm, [&] {
      for (const scene::Body& body : scene.bodies) requests_.push_back(scene::kernel_request(scene, body));
    });
    needs_ = needs_of(scene, requests_, folder_, meshes_, comm, console);
  }

  std::size_t size() const { return requests_.size(); }

  /// Checks the bodies from the k-th on whose kernels must be computed.
  void check_missing(std::size_t from) {
    for (std::size_t k = from; k < size(); ++k) {
      const auto alike = [&](const scene::KernelRequest& other) {
        return other.hash == requests_[k].hash || scene::similarity(other, requests_[k]);
      };
      const auto earlier = requests_.begin() + static_cast<std::ptrdiff_t>(k);
      if (std::none_of(requests_.begin(), earlier, alike) && stored(k).empty())
        check_body(requests_[k], meshes_, comm_, console_);
    }
  }

  /// Plans the kernels that must be computed.
  std::vector<KernelPlan> plan() {
    std::vector<KernelPlan> plans;
    for (std::size_t k = 0; k < size(); ++k) {
      const std::string& name = requests_[k].body.name;
      const auto earlier = requests_.begin() + static_cast<std::ptrdiff_t>(k);
      const bool derived = std::any_of(requests_.begin(), earlier, [&](const scene::KernelRequest& other) {
        return other.hash == requests_[k].hash || scene::similarity(other, requests_[k]);
      });
      if (derived || !stored(k).empty()) continue;
      const scene::KernelRequest request = limited_to(requests_[k], needs_[k]);
      bool derivable = false;
      parallel::on_first_rank(comm_,
                              [&] { derivable = scene::derive_from_any(folder_, request).has_value(); });
      if (parallel::of_rank(comm_, 0, derivable) ||
          (request.body.imported() && holds_modes(request.body, comm_)))
        continue;
      if (request.modes.solver != "ricochet")
        throw InputError(fmt::format("{}: modes.solver = {}: only the time of \"ricochet\" can be planned",
                                     name, request.modes.solver));
      plans.push_back(plan_kernel(limited_to(requests_[k], worth_computing(requests_, needs_, k)), meshes_,
                                  comm_, console_));
    }
    return plans;
  }

  /// Derives or computes the k-th kernel unless it is there.
  /// @param report  whether to report the body of a computed kernel
  /// @param before_computing  called before modes are computed
  /// @return the file written, if any
  template <class Task>
  std::optional<std::filesystem::path> complete(std::size_t k, bool report, const Task& before_computing) {
    const std::string& name = requests_[k].body.name;
    if (const std::string there = stored(k); !there.empty()) {
      if (!scene_.bodies[k].copy_of.empty()) return {};
      forget(checkpoint_of(there));
      console_.say(fmt::format("{}: already there: {}", name, there));
      return {};
    }
    scene::KernelRequest request = limited_to(requests_[k], needs_[k]);
    std::filesystem::path path = scene::kernel_path(folder_, request);
    parallel::on_first_rank(comm_, [&] { base::check_place(path); });
    std::string from;
    if (view_mib_ > 0) {  // a kernel with a surface gives one to those that are derived from it
      const scene::KernelRequest seen = scene::with_view(request);
      path = scene::kernel_path(folder_, seen);
      from = derive_if_possible(seen, folder_, path, comm_, console_);
    }
    if (from.empty()) {
      path = scene::kernel_path(folder_, request);
      from = derive_if_possible(request, folder_, path, comm_, console_);
    }
    if (from.empty()) {
      request = limited_to(requests_[k], worth_computing(requests_, needs_, k));
      const std::filesystem::path checkpoint = checkpoint_of(scene::kernel_path(folder_, request));
      before_computing();
      const kernels::Kernel kernel = compute(request, checkpoint, view_mib_, meshes_, comm_, console_);
      path = scene::kernel_path(folder_, request);
      parallel::on_first_rank(comm_, [&] { kernels::write(kernel, path); });
      if (first() && report) report_body(request.body, kernel, console_);
      forget(checkpoint);
    }
    forget(checkpoint_of(path));
    console_.say(fmt::format("{}: {}{}", name, from, path.string()));
    return path;
  }

 private:
  bool first() const { return parallel::rank_of(comm_) == 0; }

  /// The file of the k-th kernel; empty if there is none.
  std::string stored(std::size_t k) const {
    std::string found;
    if (first())
      for (const store::KernelFile& file : store::kernel_files(folder_, requests_[k]))
        if (found.empty() && file.holds(needs_[k].points, needs_[k].normals) &&
            (file.mesh_error || !requests_[k].mesh_error))
          found = file.path.string();
    parallel::broadcast(comm_, found);
    return found;
  }

  /// Removes the finished slices of a kernel that is complete.
  void forget(const std::filesystem::path& checkpoint) const {
    std::error_code ignored;
    if (first()) std::filesystem::remove_all(checkpoint, ignored);
  }

  const scene::Scene& scene_;
  std::filesystem::path folder_;
  double view_mib_;
  MPI_Comm comm_;
  console::Console& console_;
  OpenedMeshes meshes_;
  std::vector<scene::KernelRequest> requests_;
  std::vector<Need> needs_;
};

/// Computes the kernels of a closed scene that are not there yet. Collective.
/// @param check  whether to check all bodies before the first one is computed
/// @return the files written
std::vector<std::filesystem::path> compute_kernels(const scene::Scene& scene, bool check,
                                                   const console::Options& options, MPI_Comm comm,
                                                   console::Console& console) {
  Kernels all(scene, options, comm, console);
  std::vector<std::filesystem::path> written;
  if (options.check) {
    all.check_missing(0);
    return written;
  }
  bool checked = !check;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto path = all.complete(k, check, [&] {
      // Errors of later bodies are reported early.
      if (!std::exchange(checked, true)) all.check_missing(k + 1);
    });
    if (path) written.push_back(*path);
  }
  return written;
}

/// Arguments of `ricochet kernel` that ask for the same kernels.
std::vector<std::string> words_of(const console::Options& options) {
  std::vector<std::string> words{options.scene.string()};
  for (const std::string& override : options.overrides) words.insert(words.end(), {"--set", override});
  words.insert(words.end(), {"--out", options.out.string()});
  return words;
}

/// Plans the kernels of a scene, and prints the plan. Collective.
void plan_kernels(const scene::Scene& given, const console::Options& options, MPI_Comm comm,
                  console::Console& console) {
  scene::Scene scene;
  parallel::on_all_ranks(comm, [&] {
    store::KernelStore store;
    if (accuracy::missing_settings(given, options.out, store))
      throw InputError(
          fmt::format("{}: accuracy = {:.3g}: its settings are found by computing kernels, which cannot be "
                      "planned: give modes, and order and size of the bodies, instead",
                      given.file.string(), *given.accuracy));
    scene = accuracy::closed(given, options.out, store).scene;
  });
  const std::vector<KernelPlan> plans = Kernels(scene, options, comm, console).plan();
  if (parallel::rank_of(comm) != 0) return;
  std::cout << (plans.empty() ? "every kernel is there or can be derived: nothing to compute\n"
                              : plan_text(plans, words_of(options)));
}

}  // namespace

int run_kernel(const console::Options& options, MPI_Comm comm) {
  const bool first = parallel::rank_of(comm) == 0;
  scene::Scene scene;
  parallel::on_all_ranks(comm, [&] {  // the scene file is small, so each rank reads it
    scene = scene::read(options.scene, options.overrides, scene::Purpose::kernels);
  });
  if (options.dry_run) {
    const scene::Scene known = accuracy::closed_if_known(scene, options.out);
    if (first) std::cout << scene::about_rotation(known) << scene::to_toml(known);
    return 0;
  }
  if (options.verify) {
    console::Console console(options.quiet || !first);
    import_meshes(scene, options.out, comm, console);
    return verify_kernels(scene, options, comm, console);
  }
  // Before the computation starts.
  parallel::on_first_rank(comm, [&] { store::check_histories(scene); });

  console::Console console(options.quiet || !first,
                           [comm] { return parallel::largest(comm, console::peak_memory_mib()); });
  import_meshes(scene, options.out, comm, console);
  make_surfaces(scene, options.out, comm, console);
  if (scene.bodies.empty())
    console.say("the scene takes its responses from contact.table: nothing to compute");
  if (options.plan) {
    plan_kernels(scene, options, comm, console);
    return 0;
  }
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
