// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/material.hpp"

#include <cmath>
#include <numbers>

#include "src/scene/elastic_law.hpp"
#include "src/scene/keys.hpp"
#include "src/scene/materials.hpp"

namespace ricochet::scene {

namespace {

/// Largest angle by which the axes of a material may miss a right angle [degrees].
constexpr double most_oblique = 1;

bool is_orthotropic(const Material& material) { return material.orthotropy.has_value(); }
bool is_anisotropic(const Material& material) { return !material.isotropic(); }

/// Sets all values to those of a material that has a name.
bool read_like(const Table& table, const Key& key, Material& material) {
  std::string name;
  if (!table.read(key, name)) return false;
  const std::string group = material.group;
  material = named_material(table, key.name, name);
  material.group = group;
  return true;
}

std::string no_text(const Material&) { return ""; }

/// One modulus makes the material isotropic, three make it orthotropic.
bool read_young(const Table& table, const Key& key, Material& material) {
  if (!table.has(key.name)) return false;
  if (!table.has_list(key.name)) {
    table.read(key, material.young);
    material.orthotropy.reset();
    material.stiffness.reset();
    return true;
  }
  Orthotropy law = material.orthotropy.value_or(Orthotropy{});
  table.read(key, law.young);
  material.orthotropy = law;
  material.stiffness.reset();
  material.young = material.poisson = 0;
  return true;
}

std::string young_of(const Material& material) {
  if (material.stiffness) return "";
  return material.orthotropy ? toml_value(material.orthotropy->young) : toml_value(material.young);
}

bool read_shear(const Table& table, const Key& key, Material& material) {
  Vector3 shear{};
  const bool given = table.read(key, shear);
  if (given && material.orthotropy) material.orthotropy->shear = shear;
  return given;
}

std::string shear_of(const Material& material) {
  return material.orthotropy ? toml_value(material.orthotropy->shear) : "";
}

bool read_poisson(const Table& table, const Key& key, Material& material) {
  if (!table.has(key.name)) return false;
  if (table.has_list(key.name) != is_orthotropic(material))
    table.complain(key.name, material.orthotropy ? "must be three numbers as young, [nu23, nu13, nu12]"
                                                 : "three ratios belong to young = [E1, E2, E3]: give one");
  if (!material.orthotropy) return table.read(key, material.poisson);
  Key of_three = key;
  of_three.range = any();  // their law is checked as a whole
  return table.read(of_three, material.orthotropy->poisson);
}

std::string poisson_of(const Material& material) {
  if (material.stiffness) return "";
  return material.orthotropy ? toml_value(material.orthotropy->poisson) : toml_value(material.poisson);
}

bool read_stiffness(const Table& table, const Key& key, Material& material) {
  std::vector<double> constants;
  if (!table.read(key, constants)) return false;
  std::array<double, 21> upper{};
  if (constants.size() != upper.size())
    table.complain(key.name, fmt::format("has {} numbers: give the 21 of the upper triangle, by rows",
                                         constants.size()));
  for (const char* other : {"young", "shear", "poisson"})
    if (table.has(other))
      table.complain(other, "is part of stiffness, which is the whole law: leave one of them out");
  std::ranges::copy(constants, upper.begin());
  material.stiffness = upper;
  material.orthotropy.reset();
  material.young = material.poisson = 0;
  return true;
}

std::string stiffness_text(const Material& material) { return toml_value(material.stiffness); }

double product(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Axes that are orthonormal up to round-off stay as they are, so that a written scene gives them again.
bool read_axes(const Table& table, const Key& key, Material& material) {
  std::array<Vector3, 2> axes{};
  if (!table.read(key, axes)) return false;
  const auto normalise = [&](Vector3& axis) {
    const double length = std::hypot(axis[0], axis[1], axis[2]);
    if (!(length > 0)) table.complain(key.name, "an axis must not be zero");
    if (std::abs(length - 1) >= 1e-15)
      for (double& x : axis) x /= length;
  };
  normalise(axes[0]);
  normalise(axes[1]);
  const double along = product(axes[0], axes[1]),
               angle = std::acos(std::clamp(along, -1.0, 1.0)) * 180 / std::numbers::pi;
  if (std::abs(angle - 90) > most_oblique)
    table.complain(key.name, fmt::format("the two axes meet at {:.4g} degrees: they must be normal to each "
                                         "other within {:g} degree",
                                         angle, most_oblique));
  if (std::abs(along) >= 1e-15) {
    for (std::size_t k = 0; k < 3; ++k) axes[1][k] -= along * axes[0][k];
    normalise(axes[1]);
  }
  material.axes = axes;
  return true;
}

std::string axes_of(const Material& material) { return toml_value(material.axes); }

bool read_about(const Table& table, const Key& key, Material& material) {
  const auto line = table.table(key.name, about_keys);
  if (!line) return false;
  if (table.has("axes")) table.complain("axes", "belongs to fixed axes: leave it out, or about");
  about_keys.read(*line, material.about.emplace());
  return true;
}

std::string about_of(const Material& material) {
  return material.about ? about_keys.inline_table(*material.about) : "";
}

const char* const anisotropic = "young = [E1, E2, E3] or stiffness";

}  // namespace

const SectionOf<Material> material_keys{
    "[bodies.NAME.material]",
    "A linear elastic material: isotropic, or [anisotropic](scene.md#anisotropic-materials) with three "
    "moduli "
    "or 21 constants. A body of several materials has one table for each: `[bodies.NAME.material.GROUP]`.",
    {{"like", Access<Material>(Type::text, read_like, no_text), "", none, any(),
      "[name of a material](commands.md#ricochet-materials), whose values serve for the keys that are not "
      "given. The resolved scene has the values alone"},
     {"density", &Material::density, "kg/m³", "– without `like`", above("0"), "mass per volume"},
     {"young", Access(Type::number_or_three, read_young, young_of), "Pa", "– without `like` or `stiffness`",
      above("0"),
      "Young's modulus; three numbers, E1, E2 and E3, are those along the axes of an orthotropic material",
      "[E1, E2, E3]"},
     {"shear", Access(Type::three, read_shear, shear_of).only(is_orthotropic, "young = [E1, E2, E3]"), "Pa",
      "– with three `young`", above("0"), "shear moduli G23, G13 and G12 of an orthotropic material",
      "[G23, G13, G12]"},
     {"poisson", Access(Type::number_or_three, read_poisson, poisson_of), "1", ", or that of `like`",
      Range{.low = "-1",
            .high = "0.5",
            .low_open = true,
            .high_open = true,
            .remark = ". Nearly incompressible: try 0.49."},
      "Poisson's ratio; rods do not use it. Above 0.45 use `order` 2 or more: linear elements lock, and a "
      "warning is printed. Three numbers of any size, ν23, ν13 and ν12, with three `young`: ν_ij is −ε_j/ε_i "
      "under a stress along i",
      "[nu23, nu13, nu12]"},
     {"stiffness", Access(Type::list, read_stiffness, stiffness_text), "Pa", none, any(),
      "the law by 21 constants, instead of `young` and `poisson`: the upper triangle of C by rows, C11, C12 "
      "… C16, C22 … C66, for xx, yy, zz, yz, xz, xy and the engineering shear strains γ = 2ε",
      "[C11, C12, C13, C14, C15, C16, C22, …, C66]"},
     {"axes", Access(Type::axes, read_axes, axes_of).if_changed().only(is_anisotropic, anisotropic), "",
      "`[[1, 0, 0], [0, 1, 0]]`", any(),
      "axes 1 and 2 of the material in the axes of the mesh (before `rotate_deg`), of any length, at right "
      "angles within 1°; axis 2 is made exactly normal to axis 1",
      "[[1, 0, 0], [0, 1, 0]]"},
     {"about", Access(Type::table, read_about, about_of).only(is_anisotropic, anisotropic), "", none, any(),
      "a line, instead of `axes`: at each point, axis 1 is radial from the line, axis 2 tangential and axis "
      "3 along it",
      "{ point = [0, 0, 0], direction = [0, 0, 1] }"},
     {"area", Access(&Material::area).if_changed(), "m²", none, above("0"),
      "cross-section of a rod; other bodies do not use it"},
     {"yield", Access(&Material::yield).if_changed(), "Pa", none, above("0"),
      "stress at which the material yields. A run warns if the pressure of a contact or the stress "
      "at a gauge exceeds it; nothing else depends on it"}}};

const SectionOf<CentreLine> about_keys{
    "[bodies.NAME.material.about]",
    "The line about which the axes of an anisotropic material turn, such as the pith of a tree.",
    {{"point", &CentreLine::point, "m", required("a point of the line, such as [0, 0, 0]"), any(),
      "a point of the line, in the axes of the mesh: after `scale`, before `rotate_deg` and `translate`"},
     {"direction", direction<CentreLine>(&CentreLine::direction), "",
      required("the direction of axis 3, such as [0, 0, 1]"), any(),
      "direction of the line and of axis 3, in the axes of the mesh"}}};

namespace {

/// Checks that the constants of a law are complete.
void check_complete(const Table& table, const Material& material) {
  for (const char* required : {"density", "young"}) {
    const bool given = table.has(required) || table.has("like") || (required[0] == 'y' && material.stiffness);
    if (!given)
      table.complain(required, "is missing: give a number in " + material_keys.find(required)->unit +
                                   ", or like, the name of a material");
  }
  Material like;
  if (table.has("like")) read_like(table, *material_keys.find("like"), like);
  if (is_orthotropic(material) && !is_orthotropic(like))
    for (const char* key : {"shear", "poisson"})
      if (!table.has(key))
        table.complain(key, "is missing: three moduli need " + material_keys.find(key)->example);
  if (material.isotropic() && !like.isotropic() && !table.has("poisson"))
    table.complain("poisson", "is missing: young is one number, so like has no value for it");
}

/// Checks that every strain stores energy.
void check_definite(const Table& table, const Material& material) {
  const auto value = refused_eigenvalue(material);
  if (!value) return;
  if (material.stiffness)
    table.complain("stiffness",
                   fmt::format("must be positive definite; the smallest eigenvalue of this matrix is {:.4g} "
                               "Pa: check the order, rows of the upper triangle for xx, yy, zz, yz, xz, xy",
                               *value));
  table.complain("poisson",
                 fmt::format("the compliance of the nine constants must be positive definite; its smallest "
                             "eigenvalue is {:.4g} 1/Pa. ν_ij is −ε_j/ε_i under a stress along i: check "
                             "that ν_ij² < E_i/E_j",
                             *value));
}

}  // namespace

Material read_material(const Table& table, const std::string& group) {
  Material material{.group = group};
  material_keys.read(table, material);
  check_complete(table, material);
  check_definite(table, material);
  return material;
}

}  // namespace ricochet::scene
