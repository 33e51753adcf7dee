// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/msh_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "src/mesh/complaints.hpp"
#include "src/mesh/open.hpp"
#include "src/mesh/transport.hpp"

namespace ricochet::mesh {

namespace {

/// Refuses a mesh whose last files are missing. Entities record the parts that they touch, which reveals
/// parts without a file.
void refuse_missing_parts(const std::filesystem::path& file, const MshOutline& outline, std::size_t files) {
  if (files > 1 && outline.last_part > static_cast<std::int64_t>(files))
    throw InputError(fmt::format(
        "{}: touches part {} of the mesh, but there are only {}: keep the files of all parts together",
        file.filename().string(), outline.last_part, files));
}

void join(Entities& all, const Entities& more) {
  for (const auto& [key, entity] : more.all) {
    const auto [at, is_new] = all.all.emplace(key, entity);
    if (!is_new)
      at->second.groups.insert(at->second.groups.end(), entity.groups.begin(), entity.groups.end());
  }
  all.group_name.insert(more.group_name.begin(), more.group_name.end());
}

/// The highest dimension of elements.
int dimension_of(const MshFiles& files) {
  int dim = 0;
  for (const MshOutline& outline : files.outline)
    for (const MshElements& block : outline.elements)
      if (block.list.count > 0) dim = std::max(dim, block.entity.dim);
  return dim;
}

}  // namespace

std::optional<MshFiles> open_msh(const scene::Body& body, MPI_Comm comm) {
  const auto ranks = static_cast<std::size_t>(parallel::size_of(comm)),
             me = static_cast<std::size_t>(parallel::rank_of(comm));
  MshFiles files;
  std::string names;
  parallel::on_first_rank(comm, [&] {
    files.path = msh_files(body);
    Packer packer;
    pass(packer, files.path);
    names = packer.bytes;
  });
  parallel::broadcast(comm, names);
  Unpacker unpacked_names(names);
  pass(unpacked_names, files.path);
  if (files.path.empty()) return std::nullopt;

  files.outline.resize(files.path.size());
  parallel::on_all_ranks(comm, [&] {
    for (std::size_t f = me; f < files.path.size(); f += ranks) {
      files.outline[f] = outline_of(files.path[f]);
      refuse_missing_parts(files.path[f], files.outline[f], files.path.size());
    }
  });
  for (std::size_t f = 0; f < files.path.size(); ++f) {
    Packer packer;
    if (f % ranks == me) pass(packer, files.outline[f]);
    parallel::broadcast(comm, packer.bytes, static_cast<int>(f % ranks));
    Unpacker unpacker(packer.bytes);
    files.outline[f] = {};
    pass(unpacker, files.outline[f]);
    join(files.entities, files.outline[f].entities);
  }

  const std::string first = files.path.front().filename().string();
  const int dim = dimension_of(files);
  const bool in_parts = files.path.front() != body.mesh;
  if (dim == 1 && in_parts)
    throw InputError(fmt::format("{}: is part of a rod: save the rod in one file", first));
  if (dim == 1) return std::nullopt;
  if (dim != 3) throw no_volume(dim, first);
  if (std::ranges::count(body.materials, "", &scene::Material::group) > 0)
    files.warning = files.entities.left_out_warning(dim, body.mesh.filename().string(), body.name);
  return files;
}

}  // namespace ricochet::mesh
