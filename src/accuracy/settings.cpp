// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/settings.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/atomic_file.hpp"
#include "src/scene/scene.hpp"
#include "src/scene/write.hpp"

namespace ricochet::accuracy {
namespace {

/// Bytes of the names of bodies in a file name.
constexpr std::size_t longest_names = 100;

}  // namespace

scene::Scene with_settings(scene::Scene scene, const KernelSettings& settings) {
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
  return scene;
}

std::filesystem::path settings_path(const std::filesystem::path& folder, const scene::Scene& scene,
                                    scene::MeshHashes* known) {
  std::string names, data = fmt::format("{}\n{}\n", scene::toml_number(*scene.accuracy),
                                        static_cast<int>(scene.contact.scheme));
  for (const Quantity quantity : scene.accuracy_of) data += std::string(name_of(quantity)) + '\n';
  for (const scene::Body& body : scene.bodies) {
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

std::string toml_of(const KernelSettings& settings, const std::string& table) {
  std::string text = fmt::format("\n[{}]\nbasis = \"{}\"\nup_to_hz = {}\n", table,
                                 settings.basis == scene::Basis::contact ? "contact" : "modes",
                                 scene::toml_number(settings.up_to.value));
  text += fmt::format("flexibility_error = {}\n", scene::toml_number(settings.flexibility_error));
  if (settings.zone) text += fmt::format("zone = {}\n", scene::toml_number(*settings.zone));
  for (const auto& [body, mesh] : settings.mesh)
    text += fmt::format("bodies.{} = {{ order = {}, size_factor = {}{} }}\n", body, mesh.order,
                        scene::toml_number(mesh.size_factor),
                        mesh.refine.empty() ? "" : ", refine = " + scene::toml_refine(mesh.refine));
  return text;
}

/// @return no value if an entry is missing or has another type
std::optional<std::vector<scene::FineBall>> balls_of(const toml::table& mesh) {
  std::vector<scene::FineBall> out;
  if (!mesh.contains("refine")) return out;
  const toml::array* const balls = mesh["refine"].as_array();
  if (balls == nullptr) return std::nullopt;
  for (const toml::node& node : *balls) {
    const toml::node_view<const toml::node> ball(node);
    scene::FineBall& one = out.emplace_back();
    one.radius = ball["radius"].value_or(0.0);
    one.size = ball["size"].value_or(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto x = ball["at"][k].value<double>();
      if (!x) return std::nullopt;
      one.at[k] = *x;
    }
    if (!(one.radius > 0) || !(one.size > 0)) return std::nullopt;
  }
  return out;
}

/// @return no value if an entry is missing or has another type
std::optional<KernelSettings> kernel_settings_of(const toml::table& root, const char* name) {
  const toml::table* const table = root[name].as_table();
  if (table == nullptr) return std::nullopt;
  const auto basis = (*table)["basis"].value<std::string>();
  const auto up_to = (*table)["up_to_hz"].value<double>();
  if (!basis || !up_to || !(*up_to > 0)) return std::nullopt;
  KernelSettings out{.mesh = {},
                     .basis = *basis == "contact" ? scene::Basis::contact : scene::Basis::modes,
                     .up_to = Hertz{*up_to},
                     .flexibility_error = (*table)["flexibility_error"].value_or(0.0),
                     .zone = (*table)["zone"].value<double>()};
  if (out.zone && !(*out.zone > 0)) return std::nullopt;
  if (out.basis == scene::Basis::contact && !(out.flexibility_error > 0)) return std::nullopt;
  if (const toml::table* const bodies = (*table)["bodies"].as_table())
    for (auto&& [body, node] : *bodies) {
      const toml::table* const mesh = node.as_table();
      const auto order = mesh ? (*mesh)["order"].value<std::int64_t>() : std::nullopt;
      const auto factor = mesh ? (*mesh)["size_factor"].value<double>() : std::nullopt;
      auto balls = mesh ? balls_of(*mesh) : std::nullopt;
      if (!order || *order < 1 || *order > 10 || !factor || !(*factor > 0) || !balls) return std::nullopt;
      out.mesh[std::string(body.str())] = {static_cast<int>(*order), *factor, std::move(*balls)};
    }
  return out;
}

}  // namespace

std::string to_toml(const Settings& settings) {
  std::string text = fmt::format("rate_hz = {}\nfor_few_candidates = {}\n",
                                 scene::toml_number(settings.rate.value), settings.for_few_candidates);
  text += toml_of(settings.found, "found");
  if (settings.coarser)
    text += "\n# The next coarser mesh, from which the error of the mesh is estimated." +
            toml_of(*settings.coarser, "coarser");
  const auto add_changes = [&](const char* title, const std::map<Quantity, double>& changes) {
    if (!changes.empty()) text += title;
    for (const auto& [quantity, change] : changes)
      text += fmt::format("{} = {}\n", name_of(quantity), scene::toml_number(change));
  };
  add_changes("\n# Relative change from there to an even coarser mesh.\n[coarser_change]\n",
              settings.coarser_change);
  add_changes("\n# Relative change from the last refinement near contact.\n[change_near_contact]\n",
              settings.change_near_contact);
  return text;
}

namespace {

/// @return no value if an entry has another name or type
std::optional<std::map<Quantity, double>> changes_of(const toml::table& root, const char* name) {
  std::map<Quantity, double> out;
  if (const toml::table* const changes = root[name].as_table())
    for (auto&& [quantity, node] : *changes) {
      const auto known = std::ranges::find(quantity_names, quantity.str());
      const auto change = node.value<double>();
      if (known == quantity_names.end() || !change) return std::nullopt;
      out[static_cast<Quantity>(known - quantity_names.begin())] = *change;
    }
  return out;
}

}  // namespace

std::optional<Settings> parse_settings(const std::string& text) {
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error&) {
    return std::nullopt;
  }
  auto found = kernel_settings_of(root, "found");
  auto coarser = kernel_settings_of(root, "coarser");
  auto coarser_change = changes_of(root, "coarser_change"),
       change_near_contact = changes_of(root, "change_near_contact");
  if (!found || !coarser_change || !change_near_contact || (root.contains("coarser") && !coarser))
    return std::nullopt;
  return Settings{.found = std::move(*found),
                  .coarser = std::move(coarser),
                  .coarser_change = std::move(*coarser_change),
                  .change_near_contact = std::move(*change_near_contact),
                  .rate = Hertz{root["rate_hz"].value_or(0.0)},
                  .for_few_candidates = root["for_few_candidates"].value_or(0)};
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
