// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/read.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "src/scene/body.hpp"
#include "src/scene/contact.hpp"
#include "src/scene/keys.hpp"
#include "src/scene/loads.hpp"
#include "src/scene/modes.hpp"
#include "src/scene/motion.hpp"
#include "src/scene/output.hpp"
#include "src/scene/overrides.hpp"
#include "src/scene/scene_file.hpp"
#include "src/scene/strikes.hpp"

namespace ricochet::scene {

namespace {

bool read_quantities(const Table& table, const Key& key, Scene& scene) {
  std::vector<std::string> names;
  if (!table.read(key, names)) return false;
  scene.accuracy_of.clear();
  for (const std::string& name : names) {
    const auto found = std::ranges::find(quantity_names, name);
    if (found == quantity_names.end())
      table.complain("accuracy_of", fmt::format("there is no quantity \"{}\": the quantities are {}", name,
                                                fmt::join(quantity_names, ", ")));
    scene.accuracy_of.push_back(static_cast<Quantity>(found - quantity_names.begin()));
  }
  return true;
}

std::string quantities_of(const Scene& scene) {
  if (!scene.accuracy) return "";
  std::vector<std::string> names;
  for (const Quantity quantity : scene.accuracy_of) names.emplace_back(name_of(quantity));
  return toml_value(names);
}

}  // namespace

const SectionOf<Scene> scene_keys{
    "Top level",
    "",
    {{"title", &Scene::title, "", "the file's name without `.toml`", any(),
      "title of the pictures; the names of the result files are made from it"},
     {"accuracy", &Scene::accuracy, "1",
      toml_number(default_accuracy) + " if `modes` are left open, otherwise none",
      Range{.low = "1e-6",
            .high = "0.5",
            .choices = {"off"},
            .remark = ": the relative error that results may have"},
      "relative error allowed in the quantities of `accuracy_of`; `ricochet-kernel` and `ricochet-contact` "
      "choose the settings that the scene leaves open. With finite rotation, they serve the [first "
      "touch](scene.md#bodies-that-turn). `\"off\"`: nothing is chosen, and no error is estimated"},
     {"accuracy_of", Access(Type::texts, read_quantities, quantities_of), "", "`[\"impulse\", \"rebound\"]`",
      any(),
      "quantities to which `accuracy` applies: some of `\"impulse\"`, `\"rebound\"`, `\"spin\"`, "
      "`\"peak_force\"`, `\"duration\"`, `\"energy\"` and `\"receivers\"`, or their only name. At rest: "
      "`\"force\"` and `\"approach\"`, always both"},
     {"settings", Access(&Scene::settings).if_changed(), "", "a file for all impacts of these bodies", any(),
      "with `accuracy`: the file of the settings chosen, `NAME.settings.toml`, in the folder of the kernels. "
      "Impacts that need settings of their own have files of their own, as the [groups of a "
      "study](studies.md#studies-with-accuracy)"},
     {"bodies", Type::table, "", required(), any(),
      "`[bodies.NAME]`, one table for each elastic body. NAME consists of letters, digits, `-` and `_`. A "
      "scene with a `contact.table` has no bodies",
      "[bodies.NAME], one table for each body"},
     {"obstacles", Type::table, "", none, any(), "`[obstacles.NAME]`, rigid half-spaces",
      "[obstacles.NAME], with normal = [0, 0, 1]"},
     {"modes", Type::table, "", required(), any(),
      "basis of every body: which modes, or which Ritz vectors. Optional unless `accuracy = \"off\"`",
      "[modes], with up_to_hz or count"},
     {"contact", Type::table, "", required(), any(),
      "contact pairs and contact law. Optional for kernels and modes",
      "[contact], with between; several pairs are [[contact.pair]]"},
     {"motion", Type::table, "", none, any(), "how free bodies move as a whole",
      "[motion], with rotation = \"finite\""},
     {"time", Type::table, "", required(), any(),
      "time step and duration. Optional for kernels and modes, and with `scheme = \"static\"`",
      "[time], with duration"},
     {"loads", Type::table, "", none, any(), "gravity, tractions, point forces, moving supports",
      "[loads], with gravity = [0, 0, -9.81]"},
     {"strikes", Type::tables, "", none, any(), "`[[strikes]]`, blows by mallets"},
     {"output", Type::table, "", none, any(), "what is written, and receivers",
      "[output], with its keys below"}}};

namespace {

/// Sets the duration, or its bound if the run ends when bodies have parted.
bool read_duration(const Table& table, const Key& key, Time& time) {
  if (table.read(key, time.duration)) return true;
  time.until_parted = table.has(key.name);
  if (time.until_parted) time.duration = default_longest;
  return time.until_parted;
}

std::string duration_of(const Time& time) {
  return time.until_parted ? toml_string(duration_until_parted) : toml_value(time.duration);
}

/// Whether the run may last until bodies have parted.
bool may_wait(const Time& time) { return time.until_parted; }

}  // namespace

const SectionOf<Time> time_keys{
    "[time]",
    "",
    {{"rate_hz", &Time::rate_hz, "Hz", "`44100.0`, or fewer, chosen by `accuracy` without receivers",
      above("0"),
      "output samples per second. In free flight, steps go from sample to sample. With scheme = `impulse` "
      "and with sampled responses, also the steps per second; `impulse` with `accuracy` chooses it"},
     {"contact_rate_hz", &Time::contact_rate_hz, "Hz", "rate_hz, or chosen by `accuracy`", above("0"),
      "steps per second while a point could close, rounded up to a multiple of rate_hz. Needs `scheme = "
      "\"compliant\"` and `kernel = \"modes\"`"},
     {"duration", Access(Type::number, read_duration, duration_of), "s", required(),
      Range{.low = "0", .low_open = true, .choices = {duration_until_parted}},
      "simulated time. duration · rate_hz is rounded to a whole number of samples, from 1 to 1e9. `\"until "
      "parted\"`: the run ends [when bodies have touched and parted](scene.md#when-a-run-ends)"},
     {"longest",
      Access<Time>(
          Type::number,
          [](const Table& table, const Key& key, Time& time) { return table.read(key, time.duration); },
          [](const Time& time) { return toml_value(time.duration); })
          .only(may_wait, "duration = \"until parted\""),
      "s", '`' + toml_value(default_longest) + '`', above("0"),
      "with `duration = \"until parted\"`: the simulated time at most. A warning reports a run that ends "
      "there while bodies touch"},
     {"precision", choice<Time>(&Time::precision, {"double", "single"}), "", ", or chosen by `accuracy`",
      any(),
      "`\"single\"`: matrix products of the steps in single precision, which is faster with many points. "
      "Needs `scheme = \"compliant\"` and `kernel = \"modes\"`"}}};

namespace {

void read_time(const Table& root, Scene& scene) {
  const Contact& contact = scene.contact;
  Time& time = scene.time;
  const auto table = root.table("time", time_keys);
  if (!table && contact.scheme == Scheme::at_rest) return;
  if (!table) root.complain("time", "is missing: give duration [s]");
  time_keys.read(*table, time);
  const bool steps_by_modes = contact.has_contact_rate();
  if (time.until_parted && contact.scheme == Scheme::at_rest)
    table->complain("duration", "bodies at rest do not part: leave it out");
  if (time.until_parted && contact.kernel == ContactKernel::table)
    table->complain(
        "duration",
        "contact.kernel = \"table\" needs to know how long its responses are: give it in seconds");
  if (time.contact_rate_hz && !steps_by_modes)
    table->complain("contact_rate_hz",
                    "belongs to scheme = \"compliant\" and kernel = \"modes\": give rate_hz alone");
  if (time.contact_rate_hz && *time.contact_rate_hz > most_steps_per_sample * time.rate_hz)
    table->complain("contact_rate_hz", fmt::format("is above {:g} times rate_hz = {:g}: raise rate_hz",
                                                   most_steps_per_sample, time.rate_hz));
  time.rate_by_accuracy = scene.accuracy && !table->has(steps_by_modes ? "contact_rate_hz" : "rate_hz");
  const bool is_open = time.rate_by_accuracy && !steps_by_modes;
  const double samples = is_open ? 1 : time.duration * time.rate_hz;
  if (samples < 1 || samples > 1e9)
    table->complain(time.until_parted ? "longest" : "duration",
                    fmt::format("makes {:.3g} samples at rate_hz = {:g}: must be from 1 to 1e9: change {}",
                                samples, time.rate_hz, time.until_parted ? "either" : "rate_hz"));
  if (time.precision == Precision::float32 && !steps_by_modes)
    table->complain("precision", "belongs to scheme = \"compliant\" and kernel = \"modes\": leave it out");
  time.samples_by_accuracy = time.rate_by_accuracy && steps_by_modes && !table->has("rate_hz");
  time.precision_by_accuracy = scene.accuracy && steps_by_modes && !table->has("precision");
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
void refuse_what_needs_elements(const Table& root, const Scene& scene) {
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
void refuse_unnumbered_modes(const Table& root, const Scene& scene) {
  if (scene.modes.basis == Basis::modes && !scene.modes.flexibility_error && !scene.modes.open()) return;
  for (const Body& body : scene.bodies)
    if (body.damping.law == Damping::Law::by_mode)
      root.complain(fmt::format("bodies.{}.damping.by_mode", body.name),
                    "needs numbered modes: set modes.basis = \"modes\" with up_to_hz or count, without "
                    "flexibility_error, or give t60");
}

/// Refuses a file of settings that is not in the folder of the kernels, or without accuracy.
void check_settings_file(const Table& root, const Scene& scene) {
  if (scene.settings.empty()) return;
  if (!scene.accuracy && !root.has("accuracy"))
    root.complain("settings", "belongs to accuracy: leave it out, or give an accuracy");
  constexpr std::string_view ending = ".settings.toml";
  if (scene.settings.find('/') != std::string::npos || scene.settings.size() <= ending.size() ||
      !scene.settings.ends_with(ending))
    root.complain("settings", fmt::format("is \"{}\": give the name of a file in the folder of the kernels, "
                                          "NAME{}",
                                          scene.settings, ending));
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
void refuse_what_does_not_go(const Table& root, const Scene& scene) {
  const bool table = scene.contact.kernel == ContactKernel::table;
  if (table && scene.output.snapshot_every > 0)
    root.complain("output.snapshot_every",
                  "contact.kernel = \"table\" has no modal coordinates: leave it out");
  if (table && scene.output.vtk_every > 0)
    root.complain("output.vtk_every",
                  "contact.kernel = \"table\" gives no motion of the bodies: leave it out");
  if (table && scene.accuracy)
    root.complain("accuracy", "errors of runs by contact.kernel = \"table\" are not estimated: leave it out");
  if (table && !scene.output.gauges.empty())
    root.complain("output.gauge", "contact.kernel = \"table\" gives no stress of the bodies: leave it out");
  if (table && scene.output.stress)
    root.complain("output.stress", "contact.kernel = \"table\" gives no stress of the bodies: leave it out");
  if (!table && scene.contact.scheme != Scheme::at_rest) return;
  const char* with = table ? "contact.kernel = \"table\"" : "contact.scheme = \"static\"";
  const Loads& loads = scene.loads;
  if (table && (!loads.tractions.empty() || !loads.points.empty() || !loads.motions.empty()))
    root.complain("loads", fmt::format("{} allows gravity only: leave the other loads out", with));
  if (!scene.output.receivers.empty())
    root.complain("output.receiver", fmt::format("{} allows none: leave it out", with));
}

/// Refuses bodies without the contact that the scene needs.
/// @param meets  whether the scene has contact
void refuse_idle_bodies(const Scene& scene, bool meets) {
  const std::string name = scene.file.filename().string();
  for (const Body& body : scene.bodies) {
    if (meets &&
        std::ranges::none_of(scene.contact.pairs, [&](const Pair& pair) { return pair.names(body.name); }))
      throw InputError(
          fmt::format("{}: bodies.{}: no contact pair names it: add it to contact.between or remove it", name,
                      body.name));
    if (!body.contact.empty()) continue;
    const std::string missing = fmt::format("{}: bodies.{}.contact: is missing: ", name, body.name);
    if (meets) throw InputError(missing + "name the physical surface that may touch");
    if (scene.modes.basis == Basis::contact || scene.modes.flexibility_error)
      throw InputError(missing +
                       "modes.basis = \"contact\" and modes.flexibility_error need a contact surface");
  }
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
  scene.title = file.stem().string();
  const Table root(parsed, scene_keys, file);
  scene_keys.read(root, scene);
  const bool off = root.has("accuracy") && !scene.accuracy;
  const bool by_table = static_cast<bool>(parsed["contact"]["table"]);
  const bool meets = purpose == Purpose::impact || root.has("contact");
  if (by_table) {
    for (const char* key : {"bodies", "obstacles", "modes", "loads", "strikes"})
      if (root.has(key)) root.complain(key, replaced_by_table);
  } else {
    read_bodies(root, scene);
    scene.modes = read_modes(root, meets && !off);
    refuse_what_needs_elements(root, scene);
    refuse_unnumbered_modes(root, scene);
    if (scene.modes.open() && !scene.accuracy) scene.accuracy = default_accuracy;
    find_open(scene);
  }
  if (meets) scene.contact = read_contact(root, scene);
  const char* no_contact = "needs [contact]: leave it out, or add [contact]";
  if (!meets && scene.accuracy) root.complain("accuracy", no_contact);
  check_settings_file(root, scene);
  if (!meets && root.has("strikes")) root.complain("strikes", no_contact);
  if (purpose == Purpose::impact || by_table || root.has("time")) read_time(root, scene);
  read_loads(root, scene);
  read_output(root, scene);
  if (!scene.output.receivers.empty() || !scene.output.gauges.empty()) scene.time.samples_by_accuracy = false;
  read_motion(root, scene);
  refuse_what_does_not_go(root, scene);
  refuse_long_names(scene);
  if (meets) read_strikes(root, scene);
  refuse_idle_bodies(scene, meets);
  return scene;
}

}  // namespace ricochet::scene
