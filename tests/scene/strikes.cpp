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

const std::string struck = shared_scene("struck");
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

}  // namespace ricochet::scene::strikes_test
