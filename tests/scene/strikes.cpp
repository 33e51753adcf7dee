// SPDX-License-Identifier: BSD-2-Clause
// Blows by mallets: bodies and pairs that they add, what they share, and what is refused.
#include "src/scene/strikes.hpp"

#include <gmock/gmock.h>

#include "src/scene/request.hpp"
#include "src/scene/write.hpp"
#include "tests/scene/scenes.hpp"

namespace ricochet::scene::strikes_test {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string struck = R"(
[bodies.hammer]
mesh = "ball.msh"
material = { density = 7800, young = 2e11 }
contact = "skin"
translate = [1, 2, 3]
velocity = [0, 0, -2]

[bodies.plate]
mesh = "plate.msh"
material = { density = 1000, young = 1e9 }
contact = "top"
support = { rim = "xyz" }

[modes]
count = 10

[contact]
between = ["hammer", "plate"]
gap = 1e-5

[time]
duration = 3

[[strikes]]
mallet = "hammer"
time = 0.5
speed = 0.7

[[strikes]]
mallet = "hammer"
time = 1.5

[[strikes]]
mallet = "hammer"
time = 2
speed = 5
direction = [0, 3, -4]
translate = [4, 5, 6]
rotate_deg = [0, 0, 90]
)";

TEST(Strikes, after_the_first_add_a_copy_of_the_mallet_and_its_pairs) {
  const Scene scene = scene_of(struck);
  ASSERT_EQ(scene.bodies.size(), 4U);
  std::vector<std::string> names;
  for (const Body& body : scene.bodies) names.push_back(body.name);
  EXPECT_THAT(names, ElementsAre("hammer", "plate", "hammer.2", "hammer.3"));
  const Body &first = scene.bodies[0], &second = scene.bodies[2], &third = scene.bodies[3];
  EXPECT_EQ(first.arrival, 0.5);
  EXPECT_THAT(first.velocity, ElementsAre(0, 0, -0.7));
  EXPECT_EQ(first.copy_of, "");
  EXPECT_EQ(second.arrival, 1.5);  // all else is that of the body in the scene, not of the first strike
  EXPECT_THAT(second.velocity, ElementsAre(0, 0, -2));
  EXPECT_THAT(second.translate, ElementsAre(1, 2, 3));
  EXPECT_EQ(second.copy_of, "hammer");
  EXPECT_THAT(third.velocity, ElementsAre(0, 3, -4));
  EXPECT_THAT(third.translate, ElementsAre(4, 5, 6));
  EXPECT_THAT(third.rotate_deg, ElementsAre(0, 0, 90));
  ASSERT_EQ(scene.contact.pairs.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(scene.contact.pairs[k].a, std::vector({"hammer", "hammer.2", "hammer.3"})[k]);
    EXPECT_EQ(scene.contact.pairs[k].b, "plate");
    EXPECT_EQ(scene.contact.pairs[k].gap, 1e-5);
  }
}

TEST(Strikes, of_one_mallet_share_its_kernel) {
  const Folder folder;
  folder.write("ball.msh", "a mesh");
  folder.write("plate.msh", "another mesh");
  const Scene scene = read(folder.write("scene.toml", struck), {}),
              without = read(folder.write("scene.toml", struck.substr(0, struck.find("[[strikes]]"))), {});
  const auto path = [&](const Scene& of, const char* name) {
    return kernel_path("out", kernel_request(of, *of.find_body(name)));
  };
  for (const char* name : {"hammer", "hammer.2", "hammer.3"})
    EXPECT_EQ(path(scene, name), path(without, "hammer"));
  EXPECT_EQ(path(scene, "plate"), path(without, "plate"));
}

TEST(Strikes, are_written_as_such_and_read_back) {
  const Folder folder;
  const Scene scene = read(folder.write("scene.toml", struck), {});
  const std::string text = to_toml(scene);
  EXPECT_THAT(text, Not(HasSubstr("hammer.2")));
  Scene back = read(folder.write("scene.toml", text), {});
  EXPECT_EQ(back, scene);
  EXPECT_EQ(to_toml(back), text);
}

TEST(Strikes, are_refused_in_one_line) {
  const std::vector<std::pair<std::vector<Override>, std::string>> refusals = {
      {{"strikes[0].mallet=hamer"},
       "strikes[0].mallet = \"hamer\": there is no body \"hamer\". Did you mean \"hammer\"?"},
      {{"strikes[1].mallet=plate"},
       "strikes[1].mallet = \"plate\": bodies.plate has a support, so it cannot fly: name a free body"},
      {{"strikes[0].time=-1"}, "strikes[0].time = -1: must not be negative"},
      {{"strikes[2].time=3"},
       "strikes[2].time = 3: is not before the end, time.duration = 3: lengthen the run, or leave this "
       "strike out"},
      {{"strikes[0].speed=0"}, "strikes[0].speed = 0: must be above 0"},
      {{"strikes[0].pace=1"},
       "strikes[0].pace = 1: unknown key. The keys here are direction, mallet, rotate_deg, speed, time, "
       "translate."},
      {{"bodies.hammer.velocity=[0,0,0]"},
       "strikes[0].direction: is missing: give it, or bodies.hammer.velocity"},
      {{"bodies.hammer.velocity=[0,0,0]", "strikes[0].direction=[1,0,0]"},
       "strikes[1].speed: is missing: give it, or bodies.hammer.velocity"},
      {{"bodies.hammer.angular_velocity=[0,0,1]"},
       "strikes[0].mallet = \"hammer\": bodies.hammer.angular_velocity would turn it before the strike: "
       "leave it "
       "out"},
      {{"output.receiver=[{name=\"mic\",body=\"hammer\",at=[1,2,3]}]"},
       "strikes[0].mallet = \"hammer\": bodies.hammer has a receiver or a load, which a mallet cannot have: "
       "leave "
       "it out"},
      {{"contact.between=[\"plate\",\"hammer\"]"},
       "strikes[0].mallet = \"hammer\": its gap would move \"plate\", the first name in contact.between: "
       "name the "
       "mallet first"},
      {{"accuracy=1e-2"},
       "strikes[0]: errors of several strikes are not estimated: leave it out, or give [modes] and set "
       "accuracy = \"off\""},
      {{"contact.kernel=table"},
       "strikes[0]: sampled responses know no strikes: leave it out, or set contact.kernel = \"modes\""},
      {{"contact.scheme=static"},
       "strikes[0]: bodies at rest strike nothing: leave it out, or choose another contact.scheme"},
      {{"modes.strikes=1"}, "modes.strikes = 1: unknown key here: it belongs to [[strikes]]"}};
  for (const auto& [overrides, line] : refusals)
    EXPECT_EQ(complaint_about(struck, overrides), "scene.toml: " + line);
  EXPECT_THAT(complaint_about(tabular + "[[strikes]]\n"),
              HasSubstr("strikes = [{…}]: is replaced by contact.table"));
}

}  // namespace ricochet::scene::strikes_test
