// SPDX-License-Identifier: BSD-2-Clause
#include "benchmarks/calculix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>

namespace ricochet::bench {

namespace {

/// CalculiX reads at most 20 characters of a number. With 13 decimals, a number has no more.
std::string number(double x) { return fmt::format("{:.13e}", x); }

/// An element type of gmsh and its name in CalculiX. Node a of the element in CalculiX is its node `node[a]`
/// in gmsh.
struct Element {
  int gmsh_type;
  const char* name;
  std::array<int, 10> node;
};
/// gmsh and CalculiX number the nodes on the edges 2–4 and 3–4 of the quadratic tetrahedron in opposite
/// order.
constexpr std::array<Element, 2> known{
    {{4, "C3D4", {0, 1, 2, 3}}, {11, "C3D10", {0, 1, 2, 3, 4, 5, 6, 7, 9, 8}}}};

std::string nodes_text(const mesh::GlobalMesh& mesh) {
  std::string text = "*NODE, NSET=ALL\n";
  for (std::size_t n = 0; n < mesh.fixed.size(); ++n)
    fmt::format_to(std::back_inserter(text), "{},{},{},{}\n", n + 1, number(mesh.position[3 * n]),
                   number(mesh.position[3 * n + 1]), number(mesh.position[3 * n + 2]));
  return text;
}

/// The elements of the mesh, in one set for each material.
std::string elements_text(const mesh::GlobalMesh& mesh, const scene::Body& body) {
  std::string text;
  auto out = std::back_inserter(text);
  std::size_t number_of_element = 0;
  for (const mesh::Block& block : mesh.blocks) {
    const auto* kind = std::find_if(known.begin(), known.end(),
                                    [&](const Element& e) { return e.gmsh_type == block.gmsh_type; });
    if (kind == known.end())
      throw InputError(fmt::format(
          "{}: CalculiX is given tetrahedra of order 1 and 2 only: set bodies.{}.order, or mesh it "
          "with tetrahedra",
          body.mesh.filename().string(), body.name));
    const auto nodes = static_cast<std::size_t>(block.nodes_per_element);
    for (std::size_t m = 0; m < body.materials.size(); ++m) {
      fmt::format_to(out, "*ELEMENT, TYPE={}, ELSET=E{}\n", kind->name, m);
      for (std::size_t e = 0; e < block.size(); ++e) {
        if (block.label[e] != static_cast<std::int64_t>(m)) continue;
        fmt::format_to(out, "{}", ++number_of_element);
        for (std::size_t a = 0; a < nodes; ++a)
          fmt::format_to(out, ",{}", block.node[e * nodes + static_cast<std::size_t>(kind->node[a])] + 1);
        text += '\n';
      }
    }
  }
  return text;
}

std::string materials_text(const scene::Body& body) {
  std::string text;
  for (std::size_t m = 0; m < body.materials.size(); ++m) {
    const scene::Material& material = body.materials[m];
    text += fmt::format(
        "*MATERIAL, NAME=M{0}\n*ELASTIC\n{1},{2}\n*DENSITY\n{3}\n*SOLID SECTION, ELSET=E{0}, MATERIAL=M{0}\n",
        m, number(material.young), number(material.poisson), number(material.density));
  }
  return text;
}

std::string supports_text(const mesh::GlobalMesh& mesh) {
  std::string text;
  for (std::size_t n = 0; n < mesh.fixed.size(); ++n)
    for (int c = 0; c < 3; ++c)
      if (((mesh.fixed[n] >> c) & 1) != 0) text += fmt::format("{},{}\n", n + 1, c + 1);
  return text.empty() ? text : "*BOUNDARY\n" + text;
}

}  // namespace

void write_calculix(const mesh::GlobalMesh& mesh, const scene::Body& body, std::int64_t count,
                    const std::filesystem::path& path) {
  std::ofstream file(path);
  file << nodes_text(mesh) << elements_text(mesh, body) << materials_text(body) << supports_text(mesh)
       << fmt::format("*STEP\n*FREQUENCY\n{}\n*END STEP\n", count);
  if (!file.flush()) throw InputError(fmt::format("{}: can't be written", path.string()));
}

}  // namespace ricochet::bench
