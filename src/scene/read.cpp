#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>

#include "src/scene/loads.hpp"

namespace ricochet::scene {

namespace {

Material read_material(Table& table, const std::string& group) {
  Material material;
  material.group = group;
  material.density = table.required_number("density");
  material.young = table.required_number("young");
  material.poisson = table.number("poisson").value_or(material.poisson);
  material.area = table.number("area").value_or(material.area);
  table.refuse_unknown();
  return material;
}

/// None where none are given, as for an imported body.
std::vector<Material> read_materials(Table& body) {
  auto table = body.table("material", material_keys());
  if (!table || table->raw().empty()) return {};
  bool nested = true;
  for (auto&& [key, node] : table->raw()) nested = nested && node.is_table();
  if (!nested) return {read_material(*table, "")};
  std::vector<Material> materials;
  for (auto& [group, inner] : table->tables(material_keys()))
    materials.push_back(read_material(inner, group));
  return materials;
}

Damping read_damping(Table& body) {
  Damping damping;
  auto table = body.table("damping", damping_keys());
  if (!table) return damping;
  const std::pair<const char*, Damping::Law> laws[] = {{"ratio", Damping::Law::ratio},
                                                       {"loss_factor", Damping::Law::loss_factor},
                                                       {"viscosity", Damping::Law::viscosity}};
  int given = 0;
  for (const auto& [key, law] : laws)
    if (const auto value = table->number(key)) {
      damping = {law, *value, 0};
      ++given;
    }
  if (const auto value = table->pair("rayleigh", "[alpha, beta]")) {
    damping = {Damping::Law::rayleigh, (*value)[0], (*value)[1]};
    ++given;
  }
  table->refuse_unknown();
  if (given > 1) body.complain("damping", "give one law only: ratio, loss_factor, rayleigh or viscosity");
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

}  // namespace

void read_body_matter(Table& table, Body& body) {
  body.geometry = table.numbers("geometry");
  if (const auto order = table.integer("order")) body.order = static_cast<int>(*order);
  body.scale = table.number("scale").value_or(body.scale);
  body.materials = read_materials(table);
  body.damping = read_damping(table);
  body.contact = table.texts("contact");
  body.support = read_support(table);
}

namespace {

/// What belongs to a mesh, and what to an imported body.
void check_matter(Table& table, const Body& body) {
  if (!body.imported()) {
    if (body.materials.empty())
      table.complain("material", "is missing: give { density = …, young = …, poisson = … }");
    return;
  }
  const char* fixed = "a body file (.h5) has it in its numbers: leave it out";
  if (!body.materials.empty()) table.complain("material", fixed);
  if (!body.geometry.empty()) table.complain("geometry", fixed);
  if (body.scale != 1) table.complain("scale", fixed);
}

Body read_body(const std::string& name, Table& table, const std::filesystem::path& folder) {
  Body body;
  body.name = name;
  if (name.empty() ||
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") !=
          std::string::npos)
    table.complain("", "a body's name is made of letters, digits, - and _");
  const auto mesh = table.text("mesh");
  if (!mesh)
    table.complain("mesh", "is missing: name a .geo, .step, .brep or .msh file, or a body file (.h5)");
  body.mesh = (folder / *mesh).lexically_normal();
  read_body_matter(table, body);
  check_matter(table, body);
  body.translate = table.vector("translate").value_or(Vector3{});
  body.rotate_deg = table.vector("rotate_deg").value_or(Vector3{});
  body.velocity = table.vector("velocity").value_or(Vector3{});
  table.refuse_unknown();
  return body;
}

}  // namespace

Modes read_modes(Table& root, const std::optional<double>& accuracy) {
  Modes modes;
  auto table = root.table("modes", modes_keys());
  if (!table && accuracy) {
    modes.basis = Basis::contact;
    modes.accuracy = accuracy;
    return modes;
  }
  if (!table) root.complain("modes", "is missing: give up_to_hz or count, or accuracy in the scene");
  if (const auto band = table->number("up_to_hz")) modes.up_to = Hertz{*band};
  modes.count = table->integer("count");
  modes.flexibility_error = table->number("flexibility_error");
  modes.residual_flexibility = table->boolean("residual_flexibility").value_or(modes.residual_flexibility);
  if (const auto basis = table->text("basis")) {
    if (*basis == "contact") modes.basis = Basis::contact;
  } else if (accuracy && !modes.up_to && !modes.count) {
    modes.basis = Basis::contact;
  }
  if (const auto threshold = table->number("low_rank")) {
    if (*threshold != 0 && modes.basis != Basis::contact)
      table->complain("low_rank", "proves no count of modes: it goes with basis = \"contact\"");
    modes.low_rank = *threshold;
  }
  if (const auto iterations = table->integer("approximate")) {
    if (*iterations > 0 && modes.basis == Basis::contact)
      table->complain("approximate", "goes with basis = \"modes\": vectors fitted to contact need no start");
    if (*iterations > 0 && (modes.flexibility_error || (!modes.up_to && !modes.count)))
      table->complain("approximate", "goes with up_to_hz or count alone: leave flexibility_error out");
    modes.approximate = static_cast<int>(*iterations);
  }
  if (accuracy && !modes.up_to && !modes.count) {
    modes.accuracy = accuracy;
    if (modes.basis == Basis::modes && !modes.residual_flexibility)
      root.complain("modes", "accuracy needs residual_flexibility = true, to which modes are left");
  } else if (modes.basis == Basis::contact) {
    if (!modes.up_to)
      root.complain("modes", "basis = \"contact\" needs up_to_hz, the band in which contact acts");
    if (modes.count && modes.flexibility_error)
      root.complain("modes", "give one of count and flexibility_error");
    if (!modes.count && !modes.flexibility_error) modes.flexibility_error = 1e-3;
  } else {
    if (modes.up_to.has_value() == modes.count.has_value())
      root.complain("modes", "give one of up_to_hz and count");
    if (modes.flexibility_error && !modes.up_to)
      root.complain("modes", "flexibility_error needs up_to_hz, the band in which contact acts");
    if (modes.flexibility_error && !modes.residual_flexibility)
      root.complain("modes", "flexibility_error needs residual_flexibility = true, to which modes are left");
  }
  modes.relative_residual = table->number("relative_residual").value_or(modes.relative_residual);
  table->refuse_unknown();
  return modes;
}

namespace {

void read_time(Table& root, const Contact& contact, const std::optional<double>& accuracy, Time& time) {
  auto table = root.table("time", time_keys());
  if (!table && contact.scheme == Scheme::at_rest) return;
  if (!table) root.complain("time", "is missing: give duration [s]");
  time.rate_by_accuracy = accuracy && !table->has("rate_hz");
  if (const auto rate = table->number("rate_hz")) time.rate = Hertz{*rate};
  time.duration = table->required_number("duration");
  const double steps = time.rate_by_accuracy ? 1 : time.duration * time.rate.value;
  if (steps < 1 || steps > 1e9)
    table->complain("duration", fmt::format("makes {:.3g} steps: must be from 1 to 1e9", steps));
  const bool steps_by_modes = contact.scheme == Scheme::compliant && contact.kernel == ContactKernel::modes;
  const auto precision = table->text("precision");
  if (precision == "single" && !steps_by_modes)
    table->complain("precision", "belongs to scheme = \"compliant\" and kernel = \"modes\"");
  if (precision == "single") time.precision = Precision::float32;
  if (!precision && accuracy && steps_by_modes) time.precision.reset();
  table->refuse_unknown();
}

void read_output(Table& root, Scene& scene) {
  Output& output = scene.output;
  auto table = root.table("output", output_keys());
  if (!table) return;
  if (const auto every = table->integer("every")) output.every = static_cast<int>(*every);
  const auto view = table->boolean("view");
  output.vtk_every = table->integer("vtk_every").value_or(output.vtk_every);
  if (output.vtk_every > 0 && view && !*view)
    table->complain("view", "vtk_every draws the skin of each body: leave view out, or set it to true");
  output.view = view.value_or(output.vtk_every > 0);
  output.snapshot_every = table->integer("snapshot_every").value_or(output.snapshot_every);
  output.receivers = read_receivers(*table, scene);
  table->refuse_unknown();
}

/// Modes that an imported body can't have, as it has neither elements nor a wave speed.
void refuse_what_needs_elements(Table& root, const Scene& scene) {
  const Modes& modes = scene.modes;
  const char* what = modes.approximate > 0 ? "approximate" : modes.low_rank > 0 ? "low_rank" : nullptr;
  for (const Body& body : scene.bodies) {
    if (!body.imported()) continue;
    if (modes.accuracy)
      root.complain("accuracy", fmt::format("can't choose modes for bodies.{}, a body file: give "
                                            "modes.up_to_hz or modes.count",
                                            body.name));
    if (what != nullptr)
      root.table("modes", modes_keys())
          ->complain(what, fmt::format("does not go with bodies.{}, a body file: leave it out", body.name));
  }
}

/// File systems end names at 255 bytes; the longest are those of temporary files, "<name>.<process>.partial".
void refuse_long_names(const Scene& scene) {
  constexpr std::size_t most = 255, temporary = 16;
  std::size_t ending = std::string_view(".summary.json").size();
  for (const Receiver& receiver : scene.output.receivers)
    ending = std::max(ending, receiver.name.size() + std::string_view("..wav").size());
  const std::size_t length = slug(scene.title).size() + ending + temporary;
  if (length > most)
    throw InputError(
        fmt::format("{}: title: with the names of receivers it makes names of files of {} bytes, more than "
                    "{}: shorten it",
                    scene.file.filename().string(), length, most));
}

/// Output and loads that a table or bodies at rest know nothing of.
void refuse_what_does_not_go(Table& root, const Scene& scene) {
  const bool table = scene.contact.kernel == ContactKernel::table;
  if (table && scene.output.snapshot_every > 0)
    root.table("output", output_keys())
        ->complain("snapshot_every", "contact.kernel = \"table\" has no modal coordinates: leave it out");
  if (table && scene.output.vtk_every > 0)
    root.table("output", output_keys())
        ->complain("vtk_every", "contact.kernel = \"table\" knows no motion of the bodies: leave it out");
  if (table && scene.accuracy)
    root.complain("accuracy", "errors of runs by contact.kernel = \"table\" are not estimated: leave it out");
  if (!table && scene.contact.scheme != Scheme::at_rest) return;
  const char* with = table ? "contact.kernel = \"table\"" : "contact.scheme = \"static\"";
  const Loads& loads = scene.loads;
  if (!loads.tractions.empty() || !loads.points.empty() || !loads.motions.empty())
    root.table("loads", loads_keys())
        ->complain("", fmt::format("{} takes gravity alone: leave the others out", with));
  if (!scene.output.receivers.empty())
    root.table("output", output_keys())->complain("receiver", fmt::format("{} has none: leave it out", with));
}

std::string text_of(const std::filesystem::path& file) {
  constexpr std::uintmax_t most = 4 << 20;
  std::error_code failure;
  if (!std::filesystem::is_regular_file(file, failure))
    throw InputError(fmt::format("{}: no such file", file.string()));
  if (std::filesystem::file_size(file, failure) > most)
    throw InputError(
        fmt::format("{}: has more than 4 MiB: it is no scene, name another file", file.string()));
  std::ifstream stream(file, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(stream), {});
  if (!stream) throw InputError(fmt::format("{}: cannot be read", file.string()));
  return text;
}

}  // namespace

const Body* Scene::find_body(const std::string& name) const {
  const auto found =
      std::find_if(bodies.begin(), bodies.end(), [&](const Body& body) { return body.name == name; });
  return found == bodies.end() ? nullptr : &*found;
}

const Obstacle* Scene::find_obstacle(const std::string& name) const {
  const auto found =
      std::find_if(obstacles.begin(), obstacles.end(), [&](const Obstacle& o) { return o.name == name; });
  return found == obstacles.end() ? nullptr : &*found;
}

namespace {

/// The tables of a scene's text, `name` of its file, with the overrides applied.
toml::table tables_of(const std::string& text, const std::string& name,
                      const std::vector<Override>& overrides) {
  toml::table parsed;
  try {
    parsed = parse_toml(text, name);
  } catch (const toml::parse_error& error) {
    throw InputError(one_line(fmt::format("{}:{}:{}: {}", name, error.source().begin.line,
                                          error.source().begin.column, error.description())));
  }
  for (const Override& override : overrides) apply_override(parsed, override);
  return parsed;
}

}  // namespace

Scene read(const std::filesystem::path& file, const std::vector<Override>& overrides, Purpose purpose) {
  return parse(text_of(file), file, overrides, purpose);
}

std::string overridden(const std::string& text, const std::filesystem::path& file,
                       const std::vector<Override>& overrides) {
  std::ostringstream out;
  out << toml::toml_formatter(tables_of(text, file.filename().string(), overrides));
  return out.str();
}

Scene parse(const std::string& text, const std::filesystem::path& file,
            const std::vector<Override>& overrides, Purpose purpose) {
  const std::string name = file.filename().string();
  const toml::table parsed = tables_of(text, name, overrides);
  Scene scene;
  scene.file = file;
  Table root(parsed, scene_keys(), name, "");
  scene.title = root.text("title").value_or(file.stem().string());
  scene.accuracy = root.number("accuracy");
  if (parsed["contact"]["table"]) {
    for (const char* key : {"bodies", "obstacles", "modes", "loads"})
      if (parsed.contains(key))
        root.complain(key,
                      "does not go with contact.table, a file that takes its place: leave one of them out");
    scene.contact = read_contact(root, scene);
    read_time(root, scene.contact, scene.accuracy, scene.time);
    read_output(root, scene);
    refuse_what_does_not_go(root, scene);
    refuse_long_names(scene);
    root.refuse_unknown();
    return scene;
  }
  auto bodies = root.table("bodies", body_keys());
  if (!bodies || bodies->raw().empty())
    root.complain("bodies", "is missing: a scene needs a body, [bodies.NAME]");
  for (auto& [body_name, table] : bodies->tables(body_keys()))
    scene.bodies.push_back(read_body(body_name, table, file.parent_path()));
  if (auto obstacles = root.table("obstacles", obstacle_keys()))
    for (auto& [obstacle_name, table] : obstacles->tables(obstacle_keys())) {
      Obstacle obstacle{obstacle_name, table.vector("point").value_or(Vector3{}), {}};
      const auto normal = table.direction("normal");
      if (!normal) table.complain("normal", "is missing: it points out of the obstacle");
      obstacle.normal = *normal;
      table.refuse_unknown();
      if (scene.find_body(obstacle_name) != nullptr) table.complain("", "a body has this name already");
      scene.obstacles.push_back(obstacle);
    }
  scene.modes = read_modes(root, scene.accuracy);
  refuse_what_needs_elements(root, scene);
  const bool meets = purpose == Purpose::impact || parsed.contains("contact");
  if (meets) scene.contact = read_contact(root, scene);
  if (!meets && scene.accuracy) root.complain("accuracy", "needs [contact]: leave it out, or add [contact]");
  if (purpose == Purpose::impact || parsed.contains("time"))
    read_time(root, scene.contact, scene.accuracy, scene.time);
  read_loads(root, scene);
  read_output(root, scene);
  refuse_what_does_not_go(root, scene);
  refuse_long_names(scene);
  root.refuse_unknown();
  if (!meets) {
    for (const Body& body : scene.bodies)
      if (body.contact.empty() && (scene.modes.basis == Basis::contact || scene.modes.flexibility_error))
        throw InputError(fmt::format(
            "{}: bodies.{}.contact: is missing: modes.basis = \"contact\" and modes.flexibility_error need a "
            "contact surface",
            name, body.name));
    return scene;
  }
  for (const Body& body : scene.bodies) {
    const bool paired = std::any_of(scene.contact.pairs.begin(), scene.contact.pairs.end(),
                                    [&](const Pair& p) { return p.a == body.name || p.b == body.name; });
    if (!paired)
      throw InputError(
          fmt::format("{}: bodies.{}: no contact pair names it: add it to contact.between or remove it", name,
                      body.name));
    if (body.contact.empty())
      throw InputError(fmt::format(
          "{}: bodies.{}.contact: is missing: name the physical surface that may touch", name, body.name));
  }
  return scene;
}

}  // namespace ricochet::scene
