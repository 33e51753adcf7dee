// SPDX-License-Identifier: BSD-2-Clause
// --set KEY=VALUE has the effect of the same line in the file.
#include <gmock/gmock.h>

#include "tests/scene/scenes.hpp"

namespace ricochet::scene::overrides_test {

using namespace test;
using ::testing::ElementsAre;
using ::testing::Pair;

TEST(Set, replaces_a_value_of_the_file) {
  EXPECT_THAT(scene_of(fullest, {"bodies.ball.velocity=[0,-6,0]"}).find_body("ball")->velocity,
              ElementsAre(0, -6, 0));
  EXPECT_EQ(scene_of(smallest, {"time.duration=0.5"}).time.duration, 0.5);
  EXPECT_TRUE(scene_of(smallest, {"output.view=true"}).output.view);
}

TEST(Set, takes_text_that_is_not_toml_as_a_string) {
  EXPECT_EQ(scene_of(smallest, {"title=fast and loose"}).title, "fast and loose");
  EXPECT_EQ(scene_of(smallest, {"contact.scheme=impulse"}).contact.scheme, Scheme::impulse);
  EXPECT_EQ(scene_of(smallest, {"title=\"quoted\""}).title, "quoted");
  EXPECT_EQ(scene_of(smallest, {"title="}).title, "");
  EXPECT_EQ(scene_of(smallest, {"title=a=b"}).title, "a=b");  // the first "=" ends the key
}

TEST(Set, replaces_an_entry_of_a_list) {
  EXPECT_THAT(scene_of(fullest, {"bodies.ball.translate[1]=7"}).find_body("ball")->translate,
              ElementsAre(0, 7, -2));
  EXPECT_EQ(scene_of(smallest, {"contact.between[0]=floor", "contact.between[1]=ball"}).contact.pairs[0].a,
            "ball");
}

TEST(Set, reaches_into_an_entry_of_a_list) {
  const Contact contact = scene_of(fullest, {"contact.pair[1].gap=0.125"}).contact;
  EXPECT_EQ(*contact.pairs[0].gap, 0.01);
  EXPECT_EQ(*contact.pairs[1].gap, 0.125);
}

TEST(Set, creates_missing_tables) {
  EXPECT_THAT(scene_of(smallest, {"loads.gravity=[0,0,-9.81]"}).loads.gravity, ElementsAre(0, 0, -9.81));
  const Scene scene = scene_of(
      smallest, {"bodies.cube.mesh=cube.msh", "bodies.cube.material.density=1",
                 "bodies.cube.material.young=2", "bodies.cube.contact=top", "contact.between[1]=cube"});
  ASSERT_NE(scene.find_body("cube"), nullptr);
  EXPECT_EQ(scene.find_body("cube")->materials[0].young, 2);
}

TEST(Set, accepts_tables) {
  EXPECT_THAT(scene_of(fullest, {"bodies.ball.geometry={ turns = 3 }"}).find_body("ball")->geometry,
              ElementsAre(Pair("turns", 3)));
}

TEST(Set, accepts_quoted_keys_with_dots) {
  EXPECT_THAT(scene_of(smallest, {"bodies.ball.support.\"rim.left\"=xy"}).bodies[0].support,
              ElementsAre(Pair("rim.left", "xy")));
  EXPECT_THAT(scene_of(smallest, {"bodies.ball.support.\"a=b\"=x"}).bodies[0].support,
              ElementsAre(Pair("a=b", "x")));
}

TEST(Set, may_have_blanks_around_the_equals_sign_as_a_file_may) {
  EXPECT_EQ(scene_of(smallest, {"time.duration = 0.5"}).time.duration, 0.5);
  EXPECT_EQ(scene_of(smallest, {"contact.scheme = impulse"}).contact.scheme, Scheme::impulse);
}

TEST(Set, is_applied_in_order) {
  EXPECT_EQ(scene_of(smallest, {"title=first", "title=second"}).title, "second");
  EXPECT_THAT(scene_of(smallest, {"loads.gravity=[1,2,3]", "loads.gravity[0]=9"}).loads.gravity,
              ElementsAre(9, 2, 3));
}

TEST(Set, that_is_not_utf_8_is_refused) {
  for (const char* bytes : {"title=\xff", "title=\xc3", "title=\xc0\x80", "title=\xed\xa0\x80", "t\x80=1"})
    EXPECT_EQ(complaint_about(smallest, {bytes}), "--set: is not UTF-8: give it in that encoding");
  EXPECT_EQ(scene_of(smallest, {"title=\u00e9 \u20ac \U0001f600"}).title, "\u00e9 \u20ac \U0001f600");
}

}  // namespace ricochet::scene::overrides_test
