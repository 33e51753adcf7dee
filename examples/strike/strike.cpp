// SPDX-License-Identifier: BSD-2-Clause
// Strikes a body with a mallet and writes the motion of its surface as a sound.
//
//   strike OUT.wav                      an aluminium bar
//   strike OUT.wav KERNEL [CANDIDATE]   a body prepared by ricochet-kernel, struck at a candidate
//
// The left channel is the point of the strike, and the right channel is the first candidate. The samples are
// velocities without components below 40 Hz. The loudest sample is 0.9 of full scale; the velocity of full
// scale is printed.
#include <sndfile.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numbers>
#include <string>
#include <string_view>

#include "bar.hpp"
#include "ricochet/ricochet.h"

namespace {

constexpr int rate = 44100;
constexpr std::int64_t block = 512;  // as in an audio callback
constexpr double seconds = 2, impact_speed = 2, headroom = 0.9;

using ricochet::InputError;
using ricochet::Vector3;

Vector3 row(const std::vector<double>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

/// Direction out of the body at the candidate; if the kernel has one component only, along its direction.
Vector3 outward(const ricochet::kernels::Surface& surface, std::size_t candidate) {
  const Vector3 normal = row(surface.normal, candidate);
  if (!surface.direction) return normal;
  Vector3 out = *surface.direction;
  if (out[0] * normal[0] + out[1] * normal[1] + out[2] * normal[2] < 0)
    for (double& x : out) x = -x;
  return out;
}

/// The mallet 10 µm away from the body, moving towards it.
ricochet::Scene scene_of(const ricochet::SharedKernel& body, std::size_t candidate) {
  const ricochet::kernels::Surface& surface = body->surface;
  if (candidate >= surface.size())
    throw InputError("candidate " + std::to_string(candidate) + ": the kernel has " +
                     std::to_string(surface.size()) + ", counted from 0");
  const Vector3 out = outward(surface, candidate);
  Vector3 place = row(surface.node, candidate), inward{};
  for (std::size_t k = 0; k < 3; ++k) {
    place[k] += 1e-5 * out[k];
    inward[k] = -out[k];
  }
  Vector3 velocity = inward;
  for (double& x : velocity) x *= impact_speed;
  ricochet::Scene scene;
  scene.rate_hz = rate;
  scene.bodies = {{.name = "body", .kernel = body},
                  {.name = "mallet",
                   .kernel = strike::mallet_kernel(0.02, 1e6, out),
                   .translate = place,
                   .velocity = velocity}};
  scene.pairs = {{.a = "mallet", .b = "body", .direction = inward}};
  scene.pickups = {{.body = "body", .candidate = candidate, .direction = out},
                   {.body = "body", .candidate = 0, .direction = outward(surface, 0)}};
  return scene;
}

/// (n,2) velocities, high-pass filtered by a filter of first order.
std::vector<double> render(ricochet::Simulation& simulation) {
  const std::int64_t total = static_cast<std::int64_t>(seconds * rate);
  std::vector<double> sound(static_cast<std::size_t>(2 * total));
  for (std::int64_t done = 0; done < total; done += block) {
    const std::int64_t n = std::min(block, total - done);
    if (simulation.step_block(n, {.velocity = sound.data() + 2 * done}).status != ricochet::StepStatus::ok)
      throw InputError(
          "the motion of this body cannot be continued; does its kernel have a residual flexibility?");
  }
  const double keep = std::exp(-2 * std::numbers::pi * 40 / rate);
  for (std::size_t channel = 0; channel < 2; ++channel) {
    double before = 0, out = 0;
    for (std::size_t i = channel; i < sound.size(); i += 2) {
      out = keep * out + sound[i] - before;
      before = sound[i];
      sound[i] = out;
    }
  }
  return sound;
}

void write_wav(const std::string& path, std::vector<double> sound) {
  double loudest = 0;
  for (const double x : sound) loudest = std::max(loudest, std::abs(x));
  if (loudest > 0)
    for (double& x : sound) x *= headroom / loudest;
  SF_INFO info{};
  info.samplerate = rate;
  info.channels = 2;
  info.format = SF_FORMAT_WAV | SF_FORMAT_PCM_24;
  SNDFILE* file = sf_open(path.c_str(), SFM_WRITE, &info);
  if (file == nullptr) throw InputError(path + ": " + sf_strerror(nullptr));
  const sf_count_t frames = static_cast<sf_count_t>(sound.size() / 2);
  const bool whole = sf_writef_double(file, sound.data(), frames) == frames;
  if (sf_close(file) != 0 || !whole) throw InputError(path + ": cannot be written completely");
  std::printf("%s: full scale is %.4g m/s\n", path.c_str(), loudest / headroom);
}

std::size_t number(const std::string& text) {
  std::size_t end = 0;
  unsigned long value = 0;
  try {
    value = std::stoul(text, &end);
  } catch (const std::exception&) {
    end = 0;
  }
  if (end == 0 || end != text.size()) throw InputError("candidate \"" + text + "\": must be a number");
  return value;
}

constexpr const char* usage = "usage: strike OUT.wav [KERNEL [CANDIDATE]]";

int run(int count, char** arguments) {
  for (int k = 1; k < count; ++k) {
    const std::string_view word = arguments[k];
    if (word == "--help" || word == "-h") {
      std::printf(
          "%s\n\n"
          "Strikes a body with a mallet and writes the motion of its surface as a stereo sound.\n\n"
          "  OUT.wav    the sound: left the point of the strike, right the first candidate\n"
          "  KERNEL     a body prepared by ricochet-kernel; without it, an aluminium bar\n"
          "  CANDIDATE  number of the candidate that is struck, from 0\n"
          "  --help     shows this text\n"
          "  --version  shows the version of Ricochet\n",
          usage);
      return 0;
    }
    if (word == "--version") {
      std::printf("strike, Ricochet %d.%d.%d\n", RICOCHET_VERSION_MAJOR, RICOCHET_VERSION_MINOR,
                  RICOCHET_VERSION_PATCH);
      return 0;
    }
    if (word.starts_with('-'))
      throw InputError(std::string(word) + ": is not an option: --help shows them; write a file as ./" +
                       std::string(word));
  }
  if (count < 2 || count > 4) {
    std::fprintf(stderr, "%s\n", usage);
    return 2;
  }
  const ricochet::SharedKernel body =
      count > 2 ? ricochet::load_kernel(arguments[2]) : strike::bar_kernel({});
  ricochet::Simulation simulation(
      scene_of(body, count > 3 ? number(arguments[3]) : body->surface.size() / 5));
  write_wav(arguments[1], render(simulation));
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    return run(count, arguments);
  } catch (const InputError& error) {
    std::fprintf(stderr, "strike: %s\n", error.what());
    return 2;
  }
}
