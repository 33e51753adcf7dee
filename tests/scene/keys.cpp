// SPDX-License-Identifier: BSD-2-Clause
// The reader agrees with the key reference.
#include "src/scene/keys.hpp"
#include "src/scene/key_reference.hpp"
#include "src/scene/read.hpp"
#include "src/scene/write.hpp"

#include <gmock/gmock.h>

#include <map>
#include <sstream>

#include "tests/scene/scenes.hpp"

namespace ricochet::scene::keys_test {

using namespace test;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Every table, each with only its required keys.
const std::string barest = shared_scene("barest");
/// The same with an orthotropic ball, and with one whose axes turn about a line.
const std::string orthotropic = changed(barest, "density = 1000\nyoung = 1e9\n", R"(density = 1000
young = [3e9, 2e9, 1e9]
shear = [1e9, 1e9, 1e9]
poisson = [0.1, 0.1, 0.1]
)");
const std::string cylindrical =
    changed(orthotropic, "poisson = [0.1, 0.1, 0.1]\n", R"(poisson = [0.1, 0.1, 0.1]
[bodies.ball.material.about]
point = [0, 0, 0]
direction = [0, 0, 1]
)");
/// A run that ends when bodies have parted.
const std::string endless = changed(barest, "duration = 0.01", "duration = \"until parted\"");
/// The same with a cone, and with a mesh as the obstacle.
const std::string coned = changed(barest, "normal = [0, 0, 1]", "shape = \"cone\"\nradius = 1\nlength = 1");
const std::string of_mesh = changed(barest, "normal = [0, 0, 1]", "surface = \"anvil.step\"");
/// A scene to which a key may be added.
const std::string& with_room_for(const Section& section, const Key& key) {
  if (&section == &obstacle_keys && (key.name == "scale" || key.name == "size_factor")) return of_mesh;
  if (&section == &obstacle_keys && (key.name == "side" || key.name == "rotate_deg" ||
                                     key.name == "radius_small" || key.name == "angular_velocity"))
    return coned;
  if (key.name == "table") return tabular;
  if (&section == &about_keys) return cylindrical;
  if (key.name == "longest") return endless;
  return &section == &material_keys && key.name == "axes" ? orthotropic : barest;
}
/// The error of the scene, or an empty string if it is accepted.
std::string refusal(const std::string& text, const std::vector<Override>& overrides) {
  try {
    scene_of(text, overrides);
  } catch (const ricochet::InputError& error) {
    return error.what();
  }
  return "";
}

/// The path of the key in `barest`, in the syntax of --set.
std::string path(const Section& section, const Key& key) {
  if (section.title.front() != '[') return key.name;
  std::string table = section.title.substr(section.title.find_first_not_of('['));
  table = table.substr(0, table.find(']'));
  if (const auto at = table.find("NAME"); at != std::string::npos)
    table.replace(at, 4, table.front() == 'b' ? "ball" : "floor");
  return table + (section.title.starts_with("[[") ? "[0]." : ".") + key.name;
}

template <class Do>
void for_each_key(const Do& act) {
  for (const Section* section : all_sections())
    for (const Key& key : section->keys) {
      SCOPED_TRACE(path(*section, key));
      act(*section, key);
    }
}

TEST(EveryKeyOfTheReference, is_read) {
  for_each_key([](const Section& section, const Key& key) {
    const std::string of_no_type = "=1979-05-27";
    EXPECT_THAT(complaint_about(with_room_for(section, key), {path(section, key) + of_no_type}),
                StartsWith("scene.toml: " + path(section, key) + " = 1979-05-27: must be "));
  });
}

// Some keys belong to one contact law only.
TEST(TheDefaultOfAKey, given_in_the_scene_changes_nothing) {
  int found = 0;
  for_each_key([&](const Section& section, const Key& key) {
    if (!key.fallback.starts_with('`')) return;
    // Axes of loads need finite rotations, which exclude most of what this scene has.
    if (key.name == "axes" && section.title.starts_with("[[loads")) return;
    const std::string value = key.fallback.substr(1, key.fallback.find('`', 1) - 1);
    bool taken = false;
    for (const std::string law : {"compliant", "impulse", "static"}) {
      const std::string scheme = "contact.scheme=" + law,
                        scene = law == "static" ? changed(smallest, "[contact]", "[contact]\nfriction = 0.3")
                                : law == "impulse" ? changed(barest, "static = 0.4", "static = 0")
                                                   : with_room_for(section, key);
      if (!refusal(scene, {scheme, path(section, key) + "=" + value}).empty()) continue;
      taken = true;
      const Folder folder;
      const auto file = folder.write("scene.toml", scene);
      const std::vector<Override> without =
          key.name == "scheme" ? std::vector<Override>{} : std::vector<Override>{scheme};
      std::vector<Override> with = without;
      with.push_back(path(section, key) + "=" + value);
      EXPECT_EQ(to_toml(read(file, with)), to_toml(read(file, without)));
      break;
    }
    EXPECT_TRUE(taken) << value;
    ++found;
  });
  EXPECT_GT(found, 20);
}

// For missing tables, see Refused.is_a_missing_key.
TEST(ARequiredKey, is_reported_if_missing) {
  ASSERT_EQ(refusal(barest, {}), "");
  for_each_key([](const Section& section, const Key& key) {
    if (key.fallback != "–" || key.type == Type::table || key.type == Type::text_or_table ||
        &section == &contact_keys)
      return;
    std::string title = section.title;
    if (const auto at = title.find("NAME"); at != std::string::npos)
      title.replace(at, 4, title.find("bodies") != std::string::npos ? "ball" : "floor");
    const std::string& scene = with_room_for(section, key);
    const auto line = scene.find("\n" + key.name + " = ", scene.find(title));
    ASSERT_NE(line, std::string::npos);
    std::string without = scene;
    without.erase(line, scene.find('\n', line + 1) - line);
    EXPECT_THAT(complaint_about(without), HasSubstr(path(section, key) + ": is missing"));
  });
}

// Bounds of each kind, at and beyond their ends, with numbers written in the test.
TEST(ARange, accepts_what_its_text_states) {
  const Range above{.low = "0", .low_open = true}, from{.low = "1e-6", .high = "0.5"},
      inside{.low = "-1", .high = "0.5", .low_open = true, .high_open = true},
      zero{.low = "1e-12", .high = "1e-3", .or_zero = true}, least{.low = "1"};
  EXPECT_EQ(above.text(), "above 0");
  EXPECT_FALSE(above.holds(0));
  EXPECT_TRUE(above.holds(1e-300));
  EXPECT_EQ(from.text(), "from 1e-6 to 0.5");
  EXPECT_TRUE(from.holds(1e-6) && from.holds(0.5));
  EXPECT_FALSE(from.holds(9.9e-7) || from.holds(0.51));
  EXPECT_EQ(inside.text(), "above -1 and below 0.5");
  EXPECT_TRUE(inside.holds(-0.99) && inside.holds(0.49));
  EXPECT_FALSE(inside.holds(-1) || inside.holds(0.5));
  EXPECT_EQ(zero.text(), "0 or from 1e-12 to 1e-3");
  EXPECT_TRUE(zero.holds(0) && zero.holds(1e-3));
  EXPECT_FALSE(zero.holds(1e-13) || zero.holds(0.01));
  EXPECT_EQ(least.text(), "at least 1");
  EXPECT_TRUE(least.holds(1) && least.holds(1e9));
  EXPECT_FALSE(least.holds(0));
}

TEST(DocsKeysMd, equals_the_output_of_the_programs) {
  std::ostringstream text;
  text << std::ifstream(RICOCHET_SOURCE "/docs/keys.md").rdbuf();
  EXPECT_TRUE(text.str() == key_reference() + "\n")
      << "it differs: build/bin/ricochet-contact --keys > docs/keys.md";
}

}  // namespace ricochet::scene::keys_test
