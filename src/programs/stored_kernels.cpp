#include "src/programs/stored_kernels.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "kernels/read.hpp"
#include "ricochet/error.hpp"
#include "src/programs/placing.hpp"

namespace ricochet::programs {

namespace fs = std::filesystem;

namespace {

/// Files that hold all candidates of a body, or some.
std::vector<KernelFile> files_of(const scene::Scene& scene, const scene::Body& body,
                                 const scene::KernelRequest& request, const fs::path& folder,
                                 KernelCache& cache) {
  if (is_limited(scene, body)) return kernel_files(folder, request);
  const fs::path path = scene::kernel_path(folder, request);
  if (!fs::exists(path)) return {};
  if (!cache.seen.contains(path)) {
    if (kernels::read_hash(path) != request.hash) return {};
    cache.seen.insert(path);
  }
  return {{path, {}}};
}

std::shared_ptr<const kernels::Kernel> read(const fs::path& path, KernelCache& cache, bool view = false) {
  std::shared_ptr<const kernels::Kernel>& kernel = cache.kernels[path];
  if (!kernel || (view && !kernel->view))
    kernel = std::make_shared<const kernels::Kernel>(kernels::read(path, view));
  return kernel;
}

}  // namespace

std::vector<const kernels::Kernel*> Kernels::pointers() const {
  std::vector<const kernels::Kernel*> out;
  for (const auto& one : kernel) out.push_back(one.get());
  return out;
}

std::vector<StoredKernel> find_kernels(const scene::Scene& scene, const fs::path& folder,
                                       KernelCache& cache) {
  std::vector<std::vector<KernelFile>> files;
  std::vector<StoredKernel> out;
  for (const scene::Body& body : scene.bodies) {
    const scene::KernelRequest request = scene::kernel_request(scene, body, &cache.meshes);
    const fs::path whole = scene::kernel_path(folder, request);
    files.push_back(files_of(scene, body, request, folder, cache));
    const bool none = files.back().empty();
    out.push_back({none ? whole : files.back().front().path, !none, whole, request.hash});
  }
  const auto whole = [](const auto& of_body) { return of_body.size() == 1 && !of_body.front().held; };
  const auto none = [](const auto& of_body) { return of_body.empty(); };
  if (std::ranges::all_of(files, whole) || std::ranges::any_of(files, none)) return out;

  std::vector<kernels::WholeSurface> surfaces;
  for (const StoredKernel& stored : out)
    surfaces.push_back(kernels::whole_surface(read(stored.path, cache)->surface));
  const std::vector<Points> points = points_within_reach(scene, surfaces, cache.pairings);
  for (std::size_t k = 0; k < files.size(); ++k) {
    const auto enough =
        std::ranges::find_if(files[k], [&](const KernelFile& file) { return file.holds(points[k]); });
    out[k].enough = enough != files[k].end();
    if (out[k].enough) out[k].path = enough->path;
  }
  return out;
}

namespace {

/// Linear elements that must keep their volume can hardly deform otherwise: from here on peak forces come out
/// twice as large and more.
constexpr double locking_poisson = 0.45;

std::vector<std::string> locking(const scene::Body& body, const kernels::Kernel& kernel) {
  std::vector<std::string> out;
  for (const scene::Material& material : body.materials)
    if (kernel.order == 1 && material.area == 0 && material.poisson > locking_poisson)  // a rod has an area
      out.push_back(fmt::format(
          "{}: elements of order 1 lock at poisson = {:g} (above {:g}), forces are far too large: "
          "it takes order 2 or more",
          body.name, material.poisson, locking_poisson));
  return out;
}

}  // namespace

Kernels read_kernels(const scene::Scene& scene, const fs::path& folder, KernelCache& cache, bool view) {
  const std::vector<StoredKernel> stored = find_kernels(scene, folder, cache);
  Kernels out;
  decltype(cache.kernels) kept;
  for (std::size_t k = 0; k < stored.size(); ++k) {
    const scene::Body& body = scene.bodies[k];
    const fs::path& path = stored[k].path;
    const bool limited = is_limited(scene, body);
    if (!stored[k].enough && !fs::exists(path))
      throw InputError(fmt::format(
          "{}: no kernel for body \"{}\" {}. Run ricochet-kernel {} first, with the same --set and --out.",
          scene.file.string(), body.name, limited ? "in " + folder.string() : "at " + path.string(),
          scene.file.string()));
    const auto kernel = read(path, cache, view);
    if (!limited && kernel->hash != stored[k].hash)
      throw InputError(
          fmt::format("{}: is a kernel of another scene, not of body \"{}\". Run ricochet-kernel {} again.",
                      path.string(), body.name, scene.file.string()));
    out.kernel.push_back(kernel);
    out.file.push_back(path.filename().string());
    for (const std::string& warning : locking(body, *kernel)) out.warnings.push_back(warning);
    kept[path] = kernel;
  }
  cache.kernels = std::move(kept);
  return out;
}

}  // namespace ricochet::programs
