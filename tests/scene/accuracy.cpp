// SPDX-License-Identifier: BSD-2-Clause
// `accuracy` chooses only settings that a scene leaves open. Kernels chosen for it belong to this scene only.
#include <gmock/gmock.h>

#include "src/scene/derive.hpp"
#include "src/scene/read.hpp"
#include "src/scene/request.hpp"
#include "src/scene/write.hpp"
#include "tests/scene/scenes.hpp"

namespace {

using namespace ricochet;
using namespace ricochet::scene;
using namespace ricochet::scene::test;
using ::testing::HasSubstr;

/// The smallest scene without [modes], with a block from a .geo file beside the ball.
const std::string open_scene = changed(changed(smallest, "[modes]\ncount = 10\n", R"([bodies.block]
mesh = "block.geo"
material = { density = 1000, young = 1e9 }
contact = "top"
)"),
                                       R"(["ball", "floor"])", R"(["ball", "block"])");

std::vector<Override> with_accuracy(std::vector<Override> more = {}) {
  more.insert(more.begin(), "accuracy=1e-2");
  return more;
}

/// Request of the body with this index: 0 is the block, 1 the ball.
KernelRequest request_of(const std::vector<Override>& overrides, std::size_t body = 1,
                         const std::string& ball = "a ball") {
  const Folder folder;
  folder.write("ball.msh", ball);
  folder.write("block.geo", "a block");
  const Scene scene = read(folder.write("scene.toml", open_scene), overrides);
  return kernel_request(scene, scene.bodies[body]);
}

TEST(Accuracy, leaves_nothing_open_if_it_is_not_requested) {
  const Scene scene = scene_of(smallest);
  EXPECT_FALSE(scene.accuracy);
  EXPECT_FALSE(scene.modes.accuracy);
  EXPECT_FALSE(scene.time.rate_by_accuracy);
  EXPECT_EQ(scene.time.precision, Precision::float64);
}

TEST(Accuracy, chooses_what_is_not_given) {
  for (const char* modes : {"title=x", "modes={}", "modes.residual_flexibility=true"}) {
    const Scene scene = scene_of(open_scene, with_accuracy({modes}));
    EXPECT_EQ(scene.accuracy, 1e-2);
    EXPECT_EQ(scene.modes.accuracy, 1e-2);
    EXPECT_EQ(scene.modes.basis, Basis::contact);
    EXPECT_FALSE(scene.modes.up_to);
    EXPECT_TRUE(scene.time.rate_by_accuracy);
    EXPECT_FALSE(scene.time.precision);
  }
}

TEST(Accuracy, leaves_what_is_given) {
  const Scene scene =
      scene_of(smallest, with_accuracy({"time.rate_hz=1e3", "time.precision=single", "time.duration=1"}));
  EXPECT_FALSE(scene.modes.accuracy);
  EXPECT_EQ(scene.modes.count, 10);
  EXPECT_EQ(scene.modes.basis, Basis::modes);
  EXPECT_FALSE(scene.time.rate_by_accuracy);
  EXPECT_EQ(scene.time.rate.value, 1e3);
  EXPECT_EQ(scene.time.precision, Precision::float32);
}

TEST(Accuracy, is_preserved_by_the_resolved_scene) {
  for (const char* set : {"title=x", "time.rate_hz=1e3", "time.precision=double", "modes.count=3"}) {
    const Folder folder;
    const Scene scene = read(folder.write("scene.toml", open_scene), with_accuracy({set}));
    const Scene back = read(folder.write("resolved.toml", to_toml(scene)));
    EXPECT_EQ(back.accuracy, scene.accuracy);
    EXPECT_EQ(back.modes.accuracy, scene.modes.accuracy);
    EXPECT_EQ(back.modes.count, scene.modes.count);
    EXPECT_EQ(back.time.rate_by_accuracy, scene.time.rate_by_accuracy);
    EXPECT_EQ(back.time.rate.value, scene.time.rate.value);
    EXPECT_EQ(back.time.precision, scene.time.precision);
  }
}

TEST(Accuracy, is_refused_in_one_line_if_it_has_no_meaning) {
  for (const char* value : {"0", "1", "-1e-2", "1e-9"})
    EXPECT_THAT(complaint_about(smallest, {std::string("accuracy=") + value}),
                HasSubstr("must be from 1e-6 to 0.5"));
  EXPECT_THAT(complaint_about(tabular, {"accuracy=1e-2"}), HasSubstr("accuracy"));
  EXPECT_THAT(complaint_about(open_scene), HasSubstr("accuracy"));  // without it, [modes] is missing
  EXPECT_THAT(
      complaint_about(open_scene, with_accuracy({"modes={basis=\"modes\",residual_flexibility=false}"})),
      HasSubstr("residual_flexibility"));
}

TEST(KernelOfAccuracy, moves_with_accuracy_and_with_the_body_beside_it) {
  const std::string hash = request_of(with_accuracy()).hash;
  EXPECT_EQ(request_of(with_accuracy({"bodies.ball.velocity=[0,0,-1]"})).hash, hash);
  EXPECT_EQ(request_of(with_accuracy({"time.rate_hz=1e3"})).hash, hash);
  EXPECT_NE(request_of({"accuracy=1e-3"}).hash, hash);
  EXPECT_NE(request_of(with_accuracy({"bodies.ball.material.young=2e9"})).hash, hash);
  EXPECT_NE(request_of(with_accuracy(), 1, "another ball").hash, hash);
}

TEST(KernelOfAccuracy, is_an_ordinary_one_if_modes_are_given) {
  const std::string hash = request_of({"modes.count=10"}).hash;
  EXPECT_EQ(request_of(with_accuracy({"modes.count=10"})).hash, hash);
  EXPECT_EQ(request_of(with_accuracy({"modes.count=10", "bodies.ball.material.young=2e9"})).hash, hash);
}

TEST(KernelOfAccuracy, is_not_derived_from_another) {
  const KernelRequest wanted = request_of(with_accuracy());
  EXPECT_FALSE(similarity(request_of({"modes.count=10"}), wanted));
  EXPECT_THAT(complaint_of([&] {
                scene::request_of({wanted.hash, wanted.toml, wanted.mesh_sha256}, "x.kernel.h5");
              }),
              HasSubstr("accuracy"));
}

TEST(OtherOrder, is_the_next_lower_one_or_2_for_1) {
  for (const auto& [order, other] : {std::pair{"1", 2}, std::pair{"2", 1}, std::pair{"3", 2}}) {
    const KernelRequest request = request_of({"modes.count=10", std::string("bodies.block.order=") + order});
    const auto found = other_order(request);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->body.order, other);
    EXPECT_NE(found->hash, request.hash);
  }
}

TEST(OtherOrder, does_not_exist_for_a_mesh_file) {
  EXPECT_FALSE(other_order(request_of(with_accuracy(), 0)));
}

}  // namespace
