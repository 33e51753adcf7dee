// SPDX-License-Identifier: BSD-2-Clause
#include "src/store/recast.hpp"

#include <fmt/format.h>

#include <ostream>

#include "base/atomic_file.hpp"
#include "kernels/modes_file.hpp"
#include "kernels/read.hpp"
#include "kernels/write.hpp"
#include "ricochet/error.hpp"
#include "src/scene/derive.hpp"
#include "src/scene/elastic_law.hpp"
#include "src/scene/request.hpp"

namespace ricochet::store {

namespace fs = std::filesystem;

namespace {

/// Converts numbers of candidates in the kernel to numbers on the whole surface.
std::vector<std::int64_t> of_whole_surface(const scene::KernelRequest& had,
                                           const std::vector<std::int64_t>& points, std::size_t candidates) {
  if (!had.points) return points;
  std::vector<std::int64_t> whole;
  for (const std::int64_t point : points) {
    if (point < 0 || static_cast<std::uint64_t>(point) >= candidates)
      throw InputError(
          fmt::format("there is no candidate {}: they are numbered from 0 to {}", point, candidates - 1));
    whole.push_back((*had.points)[static_cast<std::size_t>(point)]);
  }
  return whole;
}

scene::KernelRequest wanted_of(const scene::KernelRequest& had, const RecastOptions& options,
                               const kernels::Kernel& kernel) {
  scene::KernelRequest wanted = had;
  if (wanted.body.materials.empty() && (options.young != 1 || options.density != 1 || options.scale != 1))
    throw InputError(
        "belongs to a body file, whose numbers include material and size: leave the factors out, or change "
        "the file");
  for (scene::Material& material : wanted.body.materials) {
    scene::stiffen(material, options.young);
    material.density *= options.density;
  }
  wanted.body.scale *= options.scale;
  scene::scale_places(wanted, options.scale);
  if (wanted.spacing) *wanted.spacing *= options.scale;
  if (options.points) {
    wanted.points = of_whole_surface(had, *options.points, kernel.surface.size());
    wanted.within_reach = false;
  }

  const double frequency =
      kernels::frequency_factor({.young = options.young, .density = options.density, .scale = options.scale});
  scene::Modes& modes = wanted.modes;
  if (modes.up_to) modes.up_to->value *= frequency;
  if (options.up_to || options.flexibility_error) {
    if (!modes.up_to) modes.up_to = Hertz{kernel.modes.certificate.upto_hz * frequency};
    if (options.up_to) modes.up_to = options.up_to;
    modes.flexibility_error = options.flexibility_error;
    modes.count.reset();
  } else if (options.count) {
    modes.up_to.reset();
    modes.flexibility_error.reset();
    modes.count = options.count;
  }
  scene::seal(wanted);
  return wanted;
}

/// Rescales or truncates `kernel` and returns the name of its file.
std::string changed(const RecastOptions& options, kernels::Kernel& kernel) {
  const std::string file = options.kernel.string();
  kernels::Header header{kernel.hash, kernel.scene, kernel.mesh_sha256};
  if (kernel.surface.whole) header.held = kernel.surface.whole->held;
  scene::KernelRequest had = scene::request_of(header, file);
  had.body.name = kernel.body;
  scene::KernelRequest wanted = wanted_of(had, options, kernel);
  // Refuses values that no scene may contain, because the new kernel could not be read.
  scene::request_of({wanted.hash, wanted.toml, wanted.mesh_sha256, wanted.points}, "the new kernel");
  kernel = scene::derived(std::move(kernel), had, wanted);
  return scene::kernel_path({}, wanted).string();
}

}  // namespace

int run_recast(const RecastOptions& options, std::ostream& out) {
  const std::string given = options.kernel.string();
  if (given.ends_with(".toml") || given.ends_with(".result.h5") || fs::is_directory(options.kernel))
    throw InputError(given + ": is not a kernel: name a file that ends in .kernel.h5");
  kernels::Kernel kernel = kernels::read(options.kernel);
  const std::size_t modes = kernel.modes.size(), points = kernel.surface.size();
  const char* of_basis = kernel.modes.contact_adapted() ? "vectors" : "modes";
  fs::path path = options.out.empty() ? options.kernel.parent_path() : options.out;
  try {
    path /= options.vtk && !options.changes() ? options.kernel.filename().string() : changed(options, kernel);
    base::check_place(path);
    if (options.vtk) {
      const fs::path stem = path.replace_extension().replace_extension(".modes");  // removes .kernel.h5
      kernels::write_modes(kernel, stem);
      out << fmt::format("{}: {} {}: {}.xdmf\n", kernel.body, kernel.modes.size(), of_basis, stem.string());
      return 0;
    }
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", options.kernel.string(), error.what()));
  }
  kernels::write(kernel, path);
  out << fmt::format("{}: {} of {} {}, {} of {} points: {}\n", kernel.body, kernel.modes.size(), modes,
                     of_basis, kernel.surface.size(), points, path.string());
  return 0;
}

}  // namespace ricochet::store
