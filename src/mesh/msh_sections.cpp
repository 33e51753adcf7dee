// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/msh_sections.hpp"

#include <fmt/format.h>
#include <gmsh.h>

#include <algorithm>
#include <fstream>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

namespace {

/// Refuses files without a closing line; most truncated files lack it.
void refuse_cut_off(const std::filesystem::path& msh) {
  std::ifstream stream(msh, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg(), length = std::min<std::streamoff>(size, 256);
  std::string tail(static_cast<std::size_t>(std::max<std::streamoff>(length, 0)), ' ');
  stream.seekg(size - length);
  stream.read(tail.data(), length);
  tail.erase(tail.find_last_not_of(" \t\r\n") + 1);
  tail.erase(0, tail.find_last_of('\n') + 1);
  if (!tail.starts_with("$End"))
    throw InputError(fmt::format(
        "{}: is cut off (its last line is not $EndElements or another end): write it again with gmsh",
        msh.filename().string()));
}

}  // namespace

std::string msh_version(const std::filesystem::path& msh) {
  std::ifstream stream(msh);
  std::string header, version;
  stream >> header >> version;
  return header == "$MeshFormat" ? version : "";
}

bool is_old_version(const std::string& version) {
  return version == "2" || version == "2.0" || version == "2.1" || version == "2.2";
}

void MshSections::read() {
  if (in_.ended() || in_.word("$MeshFormat") != "$MeshFormat")
    in_.fail(
        "is not a gmsh mesh (it does not start with $MeshFormat): write it with gmsh, or name another file");
  refuse_cut_off(path_);
  format();
  while (!in_.ended()) {
    const std::string name(in_.word("a section"));
    if (!in_.rest_of_line().empty()) in_.fail("the name of a section must be on a line of its own");
    if (name == "$Comments") {
      comments();
    } else if (!seen_.insert(name).second) {
      in_.fail("the second section of its kind");
    } else if (name == "$PhysicalNames") {
      names();
    } else {
      in_.skip_line();
      if (!section(name))
        in_.fail("contains an unsupported section: save the mesh alone, without results and ghost cells");
    }
    end("$End" + name.substr(1));
  }
  for (const char* needed : {"$Nodes", "$Elements"})
    if (seen_.count(needed) == 0) in_.fail(fmt::format("has no {}: write it again with gmsh", needed));
}

void MshSections::format() {
  const std::string version(in_.word("the version"));
  if (!is_old_version(version) && version != "4.1")
    in_.fail("has an unsupported version: write it in version 4.1 or 2.2 (Mesh.MshFileVersion)");
  binary_ = in_.integer<std::int32_t>("the kind of file", 0, 1) == 1;
  in_.integer<std::int32_t>("the size of numbers", 8, 8);
  in_.rest_of_line();
  if (binary_) {
    in_.skip_line();
    in_.set_binary(true);
    if (in_.integer<std::int32_t>("1", -largest_int, largest_int) != 1)
      in_.fail("its numbers have the wrong byte order, or are text: write it on this machine, or as text");
  }
  end("$EndMeshFormat");
}

void MshSections::end(const std::string& name) {
  in_.set_binary(false);
  if (in_.word(name.c_str()) != name) in_.fail(fmt::format("{} is not where the counts place it", name));
}

void MshSections::comments() {
  while (in_.rest_of_line() != "$EndComments") {
    in_.skip_line();
    if (in_.ended()) in_.fail("is cut off: $EndComments is missing");
  }
}

std::int64_t MshSections::line_count(const char* what) {
  const std::int64_t n = in_.integer<std::int32_t>(what, 0, largest_int);
  if (!in_.rest_of_line().empty()) in_.fail(fmt::format("{} must be on a line of its own", what));
  return n;
}

void MshSections::names() {
  in_.skip_line();
  const std::int64_t n = line_count("the number of names");
  for (std::int64_t i = 0; i < n; ++i) {
    const int dim = number("a group's dimension", 0, 3), group = number("a group's number", 1, largest_int);
    const std::string name = in_.rest_of_line();
    if (name.size() < 2 || name.size() > 130 || name.front() != '"' || name.find('"', 1) != name.size() - 1)
      in_.fail("the name of a group must be in quotes and have at most 128 bytes");
    names_[{dim, group}] = name.substr(1, name.size() - 2);
  }
}

void MshSections::coordinates() {
  for (int c = 0; c < 3; ++c) in_.real("a coordinate");
}

MshSections::ElementType MshSections::type_of(int type) const {
  static const auto all = [] {
    std::map<int, ElementType> types{{15, {0, 1}}};
    for (int p = 1; p <= 10; ++p) {
      struct Kind {
        const char* family;
        int dim, largest_order, complete, on_edges;
      };
      const int inner = p - 1;
      for (const auto& [family, dim, largest_order, complete, on_edges] :
           {Kind{"line", 1, 10, p + 1, p + 1}, Kind{"triangle", 2, 10, (p + 1) * (p + 2) / 2, 3 * p},
            Kind{"quadrangle", 2, 10, (p + 1) * (p + 1), 4 * p},
            Kind{"tetrahedron", 3, 10, (p + 1) * (p + 2) * (p + 3) / 6, 4 + 6 * inner},
            Kind{"hexahedron", 3, 9, (p + 1) * (p + 1) * (p + 1), 8 + 12 * inner},
            Kind{"prism", 3, 9, (p + 1) * (p + 1) * (p + 2) / 2, 6 + 9 * inner},
            Kind{"pyramid", 3, 9, (p + 1) * (p + 2) * (2 * p + 3) / 6, 5 + 8 * inner}}) {
        if (p > largest_order) continue;
        types[gmsh::model::mesh::getElementType(family, p, /*serendip=*/true)] = {dim, on_edges};
        types[gmsh::model::mesh::getElementType(family, p)] = {dim, complete};
      }
    }
    return types;
  }();
  const auto found = all.find(type);
  if (found == all.end())
    in_.fail(fmt::format(
        "elements of type {} are not supported: mesh with tetrahedra, hexahedra, prisms or lines", type));
  return found->second;
}

}  // namespace ricochet::mesh
