// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/atomic_file.hpp"
#include "src/scene/keys.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::accuracy {
namespace {

/// Bytes of the names of bodies in a file name.
constexpr std::size_t longest_names = 100;

}  // namespace

scene::Scene with_settings(scene::Scene scene, const KernelSettings& settings) {
  if (scene.motion.rotation_open && settings.rotation == Rotation::finite)
    scene = scene::with_finite_rotation(std::move(scene), "accuracy has found that a body turns");
  for (scene::Body& body : scene.bodies) {
    const auto mesh = settings.mesh.find(body.name);
    if (mesh != settings.mesh.end()) {
      body.order = mesh->second.order;
      body.size_factor = mesh->second.size_factor;
      body.refine = mesh->second.refine;
    }
    body.order_open = body.size_open = body.refine_open = false;
  }
  if (scene.modes.open()) {
    scene.modes.basis = settings.basis;
    scene.modes.up_to = settings.up_to;
    if (settings.basis == scene::Basis::contact && !scene.modes.flexibility_error)
      scene.modes.flexibility_error = settings.flexibility_error;
  }
  for (scene::Pair& pair : scene.contact.pairs)
    if (!pair.zone && !pair.reach) pair.zone = settings.zone;
  scene.output.view = scene.output.view && settings.view;
  return scene;
}

scene::Scene without_accuracy(scene::Scene scene) {
  scene.accuracy.reset();
  scene.settings.clear();
  scene::Time& time = scene.time;
  time.rate_by_accuracy = time.samples_by_accuracy = time.precision_by_accuracy = false;
  return scene;
}

std::filesystem::path settings_path(const std::filesystem::path& folder, const scene::Scene& scene,
                                    scene::MeshHashes* known) {
  if (!scene.settings.empty()) return folder / scene.settings;
  std::string names, data = fmt::format("{}\n{}\n", scene::toml_number(*scene.accuracy),
                                        static_cast<int>(scene.contact.scheme));
  if (scene.motion.is_finite()) data += "finite\n";
  if (scene.motion.rotation_open) data += "open\n";
  for (const Quantity quantity : scene.accuracy_of) data += std::string(name_of(quantity)) + '\n';
  for (scene::Body body : scene.bodies) {
    body.damping = {};
    const scene::KernelRequest request = scene::kernel_request(scene, body, known);
    names += body.name + '-';
    data += fmt::format("{} {} {}\n", request.hash, body.order_open, body.size_open);
  }
  for (const scene::Pair& pair : scene.contact.pairs)
    data += fmt::format("{} {} {} {}{}\n", pair.a, pair.b, pair.reach.value_or(0), pair.zone.value_or(0),
                        pair.friction ? " friction" : "");
  return folder /
         fmt::format("{}{}.settings.toml", names.substr(0, longest_names), scene::sha256(data).substr(0, 12));
}

namespace {

using scene::choice, scene::none, scene::required, scene::SectionOf, scene::Type;

const SectionOf<MeshSettings> mesh_keys{
    "a body",
    "",
    {{"order", &MeshSettings::order, "", required("give the order"), scene::from_to("1", "10")},
     {"size_factor", &MeshSettings::size_factor, "", required(), scene::above("0")},
     {"refine", scene::list(&MeshSettings::refine, scene::refine_keys).if_changed()}}};

const SectionOf<KernelSettings> kernel_keys{
    "the settings of kernels",
    "",
    {{"basis", choice<KernelSettings>(&KernelSettings::basis, {"modes", "contact"}), "",
      required("give the basis")},
     {"up_to_hz", &KernelSettings::up_to, "", required(), scene::above("0")},
     {"flexibility_error", &KernelSettings::flexibility_error},
     {"zone", &KernelSettings::zone, "", none, scene::above("0")},
     {"view", scene::Access(&KernelSettings::view).if_changed()},
     {"rotation", choice<KernelSettings>(&KernelSettings::rotation, {"linear", "finite"}).if_changed()},
     {"bodies", Type::table}}};

const SectionOf<Settings> settings_keys{"the settings",
                                        "",
                                        {{"rate_hz", &Settings::rate},
                                         {"for_few_candidates", &Settings::for_few_candidates},
                                         {"pilot", scene::Access(&Settings::pilot).if_changed()},
                                         {"missed_by", scene::Access(&Settings::missed_by).if_changed()},
                                         {"error", scene::Access(&Settings::error).if_changed()},
                                         {"least_error", scene::Access(&Settings::least_error).if_changed()},
                                         {"idle_rounds", scene::Access(&Settings::idle_rounds).if_changed()},
                                         {"found", Type::table},
                                         {"elements_before", Type::table}}};

std::string toml_of(const KernelSettings& settings, const std::string& table) {
  std::string text = fmt::format("\n[{}]\n{}", table, kernel_keys.write(settings));
  for (const auto& [body, mesh] : settings.mesh)
    text += fmt::format("bodies.{} = {}\n", body, mesh_keys.inline_table(mesh));
  return text;
}

std::optional<KernelSettings> kernel_settings_of(const scene::Table& root, const char* name) {
  const auto table = root.table(name, kernel_keys);
  if (!table) return std::nullopt;
  KernelSettings out;
  kernel_keys.read(*table, out);
  if (out.basis == scene::Basis::contact && !(out.flexibility_error > 0))
    table->complain("flexibility_error", "must be above 0");
  for (const auto& [body, mesh] : table->named("bodies", mesh_keys)) mesh_keys.read(mesh, out.mesh[body]);
  return out;
}

}  // namespace

std::string to_toml(const Settings& settings) {
  std::string text = settings_keys.write(settings) + toml_of(settings.found, "found");
  if (!settings.elements_before.empty()) text += "\n[elements_before]\n";
  for (const auto& [body, elements] : settings.elements_before)
    text += fmt::format("{} = {}\n", body, scene::toml_number(elements));
  return text;
}

std::optional<Settings> parse_settings(const std::string& text) try {
  const toml::table parsed = toml::parse(text);
  const scene::Table root(parsed, settings_keys, "settings");
  Settings settings;
  settings_keys.read(root, settings);
  auto found = kernel_settings_of(root, "found");
  if (!found) return std::nullopt;
  settings.found = std::move(*found);
  if (const toml::table* const before = parsed["elements_before"].as_table())
    for (auto&& [body, node] : *before) {
      const auto elements = node.value<double>();
      if (!elements) return std::nullopt;
      settings.elements_before[std::string(body.str())] = *elements;
    }
  return settings;
} catch (const toml::parse_error&) {
  return std::nullopt;
} catch (const InputError&) {
  return std::nullopt;
}

void write_settings(const Settings& settings, const scene::Scene& scene, const std::filesystem::path& path) {
  base::AtomicFile temporary(path);
  std::ofstream file(temporary.path());
  file << fmt::format(
              "# Chosen by ricochet-kernel for accuracy = {:g}. Without this file, it chooses again.\n",
              *scene.accuracy)
       << to_toml(settings);
  file.close();
  if (!file) temporary.fail();
  temporary.commit();
}

std::optional<Settings> read_settings(const std::filesystem::path& path) {
  std::error_code ignored;
  constexpr std::uintmax_t most = 1 << 20;
  if (!std::filesystem::is_regular_file(path, ignored) || std::filesystem::file_size(path, ignored) > most)
    return std::nullopt;
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return parse_settings(text.str());
}

}  // namespace ricochet::accuracy
