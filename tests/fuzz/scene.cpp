// SPDX-License-Identifier: BSD-2-Clause
// A scene, and after a line "---" overrides, one per line. An accepted scene is unchanged after it is written
// and read again. The request that a kernel stores is similar to the original request.
#include "src/scene/scene.hpp"
#include "src/scene/read.hpp"
#include "src/scene/request.hpp"

#include <sstream>

#include "kernels/read.hpp"
#include "src/scene/derive.hpp"
#include "src/scene/write.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace ricochet;
using fuzz::accepts;
using fuzz::require;

void check_requests(const scene::Scene& scene) {
  for (const scene::Body& body : scene.bodies) {
    scene::KernelRequest request;
    if (!accepts([&] { request = scene::kernel_request(scene, body); })) continue;
    if (request.modes.open()) continue;  // no kernel has such a request
    const kernels::Header header{request.hash, request.toml, request.mesh_sha256};
    const scene::KernelRequest again = scene::request_of(header, "kernel");
    require(scene::similarity(again, request).has_value(), "a kernel does not know its own body");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch folder;
  static const auto mesh = folder.put("m.geo", ""), history = folder.put("h.csv", "0,1\n");
  std::string text(reinterpret_cast<const char*>(data), size);
  std::vector<scene::Override> overrides;
  if (const auto end = text.find("\n---\n"); end != std::string::npos) {
    std::istringstream lines(text.substr(end + 5));
    for (std::string line; std::getline(lines, line);) overrides.push_back(line);
    text.resize(end + 1);
  }
  const auto file = folder.put("scene.toml", text);
  accepts([&] { scene::request_of({"", text, ""}, "kernel"); });
  scene::Scene scene;
  if (!accepts([&] { scene = scene::read(file, overrides); })) return 0;
  const std::string written = scene::to_toml(scene);
  const scene::Scene again = scene::read(folder.put("scene.toml", written));
  require(again == scene, "a written scene is another one:\n" + written);
  require(scene::to_toml(again) == written, "a scene is written in two ways:\n" + written);
  check_requests(scene);
  return 0;
}
