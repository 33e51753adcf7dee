// SPDX-License-Identifier: BSD-2-Clause
// A .msh file, read by gmsh as a whole body and as a body with named parts, and by ranges. Accepted
// meshes contain valid numbers. Their matrices are assembled or refused with one line.
#include "src/mesh/mesh.hpp"

#include <gmsh.h>

#include <cmath>

#include "src/elasticity/assemble.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/open.hpp"
#include "src/mesh/partition.hpp"
#include "src/mesh/parts.hpp"
#include "src/mesh/read.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace ricochet;
using fuzz::accepts;
using fuzz::require;

void check_blocks(const std::vector<mesh::Block>& blocks, std::size_t nodes) {
  for (const mesh::Block& block : blocks) {
    require(block.node.size() == block.size() * static_cast<std::size_t>(block.nodes_per_element),
            "elements have another number of nodes");
    require(block.label.size() == block.size(), "elements have no label");
    for (std::int64_t node : block.node)
      require(node >= 0 && node < static_cast<std::int64_t>(nodes),
              "an element has a node that is not there");
  }
}

void read(const scene::Body& body, const mesh::RequestedGroups& asked) {
  mesh::GlobalMesh global;
  const bool read = accepts([&] { global = mesh::read_mesh(body, {}, asked); });
  mesh::forget_meshes();
  if (!read) return;
  const std::size_t nodes = global.position.size() / 3;
  require(!global.blocks.empty() && nodes > 0, "a mesh without elements was accepted");
  for (double x : global.position) require(std::isfinite(x), "a coordinate is not finite");
  for (const auto* blocks :
       {&global.blocks, &global.contact.blocks, &global.loaded.blocks, &global.visualisation.blocks})
    check_blocks(*blocks, nodes);
  accepts([&] {
    elasticity::assemble(mesh::distribute(std::move(global), PETSC_COMM_SELF), body.materials, "m.msh");
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const parallel::Session session;
  static const mesh::GmshSession gmsh;
  static const fuzz::Scratch folder;
  scene::Body body;
  body.name = "body";
  body.mesh = folder.put("m.msh", {reinterpret_cast<const char*>(data), size});
  body.materials = {{.group = "", .density = 2.0, .young = 3.0, .poisson = 0.3, .area = 0.5}};
  read(body, {});
  accepts([&] { mesh::with_gmsh_errors("m.msh", [&] { mesh::extent_of(body); }); });
  mesh::forget_meshes();
  body.contact = {"top"};
  body.support = {{"foot", "xy"}};
  read(body, {.loaded = {"top"}, .moved = {"foot"}});
  accepts([&] {
    if (const auto files = mesh::open_msh(body, PETSC_COMM_SELF)) {
      const mesh::Mesh mesh = mesh::read_msh(*files, body, PETSC_COMM_SELF, PETSC_COMM_SELF);
      check_blocks(mesh.blocks, mesh.node.size());
    }
  });
  return 0;
}
