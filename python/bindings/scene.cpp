// SPDX-License-Identifier: BSD-2-Clause
#include "python/bindings/scene.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "src/accuracy/scene_dial.hpp"
#include "src/scene/materials.hpp"
#include "src/scene/read.hpp"
#include "src/scene/scene.hpp"
#include "src/scene/write.hpp"
#include "src/store/stored_kernels.hpp"
#include "src/store/surfaces.hpp"

namespace ricochet::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

/// For each body: its name, the path of its file, and whether the file exists and contains enough candidates.
/// Without settings or a surface on which they depend, there are none.
std::vector<std::tuple<std::string, fs::path, bool>> kernel_files(const scene::Scene& scene,
                                                                  const fs::path& folder) {
  store::KernelStore store;
  std::vector<std::tuple<std::string, fs::path, bool>> out;
  if (store::missing_surface(scene, folder) ||
      (scene.modes.open() && accuracy::missing_settings(scene, folder, store))) {
    for (const scene::Body& body : scene.bodies) out.emplace_back(body.name, "", false);
    return out;
  }
  const std::vector<store::StoredKernel> stored =
      store::find_kernels(accuracy::closed(scene, folder, store).scene, folder, store);
  for (std::size_t k = 0; k < stored.size(); ++k)
    out.emplace_back(scene.bodies[k].name, stored[k].path, stored[k].enough);
  return out;
}

}  // namespace

void bind_scene(py::module_& module) {
  py::enum_<scene::Purpose>(module, "Purpose")
      .value("impact", scene::Purpose::impact)
      .value("kernels", scene::Purpose::kernels);
  py::class_<scene::Scene>(module, "Scene")
      .def(
          py::init([](const std::string& text, const fs::path& file, const std::vector<std::string>& settings,
                      scene::Purpose purpose) { return scene::parse(text, file, settings, purpose); }))
      .def_static("read", [](const fs::path& file) { return scene::read(file, {}, scene::Purpose::kernels); })
      .def_readonly("title", &scene::Scene::title)
      .def_property_readonly("slug", [](const scene::Scene& scene) { return scene::slug(scene.title); })
      .def_property_readonly("bodies",
                             [](const scene::Scene& scene) {
                               std::vector<std::string> names;
                               for (const scene::Body& body : scene.bodies) names.push_back(body.name);
                               return names;
                             })
      .def_property_readonly("needs_other_orders",
                             [](const scene::Scene& scene) { return scene.accuracy.has_value(); })
      .def("toml", [](const scene::Scene& scene) { return scene::to_toml(scene); })
      .def("kernel_files", &kernel_files)
      .def("chosen", [](const scene::Scene& scene, const fs::path& folder) {
        store::KernelStore store;
        return accuracy::chosen(scene, folder, store);
      });
  module.def("slug", &scene::slug);
  module.def("overridden", &scene::overridden);
  module.def("materials_toml", &scene::materials_toml);
}

}  // namespace ricochet::python
