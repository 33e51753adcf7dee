// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/rotation.hpp"
#include "src/scene/request.hpp"

namespace ricochet::scene {

int Output::receivers_every(double rate_hz) const {
  const double wanted = receivers_rate ? receivers_rate->value : every > 1 ? audio_rows.value : rate_hz;
  const double ratio = std::floor(rate_hz / wanted * (1 + 1e-12));
  return static_cast<int>(std::clamp(ratio, 1.0, double{most_samples_per_receiver_row}));
}

const Body* Scene::find_body(const std::string& name) const {
  const auto found = std::ranges::find(bodies, name, &Body::name);
  return found == bodies.end() ? nullptr : &*found;
}

const Obstacle* Scene::find_obstacle(const std::string& name) const {
  const auto found = std::ranges::find(obstacles, name, &Obstacle::name);
  return found == obstacles.end() ? nullptr : &*found;
}

namespace {

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

}  // namespace

bool is_foreign_mesh(const std::filesystem::path& file) {
  static constexpr std::array endings{".inp",  ".bdf",  ".nas",  ".fem", ".med",   ".mmed", ".vtu",
                                      ".cgns", ".xdmf", ".xml",  ".e",   ".exo",   ".ex2",  ".vol",
                                      ".su2",  ".avs",  ".node", ".ele", ".f3grid"};
  return std::ranges::count(endings, ending_of(file)) > 0;
}

bool Body::foreign() const { return is_foreign_mesh(mesh); }

bool Obstacle::is_drawn() const {
  return shape == Shape::mesh && ending_of(surface) != ".stl" && ending_of(surface) != ".obj";
}

bool Contact::rubs(const std::string& name) const {
  return std::ranges::any_of(pairs, [&](const Pair& pair) { return pair.friction && pair.names(name); });
}

Scene with_finite_rotation(Scene scene, std::string reason) {
  scene.motion.rotation = Rotation::finite;
  scene.motion.rotation_open = false;
  scene.motion.reason = std::move(reason);
  scene.time.precision_by_accuracy = false;  // single precision is for linear rotations
  return scene;
}

std::string slug(const std::string& title) {
  constexpr std::array<std::string_view, 8> separators{"", " ", "-", "_", "/", ".", ", ", ": "};
  std::string result, dropped;
  bool loses = false;
  for (std::size_t k = 0; k <= title.size(); ++k) {  // the end is judged like a character that stays
    const bool end = k == title.size();
    const char c = end ? '\0' : title[k];
    const char lower = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (!end && !(lower >= 'a' && lower <= 'z') && !(lower >= '0' && lower <= '9')) {
      dropped += c;
      continue;
    }
    const bool inside = !end && !result.empty();
    loses = loses || (inside ? std::ranges::count(separators, dropped) == 0 : !dropped.empty());
    if (inside && !dropped.empty()) result += '-';
    dropped.clear();
    if (!end) result += lower;
  }
  if (result.empty()) result = "scene";
  return loses ? result + '-' + sha256(title).substr(0, 6) : result;
}

std::array<double, 9> rotation_of(const Body& body) { return ricochet::rotation_of(body.rotate_deg); }

Vector3 in_body(const Body& body, const Vector3& world) {
  const std::array<double, 9> rotation = rotation_of(body);
  Vector3 own{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t j = 0; j < 3; ++j) own[k] += rotation[3 * j + k] * world[j];
  return own;
}

Vector3 point_in_world(const Body& body, const Vector3& own) {
  const std::array<double, 9> rotation = rotation_of(body);
  Vector3 world = body.translate;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t j = 0; j < 3; ++j) world[k] += rotation[3 * k + j] * own[j];
  return world;
}

Vector3 point_in_body(const Body& body, Vector3 world) {
  for (std::size_t k = 0; k < 3; ++k) world[k] -= body.translate[k];
  return in_body(body, world);
}

bool moves(const Scene& scene, const Obstacle& obstacle) {
  return obstacle.velocity != Vector3{} || obstacle.angular_velocity != Vector3{} ||
         std::ranges::count(scene.loads.motions, obstacle.name, &Forcing::obstacle) > 0;
}

bool leaves_its_surface(const Scene& scene, const Obstacle& obstacle) {
  if (!obstacle.is_half_space()) return moves(scene, obstacle);
  return along_normal(obstacle, obstacle.velocity) != 0 ||
         std::ranges::any_of(scene.loads.motions, [&](const Forcing& one) {
           return one.obstacle == obstacle.name && along_normal(obstacle, one.vector) != 0;
         });
}

double along_normal(const Obstacle& obstacle, const Vector3& vector) {
  double along = 0;
  for (std::size_t k = 0; k < 3; ++k) along += obstacle.normal[k] * vector[k];
  // 1e-9: above the round-off of directions that a scene gives with ten digits
  return std::abs(along) > 1e-9 * std::hypot(vector[0], vector[1], vector[2]) ? along : 0;
}

}  // namespace ricochet::scene
