// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/write.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "src/scene/body.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::scene {

std::string toml_number(double value) {
  if (value == 0) value = 0;  // not "-0"
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string toml_string(const std::string& text) {
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) < 32 || c == 127) {
      quoted += fmt::format("\\u{:04X}", static_cast<int>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string toml_vector(const Vector3& v) {
  return fmt::format("[{}, {}, {}]", toml_number(v[0]), toml_number(v[1]), toml_number(v[2]));
}

namespace {

std::string toml_quantities(const std::vector<Quantity>& quantities) {
  std::string text = "[";
  for (const Quantity quantity : quantities)
    text += fmt::format("{}\"{}\"", text.back() == '[' ? "" : ", ", name_of(quantity));
  return text + "]";
}

}  // namespace

std::string toml_refine(const std::vector<FineBall>& balls) {
  std::string text = "[";
  for (const FineBall& ball : balls)
    text += fmt::format("{}{{ at = {}, radius = {}, size = {} }}", text.back() == '[' ? "" : ", ",
                        toml_vector(ball.at), toml_number(ball.radius), toml_number(ball.size));
  return text + "]";
}

namespace {

std::string material_of(const Material& m) {
  std::string text = fmt::format("{{ density = {}, young = {}, poisson = {}", toml_number(m.density),
                                 toml_number(m.young), toml_number(m.poisson));
  if (m.area > 0) text += ", area = " + toml_number(m.area);
  if (m.yield > 0) text += ", yield = " + toml_number(m.yield);
  return text + " }";
}

std::string damping_of(const Damping& d) {
  if (d.law == Damping::Law::rayleigh)
    return fmt::format("{{ rayleigh = [{}, {}] }}", toml_number(d.first), toml_number(d.second));
  std::string text;
  for (const auto& [hertz, seconds] : d.table)
    text += fmt::format("{}[{}, {}]", text.empty() ? "" : ", ", toml_number(hertz), toml_number(seconds));
  for (const double factor : d.by_mode) text += (text.empty() ? "" : ", ") + toml_number(factor);
  if (!text.empty()) return fmt::format("{{ {} = [{}] }}", d.table.empty() ? "by_mode" : "t60", text);
  for (const auto& [key, law] : damping_laws)
    if (law == d.law) return fmt::format("{{ {} = {} }}", key, toml_number(d.first));
  return "{}";
}

}  // namespace

std::string toml_body_matter(const Body& body) {
  std::string text = "geometry = {";
  for (const auto& [name, value] : body.geometry)
    text += fmt::format("{} {} = {}", text.back() == '{' ? "" : ",", toml_string(name), toml_number(value));
  text += " }\n";
  if (!body.order_open) text += fmt::format("order = {}\n", body.order);
  if (body.size_factor != 1) text += fmt::format("size_factor = {}\n", toml_number(body.size_factor));
  if (!body.refine.empty()) text += "refine = " + toml_refine(body.refine) + "\n";
  text += fmt::format("scale = {}\n", toml_number(body.scale));
  if (body.materials.empty()) {
    text += "material = {}\n";
  } else if (body.materials.size() == 1 && body.materials[0].group.empty()) {
    text += "material = " + material_of(body.materials[0]) + "\n";
  } else {
    text += "material = {";
    for (const Material& m : body.materials)
      text += fmt::format("{} {} = {}", text.back() == '{' ? "" : ",", toml_string(m.group), material_of(m));
    text += " }\n";
  }
  text += "damping = " + damping_of(body.damping) + "\ncontact = [";
  for (std::size_t k = 0; k < body.contact.size(); ++k)
    text += fmt::format("{}{}", k > 0 ? ", " : "", toml_string(body.contact[k]));
  text += "]\nsupport = {";
  for (const auto& [group, components] : body.support)
    text += fmt::format("{} {} = \"{}\"", text.back() == '{' ? "" : ",", toml_string(group), components);
  return text + " }\n";
}

std::string toml_modes(const Modes& modes) {
  std::string text =
      fmt::format("[modes]\nbasis = \"{}\"\n", modes.basis == Basis::contact ? "contact" : "modes");
  if (modes.up_to) text += fmt::format("up_to_hz = {}\n", toml_number(modes.up_to->value));
  if (modes.count) text += fmt::format("count = {}\n", *modes.count);
  if (modes.flexibility_error)
    text += fmt::format("flexibility_error = {}\n", toml_number(*modes.flexibility_error));
  if (modes.solver != Modes{}.solver) text += fmt::format("solver = \"{}\"\n", modes.solver);
  if (modes.low_rank > 0) text += fmt::format("low_rank = {}\n", toml_number(modes.low_rank));
  if (modes.all_components) text += "residual_components = \"all\"\n";
  return text + fmt::format("residual_flexibility = {}\nrelative_residual = {}\n", modes.residual_flexibility,
                            toml_number(modes.relative_residual));
}

namespace {

/// The path relative to the folder of the scene.
std::string path_of(const Scene& scene, const std::filesystem::path& path) {
  const auto relative =
      path.lexically_relative(scene.file.parent_path().empty() ? "." : scene.file.parent_path());
  return toml_string((relative.empty() ? path : relative).string());
}

std::string toml_friction(const Friction& friction) {
  if (friction.static_coefficient == friction.dynamic_coefficient && friction.stribeck_velocity == 0)
    return toml_number(friction.static_coefficient);
  std::string text = fmt::format("{{ static = {}, dynamic = {}", toml_number(friction.static_coefficient),
                                 toml_number(friction.dynamic_coefficient));
  if (friction.stribeck_velocity > 0)
    text += ", stribeck_velocity = " + toml_number(friction.stribeck_velocity);
  return text + " }";
}

std::string scheme_of(const Contact& contact) {
  const Scheme scheme = contact.scheme;
  std::string text = fmt::format("scheme = \"{}\"\n", scheme == Scheme::impulse   ? "impulse"
                                                      : scheme == Scheme::at_rest ? "static"
                                                                                  : "compliant");
  if (scheme == Scheme::at_rest)
    text += fmt::format("solver = \"{}\"\n", contact.solver == Solver::uzawa ? "uzawa" : "exact");
  if (scheme == Scheme::compliant)
    text += fmt::format("integration = \"{}\"\n",
                        contact.integration == ContactStep::conserving ? "conserving" : "backward-euler");
  if (scheme == Scheme::impulse)
    text +=
        fmt::format("admittance = \"{}\"\ninstant = \"{}\"\nrestitution = {}\n",
                    contact.admittance == Admittance::jump ? "jump" : "difference",
                    contact.instant == Instant::step ? "step" : "exact", toml_number(contact.restitution));
  if (contact.max_pivots) text += fmt::format("max_pivots = {}\n", *contact.max_pivots);
  if (contact.increments != Contact{}.increments)
    text += fmt::format("increments = {}\n", contact.increments);
  return text;
}

std::string time_of(const Scene& scene) {
  std::string text;
  if (scene.time.duration > 0) {
    text += "\n[time]\n";
    if (!scene.time.rate_by_accuracy || scene.contact.has_contact_rate())
      text += fmt::format("rate_hz = {}\n", toml_number(scene.time.rate.value));
    if (scene.time.contact_rate)
      text += fmt::format("contact_rate_hz = {}\n", toml_number(scene.time.contact_rate->value));
    text += fmt::format("duration = {}\n", toml_number(scene.time.duration));
  }
  const auto& precision = scene.time.precision;
  if (precision == Precision::float32 || (precision && scene.accuracy && scene.time.duration > 0))
    text += fmt::format("precision = \"{}\"\n", precision == Precision::float32 ? "single" : "double");
  return text;
}

std::string loads_of(const Scene& scene) {
  std::string text = "\n[loads]\ngravity = " + toml_vector(scene.loads.gravity) + "\n";
  for (const auto& [table, list] :
       {std::pair{"traction", &scene.loads.tractions}, std::pair{"point", &scene.loads.points},
        std::pair{"motion", &scene.loads.motions}})
    for (const Forcing& driven : *list) {
      text += fmt::format("\n[[loads.{}]]\nname = {}\n", table, toml_string(driven.name));
      if (!driven.obstacle.empty())
        text += "obstacle = " + toml_string(driven.obstacle) + "\n";
      else
        text += fmt::format("body = {}\n{}\n", toml_string(driven.body),
                            list == &scene.loads.points ? "at = " + toml_vector(driven.at)
                                                        : "group = " + toml_string(driven.group));
      text += "vector = " + toml_vector(driven.vector) + "\n";
      if (!driven.history.empty()) text += "history = " + path_of(scene, driven.history) + "\n";
    }
  return text;
}

std::string sound_of(const Sound& sound) {
  std::string receivers;
  for (const std::string& name : sound.receivers)
    receivers += (receivers.empty() ? "" : ", ") + toml_string(name);
  const char* format = sample_format_names[static_cast<std::size_t>(sound.format)];
  return fmt::format(
      "\n[output.sound]\nreceivers = [{}]\ndirection = {}\nhigh_pass_hz = {}\nfade = {}\nformat = \"{}\"\n",
      receivers, toml_vector(sound.direction), toml_number(sound.high_pass_hz), toml_number(sound.fade),
      format);
}

std::string output_of(const Output& output) {
  std::string text = fmt::format("\n[output]\nevery = {}\nview = {}\nsnapshot_every = {}\nvtk_every = {}\n",
                                 output.every, output.view, output.snapshot_every, output.vtk_every);
  if (output.receivers_rate)
    text += fmt::format("receivers_rate_hz = {}\n", toml_number(output.receivers_rate->value));
  for (const Receiver& receiver : output.receivers)
    text += fmt::format("\n[[output.receiver]]\nname = {}\nbody = {}\nat = {}\n", toml_string(receiver.name),
                        toml_string(receiver.body), toml_vector(receiver.at));
  if (output.sound) text += sound_of(*output.sound);
  return text;
}

}  // namespace

std::string to_toml(const Scene& scene) {
  std::string text = fmt::format("title = {}\n", toml_string(scene.title));
  if (scene.accuracy)
    text += fmt::format("accuracy = {}\naccuracy_of = {}\n", toml_number(*scene.accuracy),
                        toml_quantities(scene.accuracy_of));
  if (!scene.contact.table.empty())
    return text + fmt::format(
                      "\n[contact]\nkernel = \"table\"\ntable = {}\n{}\n[time]\nrate_hz = {}\nduration = "
                      "{}\n\n[output]\nevery = {}\nview = {}\n",
                      path_of(scene, scene.contact.table), scheme_of(scene.contact),
                      toml_number(scene.time.rate.value), toml_number(scene.time.duration),
                      scene.output.every, scene.output.view);
  for (const Body& body : scene.bodies) {
    if (!body.copy_of.empty()) continue;
    text += fmt::format(
        "\n[bodies.{}]\nmesh = {}\n{}translate = {}\nrotate_deg = {}\nvelocity = {}\nangular_velocity = {}\n",
        body.name, path_of(scene, body.mesh), toml_body_matter(body), toml_vector(body.translate),
        toml_vector(body.rotate_deg), toml_vector(body.velocity), toml_vector(body.angular_velocity));
  }
  for (const Strike& strike : scene.strikes)
    text += fmt::format(
        "\n[[strikes]]\nmallet = {}\ntime = {}\nspeed = {}\ndirection = {}\ntranslate = {}\nrotate_deg = "
        "{}\n",
        toml_string(strike.mallet), toml_number(strike.time), toml_number(strike.speed),
        toml_vector(strike.direction), toml_vector(strike.translate), toml_vector(strike.rotate_deg));
  for (const Obstacle& o : scene.obstacles)
    text += fmt::format("\n[obstacles.{}]\npoint = {}\nnormal = {}\nvelocity = {}\n", toml_string(o.name),
                        toml_vector(o.point), toml_vector(o.normal), toml_vector(o.velocity));
  text += fmt::format("\n{}", toml_modes(scene.modes));
  if (scene.contact.pairs.empty()) return text + time_of(scene) + loads_of(scene) + output_of(scene.output);
  text += fmt::format("\n[contact]\nkernel = \"{}\"\n",
                      scene.contact.kernel == ContactKernel::table ? "table" : "modes");
  text += scheme_of(scene.contact);
  const auto copied = [&](const std::string& name) {
    const Body* const body = scene.find_body(name);
    return body != nullptr && !body->copy_of.empty();
  };
  for (const Pair& pair : scene.contact.pairs) {
    if (copied(pair.a) || copied(pair.b)) continue;
    text += fmt::format("\n[[contact.pair]]\nbetween = [{}, {}]\n", toml_string(pair.a), toml_string(pair.b));
    if (pair.direction) text += "direction = " + toml_vector(*pair.direction) + "\n";
    if (pair.along) text += "along = " + toml_vector(*pair.along) + "\n";
    if (pair.spacing) text += "spacing = " + toml_number(*pair.spacing) + "\n";
    if (pair.gap) text += "gap = " + toml_number(*pair.gap) + "\n";
    if (pair.reach) text += "reach = " + toml_number(*pair.reach) + "\n";
    if (pair.zone) text += "zone = " + toml_number(*pair.zone) + "\n";
    if (pair.friction) text += "friction = " + toml_friction(*pair.friction) + "\n";
  }
  return text + time_of(scene) + loads_of(scene) + output_of(scene.output);
}

}  // namespace ricochet::scene
