// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/body.hpp"

#include <algorithm>

#include "base/similar.hpp"
#include "src/scene/near_miss.hpp"
#include "src/scene/table.hpp"

namespace ricochet::scene {

namespace {

Material read_material(Table& table, const std::string& group) {
  Material material;
  material.group = group;
  material.density = table.required_number("density");
  material.young = table.required_number("young");
  material.poisson = table.number("poisson").value_or(material.poisson);
  material.area = table.number("area").value_or(material.area);
  material.yield = table.number("yield").value_or(material.yield);
  table.refuse_unread();
  return material;
}

/// Returns an empty list if the table is missing, as for an imported body.
std::vector<Material> read_materials(Table& body) {
  const toml::table* given = body.raw()["material"].as_table();
  const bool nested = given != nullptr &&
                      std::ranges::all_of(*given, [](const auto& entry) { return entry.second.is_table(); });
  std::vector<Material> materials;
  if (nested)
    for (auto& [group, inner] : body.named("material", material_keys))
      materials.push_back(read_material(inner, group));
  else if (auto table = body.table("material", material_keys))
    materials.push_back(read_material(*table, ""));
  return materials;
}

Damping read_damping(Table& body) {
  Damping damping;
  auto table = body.table("damping", damping_keys);
  if (!table) return damping;
  int given = 0;
  for (const auto& [key, law] : damping_laws)
    if (const auto value = table->number(key)) {
      damping = {law, *value, 0};
      ++given;
    }
  if (const auto value = table->pair("rayleigh", "[alpha, beta]")) {
    damping = {Damping::Law::rayleigh, (*value)[0], (*value)[1]};
    ++given;
  }
  if (auto rows = table->pairs("t60")) {
    if (!std::ranges::is_sorted(*rows, std::ranges::less_equal{}, [](const auto& row) { return row[0]; }))
      table->complain("t60", "the frequencies must ascend: sort the rows, and give each frequency once");
    damping = {.law = Damping::Law::t60, .table = std::move(*rows)};
    ++given;
  }
  if (auto factors = table->list("by_mode")) {
    damping = {.law = Damping::Law::by_mode, .by_mode = std::move(*factors)};
    ++given;
  }
  table->refuse_unread();
  if (given > 1)
    body.complain("damping", "give one law only: ratio, loss_factor, rayleigh, viscosity, t60 or by_mode");
  return damping;
}

std::map<std::string, std::string> read_support(Table& body) {
  std::map<std::string, std::string> support;
  for (const auto& [group, text] : body.strings("support")) {
    std::string components;
    for (char c : {'x', 'y', 'z'})
      if (text.find(c) != std::string::npos) components += c;
    if (components.empty() || text.find_first_not_of("xyz") != std::string::npos)
      body.complain("support", fmt::format("\"{}\" holds \"{}\": name the fixed components, some of \"xyz\"",
                                           group, text));
    support[group] = components;
  }
  return support;
}

std::vector<FineBall> read_refine(Table& body) {
  std::vector<FineBall> balls;
  for (Table& entry : body.array("refine", refine_keys)) {
    FineBall ball;
    ball.at = entry.required("at", entry.vector("at"), "the centre, [x, y, z] in the axes of the mesh");
    ball.radius = entry.required_number("radius");
    ball.size = entry.required_number("size");
    entry.refuse_unread();
    balls.push_back(ball);
  }
  return balls;
}

}  // namespace

void read_body_matter(Table& table, Body& body) {
  body.geometry = table.numbers("geometry");
  const auto order = table.integer("order");
  body.order_open = !order;
  body.order = static_cast<int>(order.value_or(body.order));
  body.size_factor = table.number("size_factor").value_or(body.size_factor);
  body.refine = read_refine(table);
  body.scale = table.number("scale").value_or(body.scale);
  body.materials = read_materials(table);
  body.damping = read_damping(table);
  body.contact = table.texts("contact");
  body.support = read_support(table);
}

namespace {

/// Checks that only geometries have a refinement, that a meshed body has a material, and that an imported
/// body has none of the keys that its file fixes.
void check_matter(Table& table, const Body& body) {
  if (!body.refine.empty() && !body.meshable())
    table.complain("refine",
                   fmt::format("has no effect on {}, which is read as it is: remove it, or give the "
                               "geometry (.geo, .step or .brep)",
                               body.mesh.filename().string()));
  if (!body.imported()) {
    if (body.materials.empty())
      table.complain("material", "is missing: give { density = …, young = …, poisson = … }");
    return;
  }
  const char* fixed = "is part of the data of a body file (.h5): leave it out";
  if (!body.materials.empty()) table.complain("material", fixed);
  if (!body.geometry.empty()) table.complain("geometry", fixed);
  if (body.scale != 1) table.complain("scale", fixed);
}

}  // namespace

Body read_body(const std::string& name, Table& table, const std::vector<std::string>& names,
               const std::filesystem::path& folder) {
  Body body;
  body.name = name;
  if (name.empty() ||
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") !=
          std::string::npos)
    table.complain("", "the name of a body must consist of letters, digits, - and _");
  const auto mesh = table.text("mesh");
  if (!mesh) {
    std::vector<std::string> others = names;
    std::erase(others, name);
    const std::string similar = base::most_similar(name, others);
    table.complain("mesh", "is missing: name a .geo, .step, .brep or .msh file, or a body file (.h5)" +
                               (similar.empty() ? "" : "; or did you mean bodies." + similar + "?"));
  }
  body.mesh = (folder / *mesh).lexically_normal();
  read_body_matter(table, body);
  check_matter(table, body);
  body.translate = table.vector("translate").value_or(Vector3{});
  body.rotate_deg = table.vector("rotate_deg").value_or(Vector3{});
  body.velocity = table.vector("velocity").value_or(Vector3{});
  body.angular_velocity = table.vector("angular_velocity").value_or(Vector3{});
  table.refuse_unread();
  return body;
}

}  // namespace ricochet::scene
