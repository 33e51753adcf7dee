// SPDX-License-Identifier: BSD-2-Clause
// Small scenes for the tests, each in a folder of its own.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "ricochet/error.hpp"
#include "src/scene/read.hpp"
#include "src/scene/scene.hpp"
#include "tests/support.hpp"

namespace ricochet::scene::test {

using ricochet::test::complaint_of;
using ricochet::test::Folder;

/// The text of a file in tests/scene/scenes/, which programs/mistakes.py reads as well.
inline std::string shared_scene(const std::string& name) {
  std::ifstream file(RICOCHET_SOURCE "/tests/scene/scenes/" + name + ".toml");
  EXPECT_TRUE(file) << name;
  return {std::istreambuf_iterator<char>(file), {}};
}

inline const std::string smallest =
    shared_scene("smallest");  // required keys only: all others have their defaults
inline const std::string tabular = shared_scene("tabular");  // kernels from a file replace the bodies
// Two bodies, an obstacle and two pairs. Every key has a value other than its default.
inline const std::string fullest = shared_scene("fullest");
inline const std::string open_scene =
    shared_scene("open");  // the smallest without [modes], with a block from a .geo file

/// `text` with the only occurrence of `from` replaced.
inline std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "the scene does not hold: " << from;
  if (at == std::string::npos) return text;
  EXPECT_EQ(text.find(from, at + 1), std::string::npos) << "the scene holds twice: " << from;
  return text.replace(at, from.size(), to);
}

inline std::vector<Override> with_accuracy(std::vector<Override> more = {}) {
  more.insert(more.begin(), "accuracy=1e-2");
  return more;
}

/// The scene with this text, from a temporary file "scene.toml".
inline Scene scene_of(const std::string& text, const std::vector<Override>& overrides = {}) {
  const Folder folder;
  return read(folder.write("scene.toml", text), overrides);
}

inline const Body& block_of(const Scene& scene) { return *scene.find_body("block"); }

inline std::string complaint_about(const std::string& text, const std::vector<Override>& overrides = {}) {
  return complaint_of([&] { scene_of(text, overrides); });
}

}  // namespace ricochet::scene::test
