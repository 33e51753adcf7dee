// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/keys.hpp"

#include <algorithm>

#include "src/scene/scene.hpp"
#include "src/scene/write.hpp"

namespace ricochet::scene {

const Key* Section::find(std::string_view name) const {
  const auto found = std::ranges::find(keys, name, &Key::name);
  return found == keys.end() ? nullptr : &*found;
}

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

/// A default value as a scene would state it, in backticks.
std::string shown(const std::string& text) { return '`' + text + '`'; }
std::string shown(const char* choice) { return shown(toml_string(choice)); }
std::string shown(double number) { return shown(toml_number(number)); }
std::string shown(std::int64_t number) { return shown(std::to_string(number)); }
std::string shown(int number) { return shown(std::int64_t{number}); }
std::string shown(bool on) { return shown(std::string(on ? "true" : "false")); }
std::string shown(const Vector3& vector) { return shown(toml_vector(vector)); }

/// Appends the keys of `more` to those of `section`.
Section joined(Section section, const Section& more) {
  section.keys.insert(section.keys.end(), more.keys.begin(), more.keys.end());
  return section;
}

Key body_of_source() { return {"body", Type::text, "", required, any(), "name of a body"}; }

Key vector_of_source(const char* unit, const char* meaning) {
  return {"vector", Type::vector, unit, required, any(), meaning};
}

Key history_of_source() {
  return {
      "history",
      Type::text,
      "",
      none,
      any(),
      "CSV file of times [s] and factors that multiply `vector`. Without a file, the factor is always 1: a "
      "dead load, under which bodies start at rest"};
}

Key name_of_source(const char* fallback) {
  return {"name",
          Type::text,
          "",
          fallback,
          any(),
          "a name that no other load or motion of the body has; at most 100 bytes, no `/`, and not "
          "`body_force`, `body_force_residual` or `rotation`"};
}

Key place_of_source(const char* what) {
  return {"at",
          Type::vector,
          "m",
          required,
          any(),
          std::string(what) +
              ", in world axes, with the bodies placed by `translate` and `rotate_deg`. It must lie inside "
              "the body or on its surface. A point outside by at most 1e-6 of the body's size is moved onto "
              "the surface; a point farther outside is refused, with its distance"};
}

}  // namespace

const Section scene_keys{
    "Top level",
    "",
    {{"title", Type::text, "", "the file's name without `.toml`", any(),
      "title of the pictures; the names of the result files are made from it"},
     {"accuracy", Type::number, "1",
      toml_number(default_accuracy) + " if `modes` are left open, otherwise none",
      Range{.low = "1e-6",
            .high = "0.5",
            .choices = {"off"},
            .remark = ": the relative error that results may have"},
      "relative error allowed in the quantities of `accuracy_of`; `ricochet-kernel` and `ricochet-contact` "
      "choose the settings that the scene leaves open. `\"off\"`: nothing is chosen, and no error is "
      "estimated"},
     {"accuracy_of", Type::texts, "", "`[\"impulse\", \"rebound\"]`", any(),
      "quantities to which `accuracy` applies: some of `\"impulse\"`, `\"rebound\"`, `\"spin\"`, "
      "`\"peak_force\"`, `\"duration\"`, `\"energy\"` and `\"receivers\"`, or their only name. At rest: "
      "`\"force\"` and `\"approach\"`, always both"},
     {"bodies", Type::table, "", required, any(),
      "`[bodies.NAME]`, one table for each elastic body. NAME consists of letters, digits, `-` and `_`. A "
      "scene with a `contact.table` has no bodies",
      "[bodies.NAME], one table for each body"},
     {"obstacles", Type::table, "", none, any(), "`[obstacles.NAME]`, rigid half-spaces",
      "[obstacles.NAME], with normal = [0, 0, 1]"},
     {"modes", Type::table, "", required, any(),
      "basis of every body: which modes, or which Ritz vectors. Optional unless `accuracy = \"off\"`",
      "[modes], with up_to_hz or count"},
     {"contact", Type::table, "", required, any(),
      "contact pairs and contact law. Optional for kernels and modes",
      "[contact], with between; several pairs are [[contact.pair]]"},
     {"time", Type::table, "", required, any(),
      "time step and duration. Optional for kernels and modes, and with `scheme = \"static\"`",
      "[time], with duration"},
     {"loads", Type::table, "", none, any(), "gravity, tractions, point forces, moving supports",
      "[loads], with gravity = [0, 0, -9.81]"},
     {"strikes", Type::tables, "", none, any(), "`[[strikes]]`, blows by mallets"},
     {"output", Type::table, "", none, any(), "what is written, and receivers",
      "[output], with its keys below"}}};

const Section body_keys{
    "[bodies.NAME]",
    "An elastic body.",
    {{"mesh", Type::text, "", required, any(),
      "mesh file. `.msh` is read as it is; `.geo`, `.step` and `.brep` are meshed by the gmsh library; "
      "`.h5` is a [body file](interchange.md#bodies-from-another-finite-element-program) from another "
      "program"},
     {"geometry", Type::numbers, "", "`{}`", any(),
      "values for the `DefineConstant` names of a `.geo`. Names that the `.geo` does not define are "
      "refused, and so is `geometry` for other files",
      "{ size = 4e-3 }"},
     {"order", Type::integer, "", shown(Body{}.order) + ", or chosen by `accuracy`", from_to("1", "10"),
      "element order for meshes that gmsh makes; a `.msh` keeps its own"},
     {"size_factor", Type::number, "1", shown(Body{}.size_factor) + ", or chosen by `accuracy` with `order`",
      above("0"),
      "factor on the element sizes of a `.geo`, `.step` or `.brep` (gmsh's `Mesh.MeshSizeFactor`). Curves "
      "with a given number of elements keep it"},
     {"refine", Type::tables, "", "none, or chosen by `accuracy` with `size_factor`", any(),
      "`[[bodies.NAME.refine]]`, balls in which a `.geo`, `.step` or `.brep` gets smaller elements"},
     {"scale", Type::number, "1", shown(Body{}.scale), above("0"),
      "factor on all coordinates of the mesh (0.001 for a drawing in millimetres, and for any STEP file)"},
     {"rotate_deg", Type::vector, "degrees", shown(Body{}.rotate_deg), any(),
      "rotations about the fixed axes x, then y, then z, through the origin of the mesh"},
     {"translate", Type::vector, "m", shown(Body{}.translate), any(),
      "translation, after `scale` and `rotate_deg`"},
     {"material", Type::table, "", required, any(),
      "one table for the whole body, or one table for each physical volume (for a rod: physical line), "
      "named after it. A body file has no material",
      "{ density = 7800, young = 2.1e11, poisson = 0.3 }"},
     {"damping", Type::table, "", "`{}`", any(), "one damping law; no damping if empty", "{ ratio = 0.01 }"},
     {"velocity", Type::vector, "m/s", shown(Body{}.velocity), any(),
      "initial velocity of the centre of mass, in world axes. A supported body cannot have a velocity that "
      "its "
      "supports prevent; a rod moves along its axis only"},
     {"angular_velocity", Type::vector, "rad/s", shown(Body{}.angular_velocity), any(),
      "initial angular velocity about the centre of mass, in world axes, for bodies that supports do not "
      "hold. "
      "Rotations are linear: points move along their initial tangents, and the body starts without the "
      "strain "
      "of centrifugal forces"},
     {"contact", Type::texts, "", required, any(),
      "physical surface (for a rod: physical point) that may touch, or a list of them. Optional in a scene "
      "without `[contact]`"},
     {"support", Type::strings, "", "`{}`", any(),
      "physical group (surface, curve, point or volume) = fixed components, some of `\"xyz\"`, in the axes "
      "of the mesh (before `rotate_deg`). A rod is fixed unless all named components are normal to its "
      "axis",
      "{ GROUP = \"xyz\" }"}}};

const Section refine_keys{
    "[[bodies.NAME.refine]]",
    "A ball with small elements, such as the surroundings of a point that is struck. Outside the ball, "
    "elements "
    "grow by 0.4 of the distance from it, up to the size that the geometry asks for. Curves and surfaces "
    "with "
    "a given number of elements keep it.",
    {{"at", Type::vector, "m", required, any(),
      "centre, in the axes of the mesh: after `scale`, before `rotate_deg` and `translate`"},
     {"radius", Type::number, "m", required, above("0"), "radius of the ball"},
     {"size", Type::number, "m", required, above("0"), "size of elements in the ball"}}};

const Section material_keys{
    "[bodies.NAME.material]",
    "Linear and isotropic. A body of several materials has one table for each: "
    "`[bodies.NAME.material.GROUP]`.",
    {{"density", Type::number, "kg/m³", required, above("0"), "mass per volume"},
     {"young", Type::number, "Pa", required, above("0"), "Young's modulus"},
     {"poisson", Type::number, "1", shown(Material{}.poisson),
      Range{.low = "-1",
            .high = "0.5",
            .low_open = true,
            .high_open = true,
            .remark = ". Nearly incompressible: try 0.49."},
      "Poisson's ratio; rods do not use it. Above 0.45 use `order` 2 or more: linear elements lock, and a "
      "warning is printed"},
     {"area", Type::number, "m²", none, above("0"), "cross-section of a rod; other bodies do not use it"},
     {"yield", Type::number, "Pa", none, above("0"),
      "stress at which the material yields. A run warns if the pressure of a contact exceeds it; nothing "
      "else "
      "depends on it"}}};

const Section damping_keys{
    "[bodies.NAME.damping]",
    "Give one of these laws for the decay rate δ = ζω of a mode with the angular frequency ω.",
    {{"ratio", Type::number, "1", none, at_least("0"),
      "δ = ratio · ω: the same damping ratio ζ for every mode"},
     {"loss_factor", Type::number, "1", none, at_least("0"), "δ = loss_factor · ω / 2"},
     {"viscosity", Type::number, "s", none, at_least("0"), "δ = viscosity · ω² / 2 (Kelvin–Voigt)"},
     {"rayleigh", Type::pair, "[1/s, s]", none, any(),
      "[α, β]: δ = (α + β ω²) / 2; α also damps rigid motion"},
     {"t60", Type::pairs, "[Hz, s]", none, above("0"),
      "rows of a frequency, ascending, and the time T60 in which a mode of this frequency decays by 60 dB: δ "
      "= ln(1000) / T60. Between rows, log T60 is linear in log f; beyond the first and the last row, T60 is "
      "constant. Rigid motion is not damped",
      "[[100, 2.0], [1000, 0.8]]"},
     {"by_mode", Type::list, "1", none, at_least("0"),
      "loss factors of the elastic modes, from the lowest on: δ = η · ω / 2. Further modes have the last "
      "one. "
      "Not for Ritz vectors and not with `flexibility_error`, which leave no mode its number",
      "[1e-3, 2e-3]"}}};

const Section obstacle_keys{
    "[obstacles.NAME]",
    "A rigid half-space, which can replace one of the two bodies of a pair.",
    {{"point", Type::vector, "m", shown(Obstacle{}.point), any(), "a point of its surface"},
     {"normal", Type::direction, "", required, any(), "outward normal of the obstacle"},
     {"velocity", Type::vector, "m/s", shown(Obstacle{}.velocity), any(),
      "velocity along its surface, in world axes, like that of a conveyor belt; a component along the normal "
      "is refused. It acts through `friction` only, and not with `scheme = \"static\"`"}}};

const Section modes_keys{
    "[modes]",
    "",
    {{"basis", Type::text, "", shown("modes"), one_of({"modes", "contact"}),
      "`\"modes\"`: certified modes of the body. `\"contact\"`: contact-adapted basis, load-dependent Ritz "
      "vectors for the loads that contact can apply"},
     {"up_to_hz", Type::number, "Hz", none, above("0"),
      "keep all modes up to this frequency. With `flexibility_error` or `basis = \"contact\"`: end of the "
      "frequency band in which the contact surface must respond accurately"},
     {"count", Type::integer, "", none, at_least("1"),
      "number of modes or Ritz vectors, rigid modes included. The lowest modes are kept; a multiple mode "
      "at the end is kept whole"},
     {"flexibility_error", Type::number, "1", "1e-3 for Ritz vectors without `count`, otherwise none",
      from_to("1e-6", "0.5"),
      "relative error allowed in the flexibility of the contact surface over the band"},
     {"residual_flexibility", Type::boolean, "", shown(Modes{}.residual_flexibility), any(),
      "keep the static flexibility of the modes that are left out"},
     {"residual_components", Type::text, "", shown("auto"), one_of({"auto", "all"}),
      "components of the residual flexibility. `\"auto\"`: only the normal of each candidate if no pair is "
      "tilted "
      "against it by more than 3 degrees, otherwise all three. `\"all\"`: always all three"},
     {"relative_residual", Type::number, "1", shown(Modes{}.relative_residual), from_to("1e-14", "1e-2"),
      "bound on ‖Kφ − ω²Mφ‖ / ‖Kφ‖ of each mode. A mode above it is an error, unless round-off explains "
      "it. Ritz vectors are not checked"},
     {"solver", Type::text, "", shown(Modes{}.solver),
      one_of({"ricochet", "krylovschur", "subspace", "arnoldi"}),
      "solver that finds the modes, as a type of SLEPc's EPS. Whichever it is, the same certificate proves "
      "that no mode is missing. For `basis = \"modes\"`"},
     {"low_rank", Type::number, "1", shown(Modes{}.low_rank),
      Range{.low = "1e-12", .high = "1e-3", .or_zero = true},
      "threshold of MUMPS's block low-rank factorisation, for `basis = \"contact\"` only; 0: full rank. It "
      "saves memory on large solid bodies. The solves have about this relative error, so keep it well "
      "below `flexibility_error`"}}};

const Section pair_keys{
    "[[contact.pair]]",
    "One table for each of several pairs. Keys that a pair does not give are taken from `[contact]`.",
    {{"between", Type::texts, "", required, any(),
      "names of two bodies, or of a body and an obstacle. \"Body a\" below is the first body"},
     {"direction", Type::direction, "", none, any(),
      "the normal of every contact point: out of the first name in `between`, in world axes. Without it "
      "each point has the mutual normal (n_a − n_b)/|n_a − n_b|. Against an obstacle it must lie along the "
      "obstacle's normal and point towards the second name"},
     {"along", Type::direction, "", none, any(),
      "merges all nodes of the contact surface on a line in this direction (world axes) into one "
      "candidate. Each line should meet the surface on one side of the body only"},
     {"spacing", Type::number, "m", none, above("0"),
      "smallest distance between candidates. Without it, every node of the contact surface is one"},
     {"gap", Type::number, "m", none, at_least("0"),
      "moves body a along `direction` (or the mean normal) until the closest pair of contact points has this "
      "distance"},
     {"reach", Type::number, "m", none, above("0"),
      "drops the pairs of points whose initial gap, after `gap`, is not below this distance. Kernels leave "
      "out the candidates that no pair needs"},
     {"zone", Type::number, "m", std::string(none) + ", or chosen by `accuracy`", above("0"),
      "drops the pairs of points whose initial gap exceeds that of the closest pair by this distance or "
      "more, "
      "as `reach` does, wherever the bodies start"},
     {"friction", Type::number_or_table, "1", none, from_to("0", "10", ": most dry surfaces have 0.1 to 1"),
      "Coulomb friction: its coefficient, or `[contact.friction]` with its parts. 0: frictionless. Needs "
      "`scheme = \"compliant\"` or `\"static\"` and `kernel = \"modes\"`. Not on rods, which move along "
      "their "
      "axis alone",
      "{ static = 0.4, dynamic = 0.3, stribeck_velocity = 0.01 }"}}};

const Section friction_keys{
    "[contact.friction]",
    "Friction that changes with the sliding speed v of a point: dynamic + (static − dynamic) · exp(−(v / "
    "stribeck_velocity)²). In a `[[contact.pair]]`: `friction = { static = …, dynamic = …, "
    "stribeck_velocity = … }`.",
    {{"static", Type::number, "1", required, from_to("0", "10", ": most dry surfaces have 0.1 to 1"),
      "coefficient of points that stick"},
     {"dynamic", Type::number, "1", "that of `static`",
      from_to("0", "10", ": most dry surfaces have 0.1 to 1"), "coefficient of points that slide fast"},
     {"stribeck_velocity", Type::number, "m/s", none, above("0"),
      "sliding speed of the transition; required if `dynamic` differs from `static`, otherwise unused"}}};

const Section contact_keys =
    joined({"[contact]",
            "",
            {{"scheme", Type::text, "", shown("compliant"), one_of({"compliant", "impulse", "static"}),
              "contact law. `\"compliant\"`: forces with which no point penetrates at the end of a step. "
              "`\"impulse\"`: impulses on the points that touch. `\"static\"`: equilibrium under gravity, "
              "without time"},
             {"integration", Type::text, "", shown("conserving"), one_of({"conserving", "backward-euler"}),
              "`compliant` only. `\"conserving\"`: the modes are driven by a mean of the forces at the last "
              "instants, with an error of second order. `\"backward-euler\"`: by the force at the end of the "
              "step; each change of force costs energy"},
             {"admittance", Type::text, "", shown("jump"), one_of({"jump", "difference"}),
              "`impulse` only: velocity jump, or difference quotient over a step. `difference` needs ω_max "
              "· step < π"},
             {"instant", Type::text, "", shown("step"), one_of({"step", "exact"}),
              "`impulse` only: contact at the end of the step, or (event location) at the instant at which "
              "a point closes"},
             {"restitution", Type::number, "1", shown(Contact{}.restitution), from_to("0", "1"),
              "`impulse` only: coefficient of restitution"},
             {"max_pivots", Type::integer, "", none, from_to("1", "1e9"),
              "bounds the work of a step, for real time: the number of changes of the active set. A step "
              "that is cut short may let points penetrate; the summary counts such steps"},
             {"kernel", Type::text, "", shown("modes"), one_of({"modes", "table"}),
              "`\"table\"`: unit-impulse responses are sampled at each step and convolved with forces"},
             {"table", Type::text, "", none, any(),
              "file of sampled responses, for `kernel = \"table\"` only. It replaces bodies, modes, pairs "
              "and loads, which must not be given"},
             {"solver", Type::text, "", shown("exact"), one_of({"exact", "uzawa"}),
              "`static` only. `uzawa`: iteration on the pressures, for comparison; without friction"},
             {"increments", Type::integer, "", shown(Contact{}.increments), from_to("1", "1e6"),
              "`static` with `friction` only: parts of the preload and of each stage from one time of a "
              "history to the next. Slip depends on the path, so more parts are more accurate"},
             {"pair", Type::tables, "", none, any(), "`[[contact.pair]]`, several pairs"}}},
           pair_keys);

const Section time_keys{
    "[time]",
    "",
    {{"rate_hz", Type::number, "Hz", shown(Time{}.rate.value), above("0"),
      "output samples per second. In free flight, steps go from sample to sample. With scheme = `impulse` "
      "and "
      "with sampled responses, also the steps per second; `impulse` with `accuracy` chooses it"},
     {"contact_rate_hz", Type::number, "Hz", "rate_hz, or chosen by `accuracy`", above("0"),
      "steps per second while a point could close, rounded up to a multiple of rate_hz. Needs `scheme = "
      "\"compliant\"` and `kernel = \"modes\"`"},
     {"duration", Type::number, "s", required, above("0"),
      "simulated time. duration · rate_hz is rounded to a whole number of samples, from 1 to 1e9"},
     {"precision", Type::text, "", shown("double") + ", or chosen by `accuracy`",
      one_of({"double", "single"}),
      "`\"single\"`: matrix products of the steps in single precision, which is faster with many points. "
      "Needs `scheme = \"compliant\"` and `kernel = \"modes\"`"}}};

const Section loads_keys{
    "[loads]",
    "",
    {{"gravity", Type::vector, "m/s²", shown(Loads{}.gravity), any(),
      "acceleration of gravity, in world axes", "[0, 0, -9.81]"},
     {"traction", Type::tables, "", none, any(), "`[[loads.traction]]`, forces distributed over surfaces"},
     {"point", Type::tables, "", none, any(), "`[[loads.point]]`, point forces"},
     {"motion", Type::tables, "", none, any(), "`[[loads.motion]]`, moving supports"}}};

const Section traction_keys{
    "[[loads.traction]]",
    "A force distributed over a surface.",
    {body_of_source(),
     {"group", Type::text, "", required, any(),
      "physical surface on the outside of the body (for a rod: an end). It may also be a contact surface"},
     vector_of_source("Pa", "traction, in world axes"),
     history_of_source(),
     name_of_source("the group")}};

const Section point_keys{
    "[[loads.point]]",
    "A force at a point.",
    {body_of_source(), place_of_source("point of application"), vector_of_source("N", "force, in world axes"),
     history_of_source(), name_of_source("point 1, point 2, …")}};

const Section motion_keys{
    "[[loads.motion]]",
    "The displacement of a support, or of an obstacle along its surface. Motions of an obstacle and its "
    "`velocity` add up.",
    {{"body", Type::text, "", "– without `obstacle`", any(), "name of a body"},
     {"group", Type::text, "", "– without `obstacle`", any(), "one of the body's supports"},
     {"obstacle", Type::text, "", none, any(),
      "name of an obstacle, in place of `body` and `group`. Its motion acts through `friction` only, and "
      "needs "
      "a `history`"},
     vector_of_source("m",
                      "displacement, in world axes, along components that the support holds, or along the "
                      "surface of the obstacle"),
     history_of_source(),
     name_of_source("the group, or the obstacle")}};

const Section strike_keys{
    "[[strikes]]",
    "A blow by a mallet: a free body, which need not be given again for each blow. It is at its place at the "
    "time "
    "of the strike, and flies freely before and after it; `gap` and `reach` of its pairs hold for each "
    "strike. "
    "Mallets do not touch each other. Not with `accuracy`, sampled responses or bodies at rest.",
    {{"mallet", Type::text, "", required, any(), "name of a body without supports, receivers and loads"},
     {"time", Type::number, "s", required, at_least("0"),
      "time at which the mallet is at its place; it touches when it has crossed the rest of its gap"},
     {"speed", Type::number, "m/s", "that of the mallet's `velocity`", above("0"), "its speed at this time"},
     {"direction", Type::direction, "", "that of the mallet's `velocity`", any(),
      "direction of its velocity, in world axes"},
     {"translate", Type::vector, "m", "that of the mallet", any(), "its place, as for bodies"},
     {"rotate_deg", Type::vector, "degrees", "that of the mallet", any(), "its orientation, as for bodies"}}};

const Section output_keys{
    "[output]",
    "",
    {{"every", Type::integer, "samples", shown(Output{}.every), from_to("1", "1e9"),
      "interval between rows of the result, in output samples; between rows of the contact, in contact "
      "steps; for receivers see `receivers_rate_hz`"},
     {"view", Type::boolean, "", shown(Output{}.view), any(),
      "keep each body's visualisation surface in its kernel, for pictures: the modes and, with "
      "`residual_flexibility`, the static response to each candidate. Each of them takes 12 bytes "
      "for each node"},
     {"snapshot_every", Type::integer, "samples", shown(Output{}.snapshot_every), at_least("0"),
      "interval between snapshots of the modal coordinates; 0: none"},
     {"vtk_every", Type::integer, "samples", shown(Output{}.vtk_every), at_least("0"),
      "interval between frames of the [motion for ParaView](results.md#motion-in-paraview); 0: none. Sets "
      "`view`; not with `kernel = \"table\"`"},
     {"receivers_rate_hz", Type::number, "Hz",
      "rate_hz; with `every` above 1 at least " + std::to_string(static_cast<int>(audio_rows.value)),
      above("0"),
      "rows of receivers per second, rounded up so that rate_hz is a whole multiple, and at least rate_hz "
      "/ " +
          std::to_string(most_samples_per_receiver_row) +
          ". Below rate_hz, a low-pass filter removes what the rows cannot represent. Sound files do not "
          "depend on it"},
     {"sound", Type::table, "", none, any(),
      "`[output.sound]`, one or two receivers as a sound file for players",
      "{ receivers = \"mic\", direction = [0, 0, 1] }"},
     {"receiver", Type::tables, "", none, any(), "`[[output.receiver]]`, points whose motion is recorded"}}};

const Section receiver_keys{"[[output.receiver]]",
                            "A point of a body whose motion is recorded and written as sound.",
                            {{"name", Type::text, "", required, any(),
                              "a name that no other receiver has; at most 100 bytes, no `/`, and not "
                              "`body_force`, `body_force_residual` or `rotation`"},
                             body_of_source(),
                             place_of_source("the point")}};

const Section sound_keys{
    "[output.sound]",
    "A sound file for players, `<slug>.wav`, besides the files of the receivers: mono or stereo, normalised "
    "to "
    "its largest sample.",
    {{"receivers", Type::texts, "", required, any(),
      "name of a receiver (mono), or a list of two (left and right)"},
     {"direction", Type::direction, "", required, any(),
      "component of the velocity that is heard, in world axes, for example the normal of the wall"},
     {"high_pass_hz", Type::number, "Hz", shown(Sound{}.high_pass_hz), from_to("0", "1000"),
      "corner of a high-pass filter (Butterworth, fourth order), which removes rigid motion; 0: none. It "
      "must "
      "be below half of `time.rate_hz`"},
     {"fade", Type::number, "s", shown(Sound{}.fade), at_least("0"),
      "duration of the fade at the end (raised cosine); 0: none"},
     {"format", Type::text, "", shown("pcm24"), one_of({"pcm16", "pcm24", "float"}),
      "samples: integers of 16 or 24 bits, or floats of 32 bits. The header is the plain one that all "
      "players "
      "read"}}};

std::vector<const Section*> all_sections() {
  return {&scene_keys,    &body_keys,     &refine_keys,   &material_keys, &damping_keys,
          &obstacle_keys, &modes_keys,    &contact_keys,  &pair_keys,     &friction_keys,
          &time_keys,     &loads_keys,    &traction_keys, &point_keys,    &motion_keys,
          &output_keys,   &receiver_keys, &sound_keys,    &strike_keys};
}

}  // namespace ricochet::scene
