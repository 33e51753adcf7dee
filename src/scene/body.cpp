// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/body.hpp"

#include <algorithm>

#include "base/similar.hpp"
#include "src/scene/keys.hpp"
#include "src/scene/material.hpp"
#include "src/scene/materials.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::scene {

namespace {

bool read_order(const Table& table, const Key& key, Body& body) {
  body.order_open = !table.read(key, body.order);
  return !body.order_open;
}

std::string order_of(const Body& body) { return body.order_open ? "" : toml_value(body.order); }

/// A name or a table for the whole body, or a table of them, one for each group. An imported body has none.
bool read_materials(const Table& table, const Key& key, Body& body) {
  if (table.has_text(key.name)) {
    std::string name;
    table.read(Key{.name = key.name, .type = Type::text}, name);
    body.materials.push_back(named_material(table, key.name, name));
  } else if (table.has_named_entries(key.name, material_keys)) {
    std::map<std::string, std::string> names;
    for (const auto& [group, inner] : table.named(key.name, material_keys, &names))
      body.materials.push_back(read_material(inner, group));
    for (const auto& [group, name] : names) {
      body.materials.push_back(named_material(table, key.name + '.' + group, name));
      body.materials.back().group = group;
    }
    std::ranges::sort(body.materials, {}, &Material::group);
  } else if (const auto inner = table.table(key.name, material_keys)) {
    body.materials.push_back(read_material(*inner, ""));
  }
  return table.has(key.name);
}

std::string materials_of(const Body& body) {
  if (body.materials.empty()) return "{}";
  if (body.materials.size() == 1 && body.materials[0].group.empty())
    return material_keys.inline_table(body.materials[0]);
  std::string text;
  for (const Material& material : body.materials)
    text += fmt::format("{} {} = {}", text.empty() ? "" : ",", toml_string(material.group),
                        material_keys.inline_table(material));
  return '{' + text + " }";
}

/// A law of damping with its parameters.
template <class T>
Access<Damping> law(Damping::Law law, T Damping::*member) {
  return {type_of<T>,
          [law, member](const Table& table, const Key& key, Damping& damping) {
            const bool given = table.read(key, damping.*member);
            if (given) damping.law = law;
            return given;
          },
          [law, member](const Damping& damping) {
            return damping.law == law ? toml_value(damping.*member) : "";
          }};
}

bool read_rayleigh(const Table& table, const Key& key, Damping& damping) {
  std::array<double, 2> both{};
  if (!table.read(key, both)) return false;
  damping = {Damping::Law::rayleigh, both[0], both[1]};
  return true;
}

std::string rayleigh_of(const Damping& damping) {
  return damping.law == Damping::Law::rayleigh ? toml_value(std::array{damping.first, damping.second}) : "";
}

bool read_damping(const Table& body, const Key& key, Body& out) {
  const auto table = body.table(key.name, damping_keys);
  if (!table) return false;
  damping_keys.read(*table, out.damping);
  if (std::ranges::count_if(damping_keys.keys, [&](const Key& law) { return table->has(law.name); }) > 1)
    body.complain(key.name, "give one law only: ratio, loss_factor, rayleigh, viscosity, t60 or by_mode");
  if (!std::ranges::is_sorted(out.damping.table, std::ranges::less_equal{},
                              [](const auto& row) { return row[0]; }))
    table->complain("t60", "the frequencies must ascend: sort the rows, and give each frequency once");
  return true;
}

std::string damping_of(const Body& body) { return damping_keys.inline_table(body.damping); }

/// Sorts the components.
bool read_support(const Table& table, const Key& key, Body& body) {
  if (!table.read(key, body.support)) return false;
  for (auto& [group, text] : body.support) {
    std::string components;
    for (char c : {'x', 'y', 'z'})
      if (text.find(c) != std::string::npos) components += c;
    if (components.empty() || text.find_first_not_of("xyz") != std::string::npos)
      table.complain("support", fmt::format("\"{}\" holds \"{}\": name the fixed components, some of \"xyz\"",
                                            group, text));
    text = components;
  }
  return true;
}

std::string support_of(const Body& body) { return toml_value(body.support); }

}  // namespace

const SectionOf<Body> body_keys{
    "[bodies.NAME]",
    "An elastic body.",
    {{"mesh", &Body::mesh, "", required(), any(),
      "mesh file. `.msh` is read as it is; `.geo`, `.step`, `.brep` and `.stl` are meshed by the gmsh "
      "library; `.h5` is a [body file](interchange.md#bodies-from-another-finite-element-program) from "
      "another program. [Meshes of other programs](meshes.md#meshes-of-other-programs), such as `.inp` and "
      "`.med`, are converted"},
     {"geometry", &Body::geometry, "", "`{}`", any(),
      "values for the `DefineConstant` names of a `.geo`. Names that the `.geo` does not define are refused, "
      "and so is `geometry` for other files",
      "{ size = 4e-3 }"},
     {"order", Access(Type::integer, read_order, order_of), "", ", or chosen by `accuracy`",
      from_to("1", "10"), "element order for meshes that gmsh makes; a `.msh` keeps its own"},
     {"size_factor", Access(&Body::size_factor).if_changed(), "1", ", or chosen by `accuracy` with `order`",
      above("0"),
      "factor on the element sizes of a `.geo`, `.step` or `.brep` (gmsh's `Mesh.MeshSizeFactor`). Curves "
      "with a given number of elements keep it"},
     {"refine", list(&Body::refine, refine_keys).if_changed(), "",
      "none, or chosen by `accuracy` with `size_factor`", any(),
      "`[[bodies.NAME.refine]]`, balls in which a `.geo`, `.step` or `.brep` gets smaller elements"},
     {"scale", &Body::scale, "1", initial, above("0"),
      "factor on all coordinates of the mesh (0.001 for a drawing in millimetres, and for any STEP file)"},
     {"material", Access(Type::text_or_table, read_materials, materials_of), "", required(), any(),
      "the [name of a material](commands.md#ricochet-materials) or a table for the whole body, or a table "
      "of names and tables, one for each physical volume (for a rod: physical line), named after it. A body "
      "file has no material",
      "{ density = 7800, young = 2.1e11, poisson = 0.3 }"},
     {"damping", Access(Type::table, read_damping, damping_of), "", "`{}`", any(),
      "one damping law; no damping if empty", "{ ratio = 0.01 }"},
     {"contact", &Body::contact, "", required(), any(),
      "physical surface (for a rod: physical point) that may touch, or a list of them. `\"all\"`: [the whole "
      "surface](scene.md#bodies) of a solid body, unless its mesh has a physical surface of this name. "
      "Optional in a scene without `[contact]`"},
     {"support", Access(Type::strings, read_support, support_of), "", "`{}`", any(),
      "physical group (surface, curve, point or volume) = fixed components, some of `\"xyz\"`, in the axes "
      "of the mesh (before `rotate_deg`). A rod is fixed unless all named components are normal to its axis",
      "{ GROUP = \"xyz\" }"},
     {"translate", &Body::translate, "m", initial, any(), "translation, after `scale` and `rotate_deg`"},
     {"rotate_deg", &Body::rotate_deg, "degrees", initial, any(),
      "rotations about the fixed axes x, then y, then z, through the origin of the mesh"},
     {"velocity", &Body::velocity, "m/s", initial, any(),
      "initial velocity of the centre of mass, in world axes. A supported body cannot have a velocity that "
      "its supports prevent; a rod moves along its axis only"},
     {"angular_velocity", &Body::angular_velocity, "rad/s", initial, any(),
      "initial angular velocity about the centre of mass, in world axes, for bodies that supports do not "
      "hold. With [linear rotation](scene.md#which-rotation), points move along their initial "
      "tangents. The body starts without the strain of centrifugal forces"}}};

const SectionOf<Body> matter_keys =
    body_keys.without({"mesh", "translate", "rotate_deg", "velocity", "angular_velocity"});

const SectionOf<FineBall> refine_keys{
    "[[bodies.NAME.refine]]",
    "A ball with small elements, such as the surroundings of a point that is struck. Outside the ball, "
    "elements grow by 0.4 of the distance from it, up to the size that the geometry asks for. Curves and "
    "surfaces with a given number of elements keep it.",
    {{"at", &FineBall::at, "m", required("the centre, [x, y, z] in the axes of the mesh"), any(),
      "centre, in the axes of the mesh: after `scale`, before `rotate_deg` and `translate`"},
     {"radius", &FineBall::radius, "m", required(), above("0"), "radius of the ball"},
     {"size", &FineBall::size, "m", required(), above("0"), "size of elements in the ball"}}};

const SectionOf<Damping> damping_keys{
    "[bodies.NAME.damping]",
    "Give one of these laws for the decay rate δ = ζω of a mode with the angular frequency ω.",
    {{"ratio", law(Damping::Law::ratio, &Damping::first), "1", none, at_least("0"),
      "δ = ratio · ω: the same damping ratio ζ for every mode"},
     {"loss_factor", law(Damping::Law::loss_factor, &Damping::first), "1", none, at_least("0"),
      "δ = loss_factor · ω / 2"},
     {"viscosity", law(Damping::Law::viscosity, &Damping::first), "s", none, at_least("0"),
      "δ = viscosity · ω² / 2 (Kelvin–Voigt)"},
     {"rayleigh", Access(Type::pair, read_rayleigh, rayleigh_of), "[1/s, s]", none, at_least("0"),
      "[α, β]: δ = (α + β ω²) / 2; α also damps rigid motion", "[alpha, beta]"},
     {"t60", law(Damping::Law::t60, &Damping::table), "[Hz, s]", none, above("0"),
      "rows of a frequency, ascending, and the time T60 in which a mode of this frequency decays by 60 dB: δ "
      "= ln(1000) / T60. Between rows, log T60 is linear in log f; beyond the first and the last row, T60 is "
      "constant. Rigid motion is not damped",
      "[[100, 2.0], [1000, 0.8]]"},
     {"by_mode", law(Damping::Law::by_mode, &Damping::by_mode), "1", none, at_least("0"),
      "loss factors of the elastic modes, from the lowest on: δ = η · ω / 2. Further modes have the last "
      "one. Not for Ritz vectors and not with `flexibility_error`, which leave no mode its number",
      "[1e-3, 2e-3]"}}};

namespace {

template <Shape... shapes>
bool is_one(const Obstacle& obstacle) {
  return ((obstacle.shape == shapes) || ...);
}
constexpr auto& is_mesh = is_one<Shape::mesh>;
constexpr auto& is_half_space = is_one<Shape::half_space>;
bool is_solid(const Obstacle& obstacle) { return !obstacle.is_half_space(); }
bool is_drawn(const Obstacle& obstacle) { return obstacle.is_drawn(); }

}  // namespace

const SectionOf<Obstacle> obstacle_keys{
    "[obstacles.NAME]",
    "A rigid obstacle, which can replace one of the two bodies of a pair: a half-space, a "
    "[shape](scene.md#obstacles), or a closed surface.",
    {{"shape",
      choice<Obstacle>(&Obstacle::shape,
                       {"half-space", "sphere", "cylinder", "capsule", "box", "cone", "torus", "mesh"}),
      "", initial, any(),
      "what bounds it. Shapes have their axis along z before `rotate_deg`, and their middle at `point`. "
      "Without "
      "this key, an obstacle with a `surface` is a `\"mesh\"`"},
     {"point", &Obstacle::point, "m", initial, any(),
      "of a half-space: a point of its surface; of a shape: its middle; of a mesh: where its origin is"},
     {"normal", Access<Obstacle>(direction<Obstacle>(&Obstacle::normal)).only(is_half_space, "a half-space"),
      "", "– of a half-space", any(), "outward normal of a half-space"},
     {"velocity", &Obstacle::velocity, "m/s", initial, any(),
      "constant [velocity](scene.md#obstacles-that-move), in world axes. Along the surface of a half-space "
      "it acts through `friction` only, like that of a conveyor belt. Not with `scheme = \"static\"`"},
     {"angular_velocity",
      Access<Obstacle>(&Obstacle::angular_velocity).only(is_solid, "a shape or a surface").if_changed(),
      "rad/s", initial, any(),
      "constant angular velocity about `point`, in world axes. Not with `scheme = \"static\"`"},
     {"side", choice<Obstacle>(&Obstacle::side, {"outside", "inside"}).only(is_solid, "a shape or a surface"),
      "", initial, any(),
      "where bodies are: `\"inside\"` makes a bowl of a sphere, and a tube of a cylinder"},
     {"rotate_deg", Access<Obstacle>(&Obstacle::rotate_deg).only(is_solid, "a shape or a surface"), "degrees",
      initial, any(), "rotations about the fixed axes x, then y, then z, through `point`"},
     {"radius",
      Access<Obstacle>(&Obstacle::radius)
          .only(is_one<Shape::sphere, Shape::cylinder, Shape::capsule, Shape::cone, Shape::torus>,
                "a round shape"),
      "m", "– of a round shape", at_least("0"),
      "radius; of a cone at its lower end; of a torus that of the circle around which its tube is"},
     {"radius_small",
      Access<Obstacle>(&Obstacle::radius_small).only(is_one<Shape::cone, Shape::torus>, "a cone or a torus"),
      "m", initial, at_least("0"),
      "of a cone: radius at its upper end, 0 for a tip; of a torus: radius of its tube"},
     {"length",
      Access<Obstacle>(&Obstacle::length)
          .only(is_one<Shape::cylinder, Shape::capsule, Shape::cone>, "a cylinder, a capsule or a cone"),
      "m", "– of these shapes", above("0"), "along the axis; of a capsule without its two hemispheres"},
     {"size", Access<Obstacle>(&Obstacle::size).only(is_one<Shape::box>, "a box"), "m", "– of a box",
      above("0"), "edges of a box along x, y, z"},
     {"surface", Access<Obstacle>(&Obstacle::surface).only(is_mesh, "a mesh"), "", "– of a mesh", any(),
      "an STL or OBJ file of a closed surface, or a [drawing or mesh](scene.md#drawings) such as a `.step`, "
      "of "
      "which `ricochet-kernel` makes an STL file beside the kernels. Edges at which triangles meet at less "
      "than 29° are "
      "smooth; there, the surface between the nodes is curved"},
     {"scale", Access<Obstacle>(&Obstacle::scale).only(is_mesh, "a mesh"), "1", initial, above("0"),
      "factor on the coordinates of the file, for example 1e-3 for millimetres"},
     {"size_factor", Access<Obstacle>(&Obstacle::size_factor).only(is_drawn, "a drawing").if_changed(), "1",
      initial, above("0"),
      "factor on the sizes of the triangles of a drawing (gmsh's `Mesh.MeshSizeFactor`)"}}};

namespace {

/// Checks that only geometries have a refinement, that a meshed body has a material, and that an imported
/// body has none of the keys that its file fixes.
void check_matter(const Table& table, const Body& body) {
  if (!body.refine.empty() && !body.meshable())
    table.complain("refine",
                   fmt::format("has no effect on {}, which is read as it is: remove it, or give the "
                               "geometry (.geo, .step or .brep)",
                               body.mesh.filename().string()));
  if (!body.imported()) {
    if (body.materials.empty() && !body.foreign())  // ricochet-kernel then names those of the file
      table.complain("material",
                     "is missing: give a name, \"steel\", or { density = …, young = …, poisson = … }");
    return;
  }
  const char* fixed = "is part of the data of a body file (.h5): leave it out";
  if (!body.materials.empty()) table.complain("material", fixed);
  if (!body.geometry.empty()) table.complain("geometry", fixed);
  if (body.scale != 1) table.complain("scale", fixed);
}

/// @param names  of all bodies of the scene
Body read_body(const std::string& name, const Table& table, const std::vector<std::string>& names) {
  Body body;
  body.name = name;
  if (name.empty() ||
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") !=
          std::string::npos)
    table.complain("", "the name of a body must consist of letters, digits, - and _");
  if (!table.has("mesh")) {
    std::vector<std::string> others = names;
    std::erase(others, name);
    const std::string similar = base::most_similar(name, others);
    table.complain("mesh", "is missing: name a .geo, .step, .brep or .msh file, or a body file (.h5)" +
                               (similar.empty() ? "" : "; or did you mean bodies." + similar + "?"));
  }
  body_keys.read(table, body);
  check_matter(table, body);
  return body;
}

Obstacle read_obstacle(const std::string& name, const Table& table, const Scene& scene) {
  Obstacle obstacle;
  obstacle.name = name;
  if (table.has("surface")) obstacle.shape = Shape::mesh;
  obstacle_keys.read(table, obstacle);
  const auto need = [&](const char* key, const char* what, bool needed) {
    if (needed && !table.has(key)) table.complain(key, std::string("is missing: ") + what);
  };
  need("normal", "the direction out of the obstacle, for example [0, 0, 1]", obstacle.is_half_space());
  need("surface", "name an STL or OBJ file or a drawing", obstacle.shape == Shape::mesh);
  need("size", "give the edges along x, y, z in m, for example [1, 1, 0.2]", obstacle.shape == Shape::box);
  need("radius", "give a number in m",
       is_one<Shape::sphere, Shape::cylinder, Shape::capsule, Shape::cone, Shape::torus>(obstacle));
  need("length", "give a number in m", is_one<Shape::cylinder, Shape::capsule, Shape::cone>(obstacle));
  need("radius_small", "give a number in m", obstacle.shape == Shape::torus);
  if (scene.find_body(name) != nullptr) table.complain("", "a body has this name already");
  return obstacle;
}

}  // namespace

void read_bodies(const Table& root, Scene& scene) {
  const auto bodies = root.named("bodies", body_keys);
  if (bodies.empty()) root.complain("bodies", "is missing: a scene needs a body, [bodies.NAME]");
  std::vector<std::string> names;
  for (const auto& [name, table] : bodies) names.push_back(name);
  for (const auto& [name, table] : bodies) scene.bodies.push_back(read_body(name, table, names));
  for (const auto& [name, table] : root.named("obstacles", obstacle_keys))
    scene.obstacles.push_back(read_obstacle(name, table, scene));
}

}  // namespace ricochet::scene
