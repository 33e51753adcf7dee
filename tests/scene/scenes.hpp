// SPDX-License-Identifier: BSD-2-Clause
// Small scenes for the tests, each in a folder of its own.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "ricochet/error.hpp"
#include "src/scene/read.hpp"
#include "src/scene/scene.hpp"
#include "tests/support.hpp"

namespace ricochet::scene::test {

using ricochet::test::complaint_of;
using ricochet::test::Folder;

/// Required keys only; all others have their defaults.
inline const std::string smallest = R"(
[bodies.ball]
mesh = "ball.msh"
material = { density = 1000, young = 1e9 }
contact = "skin"

[obstacles.floor]
normal = [0, 0, 1]

[modes]
count = 10

[contact]
between = ["ball", "floor"]

[time]
duration = 0.01
)";

/// Kernels from a file replace the bodies.
inline const std::string tabular = R"(
[contact]
kernel = "table"
table = "../tables/rods.h5"

[time]
duration = 0.01
)";

/// Two bodies, an obstacle and two pairs. Every key has a value other than its default.
inline const std::string fullest = R"(
title = "Ball, block & \"floor\""

[bodies.ball]
mesh = "ball.geo"
geometry = { size = 4e-3, "number of turns" = 2 }
order = 2
scale = 0.001
translate = [0.0, 0.11, -2]
rotate_deg = [90, 0.5, -45]
material = { density = 11.3e3, young = 10.4e6, poisson = 0.37 }
damping = { rayleigh = [3, 1e-7] }
velocity = [0.0, -1.5, 3]
angular_velocity = [1, 0, -20.5]
contact = ["rim", "cap"]
support = { clamp = "zyx", "symmetry plane" = "x" }

[bodies.block]
mesh = "../shapes/block.step"
material = { steel = { density = 7800, young = 2.1e11, poisson = 0.3, yield = 2.5e8 }, cork = { density = 240, young = 2e7 } }
contact = "top"

[obstacles."the floor"]
point = [0, -1, 0.5]
normal = [0, 2, 0]

[modes]
up_to_hz = 1500.0
residual_flexibility = false
relative_residual = 1e-6

[contact]
scheme = "impulse"
admittance = "difference"
instant = "exact"
restitution = 0.25
max_pivots = 40

[[contact.pair]]
between = ["ball", "block"]
direction = [0, -3, 4]
along = [0, 0, 5]
spacing = 5e-3
gap = 0.01
reach = 0.02

[[contact.pair]]
between = ["ball", "the floor"]
along = [0, 0, 1]
spacing = 5e-3

[time]
rate_hz = 96000
duration = 0.04

[loads]
gravity = [0.0, -9.81, 1]

[output]
every = 4
view = true
snapshot_every = 100
vtk_every = 16
)";

/// `text` with the only occurrence of `from` replaced.
inline std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "the scene does not hold: " << from;
  if (at == std::string::npos) return text;
  EXPECT_EQ(text.find(from, at + 1), std::string::npos) << "the scene holds twice: " << from;
  return text.replace(at, from.size(), to);
}

/// The smallest scene without [modes], with a block from a .geo file beside the ball.
inline const std::string open_scene = changed(changed(smallest, "[modes]\ncount = 10\n", R"([bodies.block]
mesh = "block.geo"
material = { density = 1000, young = 1e9 }
contact = "top"
)"),
                                              R"(["ball", "floor"])", R"(["ball", "block"])");

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
