// SPDX-License-Identifier: BSD-2-Clause
// A scene of free bodies in MuJoCo, from its first keyframe: the time of its steps, its touches and its
// motion.
//
//   bench_mujoco SCENE.xml DURATION EVERY    one line of JSON: processor seconds, touches, poses each EVERY s
//
// The steps are made twice, first for their time alone.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using Scene = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
using State = std::unique_ptr<mjData, decltype(&mj_deleteData)>;
using Pair = std::pair<int, int>;

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Position (3) [m], quaternion (4) w, x, y, z, velocity (3) [m/s] and spin (3) [rad/s] of a body, in world
/// axes. Body 0 is the world.
std::vector<double> motion(const mjData& state, int body) {
  if (body == 0) return {};
  const double* place = state.qpos + 7 * (body - 1);
  const double* speed = state.qvel + 6 * (body - 1);
  std::array<double, 3> spin{};
  mju_rotVecQuat(spin.data(), speed + 3, place + 3);  // MuJoCo's is in axes of the body
  std::vector<double> out(place, place + 7);
  out.insert(out.end(), speed, speed + 3);
  out.insert(out.end(), spin.begin(), spin.end());
  return out;
}

struct Touch {
  double start = 0, impulse = 0;
};

/// Normal forces [N] of the last step, by pair of bodies
std::map<Pair, double> forces(const mjModel& scene, const mjData& state) {
  std::map<Pair, double> out;
  for (int k = 0; k < state.ncon; ++k) {
    std::array<double, 6> force{};
    mj_contactForce(&scene, &state, k, force.data());
    if (force[0] > 0)
      out[std::minmax(scene.geom_bodyid[state.contact[k].geom1],
                      scene.geom_bodyid[state.contact[k].geom2])] += force[0];
  }
  return out;
}

void run(const char* path, double duration, double every) {
  std::array<char, 1000> complaint{};
  const Scene scene(mj_loadXML(path, nullptr, complaint.data(), complaint.size()), &mj_deleteModel);
  if (!scene) throw std::runtime_error(fmt::format("{}: {}", path, complaint.data()));
  const State state(mj_makeData(scene.get()), &mj_deleteData);
  const double step = scene->opt.timestep;
  const auto steps = std::lround(duration / step), period = std::max(1L, std::lround(every / step));
  mj_resetDataKeyframe(scene.get(), state.get(), 0);
  const double started = processor_seconds();
  for (long k = 0; k < steps; ++k) mj_step(scene.get(), state.get());
  const double seconds = processor_seconds() - started;

  const auto name = [&](int body) { return body ? mj_id2name(scene.get(), mjOBJ_BODY, body) : "floor"; };
  std::map<Pair, Touch> open;
  std::vector<std::string> touches, rows;
  mj_resetDataKeyframe(scene.get(), state.get(), 0);
  for (long k = 0; k < steps; ++k) {
    if (k % period == 0) {
      std::vector<std::vector<double>> bodies;
      for (int body = 1; body < scene->nbody; ++body) bodies.push_back(motion(*state, body));
      rows.push_back(fmt::format("[{},{}]", state->time, bodies));
    }
    const double time = state->time;
    mj_step(scene.get(), state.get());
    const auto found = forces(*scene, *state);
    for (const auto& [pair, force] : found) {
      Touch& touch = open.try_emplace(pair, Touch{time}).first->second;
      touch.impulse += force * step;
    }
    for (auto at = open.begin(); at != open.end();) {
      const auto& [pair, touch] = *at;
      if (found.contains(pair)) {
        ++at;
        continue;
      }
      touches.push_back(
          fmt::format(R"({{"start_s":{},"end_s":{},"bodies":["{}","{}"],"impulse_ns":{},"after":[{},{}]}})",
                      touch.start, time, name(pair.first), name(pair.second), touch.impulse,
                      motion(*state, pair.first), motion(*state, pair.second)));
      at = open.erase(at);
    }
  }
  fmt::print("{{\"seconds\":{},\"steps\":{},\"touches\":[{}],\"rows\":[{}]}}\n", seconds, steps,
             fmt::join(touches, ","), fmt::join(rows, ","));
}

}  // namespace

int main(int count, char** words) {
  try {
    if (count != 4) throw std::invalid_argument("give SCENE.xml DURATION EVERY");
    run(words[1], std::stod(words[2]), std::stod(words[3]));
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_mujoco: {}\n", error.what());
    return 2;
  }
}
