// SPDX-License-Identifier: BSD-2-Clause
// A .geo file: the parameters that it defines, and its hash with all included files, possibly including
// itself. gmsh does not read the file, because its language can run commands.
#include "src/mesh/open.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ricochet;
  static const fuzz::Scratch folder;
  static const auto other = folder.put("n.geo", "DefineConstant[ inner = 1 ];\nInclude \"m.geo\";\n");
  scene::Scene scene;
  scene.file = folder / "scene.toml";
  scene.bodies.emplace_back().mesh = folder.put("m.geo", {reinterpret_cast<const char*>(data), size});
  fuzz::accepts([&] {
    for (const std::string& name : mesh::parameters_of(folder / "m.geo"))
      fuzz::require(!name.empty() && name.find_first_of(" \n\"") == std::string::npos,
                    "a parameter is no word");
  });
  fuzz::accepts([&] { scene::kernel_request(scene, scene.bodies.front()); });
  return 0;
}
