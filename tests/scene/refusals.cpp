// SPDX-License-Identifier: BSD-2-Clause
// An invalid scene is refused in one line: the file, the key, the value found, and the remedy.
#include "src/scene/read.hpp"

#include <gmock/gmock.h>

#include "tests/scene/scenes.hpp"

namespace ricochet::scene::refusals_test {

using namespace test;
using ::testing::HasSubstr;

struct Refusal {
  std::string from, to, line;
};

/// Each change of `smallest` must give exactly the expected line.
void expect_lines(const std::vector<Refusal>& refusals) {
  for (const Refusal& refusal : refusals) {
    SCOPED_TRACE(refusal.to);
    EXPECT_EQ(complaint_about(changed(smallest, refusal.from, refusal.to)), "scene.toml: " + refusal.line);
  }
}

/// The same for lines appended to the table of the body.
void expect_body_lines(const std::vector<std::pair<std::string, std::string>>& added) {
  for (const auto& [text, line] : added)
    expect_lines({{"contact = \"skin\"", "contact = \"skin\"\n" + text, "bodies.ball." + line}});
}

/// The same for lines inserted at the start of a table.
void expect_table_lines(const std::string& table,
                        const std::vector<std::pair<std::string, std::string>>& added) {
  for (const auto& [text, line] : added)
    expect_lines({{"[" + table + "]", "[" + table + "]\n" + text, table + "." + line}});
}

TEST(Refused, is_an_unknown_key_with_the_most_similar_one) {
  expect_body_lines(
      {{"velocty = [0, 0, 1]", "velocty = [0, 0, 1]: unknown key. Did you mean \"velocity\"?"}});
  expect_table_lines(
      "time", {{"rate = 44100", "rate = 44100: unknown key. Did you mean \"rate_hz\"?"},
               {"pace = 1",
                "pace = 1: unknown key. The keys here are contact_rate_hz, duration, precision, rate_hz."}});
  expect_table_lines("contact", {{"spacin = 1", "spacin = 1: unknown key. Did you mean \"spacing\"?"}});
  expect_table_lines("modes", {{"counts = 1", "counts = 1: unknown key. Did you mean \"count\"?"}});
  expect_table_lines("obstacles.floor",
                     {{"normla = true", "normla = true: unknown key. Did you mean \"normal\"?"}});
  expect_lines({
      {"[time]", "[outputs]\n[time]", "outputs = {…}: unknown key. Did you mean \"output\"?"},
      {"[time]", "[loads]\ngravty = 1\n[time]", "loads.gravty = 1: unknown key. Did you mean \"gravity\"?"},
      {"[time]", "[output]\nevry = 1\n[time]", "output.evry = 1: unknown key. Did you mean \"every\"?"},
      {"young = 1e9", "young = 1e9, nu = 0.3",
       "bodies.ball.material.nu = 0.3: unknown key. Did you mean \"poisson\"?"},
      {"[time]", "[[contact.pair]]\nwidth = 1\n[time]",
       "contact.pair[0].width = 1: unknown key. The keys here are along, between, direction, friction, gap, "
       "reach, spacing, zone."},
  });
}

TEST(Refused, is_a_missing_key) {
  expect_lines({
      {"mesh = \"ball.msh\"", "",
       "bodies.ball.mesh: is missing: name a .geo, .step, .brep or .msh file, or a body file (.h5)"},
      {"material = { density = 1000, young = 1e9 }", "",
       "bodies.ball.material: is missing: give { density = …, young = …, poisson = … }"},
      {"density = 1000, ", "", "bodies.ball.material.density: is missing: give a number in kg/m³"},
      {", young = 1e9", "", "bodies.ball.material.young: is missing: give a number in Pa"},
      {"contact = \"skin\"", "", "bodies.ball.contact: is missing: name the physical surface that may touch"},
      {"normal = [0, 0, 1]", "",
       "obstacles.floor.normal: is missing: the direction out of the obstacle, for example [0, 0, 1]"},
      {"[contact]\nbetween = [\"ball\", \"floor\"]", "",
       "contact: is missing: give between = [\"body\", \"body\"]"},
      {"between = [\"ball\", \"floor\"]", "", "contact.between: is missing: name the two that may touch"},
      {"between = [\"ball\", \"floor\"]", "[[contact.pair]]\ngap = 1",
       "contact.pair[0].between: is missing: name the two that may touch"},
      {"[time]\nduration = 0.01", "", "time: is missing: give duration [s]"},
      {"duration = 0.01", "", "time.duration: is missing: give a number in s"},
  });
  const std::string off = "accuracy = \"off\"\n";  // otherwise the modes may stay open
  EXPECT_EQ(complaint_about(off + changed(smallest, "[modes]\ncount = 10", "")),
            "scene.toml: modes: is missing: give up_to_hz or count");
  EXPECT_EQ(complaint_about(off + changed(smallest, "count = 10", "")),
            "scene.toml: modes = {…}: give one of up_to_hz and count");
  EXPECT_EQ(complaint_about(""), "scene.toml: bodies: is missing: a scene needs a body, [bodies.NAME]");
  EXPECT_EQ(complaint_about("bodies = {}"),
            "scene.toml: bodies = {…}: is missing: a scene needs a body, [bodies.NAME]");
}

TEST(Refused, is_a_key_that_a_body_file_contains_or_that_needs_elements) {
  const std::string material = "material = { density = 1000, young = 1e9 }",
                    imported = changed(changed(smallest, "ball.msh", "ball.h5"), material, "order = 2");
  const std::string has_it = ": is part of the data of a body file (.h5): leave it out";
  for (const auto& [from, to, line] : std::vector<Refusal>{
           {"order = 2", material, "bodies.ball.material = {…}" + has_it},
           {"order = 2", "scale = 0.001", "bodies.ball.scale = 0.001" + has_it},
           {"order = 2", "geometry = { size = 1 }", "bodies.ball.geometry = {…}" + has_it},
           {"count = 10", "basis = \"contact\"\nup_to_hz = 10\nlow_rank = 1e-9",
            "modes.low_rank = 1e-09: is not possible with bodies.ball, a body file: leave it out"},
           {"[modes]\ncount = 10", "",
            "modes: is missing: accuracy cannot choose modes for bodies.ball, a body file: give up_to_hz or "
            "count"}}) {
    SCOPED_TRACE(to);
    EXPECT_EQ(complaint_about(changed(imported, from, to)), "scene.toml: " + line);
  }
}

TEST(Refused, is_a_refinement_of_a_mesh_file_or_without_its_size) {
  EXPECT_THAT(complaint_about(smallest, {"bodies.ball.refine=[{at=[0,0,1],radius=0.1,size=0.02}]"}),
              HasSubstr("bodies.ball.refine"));
  EXPECT_THAT(complaint_about(smallest, {"bodies.ball.refine=[{at=[0,0,1],radius=0.1}]"}),
              HasSubstr("size: is missing"));
  EXPECT_THAT(complaint_about(smallest, {"bodies.ball.refine=[{at=[0,0,1],radius=0,size=1}]"}),
              HasSubstr("must be above 0"));
}

TEST(Refused, is_a_value_of_another_type) {
  expect_lines({
      {"\"ball.msh\"", "3", "bodies.ball.mesh = 3: must be a string, in quotes"},
      {"density = 1000", "density = \"lead\"",
       "bodies.ball.material.density = \"lead\": must be a number in kg/m³"},
      {"{ density = 1000, young = 1e9 }", "\"lead\"",
       "bodies.ball.material = \"lead\": must be a table: write material = { density = 7800, young = 2.1e11, "
       "poisson = 0.3 }"},
      {"\"skin\"", "[\"skin\", 1]",
       "bodies.ball.contact = [\"skin\", 1]: must be a string or a list of strings, in quotes"},
      {"\"skin\"", "1", "bodies.ball.contact = 1: must be a string or a list of strings, in quotes"},
      {"count = 10", "count = 10.0", "modes.count = 10.0: must be a whole number: write 10"},
      {"[0, 0, 1]", "[0, 0.3]", "obstacles.floor.normal = [0, 0.3]: must be three numbers, [x, y, z]"},
      {"[0, 0, 1]", "[0, 0, \"1\"]",
       "obstacles.floor.normal = [0, 0, \"1\"]: must be three numbers, [x, y, z]"},
      {"[\"ball\", \"floor\"]", "[\"ball\", \"floor\"]\npair = 1",
       "contact.pair = 1: must be an array of tables, [[contact.pair]]"},
      {"[\"ball\", \"floor\"]", "[\"ball\", \"floor\"]\npair = [1]",
       "contact.pair = [1]: must be an array of tables, [[contact.pair]]"},
      {"\n[bodies.ball]", "title = 1979-05-27\n[bodies.ball]",
       "title = 1979-05-27: must be a string, in quotes"},
      {"\n[bodies.ball]", "output = \"all\"\n[bodies.ball]",
       "output = \"all\": must be a table: write [output], with its keys below"},
      {"\n[bodies.ball]", "bodies.cube = 1\n[bodies.ball]",
       "bodies.cube = 1: must be a table, [bodies.cube]"},
  });
  expect_body_lines(
      {{"geometry = { size = \"big\" }", "geometry.size = \"big\": must be a number"},
       {"support = { clamp = 1 }", "support.clamp = 1: must be a string, in quotes"},
       {"support = \"clamp\"", "support = \"clamp\": must be a table: write support = { clamp = \"xyz\" }"},
       {"velocity = 3.5",
        "velocity = 3.5: must be three numbers, [x, y, z]: write [0, 0, 3.5] if it points along z"}});
  expect_table_lines("modes",
                     {{"residual_flexibility = 1", "residual_flexibility = 1: must be true or false"}});
}

TEST(Refused, is_a_number_out_of_range) {
  expect_lines({
      {"density = 1000", "density = -1", "bodies.ball.material.density = -1: must be above 0"},
      {"density = 1000", "density = inf", "bodies.ball.material.density = inf: must be finite"},
      {"young = 1e9", "young = 0", "bodies.ball.material.young = 0: must be above 0"},
      {"young = 1e9", "young = nan", "bodies.ball.material.young = nan: must be finite"},
      {"young = 1e9", "young = 1e9, area = 0", "bodies.ball.material.area = 0: must be above 0"},
      {"young = 1e9", "young = 1e9, poisson = 0.5",
       "bodies.ball.material.poisson = 0.5: must be above -1 and below 0.5. Nearly incompressible: try "
       "0.49."},
      {"young = 1e9", "young = 1e9, poisson = -1",
       "bodies.ball.material.poisson = -1: must be above -1 and below 0.5. Nearly incompressible: try 0.49."},
      {"count = 10", "count = 0", "modes.count = 0: must be at least 1"},
      {"count = 10", "up_to_hz = 0.0", "modes.up_to_hz = 0.0: must be above 0"},
      {"duration = 0.01", "duration = 0", "time.duration = 0: must be above 0"},
      {"duration = 0.01", "duration = 1e-5",
       "time.duration = 1e-05: makes 0.441 samples at rate_hz = 44100: must be from 1 to 1e9: change "
       "rate_hz"},
      {"duration = 0.01", "duration = 1e5",
       "time.duration = 100000.0: makes 4.41e+09 samples at rate_hz = 44100: must be from 1 to 1e9: change "
       "rate_hz"},
      {"[0, 0, 1]", "[0, 0, 0]", "obstacles.floor.normal = [0, 0, 0]: must not be zero"},
      {"[0, 0, 1]", "[0, 0, inf]", "obstacles.floor.normal = [0, 0, inf]: must be finite"},
  });
  expect_body_lines({{"order = 0", "order = 0: must be from 1 to 10"},
                     {"order = 11", "order = 11: must be from 1 to 10"},
                     {"scale = -0.001", "scale = -0.001: must be above 0"}});
  expect_table_lines("modes",
                     {{"relative_residual = 0.1", "relative_residual = 0.1: must be from 1e-14 to 1e-2"},
                      {"relative_residual = 0", "relative_residual = 0: must be from 1e-14 to 1e-2"}});
  expect_table_lines("time",
                     {{"rate_hz = -44100", "rate_hz = -44100: must be above 0"},
                      {"precision = \"half\"", "precision = \"half\": must be \"double\" or \"single\""}});
  expect_table_lines("contact", {{"spacing = 0", "spacing = 0: must be above 0"},
                                 {"reach = 0", "reach = 0: must be above 0"},
                                 {"gap = -0.1", "gap = -0.1: must not be negative"},
                                 {"max_pivots = 0", "max_pivots = 0: must be from 1 to 1e9"},
                                 {"direction = [0, 0, 0]", "direction = [0, 0, 0]: must not be zero"},
                                 {"along = [0, 0, 0]", "along = [0, 0, 0]: must not be zero"}});
  for (const auto& [key, line] : std::vector<std::pair<std::string, std::string>>{
           {"every = 0", "every = 0: must be from 1 to 1e9"},
           {"snapshot_every = -1", "snapshot_every = -1: must not be negative"},
           {"vtk_every = -1", "vtk_every = -1: must not be negative"},
           {"view = false\nvtk_every = 1",
            "view = false: vtk_every needs the visualisation surfaces: leave view out, or "
            "set it to true"}})
    expect_lines({{"[time]", "[output]\n" + key + "\n[time]", "output." + line}});
}

// Without the refusal, such numbers would give infinite factors in computations.
TEST(Refused, is_a_number_whose_square_overflows) {
  expect_body_lines({{"scale = 1e150", "scale = 1e+150: must be from -1e30 to 1e30"},
                     {"scale = 1e-150", "scale = 1e-150: must be at least 1e-30"},
                     {"velocity = [0, 0, 1e200]",
                      "velocity = [0, 0, 1e+200]: must consist of numbers from -1e30 to 1e30"}});
  expect_lines(
      {{"density = 1000", "density = 1e300",
        "bodies.ball.material.density = 1e+300: must be from -1e30 to 1e30"},
       {"young = 1e9", "young = 1e-300", "bodies.ball.material.young = 1e-300: must be at least 1e-30"},
       {"count = 10", "up_to_hz = 1e300", "modes.up_to_hz = 1e+300: must be from -1e30 to 1e30"},
       {"[time]", "[loads]\ngravity = [0, 0, -1e300]\n[time]",
        "loads.gravity = [0, 0, -1e+300]: must consist of numbers from -1e30 to 1e30"}});
}

TEST(Refused, is_damping_without_a_law_or_with_two) {
  expect_body_lines(
      {{"damping = { ratio = -0.1 }", "damping.ratio = -0.1: must not be negative"},
       {"damping = { ratio = 0.1, viscosity = 0.1 }",
        "damping = {…}: give one law only: ratio, loss_factor, rayleigh, viscosity, t60 or by_mode"},
       {"damping = { t60 = [[1, 2]], by_mode = [1] }",
        "damping = {…}: give one law only: ratio, loss_factor, rayleigh, viscosity, t60 or by_mode"},
       {"damping = { t60 = 2 }",
        "damping.t60 = 2: must be a list of pairs of numbers: write t60 = [[100, 2.0], [1000, 0.8]]"},
       {"damping = { t60 = [] }",
        "damping.t60 = []: must be a list of pairs of numbers: write t60 = [[100, 2.0], [1000, 0.8]]"},
       {"damping = { t60 = [[1, 2, 3]] }",
        "damping.t60 = [[1, 2, 3]]: must be a list of pairs of numbers: write t60 = [[100, 2.0], [1000, "
        "0.8]]"},
       {"damping = { t60 = [[100, 0]] }", "damping.t60 = [[100, 0]]: must be above 0"},
       {"damping = { t60 = [[100, inf]] }", "damping.t60 = [[100, inf]]: must be finite"},
       {"damping = { t60 = [[100, 1], [100, 2]] }",
        "damping.t60 = [[100, 1], [100, 2]]: the frequencies must ascend: sort the rows, and give each "
        "frequency once"},
       {"damping = { by_mode = 1e-3 }",
        "damping.by_mode = 0.001: must be a list of numbers: write by_mode = [1e-3, 2e-3]"},
       {"damping = { by_mode = [1, \"2\"] }",
        "damping.by_mode = [1, \"2\"]: must be a list of numbers: write by_mode = [1e-3, 2e-3]"},
       {"damping = { by_mode = [-1] }", "damping.by_mode = [-1]: must not be negative"},
       {"damping = { rayleigh = 1 }", "damping.rayleigh = 1: must be two numbers, [alpha, beta]"},
       {"damping = { rayleigh = [1] }", "damping.rayleigh = [1]: must be two numbers, [alpha, beta]"},
       {"damping = { rayleigh = [1, -2.5] }", "damping.rayleigh = [1, -2.5]: must not be negative"},
       {"damping = { rate = 1 }", "damping.rate = 1: unknown key. Did you mean \"ratio\"?"}});
}

TEST(Refused, is_damping_by_mode_of_modes_without_numbers) {
  for (const char* modes : {"{basis=\"contact\",up_to_hz=1e3}", "{up_to_hz=1e3,flexibility_error=1e-2}"})
    EXPECT_EQ(
        complaint_about(smallest, {"bodies.ball.damping.by_mode=[1]", std::string("modes=") + modes}),
        "scene.toml: bodies.ball.damping.by_mode = [1]: needs numbered modes: set modes.basis = \"modes\" "
        "with up_to_hz or count, without flexibility_error, or give t60");
}

TEST(Refused, are_rows_of_receivers_that_do_not_exist_or_at_other_rates) {
  const Override mic = "output.receiver=[{name=\"mic\",body=\"ball\",at=[0,0,1]}]";
  for (const char* rate : {"88200", "44"})
    EXPECT_EQ(complaint_about(smallest, {mic, std::string("output.receivers_rate_hz=") + rate}),
              std::string("scene.toml: output.receivers_rate_hz = ") + rate +
                  ": must be from rate_hz / 1000 to rate_hz = 44100");
  EXPECT_EQ(
      complaint_about(smallest, {"output.receivers_rate_hz=4410"}),
      "scene.toml: output.receivers_rate_hz = 4410: needs [[output.receiver]]: add one, or leave it out");
}

TEST(Refused, is_a_sound_of_receivers_that_do_not_exist_or_are_too_many) {
  const std::vector<std::pair<std::string, std::string>> sounds = {
      {"{direction=[1,0,0]}", "receivers: is missing: name one receiver (mono) or two (left and right)"},
      {"{receivers=\"mic\"}",
       "direction: is missing: the component that is heard, for example the normal of the wall"},
      {"{receivers=\"mik\",direction=[1,0,0]}",
       "receivers = \"mik\": there is no receiver \"mik\". Did you mean \"mic\"?"},
      {"{receivers=[\"mic\",\"mic\",\"mic\"],direction=[1,0,0]}",
       "receivers = [\"mic\", \"mic\", \"mic\"]: must name one receiver or two"},
      {"{receivers=\"mic\",direction=[0,0,0]}", "direction = [0, 0, 0]: must not be zero"},
      {"{receivers=\"mic\",direction=[1,0,0],fade=-1}", "fade = -1: must not be negative"},
      {"{receivers=\"mic\",direction=[1,0,0],high_pass_hz=1001}",
       "high_pass_hz = 1001: must be from 0 to 1000"},
      {"{receivers=\"mic\",direction=[1,0,0],format=\"mp3\"}",
       "format = \"mp3\": must be \"pcm16\", \"pcm24\" or \"float\""}};
  for (const auto& [sound, line] : sounds)
    EXPECT_EQ(complaint_about(smallest, {"output.receiver=[{name=\"mic\",body=\"ball\",at=[0,0,1]}]",
                                         "output.sound=" + sound}),
              "scene.toml: output.sound." + line);
}

TEST(Refused, is_a_support_that_holds_no_components) {
  expect_body_lines({{"support = { clamp = \"xw\" }",
                      "support = {…}: \"clamp\" holds \"xw\": name the fixed components, some of \"xyz\""},
                     {"support = { clamp = \"\" }",
                      "support = {…}: \"clamp\" holds \"\": name the fixed components, some of \"xyz\""}});
}

TEST(Refused, are_modes_requested_twice) {
  expect_lines({{"count = 10", "count = 10\nup_to_hz = 1e3", "modes = {…}: give one of up_to_hz and count"}});
}

TEST(Refused, is_an_unknown_basis) {
  expect_table_lines("modes",
                     {{"basis = \"wavelets\"", "basis = \"wavelets\": must be \"modes\" or \"contact\""},
                      {"basis = \"\"", "basis = \"\": must be \"modes\" or \"contact\""},
                      {"basis = true", "basis = true: must be \"modes\" or \"contact\""},
                      {"bases = \"contact\"", "bases = \"contact\": unknown key. Did you mean \"basis\"?"}});
}

TEST(Refused, is_a_low_rank_threshold_out_of_range_or_with_an_inertia_count) {
  const std::string contact = "basis = \"contact\"\nup_to_hz = 1e3\n";
  expect_lines(
      {{"count = 10", contact + "low_rank = 1e-13",
        "modes.low_rank = 1e-13: must be 0 or from 1e-12 to 1e-3"},
       {"count = 10", contact + "low_rank = 0.01", "modes.low_rank = 0.01: must be 0 or from 1e-12 to 1e-3"},
       {"count = 10", "count = 3\nlow_rank = 1e-6",
        "modes.low_rank = 1e-06: does not allow an inertia count: use it with basis = \"contact\""}});
}

TEST(Refused, is_a_solver_of_certified_modes_for_a_contact_adapted_basis) {
  expect_lines(
      {{"count = 10", "basis = \"contact\"\nup_to_hz = 1e3\nsolver = \"krylovschur\"",
        "modes.solver = \"krylovschur\": finds certified modes: leave it out with basis = \"contact\""}});
}

TEST(Refused, is_a_flexibility_error_out_of_range) {
  expect_table_lines("modes",
                     {{"flexibility_error = 0", "flexibility_error = 0: must be from 1e-6 to 0.5"},
                      {"flexibility_error = 9e-7", "flexibility_error = 9e-07: must be from 1e-6 to 0.5"},
                      {"flexibility_error = 0.51", "flexibility_error = 0.51: must be from 1e-6 to 0.5"},
                      {"flexibility_error = -1e-3", "flexibility_error = -0.001: must be from 1e-6 to 0.5"},
                      {"flexibility_error = nan", "flexibility_error = nan: must be finite"},
                      {"flexibility_error = \"small\"", "flexibility_error = \"small\": must be a number"},
                      {"flexibilityerror = 0.1",
                       "flexibilityerror = 0.1: unknown key. Did you mean \"flexibility_error\"?"}});
}

// Settings of contact-adapted bases and of modes in every contradictory combination.
TEST(Refused, are_contradictory_requests_for_modes_or_ritz_vectors) {
  const std::string no_band =
      "modes = {…}: basis = \"contact\" needs up_to_hz, the band in which contact acts";
  const std::string one_end = "modes = {…}: give one of up_to_hz and count";
  for (const auto& [modes, line] : std::vector<std::pair<std::string, std::string>>{
           {"basis = \"contact\"", no_band},
           {"basis = \"contact\"\ncount = 10", no_band},
           {"basis = \"contact\"\nflexibility_error = 1e-3", no_band},
           {"basis = \"contact\"\nup_to_hz = 1e3\ncount = 10\nflexibility_error = 1e-3",
            "modes = {…}: give one of count and flexibility_error"},
           {"basis = \"modes\"", one_end},
           {"flexibility_error = 1e-3", one_end},
           {"up_to_hz = 1e3\ncount = 10\nflexibility_error = 1e-3", one_end},
           {"count = 10\nflexibility_error = 1e-3",
            "modes = {…}: flexibility_error needs up_to_hz, the band in which contact acts"},
           {"up_to_hz = 1e3\nflexibility_error = 1e-3\nresidual_flexibility = false",
            "modes = {…}: flexibility_error needs residual_flexibility = true, to represent truncated "
            "modes"}})
    EXPECT_EQ(complaint_about(changed(smallest, "count = 10", modes), {"accuracy=off"}),
              "scene.toml: " + line)
        << modes;  // with an accuracy, the band may stay open
}

TEST(Refused, is_a_pair_of_unknown_bodies) {
  const std::string between = "[\"ball\", \"floor\"]";
  expect_lines({
      {between, "[\"ball\", \"flor\"]",
       "contact.between = [\"ball\", \"flor\"]: there is no body or obstacle \"flor\". Did you mean "
       "\"floor\"?"},
      {between, "[\"ball\", \"ball\"]",
       "contact.between = [\"ball\", \"ball\"]: must name two different bodies"},
      {between, "\"ball\"",
       "contact.between = \"ball\": must name two bodies, or a body and an obstacle, as in [\"ball\", "
       "\"floor\"]"},
      {between, "[\"floor\", \"wall\"]\n[obstacles.wall]\nnormal = [1, 0, 0]",
       "contact.between = [\"floor\", \"wall\"]: one of the two must be a body"},
      {"[obstacles.floor]",
       "[bodies.cube]\nmesh = \"a\"\nmaterial = { density = 1, young = 1 }\n[obstacles.floor]",
       "bodies.cube: no contact pair names it: add it to contact.between or remove it"},
  });
}

TEST(Refused, is_an_unknown_scheme) {
  expect_table_lines(
      "contact",
      {{"scheme = \"penalty\"", "scheme = \"penalty\": must be \"compliant\", \"impulse\" or \"static\""},
       {"solver = \"uzawa\"",
        "solver = \"uzawa\": belongs to scheme = \"static\": add it, or leave this key out"},
       {"scheme = \"static\"\nsolver = \"cg\"", "solver = \"cg\": must be \"exact\" or \"uzawa\""},
       {"scheme = \"static\"\nrestitution = 0.5",
        "restitution = 0.5: belongs to scheme = \"impulse\": add it, or leave this key out"},
       {"admittance = \"jump\"",
        "admittance = \"jump\": belongs to scheme = \"impulse\": add it, or leave this key out"},
       {"restitution = 0.5",
        "restitution = 0.5: belongs to scheme = \"impulse\": add it, or leave this key out"},
       {"instant = \"exact\"",
        "instant = \"exact\": belongs to scheme = \"impulse\": add it, or leave this key out"},
       {"scheme = \"impulse\"\ninstant = \"now\"", "instant = \"now\": must be \"step\" or \"exact\""},
       {"scheme = \"impulse\"\nadmittance = \"leap\"",
        "admittance = \"leap\": must be \"jump\" or \"difference\""},
       {"scheme = \"impulse\"\nrestitution = 1.5", "restitution = 1.5: must be from 0 to 1"},
       {"scheme = \"impulse\"\nrestitution = -0.5", "restitution = -0.5: must be from 0 to 1"}});
  expect_lines({{"[time]", "scheme = \"impulse\"\n[time]\nprecision = \"single\"",
                 "time.precision = \"single\": belongs to scheme = \"compliant\" and kernel = \"modes\": "
                 "leave it out"}});
}

TEST(Refused, is_friction_out_of_range_or_without_its_transition) {
  expect_table_lines(
      "contact",
      {{"friction = -0.1", "friction = -0.1: must be from 0 to 10: most dry surfaces have 0.1 to 1"},
       {"friction = 11", "friction = 11: must be from 0 to 10: most dry surfaces have 0.1 to 1"},
       {"friction = nan", "friction = nan: must be finite"},
       {"friction = \"0.3\"", "friction = \"0.3\": must be a number, without quotes"},
       {"friction = true",
        "friction = true: must be a number or a table: write friction = { static = 0.4, dynamic = 0.3, "
        "stribeck_velocity = 0.01 }"},
       {"friction = {}", "friction.static: is missing: give a number"},
       {"friction = { dynamic = 0.3 }", "friction.static: is missing: give a number"},
       {"friction = { static = -1 }",
        "friction.static = -1: must be from 0 to 10: most dry surfaces have 0.1 to 1"},
       {"friction = { static = 0.4, dynamic = inf }", "friction.dynamic = inf: must be finite"},
       {"friction = { static = 0.4, dynamic = 0.3 }",
        "friction.stribeck_velocity: is missing: give the sliding speed in m/s at which friction passes from "
        "static = 0.4 to dynamic = 0.3"},
       {"friction = { static = 0.4, dynamic = 0.3, stribeck_velocity = 0 }",
        "friction.stribeck_velocity = 0: must be above 0"},
       {"friction = { static = 0.4, stribeck_velocity = 1 }",
        "friction.dynamic: is missing: stribeck_velocity leads from static to dynamic: give it, or leave "
        "both "
        "out"},
       {"friction = { static = 0.4, dynamical = 0.3 }",
        "friction.dynamical = 0.3: unknown key. Did you mean \"dynamic\"?"},
       {"friction = { static = 0.4, stiction = 0.3 }",
        "friction.stiction = 0.3: unknown key. The keys here are dynamic, static, stribeck_velocity."}});
}

TEST(Refused, is_friction_where_no_method_has_it) {
  expect_table_lines(
      "contact",
      {{"scheme = \"impulse\"\nfriction = 0.3",
        "friction = 0.3: is not possible with scheme = \"impulse\": set scheme = \"compliant\", or leave "
        "friction out"},
       {"scheme = \"impulse\"\nfriction = { static = 0.3 }",
        "friction = {…}: is not possible with scheme = \"impulse\": set scheme = \"compliant\", or leave "
        "friction out"},
       {"kernel = \"table\"\nfriction = 0.3",
        "friction = 0.3: is not possible with kernel = \"table\": set kernel = \"modes\", or leave friction "
        "out"},
       {"scheme = \"static\"\nsolver = \"uzawa\"\nfriction = 0.3",
        "friction = 0.3: is not possible with solver = \"uzawa\": set solver = \"exact\", or leave friction "
        "out"},
       {"friction = 0.3\nincrements = 5",
        "increments = 5: belongs to scheme = \"static\": add it, or leave this key out"},
       {"scheme = \"static\"\nincrements = 5",
        "increments = 5: needs friction: add it, as in friction = 0.3, or leave this key out"}});
  for (const char* without : {"contact.scheme=impulse", "contact.kernel=table"})
    EXPECT_NO_THROW(scene_of(smallest, {without, "contact.friction=0"})) << without;
  EXPECT_EQ(complaint_about(tabular, {"contact.friction=0.3"}),
            "scene.toml: contact.friction = 0.3: is replaced by contact.table: leave one of them out");
}

TEST(Refused, is_an_obstacle_that_leaves_its_surface) {
  EXPECT_EQ(
      complaint_about(smallest, {"obstacles.floor.velocity=[1,0,0.25]"}),
      "scene.toml: obstacles.floor.velocity = [1, 0, 0.25]: has the component 0.25 m/s along the normal: "
      "an obstacle moves along its surface; leave this component out");
}

TEST(Refused, is_a_name_that_is_invalid_or_taken) {
  expect_lines({
      {"[bodies.ball]", "[bodies.\"a/b\"]",
       "bodies.a/b: the name of a body must consist of letters, digits, - and _"},
      {"[obstacles.floor]", "[obstacles.ball]", "obstacles.ball: a body has this name already"},
  });
}

TEST(Refused, is_a_file_that_is_missing_or_not_toml) {
  const Folder folder;
  const auto complaint_of_file = [&](const char* name, const std::string& text) {
    const std::filesystem::path file = folder.write(name, text);
    return complaint_of([&] { read(file); }).substr(file.string().size());
  };
  const std::string missing = (folder.path() / "none").string();
  EXPECT_EQ(complaint_of([&] { read(missing); }), missing + ": no such file: name a scene, SCENE.toml");
  EXPECT_EQ(complaint_of([&] { read(folder.path()); }),
            folder.path().string() + ": is a folder: name a scene, SCENE.toml");
  const std::string there = folder.write("none.toml", smallest);
  EXPECT_EQ(complaint_of([&] { read(missing); }), missing + ": no such file: did you mean " + there + "?");
  EXPECT_EQ(complaint_of([&] { read(folder.path()); }),
            folder.path().string() + ": is a folder: name a scene, such as " + there);
  EXPECT_THAT(complaint_of_file("a.result.h5", ""), HasSubstr(": is a result: name the scene"));
  EXPECT_THAT(complaint_of_file("a.kernel.h5", ""), HasSubstr(": is a kernel: name the scene"));
  EXPECT_THAT(complaint_of_file("a.geo", ""), HasSubstr(": is a mesh or drawing: name a scene"));
  EXPECT_EQ(complaint_of_file("hdf5.toml", "\x89HDF\r\n"), ": is an HDF5 file: name a scene, SCENE.toml");
  EXPECT_EQ(complaint_of_file("utf16.toml", "\xff\xfet"), ": is UTF-16 text: save it as UTF-8 in the editor");
}

TEST(Refused, is_a_study_in_the_place_of_a_scene) {
  EXPECT_EQ(complaint_about("scene = \"a.toml\"\n[grid]\n\"time.duration\" = [1, 2]\n"),
            "scene.toml: is a study: run it with ricochet sweep scene.toml, or name its scene, a.toml");
}

// What people write who know other languages. The place is line and column of the character that TOML
// excludes.
TEST(Refused, is_text_that_is_not_toml_with_what_to_write) {
  const std::vector<std::pair<std::string, std::string>> lines = {
      {"a = = 3", "1:5: a = = 3: this is not TOML: could not determine value type"},
      {"a = 1 // one", "1:7: a = 1 // one: a comment starts with #"},
      {"a: 1", "1:2: a: 1: write = between key and value"},
      {"a = \"c:\\users\"", "1:10: a = \"c:\\users\": write / in place of \\ in a path"},
      {"a = True", "1:5: a = True: write true or false, in lower case"},
      {"a = 0,5", "1:6: a = 0,5: write a decimal point in place of the comma"},
      {"a = 1;", "1:6: a = 1;: remove the semicolon"},
      {"a = 1,", "1:6: a = 1,: remove the comma at the end of the line"},
      {"a = [1, 2],", "1:11: a = [1, 2],: remove the comma at the end of the line"},
      {"a = (1, 2)", "1:5: a = (1, 2): write a vector in brackets, [x, y, z]"},
      {"a = .5", "1:5: a = .5: write a digit before the decimal point, 0.5"},
      {"a = 210 GPa", "1:9: a = 210 GPa: give the number alone: docs/keys.md states the unit of each key"},
      {"a = [1 2]", "1:8: a = [1 2]: separate the entries of a list by commas"},
      {"a =", "1:4: a =: a value is missing after ="},
      {"a = \"b", "1:7: a = \"b: close the text with a quote"},
      {"[a", "1:3: [a: close the name of the table with ]"},
      {"[a b]", "1:4: [a b]: write dots between the parts of the name, as in [bodies.NAME]"},
      {"a = b", "1:5: a = b: write text in quotes, \"…\""},
      {"a = “b”", "1:5: a = “b”: use straight quotes, \"…\""},
      {"a = [1, 2\nb = 1", "2:1: b = 1: the list before it is not closed: add ]"},
      {"a = { b = 1\n}", "1:12: a = { b = 1: close a table in braces with } on the line where it starts"},
      {"a = 1\na = 2", "2:5: a = 2: the table has this key already: remove one of the two"},
      {"[a]\n[a]",
       "2:1: [a]: the file has this table already: choose another name, or put all its keys in one place"},
      {"a = 1\nb = \"\xe9\"", "2:5: this is not UTF-8: save the file as UTF-8 in the editor"}};
  for (const auto& [text, line] : lines) EXPECT_EQ(complaint_about(text), "scene.toml:" + line);
  // A line of a damaged file may be very long.
  EXPECT_THAT(complaint_about("a = " + std::string(1 << 20, '(')),
              HasSubstr("…: write a vector in brackets"));
}

// Quoted keys and strings may contain anything.
TEST(Refused, is_reported_in_one_line_for_any_keys) {
  expect_lines({
      {"[time]", "[\"a\\nb\"]\n[time]",
       "a b = {…}: "
       "unknown key. The keys here are accuracy, accuracy_of, bodies, contact, loads, modes, obstacles, "
       "output, strikes, time, "
       "title."},
      {"\"ball\", \"floor\"", "\"ball\", \"a\\nb\"",
       "contact.between = [\"ball\", \"a\\u000Ab\"]: there is no body or obstacle \"a b\": there are "
       "\"ball\", \"floor\""},
  });
}

TEST(Refused, are_long_values_which_are_shortened_between_characters) {
  // 1 + 55 bytes, then an é whose second byte is the 58th: the message drops this character as a whole.
  const std::string start(55, 'a');
  expect_lines({{"count = 10", "count = \"" + start + "ééé\"",
                 "modes.count = \"" + start + "…: must be a whole number"}});
}

TEST(Refused, is_a_key_that_sampled_responses_do_not_use) {
  const std::string instead = "is replaced by contact.table: leave one of them out";
  const std::vector<std::pair<std::string, std::string>> lines = {
      {"[loads]\ngravity = [0, 0, 1]", "loads = {…}: " + instead},
      {"[modes]\ncount = 3", "modes = {…}: " + instead},
      {"[bodies]", "bodies = {…}: " + instead},
      {"[output]\nsnapshot_every = 2",
       "output.snapshot_every = 2: contact.kernel = \"table\" has no modal coordinates: leave it out"},
      {"[output]\nvtk_every = 2",
       "output.vtk_every = 2: contact.kernel = \"table\" gives no motion of the bodies: leave it out"}};
  for (const auto& [text, line] : lines)
    EXPECT_EQ(complaint_about(changed(tabular, "[time]", text + "\n[time]")), "scene.toml: " + line);
  EXPECT_EQ(complaint_about(changed(tabular, "kernel = \"table\"", "kernel = \"tables\"")),
            "scene.toml: contact.kernel = \"tables\": must be \"modes\" or \"table\"");
  EXPECT_EQ(complaint_about(changed(tabular, "kernel = \"table\"", "")),
            "scene.toml: contact.table = \"../tables/rods.h5\": belongs to kernel = \"table\": add it, or "
            "leave this key out");
  EXPECT_EQ(complaint_about(changed(tabular, "[time]", "between = [\"a\", \"b\"]\n[time]")),
            "scene.toml: contact.between = [\"a\", \"b\"]: " + instead);
}

// Very deeply nested tables would exhaust the stack when they are destroyed.
TEST(Refused, is_a_key_of_endless_depth) {
  std::string key = "a";
  for (int depth = 0; depth < 100000; ++depth) key += ".a";
  for (const std::string& line : {key + " = 1", "[" + key + "]"})
    EXPECT_EQ(complaint_about(smallest + line),
              "scene.toml:18: more than 100 dots: no key is nested so deeply; break the line");
  EXPECT_EQ(complaint_about(smallest, {key + "=1"}).substr(0, 8), "--set a.");
  EXPECT_EQ(complaint_about(smallest, {"title={" + key + "=1}"}),
            "--set:1: more than 100 dots: no key is nested so deeply; break the line");
  EXPECT_EQ(scene_of("# " + std::string(1000, '.') + smallest).title, "scene");
}

TEST(Refused, is_a_file_that_is_too_long_for_a_scene) {
  EXPECT_THAT(complaint_about(smallest + std::string(5 << 20, '\n')), HasSubstr("is larger than 4 MiB"));
}

TEST(Refused, is_reported_in_one_line_for_any_value) {
  EXPECT_EQ(complaint_about(smallest + "[\"a\\nb\\u007f\"]\n").find_first_of("\n\x7f"), std::string::npos);
}

}  // namespace ricochet::scene::refusals_test
