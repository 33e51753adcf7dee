#include "src/scene/keys.hpp"

#include <algorithm>

#include "src/scene/scene.hpp"
#include "src/scene/write.hpp"

namespace ricochet::scene {

namespace {

const char* const required = "–";
const char* const none = "none";

Range any() { return {}; }
Range above(const char* low) { return {.low = low, .low_open = true}; }
Range at_least(const char* low) { return {.low = low}; }
Range from_to(const char* low, const char* high, const char* remark = "") {
  return {.low = low, .high = high, .remark = remark};
}
Range one_of(std::vector<std::string> choices) { return {.choices = std::move(choices)}; }

/// A default, as a scene would say it.
std::string shown(const std::string& text) { return '`' + text + '`'; }
std::string shown(const char* choice) { return shown(toml_string(choice)); }
std::string shown(double number) { return shown(toml_number(number)); }
std::string shown(std::int64_t number) { return shown(std::to_string(number)); }
std::string shown(int number) { return shown(std::int64_t{number}); }
std::string shown(bool on) { return shown(std::string(on ? "true" : "false")); }
std::string shown(const Vector3& vector) { return shown(toml_vector(vector)); }

/// A section's keys with those of another behind.
Section joined(Section section, const Section& more) {
  section.keys.insert(section.keys.end(), more.keys.begin(), more.keys.end());
  return section;
}

Key body_of_source() { return {"body", Type::text, "", required, any(), "name of a body"}; }

Key vector_of_source(const char* unit, const char* meaning) {
  return {"vector", Type::vector, unit, required, any(), meaning};
}

Key history_of_source() {
  return {"history", Type::text,
          "",        none,
          any(),     "CSV file of times [s] and factors of `vector`; without one, constant from t = 0 on"};
}

Key name_of_source(const char* fallback) {
  return {"name",
          Type::text,
          "",
          fallback,
          any(),
          "not of another load or motion of the body, nor `body_force`, `body_force_residual` or `rotation`; "
          "no `/`"};
}

Key place_of_source(const char* what) {
  return {
      "at",
      Type::vector,
      "m",
      required,
      any(),
      std::string(what) +
          ", world axes, with the bodies as `translate` and `rotate_deg` place them. Inside the body or on "
          "its surface; up to 1e-6 of the body's size outside is moved onto it, more is refused with the "
          "distance"};
}

}  // namespace

const Section& scene_keys() {
  static const Section section{
      "Top level",
      "",
      {{"title", Type::text, "", "the file's name without `.toml`", any(),
        "title of pictures; names the result files"},
       {"accuracy", Type::number, "1", none,
        from_to("1e-6", "0.5", ", the relative error that results may have"),
        "relative error that the main results may have: chooses what the scene leaves open"},
       {"bodies", Type::table, "", required, any(),
        "`[bodies.NAME]`, one for each elastic body, none beside a `contact.table`; NAME of letters, digits, "
        "`-` and `_`"},
       {"obstacles", Type::table, "", none, any(), "`[obstacles.NAME]`, rigid half-spaces"},
       {"modes", Type::table, "", required, any(),
        "(none with `accuracy`) which modes to keep, or what vectors to fit; the same of every body"},
       {"contact", Type::table, "", required, any(), "who meets whom, and how"},
       {"time", Type::table, "", required, any(), "step and duration; `scheme = \"static\"` needs none"},
       {"loads", Type::table, "", none, any(), "gravity, tractions, point forces, supports that move"},
       {"output", Type::table, "", none, any(), "what to write; receivers"}}};
  return section;
}

const Section& body_keys() {
  static const Body body;
  static const Section section{
      "[bodies.NAME]",
      "An elastic body.",
      {{"mesh", Type::text, "", required, any(),
        "`.msh` is read as it is; `.geo`, `.step`, `.brep` are meshed by the gmsh library; `.h5` is a [body "
        "file](interchange.md#bodies-from-another-finite-element-program) of another program"},
       {"geometry", Type::numbers, "", "`{}`", any(),
        "values of the `DefineConstant` names of a `.geo`; refused for other files and for names that the "
        "`.geo` does not define"},
       {"order", Type::integer, "", shown(body.order), from_to("1", "10"),
        "element order of what gmsh meshes; a `.msh` keeps its own"},
       {"scale", Type::number, "1", shown(body.scale), above("0"),
        "factor on all coordinates of the mesh (0.001 for a drawing in millimetres)"},
       {"rotate_deg", Type::vector, "degrees", shown(body.rotate_deg), any(),
        "turns about the fixed axes x, then y, then z, through the mesh's origin"},
       {"translate", Type::vector, "m", shown(body.translate), any(), "after scale and rotation"},
       {"material", Type::table, "", required, any(),
        "(none beside a body file) one table for the whole body, or a table for each physical volume (line, "
        "for a rod), named after "
        "it"},
       {"damping", Type::table, "", "`{}`", any(), "one law; none without"},
       {"velocity", Type::vector, "m/s", shown(body.velocity), any(),
        "initial, the same in the whole body, world axes. A supported body can't have one that its supports "
        "hold; a rod moves along its axis alone"},
       {"contact", Type::texts, "", required, any(),
        "physical surface that may touch (physical point for a rod), or a list of them"},
       {"support", Type::strings, "", "`{}`", any(),
        "physical group (surface, curve, point or volume) → held components, some of `\"xyz\"`, in the axes "
        "of "
        "the mesh (before `rotate_deg`). A rod is held if a named component has a share in its axis"}}};
  return section;
}

const Section& material_keys() {
  static const Material material;
  static const Section section{"[bodies.NAME.material]",
                               "Linear, isotropic; with several materials `[bodies.NAME.material.GROUP]`.",
                               {{"density", Type::number, "kg/m³", required, above("0"), "mass by volume"},
                                {"young", Type::number, "Pa", required, above("0"), "Young's modulus"},
                                {"poisson", Type::number, "1", shown(material.poisson),
                                 Range{.low = "-1",
                                       .high = "0.5",
                                       .low_open = true,
                                       .high_open = true,
                                       .remark = ". Nearly incompressible: try 0.49."},
                                 "Poisson's ratio; a rod does not use it. Above 0.45 it takes `order` 2 or "
                                 "more: linear elements lock, and a warning says so"},
                                {"area", Type::number, "m²", none, above("0"),
                                 "cross-section; a rod needs it, other bodies do not use it"}}};
  return section;
}

const Section& damping_keys() {
  static const Section section{
      "[bodies.NAME.damping]",
      "One of these laws for the decay rate δ = ζω of a mode of angular frequency ω.",
      {{"ratio", Type::number, "1", none, at_least("0"), "δ = ratio · ω: ζ, the same for every mode"},
       {"loss_factor", Type::number, "1", none, at_least("0"), "δ = loss_factor · ω / 2"},
       {"viscosity", Type::number, "s", none, at_least("0"), "δ = viscosity · ω² / 2 (Kelvin–Voigt)"},
       {"rayleigh", Type::pair, "[1/s, s]", none, any(),
        "[α, β]: δ = (α + β ω²) / 2; α damps rigid motion too"}}};
  return section;
}

const Section& obstacle_keys() {
  static const Obstacle obstacle;
  static const Section section{
      "[obstacles.NAME]",
      "A rigid half-space that can take the place of a body in a pair.",
      {{"point", Type::vector, "m", shown(obstacle.point), any(), "a point of its surface"},
       {"normal", Type::direction, "", required, any(), "out of the obstacle"}}};
  return section;
}

const Section& modes_keys() {
  static const Modes modes;
  static const Section section{
      "[modes]",
      "",
      {{"basis", Type::text, "", shown("modes"), one_of({"modes", "contact"}),
        "`\"modes\"`: the body's modes, certified. `\"contact\"`: vectors fitted to what contact can excite"},
       {"up_to_hz", Type::number, "Hz", none, above("0"),
        "all modes up to this frequency; with `flexibility_error` or `basis = \"contact\"`, the end of the "
        "band in which the contact surface has to respond rightly"},
       {"count", Type::integer, "", none, at_least("1"),
        "rigid modes included. Modes: the lowest ones; a multiple mode at the end is taken whole. Vectors: "
        "so "
        "many, whatever error they make"},
       {"flexibility_error", Type::number, "1", "1e-3 for vectors without `count`, else none",
        from_to("1e-6", "0.5"),
        "relative error that the flexibility of the contact surface may have over the band"},
       {"residual_flexibility", Type::boolean, "", shown(modes.residual_flexibility), any(),
        "keep the static flexibility of what is left out"},
       {"relative_residual", Type::number, "1", shown(modes.relative_residual), from_to("1e-14", "1e-2"),
        "bound on ‖Kφ − ω²Mφ‖ / ‖Kφ‖ of each mode; a mode above it is an error, unless round-off alone "
        "explains it. Vectors are not held to it"},
       {"approximate", Type::integer, "", shown(modes.approximate),
        from_to("0", "5", " block iterations (0: certified modes)"),
        "basis \"modes\" with `up_to_hz` or `count` alone: so many block iterations from the modes of the "
        "next "
        "lower element order take the place of the certified search; 0: certified modes. Needs elements of "
        "order 2 or more"},
       {"low_rank", Type::number, "1", shown(modes.low_rank),
        Range{.low = "1e-12", .high = "1e-3", .or_zero = true},
        "basis \"contact\" alone: threshold of MUMPS's block low-rank factors; 0: full rank. Less memory on "
        "large solid bodies; solves are right to about this, so keep it well below `flexibility_error`. It "
        "proves no count, so `\"modes\"` refuse it"}}};
  return section;
}

const Section& pair_keys() {
  static const Section section{
      "[[contact.pair]]",
      "Several pairs; what one does not say it takes from `[contact]`.",
      {{"between", Type::texts, "", required, any(),
        "two bodies, or a body and an obstacle, by name. Body \"a\" below is the first one (the body, "
        "against "
        "an obstacle)"},
       {"direction", Type::direction, "", none, any(),
        "fixes every contact normal: out of the first of `between`, world axes. Without it each point has "
        "the "
        "mutual normal (n_a − n_b)/|n_a − n_b|. Against an obstacle it can only lie along the obstacle's "
        "normal, towards the other of the two"},
       {"along", Type::direction, "", none, any(),
        "one candidate for all of the contact surface that lies on a line in this direction, world axes. "
        "Each "
        "line should meet the surface on one side of the body only"},
       {"spacing", Type::number, "m", none, above("0"),
        "candidates no closer than this. Without it: one at each node of the contact surface"},
       {"gap", Type::number, "m", none, at_least("0"),
        "moves body a along `direction` (or the mean normal) until the closest pair is this far apart, as "
        "means over the patches"},
       {"reach", Type::number, "m", none, above("0"),
        "drops pairs whose initial gap, after `gap`, is not below this. Kernels leave out the candidates "
        "that "
        "no pair then needs"}}};
  return section;
}

const Section& contact_keys() {
  static const Contact contact;
  static const Section section = joined(
      {"[contact]",
       "",
       {{"scheme", Type::text, "", shown("compliant"), one_of({"compliant", "impulse", "static"}),
         "contact law; `\"static\"`: the bodies at rest under `[loads]`"},
        {"admittance", Type::text, "", shown("jump"), one_of({"jump", "difference"}),
         "`impulse` only. `difference` needs ω_max · step < π"},
        {"instant", Type::text, "", shown("step"), one_of({"step", "exact"}),
         "`impulse` only; `exact`: a point that closes within a step is met at that instant"},
        {"restitution", Type::number, "1", shown(contact.restitution), from_to("0", "1"), "`impulse` only"},
        {"max_pivots", Type::integer, "", none, from_to("1", "1e9"),
         "how many times a point may change between touching and open while the forces of a step are sought. "
         "Bounds the work of a step, for real time; steps cut short may let points in, which the summary "
         "counts"},
        {"kernel", Type::text, "", shown("modes"), one_of({"modes", "table"}),
         "`\"table\"`: kernels sampled at each step and convolved with the forces"},
        {"table", Type::text, "", none, any(),
         "file of such kernels; `kernel = \"table\"` only. Bodies, modes, pairs and loads are refused beside "
         "it"},
        {"solver", Type::text, "", shown("exact"), one_of({"exact", "uzawa"}),
         "`static` only; `uzawa`: the iteration on the pressures, for reference"},
        {"pair", Type::tables, "", none, any(), "`[[contact.pair]]`, several pairs"}}},
      pair_keys());
  return section;
}

const Section& time_keys() {
  static const Time time;
  static const Section section{
      "[time]",
      "",
      {{"rate_hz", Type::number, "Hz", shown(time.rate.value) + ", or as `accuracy` chooses", above("0"),
        "steps a second"},
       {"duration", Type::number, "s", required, above("0"),
        "duration · rate_hz is rounded to 1 … 1e9 steps"},
       {"precision", Type::text, "", shown("double") + ", or as `accuracy` chooses",
        one_of({"double", "single"}),
        "`\"single\"`: products of steps in single precision, with `scheme = \"compliant\"` and modal "
        "kernels; "
        "faster where there are many points"}}};
  return section;
}

const Section& loads_keys() {
  static const Loads loads;
  static const Section section{
      "[loads]",
      "",
      {{"gravity", Type::vector, "m/s²", shown(loads.gravity), any(), "acceleration, world axes"},
       {"traction", Type::tables, "", none, any(), "`[[loads.traction]]`, forces spread on surfaces"},
       {"point", Type::tables, "", none, any(), "`[[loads.point]]`, forces at points"},
       {"motion", Type::tables, "", none, any(), "`[[loads.motion]]`, supports that move"}}};
  return section;
}

const Section& traction_keys() {
  static const Section section{
      "[[loads.traction]]",
      "A force spread on a surface.",
      {body_of_source(),
       {"group", Type::text, "", required, any(),
        "physical surface on the body's outside (an end of a rod), which may be a contact surface too"},
       vector_of_source("Pa", "world axes"),
       history_of_source(),
       name_of_source("the group")}};
  return section;
}

const Section& point_keys() {
  static const Section section{
      "[[loads.point]]",
      "A force at a point.",
      {body_of_source(), place_of_source("where the force acts"), vector_of_source("N", "world axes"),
       history_of_source(), name_of_source("point 1, point 2, …")}};
  return section;
}

const Section& motion_keys() {
  static const Section section{"[[loads.motion]]",
                               "The displacement of a support.",
                               {body_of_source(),
                                {"group", Type::text, "", required, any(), "one of the body's supports"},
                                vector_of_source("m", "world axes, along components that the support holds"),
                                history_of_source(),
                                name_of_source("the group")}};
  return section;
}

const Section& output_keys() {
  static const Output output;
  static const Section section{
      "[output]",
      "",
      {{"every", Type::integer, "steps", shown(output.every), from_to("1", "1e9"),
        "a row of the result each so many steps"},
       {"view", Type::boolean, "", shown(output.view), any(),
        "keep the skin of each body in its kernel, for pictures: its modes, and with `residual_flexibility` "
        "its static response to each candidate, 12 bytes for each node and column of either"},
       {"snapshot_every", Type::integer, "steps", shown(output.snapshot_every), at_least("0"),
        "modal coordinates each so many steps; 0: none"},
       {"vtk_every", Type::integer, "steps", shown(output.vtk_every), at_least("0"),
        "a frame of the [motion for ParaView](results.md#looking-at-motion-in-paraview) each so many steps; "
        "0: "
        "none. Sets `view`; not with `kernel = \"table\"`"},
       {"receiver", Type::tables, "", none, any(), "`[[output.receiver]]`, points that are listened to"}}};
  return section;
}

const Section& receiver_keys() {
  static const Section section{"[[output.receiver]]",
                               "A point of a body whose motion is recorded, and written as sound.",
                               {name_of_source(required), body_of_source(), place_of_source("the point")}};
  return section;
}

std::vector<const Section*> all_sections() {
  return {&scene_keys(),    &body_keys(),    &material_keys(), &damping_keys(), &obstacle_keys(),
          &modes_keys(),    &contact_keys(), &pair_keys(),     &time_keys(),    &loads_keys(),
          &traction_keys(), &point_keys(),   &motion_keys(),   &output_keys(),  &receiver_keys()};
}

}  // namespace ricochet::scene
