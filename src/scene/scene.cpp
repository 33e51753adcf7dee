// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/scene.hpp"

#include <algorithm>

#include "base/rotation.hpp"

namespace ricochet::scene {

const Body* Scene::find_body(const std::string& name) const {
  const auto found =
      std::find_if(bodies.begin(), bodies.end(), [&](const Body& body) { return body.name == name; });
  return found == bodies.end() ? nullptr : &*found;
}

const Obstacle* Scene::find_obstacle(const std::string& name) const {
  const auto found =
      std::find_if(obstacles.begin(), obstacles.end(), [&](const Obstacle& o) { return o.name == name; });
  return found == obstacles.end() ? nullptr : &*found;
}

std::string slug(const std::string& title) {
  std::string result;
  for (char c : title) {
    const char lower = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if ((lower >= 'a' && lower <= 'z') || (lower >= '0' && lower <= '9')) {
      result += lower;
    } else if (!result.empty() && result.back() != '-') {
      result += '-';
    }
  }
  if (!result.empty() && result.back() == '-') result.pop_back();
  return result.empty() ? "scene" : result;
}

std::array<double, 9> rotation_of(const Body& body) { return ricochet::rotation_of(body.rotate_deg); }

}  // namespace ricochet::scene
