// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/read.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "src/scene/body.hpp"
#include "src/scene/contact.hpp"
#include "src/scene/loads.hpp"
#include "src/scene/modes.hpp"
#include "src/scene/overrides.hpp"
#include "src/scene/scene_file.hpp"
#include "src/scene/strikes.hpp"
#include "src/scene/table.hpp"

namespace ricochet::scene {

namespace {

/// Reads bodies and obstacles.
void read_bodies(Table& root, Scene& scene) {
  auto bodies = root.named("bodies", body_keys);
  if (bodies.empty()) root.complain("bodies", "is missing: a scene needs a body, [bodies.NAME]");
  std::vector<std::string> names;
  for (const auto& [name, table] : bodies) names.push_back(name);
  for (auto& [name, table] : bodies)
    scene.bodies.push_back(read_body(name, table, names, scene.file.parent_path()));
  for (auto& [name, table] : root.named("obstacles", obstacle_keys)) {
    Obstacle obstacle{name, table.vector("point").value_or(Vector3{}), {}, {}};
    obstacle.normal = table.required("normal", table.direction("normal"),
                                     "the direction out of the obstacle, for example [0, 0, 1]");
    obstacle.velocity = table.vector("velocity").value_or(Vector3{});
    if (const double along = along_normal(obstacle, obstacle.velocity); along != 0)
      table.complain("velocity", fmt::format("has the component {:.6g} m/s along the normal: an obstacle "
                                             "moves along its surface; leave this component out",
                                             along));
    table.refuse_unread();
    if (scene.find_body(name) != nullptr) table.complain("", "a body has this name already");
    scene.obstacles.push_back(obstacle);
  }
}

void read_time(Table& root, const Contact& contact, const std::optional<double>& accuracy, Time& time) {
  auto table = root.table("time", time_keys);
  if (!table && contact.scheme == Scheme::at_rest) return;
  if (!table) root.complain("time", "is missing: give duration [s]");
  const auto rate = table->number("rate_hz"), contact_rate = table->number("contact_rate_hz");
  if (rate) time.rate = Hertz{*rate};
  if (contact_rate) {
    if (!contact.has_contact_rate())
      table->complain("contact_rate_hz",
                      "belongs to scheme = \"compliant\" and kernel = \"modes\": give rate_hz alone");
    if (*contact_rate > most_steps_per_sample * time.rate.value)
      table->complain("contact_rate_hz", fmt::format("is above {:g} times rate_hz = {:g}: raise rate_hz",
                                                     most_steps_per_sample, time.rate.value));
    time.contact_rate = Hertz{*contact_rate};
  }
  time.rate_by_accuracy = accuracy && !(contact.has_contact_rate() ? contact_rate : rate);
  time.duration = table->required_number("duration");
  const bool is_open = time.rate_by_accuracy && !contact.has_contact_rate();
  const double samples = is_open ? 1 : time.duration * time.rate.value;
  if (samples < 1 || samples > 1e9)
    table->complain(
        "duration",
        fmt::format("makes {:.3g} samples at rate_hz = {:g}: must be from 1 to 1e9: change rate_hz", samples,
                    time.rate.value));
  const bool steps_by_modes = contact.has_contact_rate();
  const auto precision = table->text("precision");
  if (precision == "single" && !steps_by_modes)
    table->complain("precision", "belongs to scheme = \"compliant\" and kernel = \"modes\": leave it out");
  if (precision == "single") time.precision = Precision::float32;
  if (!precision && accuracy && steps_by_modes) time.precision.reset();
  table->refuse_unread();
}

void read_output(Table& root, Scene& scene) {
  Output& output = scene.output;
  auto table = root.table("output", output_keys);
  if (!table) return;
  if (const auto every = table->integer("every")) output.every = static_cast<int>(*every);
  const auto view = table->boolean("view");
  output.vtk_every = table->integer("vtk_every").value_or(output.vtk_every);
  if (output.vtk_every > 0 && view && !*view)
    table->complain("view", "vtk_every needs the visualisation surfaces: leave view out, or set it to true");
  output.view = view.value_or(output.vtk_every > 0);
  output.snapshot_every = table->integer("snapshot_every").value_or(output.snapshot_every);
  if (const auto rate = table->number("receivers_rate_hz")) {
    const double samples = scene.time.rate.value / *rate;
    if (scene.time.duration > 0 && !(samples >= 1 && samples <= most_samples_per_receiver_row))
      table->complain("receivers_rate_hz", fmt::format("must be from rate_hz / {} to rate_hz = {:g}",
                                                       most_samples_per_receiver_row, scene.time.rate.value));
    output.receivers_rate = Hertz{*rate};
  }
  output.receivers = read_receivers(*table, scene);
  output.sound = read_sound(*table, output.receivers);
  if (output.receivers_rate && output.receivers.empty())
    table->complain("receivers_rate_hz", "needs [[output.receiver]]: add one, or leave it out");
  table->refuse_unread();
}

void read_accuracy_of(Table& root, Scene& scene) {
  const std::vector<std::string> names = root.texts("accuracy_of");
  if (names.empty()) return;
  scene.accuracy_of.clear();
  for (const std::string& name : names) {
    const auto found = std::ranges::find(quantity_names, name);
    if (found == quantity_names.end())
      root.complain("accuracy_of", fmt::format("there is no quantity \"{}\": the quantities are {}", name,
                                               fmt::join(quantity_names, ", ")));
    scene.accuracy_of.push_back(static_cast<Quantity>(found - quantity_names.begin()));
  }
}

/// Decides which settings of meshes are chosen for the accuracy: the order if a scene does not give it, and
/// with it the size of elements if the scene does not give it either.
void find_open(Scene& scene) {
  for (Body& body : scene.bodies) {
    body.order_open = body.order_open && scene.accuracy && body.meshable();
    body.refine_open =
        body.order_open && body.size_factor == 1 && body.geometry.empty() && body.refine.empty();
    body.size_open = body.refine_open;
  }
}

/// Refuses settings of modes that need elements or a wave speed: an imported body has neither.
void refuse_what_needs_elements(Table& root, const Scene& scene) {
  const Modes& modes = scene.modes;
  for (const Body& body : scene.bodies) {
    if (!body.imported()) continue;
    if (modes.open())
      root.complain("modes",
                    fmt::format("is missing: accuracy cannot choose modes for bodies.{}, a body file: "
                                "give up_to_hz or count",
                                body.name));
    if (modes.low_rank > 0)
      root.complain("modes.low_rank",
                    fmt::format("is not possible with bodies.{}, a body file: leave it out", body.name));
  }
}

/// Refuses damping by mode if the basis leaves no mode its number.
void refuse_unnumbered_modes(Table& root, const Scene& scene) {
  if (scene.modes.basis == Basis::modes && !scene.modes.flexibility_error && !scene.modes.open()) return;
  for (const Body& body : scene.bodies)
    if (body.damping.law == Damping::Law::by_mode)
      root.complain(fmt::format("bodies.{}.damping.by_mode", body.name),
                    "needs numbered modes: set modes.basis = \"modes\" with up_to_hz or count, without "
                    "flexibility_error, or give t60");
}

/// Refuses names longer than the 255 bytes that file systems allow. The longest names are those of temporary
/// files, "<name>.<process>.partial".
void refuse_long_names(const Scene& scene) {
  constexpr std::size_t most = 255, temporary = 16;
  std::size_t ending = std::string_view(".summary.json").size();
  for (const Receiver& receiver : scene.output.receivers)
    ending = std::max(ending, receiver.name.size() + std::string_view("..wav").size());
  const std::size_t length = slug(scene.title).size() + ending + temporary;
  if (length > most)
    throw InputError(
        fmt::format("{}: title: with the names of receivers, it gives file names of {} bytes, more than "
                    "{}: shorten it",
                    scene.file.filename().string(), length, most));
}

/// Refuses outputs and loads that do not exist with tables or at equilibrium.
void refuse_what_does_not_go(Table& root, const Scene& scene) {
  const bool table = scene.contact.kernel == ContactKernel::table;
  if (table && scene.output.snapshot_every > 0)
    root.complain("output.snapshot_every",
                  "contact.kernel = \"table\" has no modal coordinates: leave it out");
  if (table && scene.output.vtk_every > 0)
    root.complain("output.vtk_every",
                  "contact.kernel = \"table\" gives no motion of the bodies: leave it out");
  if (table && scene.accuracy)
    root.complain("accuracy", "errors of runs by contact.kernel = \"table\" are not estimated: leave it out");
  if (!table && scene.contact.scheme != Scheme::at_rest) return;
  const char* with = table ? "contact.kernel = \"table\"" : "contact.scheme = \"static\"";
  const Loads& loads = scene.loads;
  if (table && (!loads.tractions.empty() || !loads.points.empty() || !loads.motions.empty()))
    root.complain("loads", fmt::format("{} allows gravity only: leave the other loads out", with));
  if (!scene.output.receivers.empty())
    root.complain("output.receiver", fmt::format("{} allows none: leave it out", with));
}

/// The tables of a scene with overrides. `name` is the name of its file.
toml::table overridden_tables(const std::string& text, const std::string& name,
                              const std::vector<Override>& overrides) {
  toml::table parsed = tables_of(text, name);
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
  out << toml::toml_formatter(overridden_tables(text, file.filename().string(), overrides));
  return out.str();
}

Scene parse(const std::string& text, const std::filesystem::path& file,
            const std::vector<Override>& overrides, Purpose purpose) {
  const std::string name = file.filename().string();
  const toml::table parsed = overridden_tables(text, name, overrides);
  Scene scene;
  scene.file = file;
  Table root(parsed, scene_keys, name, "");
  root.refuse_unknown();
  scene.title = root.text("title").value_or(file.stem().string());
  scene.accuracy = root.number("accuracy");
  const bool off = parsed["accuracy"].is_string();
  read_accuracy_of(root, scene);
  const bool by_table = static_cast<bool>(parsed["contact"]["table"]);
  const bool meets = purpose == Purpose::impact || parsed.contains("contact");
  if (by_table) {
    for (const char* key : {"bodies", "obstacles", "modes", "loads", "strikes"})
      if (parsed.contains(key)) root.complain(key, "is replaced by contact.table: leave one of them out");
  } else {
    read_bodies(root, scene);
    scene.modes = read_modes(root, meets && !off);
    refuse_what_needs_elements(root, scene);
    refuse_unnumbered_modes(root, scene);
    if (scene.modes.open() && !scene.accuracy) scene.accuracy = default_accuracy;
    find_open(scene);
  }
  if (meets) scene.contact = read_contact(root, scene);
  if (!meets && scene.accuracy) root.complain("accuracy", "needs [contact]: leave it out, or add [contact]");
  if (purpose == Purpose::impact || by_table || parsed.contains("time"))
    read_time(root, scene.contact, scene.accuracy, scene.time);
  read_loads(root, scene);
  read_output(root, scene);
  refuse_what_does_not_go(root, scene);
  refuse_long_names(scene);
  if (meets) read_strikes(root, scene);
  root.refuse_unread();
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
    if (std::ranges::none_of(scene.contact.pairs, [&](const Pair& pair) { return pair.names(body.name); }))
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
