// SPDX-License-Identifier: BSD-2-Clause
// An STL file, as text or binary, and an OBJ file. The surface that is read has finite coordinates and
// indices in range, and one that is closed can be an obstacle.
#include <algorithm>
#include <cmath>
#include <set>

#include "contact/files/surface_file.hpp"
#include "contact/pairing/rigid_surface.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace ricochet;
using fuzz::require;

void check(const SurfaceMesh& mesh) {
  for (const Vector3& x : mesh.node)
    require(std::ranges::all_of(x, [](double value) { return std::isfinite(value); }),
            "a node is not finite");
  for (const auto& t : mesh.triangle) {
    require(std::ranges::all_of(t, [&](std::uint32_t k) { return k < mesh.node.size(); }),
            "a corner is no node");
    require(std::set(t.begin(), t.end()).size() == 3, "a triangle has no area");
  }
  require(std::set(mesh.node.begin(), mesh.node.end()).size() == mesh.node.size(), "a node is there twice");
}

contact::RigidMesh rigid(const SurfaceMesh& mesh) {
  contact::RigidMesh out;
  for (const Vector3& x : mesh.node) out.node.emplace_back(x[0], x[1], x[2]);
  for (const auto& t : mesh.triangle)
    out.triangle.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch folder;
  for (const char* name : {"surface.stl", "surface.obj"}) {
    const auto file = folder.put(name, {reinterpret_cast<const char*>(data), size});
    for (const double scale : {1e-3, 1e3}) {
      SurfaceMesh mesh;
      if (!fuzz::accepts([&] { mesh = contact::read_surface(file, scale); })) continue;
      check(mesh);
      contact::RigidMesh whole = rigid(mesh);
      if (contact::flaw_of(whole).empty()) contact::rigid_surface(whole);
    }
  }
  return 0;
}
