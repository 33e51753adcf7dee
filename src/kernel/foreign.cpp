// SPDX-License-Identifier: BSD-2-Clause
#include "src/kernel/foreign.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>

#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "base/atomic_file.hpp"
#include "ricochet/error.hpp"
#include "src/mesh/child.hpp"
#include "src/parallel/parallel.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::kernel {
namespace fs = std::filesystem;

namespace {

/// What `ricochet import mesh --brief` reports of a file.
struct ForeignMesh {
  std::string size;  ///< "… nodes, … elements"
  std::vector<std::string> materials, warnings;
};

/// The text behind the prefix of a line, if it has it.
std::string_view behind(std::string_view line, std::string_view prefix) {
  return line.starts_with(prefix) ? line.substr(prefix.size()) : std::string_view();
}

/// Runs the command, which is beside this program. Throws InputError with its line if it refuses the file.
ForeignMesh import_mesh(const fs::path& source, const fs::path& target) {
  base::check_place(target);
  const fs::path command = fs::read_symlink("/proc/self/exe").parent_path() / "ricochet";
  std::string text;
  const mesh::Ending ending = mesh::run_child(
      command, "", [&](const char* data, std::size_t size) { text.append(data, size); }, mesh::longest_idle_s,
      {"import", "mesh", source.string(), "--brief", "--out", target.string()});
  constexpr int refused = 2;
  if (WIFEXITED(ending.status) && WEXITSTATUS(ending.status) == refused)
    throw InputError(std::string(behind(ending.last_line, "ricochet import: ")));
  if (ending.status != 0)
    throw InputError(fmt::format("{}: ricochet import mesh ended without a mesh{}: run it by itself",
                                 source.filename().string(),
                                 ending.last_line.empty() ? "" : "; its last message: " + ending.last_line));
  ForeignMesh out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (const auto size = behind(line, "size: "); !size.empty()) out.size = size;
    if (const auto material = behind(line, "material: "); !material.empty())
      out.materials.emplace_back(material);
    if (const auto warning = behind(line, "warning: "); !warning.empty()) out.warnings.emplace_back(warning);
  }
  return out;
}

/// Refuses a body without a material: units and names are for the user to decide.
[[noreturn]] void refuse_without_material(const scene::Scene& scene, const scene::Body& body,
                                          const ForeignMesh& found) {
  const std::string file = body.mesh.filename().string();
  throw InputError(
      fmt::format("{}: bodies.{}.material: is missing: {}: give a name, \"steel\", or {{ density = …, young "
                  "= …, poisson = … }} "
                  "in SI units",
                  scene.file.filename().string(), body.name,
                  found.materials.empty()
                      ? file + " states none"
                      : fmt::format("{} has, in its units, {}", file, fmt::join(found.materials, "; "))));
}

}  // namespace

void import_meshes(scene::Scene& scene, const fs::path& folder, MPI_Comm comm, console::Console& console) {
  for (scene::Body& body : scene.bodies) {
    if (!body.foreign()) continue;
    std::string path;
    bool there = false;
    parallel::on_first_rank(comm, [&] {
      path = scene::converted_path(folder, scene, body).string();
      there = fs::exists(path) && !body.materials.empty();
    });
    parallel::broadcast(comm, path);
    if (!parallel::of_rank(comm, 0, there)) {
      console.begin(fmt::format("{}: import of {}", body.name, body.mesh.filename().string()));
      ForeignMesh found;
      parallel::on_first_rank(comm, [&] {
        found = import_mesh(body.mesh, path);
        if (body.materials.empty()) refuse_without_material(scene, body, found);
      });
      console.end(found.size);
      for (const std::string& warning : found.warnings) console.warn(warning);
    }
    body.converted = path;
  }
}

}  // namespace ricochet::kernel
