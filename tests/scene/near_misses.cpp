// SPDX-License-Identifier: BSD-2-Clause
// A near miss is refused in one line that states what to write.
#include "src/scene/near_miss.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "base/similar.hpp"
#include "tests/scene/scenes.hpp"

namespace ricochet::scene::near_misses_test {

using namespace test;
using ::testing::HasSubstr;

/// A change of `smallest`, and the end of the line that it gives.
struct NearMiss {
  std::string from, to, end;
};

void expect_ends(const std::vector<NearMiss>& misses) {
  for (const NearMiss& miss : misses) {
    SCOPED_TRACE(miss.to);
    const std::string line = complaint_about(changed(smallest, miss.from, miss.to));
    EXPECT_EQ(line.substr(line.size() - std::min(line.size(), miss.end.size())), miss.end) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
}

// Each of these tables lacks a required key because the key is misspelt.
TEST(MisspeltKey, is_named_and_not_the_key_that_is_missing_because_of_it) {
  expect_ends({
      {"mesh = ", "mseh = ", "bodies.ball.mseh = \"ball.msh\": unknown key. Did you mean \"mesh\"?"},
      {"material = ", "Material = ", "bodies.ball.Material = {…}: unknown key. Did you mean \"material\"?"},
      {"density = 1000", "desnity = 1000", "material.desnity = 1000: unknown key. Did you mean \"density\"?"},
      {"young = 1e9", "youngs_modulus = 1e9",
       "material.youngs_modulus = 1000000000.0: unknown key. Did you mean \"young\"?"},
      {"contact = \"skin\"", "contacts = \"skin\"",
       "bodies.ball.contacts = \"skin\": unknown key. Did you mean \"contact\"?"},
      {"normal = ", "norm = ", "obstacles.floor.norm = [0, 0, 1]: unknown key. Did you mean \"normal\"?"},
      {"count = 10", "cuont = 10", "modes.cuont = 10: unknown key. Did you mean \"count\"?"},
      {"count = 10", "up_to = 1e3", "modes.up_to = 1000.0: unknown key. Did you mean \"up_to_hz\"?"},
      {"between = ", "beetween = ",
       "contact.beetween = [\"ball\", \"floor\"]: unknown key. Did you mean \"between\"?"},
      {"duration = ", "duratoin = ", "time.duratoin = 0.01: unknown key. Did you mean \"duration\"?"},
      {"[bodies.ball]", "[body.ball]", "body = {…}: unknown key. Did you mean \"bodies\"?"},
      {"[modes]", "[mode]", "mode = {…}: unknown key. Did you mean \"modes\"?"},
      {"[time]", "[Time]", "Time = {…}: unknown key. Did you mean \"time\"?"},
      {"[time]", "[[contact.pair]]\nbetwen = [\"ball\", \"floor\"]\n[time]",
       "contact.pair[0].betwen = [\"ball\", \"floor\"]: unknown key. Did you mean \"between\"?"},
      {"[time]", "[[loads.point]]\nBody = \"ball\"\n[time]",
       "loads.point[0].Body = \"ball\": unknown key. Did you mean \"body\"?"},
      {"[time]", "[[output.receiver]]\nname = \"mic\"\nbody = \"ball\"\npoint = [0, 0, 1]\n[time]",
       "[0].point = [0, 0, 1]: unknown key here: it belongs to [obstacles.NAME] or [[loads.point]]"},
  });
}

// Every list of tables, and words that resemble no key of the list.
TEST(MisspeltKey, of_a_list_of_tables_is_named_with_the_key_that_it_may_mean) {
  const auto list = [](const std::string& title, const std::string& line, const std::string& end) {
    return NearMiss{"[time]", "[[" + title + "]]\n" + line + "\n[time]", end};
  };
  const std::vector<NearMiss> misses{
      list("output.receiver", "postion = [0, 0, 0]",
           "[0].postion = [0, 0, 0]: unknown key. Did you mean \"at\"?"),
      list("output.receiver", "bdoy = \"ball\"", "unknown key. Did you mean \"body\"?"),
      list("output.recevier", "name = \"a\"", "unknown key. Did you mean \"receiver\"?"),
      list("contact.pair", "freind = 0.3",
           "contact.pair[0].freind = 0.3: unknown key. Did you mean \"friction\"? The keys here are along, "
           "between, "
           "direction, friction, gap, reach, spacing, zone."),
      list("contact.pair", "frction = 0.3", "unknown key. Did you mean \"friction\"?"),
      list("contact.pairs", "gap = 1", "unknown key. Did you mean \"pair\"?"),
      list("strikes", "malet = \"ball\"",
           "strikes[0].malet = \"ball\": unknown key. Did you mean \"mallet\"?"),
      list("strike", "mallet = \"ball\"", "strike = [{…}]: unknown key. Did you mean \"strikes\"?"),
      list("loads.point", "vectr = [0, 0, 1]", "unknown key. Did you mean \"vector\"?"),
      list("loads.points", "name = \"p\"", "unknown key. Did you mean \"point\"?"),
      list("loads.traction", "grop = \"skin\"", "unknown key. Did you mean \"group\"?"),
      list("loads.motion", "histry = \"a.csv\"", "unknown key. Did you mean \"history\"?"),
      list("bodies.ball.refine", "raduis = 1",
           "bodies.ball.refine[0].raduis = 1: unknown key. Did you mean \"radius\"?"),
  };
  expect_ends(misses);
  std::size_t lists = 0;  // so that a new list of tables joins this test
  for (const Section* section : all_sections())
    lists += static_cast<std::size_t>(std::ranges::count(section->keys, Type::tables, &Key::type));
  EXPECT_EQ(lists, 7);
}

TEST(MisspeltKey, may_state_a_unit_which_the_message_corrects) {
  expect_ends({
      {"duration = ", "duration_ms = ", "unknown key. Did you mean \"duration\", in s?"},
      {"young = 1e9", "young_gpa = 1", "unknown key. Did you mean \"young\", in Pa?"},
      {"density = 1000", "density_kg_per_m3 = 1000", "unknown key. Did you mean \"density\", in kg/m³?"},
      {"count = 10", "up_to_khz = 10", "unknown key. Did you mean \"up_to_hz\", in Hz?"},
      {"[time]", "[time]\nrate_khz = 44.1", "unknown key. Did you mean \"rate_hz\", in Hz?"},
      {"between = ", "spacing_mm = 2\nbetween = ", "unknown key. Did you mean \"spacing\", in m?"},
      {"contact = \"skin\"", "contact = \"skin\"\nvelocity_m_s = [0, 0, -1]",
       "unknown key. Did you mean \"velocity\", in m/s?"},
      {"contact = \"skin\"", "contact = \"skin\"\nrotate = [0, 0, 90]",
       "unknown key. Did you mean \"rotate_deg\"?"},
  });
}

TEST(MisspeltKey, may_be_the_word_of_another_program) {
  expect_ends({
      {"young = 1e9", "E = 1e9", "material.E = 1000000000.0: unknown key. Did you mean \"young\"?"},
      {"density = 1000", "rho = 1000", "unknown key. Did you mean \"density\"?"},
      {"count = 10", "n_modes = 10", "unknown key. Did you mean \"count\"?"},
      {"count = 10", "f_max = 10", "unknown key. Did you mean \"up_to_hz\"?"},
      {"[time]", "[time]\ndt = 1e-6", "unknown key. Did you mean \"rate_hz\"?"},
      {"contact = \"skin\"", "contact = \"skin\"\ninitial_velocity = [0, 0, -1]",
       "unknown key. Did you mean \"velocity\"?"},
      {"contact = \"skin\"", "contact = \"skin\"\nfixed = { a = \"xyz\" }",
       "unknown key. Did you mean \"support\"?"},
      {"[contact]", "[contact]\nmu = 0.3", "contact.mu = 0.3: unknown key. Did you mean \"friction\"?"},
      {"[contact]", "[contact]\nfriction = { mu_s = 0.3 }",
       "contact.friction.mu_s = 0.3: unknown key. Did you mean \"static\"?"},
      {"[contact]", "[contact]\nfriction = { static = 0.3, kinetic = 0.2 }",
       "unknown key. Did you mean \"dynamic\"?"},
  });
}

// TOML assigns every key to the table whose header precedes it.
TEST(KeyInAnotherTable, is_refused_with_its_own_table) {
  expect_ends({
      {"[time]\nduration = 0.01", "[time]\nduration = 0.01\naccuracy = 0.01",
       "time.accuracy = 0.01: unknown key here: it belongs to the top of the file, before all tables"},
      {"count = 10", "count = 10\nspacing = 0.01",
       "unknown key here: it belongs to [contact] or [[contact.pair]]"},
      {"[time]", "[[receiver]]\nname = \"mic\"\n[time]",
       "unknown key here: it belongs to [[output.receiver]]"},
      {"[time]", "[material]\ndensity = 1\n[time]", "unknown key here: it belongs to [bodies.NAME]"},
      {"[time]", "[time]\ngravity = [0, 0, -9.81]", "unknown key here: it belongs to [loads]"},
      {"[bodies.ball]", "[bodies]\nvelocity = [0, 0, 1]\n[bodies.ball]",
       "bodies.velocity = [0, 0, 1]: must be a table: \"velocity\" belongs to [bodies.NAME]"},
  });
}

TEST(ValueOfAnotherType, is_refused_with_what_to_write) {
  const std::string material = "{ density = 1000, young = 1e9 }";
  const auto in_body = [](const std::string& line, const std::string& end) {
    return NearMiss{"contact = \"skin\"", "contact = \"skin\"\n" + line, end};
  };
  expect_ends({
      {material, "\"steel\"",
       "material = \"steel\": must be a table: write material = { density = 7800, young = 2.1e11, poisson = "
       "0.3 }"},
      {material, "7800",
       "must be a table: write material = { density = 7800, young = 2.1e11, poisson = 0.3 }"},
      {"1e9 }", "\"210 GPa\" }", "must be a number in Pa, without quotes and without unit"},
      {"1e9 }", "\"1e9\" }", "must be a number in Pa, without quotes"},
      {"1e9 }", "[1e9] }", "must be a number in Pa: write 1000000000.0"},
      {"\"ball.msh\"", "[\"ball.msh\"]", "must be one string: write \"ball.msh\""},
      {"count = 10", "count = \"10\"", "must be a whole number, without quotes"},
      {"count = 10", "count = 1e2", "must be a whole number: write 100"},
      {"[time]", "[output]\nview = \"true\"\n[time]", "must be true or false, without quotes"},
      in_body("velocity = -1.5", "must be three numbers, [x, y, z]: write [0, 0, -1.5] if it points along z"),
      in_body("velocity = [0, -1.5]", "must be three numbers, [x, y, z]"),
      {"[time]", "[loads]\ngravity = 9.81\n[time]", "must be three numbers, [x, y, z]: write [0, 0, -9.81]"},
      {"normal = [0, 0, 1]", "normal = \"-y\"", "must be three numbers, [x, y, z]: write [0, -1, 0]"},
      in_body("damping = 0.02", "must be a table: write damping = { ratio = 0.02 }"),
      in_body("support = \"rim\"", "must be a table: write support = { rim = \"xyz\" }"),
      in_body("support = \"xyz\"", "must be a table: write support = { GROUP = \"xyz\" }"),
      in_body("support = \"left end\"", "must be a table: write support = { \"left end\" = \"xyz\" }"),
      in_body("support = { rim = [\"x\"] }", "support.rim = [\"x\"]: must be one string: write \"x\""),
      in_body("geometry = 0.004", "must be a table: write geometry = { size = 0.004 }"),
      {"\n[bodies.ball]", "output = true\n[bodies.ball]",
       "must be a table: write [output], with its keys below"},
      {"[modes]", "[[modes]]", "must be one table: write [modes], with up_to_hz or count"},
      {"[contact]", "[[contact]]",
       "must be one table: write [contact], with between; several pairs are [[contact.pair]]"},
      {"[time]", "[contact.pair]\n[time]",
       "contact.pair = {…}: must be an array of tables, [[contact.pair]], with two brackets"},
      {"between = [\"ball\", \"floor\"]", "between = \"ball, floor\"",
       "must name two bodies, or a body and an obstacle, as in [\"ball\", \"floor\"]"},
  });
}

TEST(NameThatDoesNotExist, is_refused_with_the_names_that_do) {
  expect_ends({
      {"between = [\"ball\"", "between = [\"Ball\"",
       "there is no body or obstacle \"Ball\". Did you mean \"ball\"?"},
      {"between = [\"ball\"", "between = [\"hammer\"",
       "there is no body or obstacle \"hammer\": there are \"ball\", \"floor\""},
      {"[time]", "[[output.receiver]]\nname = \"mic\"\nbody = \"bal\"\nat = [0, 0, 0]\n[time]",
       "there is no body \"bal\". Did you mean \"ball\"?"},
  });
  // Such an override makes a second body, which lacks a mesh.
  EXPECT_THAT(complaint_about(smallest, {"bodies.bal.velocity=[0,0,1]"}),
              HasSubstr("or did you mean bodies.ball?"));
}

// Otherwise the message would propose what the reader refuses.
TEST(Example, of_every_key_is_accepted) {
  int examples = 0;
  for (const Key& key : body_keys.keys) {
    if (key.example.empty() || key.name == "material") continue;
    ++examples;
    EXPECT_NO_THROW(scene_of(
        changed(smallest, "contact = \"skin\"", "contact = \"skin\"\n" + key.name + " = " + key.example)))
        << key.name;
  }
  EXPECT_EQ(examples, 3);
  EXPECT_NO_THROW(scene_of(
      changed(smallest, "[contact]", "[contact]\nfriction = " + pair_keys.find("friction")->example)));
  EXPECT_NO_THROW(
      scene_of(changed(smallest, "{ density = 1000, young = 1e9 }", body_keys.find("material")->example)));
  EXPECT_NO_THROW(scene_of(
      changed(smallest, "[time]", "[loads]\ngravity = " + loads_keys.find("gravity")->example + "\n[time]")));
  for (const Key& key : scene_keys.keys)
    EXPECT_EQ(key.example.starts_with("[" + key.name), key.type == Type::table) << key.name;
}

// The suggestion is one of the words, or none; a word that exists is its own nearest word.
TEST(MostSimilar, is_none_for_a_word_that_shares_few_letters) {
  const std::vector<std::string> words{"mesh", "gap", "velocity"};
  for (const std::string& word : words) EXPECT_EQ(ricochet::base::most_similar(word, words), word);
  for (const char* word : {"qqq", "x", "", "elephant", "höhe"})
    EXPECT_EQ(ricochet::base::most_similar(word, words), "") << word;
  EXPECT_EQ(ricochet::base::most_similar("VELOCITY", words), "velocity");
  EXPECT_EQ(ricochet::base::most_similar("velo", words), "velocity");
}

}  // namespace ricochet::scene::near_misses_test
