// SPDX-License-Identifier: BSD-2-Clause
// Instruments made from scenes of two bodies, and their blocks of bytes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "contact/api/scene_model.hpp"
#include "player/player.hpp"
#include "tests/contact/plate.hpp"

namespace ricochet::player::test {

using contact::test::plate;

/// A supported plate that faces −z, and a free one below it that moves up and touches its candidates from
/// `first` on. The free one lies a quarter of a cell aside, so that its partners are interpolated.
inline Scene plates(double speed, double first, double ratio = 1e-3, int points = 3) {
  Scene scene;
  scene.bodies = {
      {.name = "bell", .kernel = plate({.modes = 40, .points = 8, .ratio = ratio, .supported = true})},
      {.name = "mallet",
       .kernel = plate({.modes = 6, .points = points, .mass = 0.1, .ratio = ratio, .flexibility = 2e-7}),
       .rotate_deg = {180, 0, 0},
       .translate = {first + 0.25, 0, -1},
       .velocity = {0, 0, speed}}};
  scene.pairs = {{.a = "mallet", .b = "bell", .direction = Vector3{0, 0, 1}, .gap = 0.0}};
  scene.pickups = {{.body = "bell", .candidate = 7, .direction = {0, 0, 1}},
                   {.body = "bell", .candidate = 0, .direction = {0, 0, 1}}};
  return scene;
}

/// The place where the second body of a scene meets the first one.
inline Place place_of(const Scene& scene) {
  const contact::Model model = model_of(scene);
  const contact::Bodies::Block& bell = model.bodies.at(0);
  const contact::Bodies::Block& mallet = model.bodies.at(1);
  const Vector3& v = scene.bodies.at(1).velocity;
  Place place;
  place.normal = {0, 0, -1};
  place.rate = model.v0.segment(mallet.first_mode, mallet.modes) / std::hypot(v[0], v[1], v[2]);
  place.gap = model.gap;
  place.bulge = model.bulge;
  place.area = model.area;
  place.B.resize(model.points(), bell.modes + mallet.modes);
  place.B << model.B.middleCols(bell.first_mode, bell.modes),
      model.B.middleCols(mallet.first_mode, mallet.modes);
  place.flexibility = model.R;
  return place;
}

inline contact::Vector vector(const std::vector<double>& values) {
  return Eigen::Map<const contact::Vector>(values.data(), std::ssize(values));
}

/// An instrument with one place for each scene; all scenes have the same two bodies. The channels are the
/// first two pickups.
inline Instrument instrument_of(const std::vector<Scene>& scenes) {
  const Scene& scene = scenes.front();
  const kernels::Modes &bell = scene.bodies.at(0).kernel->modes, &mallet = scene.bodies.at(1).kernel->modes;
  const contact::Matrix heard = pickups_of(scene, model_of(scene));
  Instrument out{.contact_rate_hz = 8 * 48e3,
                 .omega = vector(bell.angular_frequency),
                 .decay = vector(bell.decay_rate),
                 .left = heard.row(0).head(std::ssize(bell.decay_rate)),
                 .right = heard.row(1).head(std::ssize(bell.decay_rate)),
                 .mallet_omega = vector(mallet.angular_frequency),
                 .mallet_decay = vector(mallet.decay_rate),
                 .mallets = {{"hard", 1, 0}, {"soft", 2, 1e-6}},
                 .places = {}};
  for (const Scene& one : scenes) out.places.push_back(place_of(one));
  return out;
}

/// The block of an instrument, in the format that instrument.hpp describes.
inline std::vector<std::byte> block_of(const Instrument& instrument) {
  std::vector<std::byte> out;
  const auto put = [&](const void* data, std::size_t bytes) {
    const auto* from = static_cast<const std::byte*>(data);
    out.insert(out.end(), from, from + bytes);
  };
  const auto number = [&](std::size_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    put(&word, sizeof word);
  };
  const auto doubles = [&](const auto& values) { put(values.data(), sizeof(double) * values.size()); };
  std::string names;
  for (const Mallet& mallet : instrument.mallets) names += mallet.name + "\n";
  put("ricochet", 8);
  number(2);
  for (const std::size_t count :
       {static_cast<std::size_t>(instrument.omega.size()),
        static_cast<std::size_t>(instrument.mallet_omega.size()), instrument.mallets.size(),
        instrument.places.size(), names.size(), std::size_t{0}})
    number(count);
  for (const Place& place : instrument.places) number(static_cast<std::size_t>(place.gap.size()));
  put(names.data(), names.size());
  out.resize((out.size() + 7) / 8 * 8);
  put(&instrument.contact_rate_hz, sizeof(double));
  for (const contact::Vector* x : {&instrument.omega, &instrument.decay, &instrument.left, &instrument.right,
                                   &instrument.mallet_omega, &instrument.mallet_decay})
    doubles(*x);
  for (const Mallet& mallet : instrument.mallets) doubles(std::array{mallet.mass, mallet.layer});
  for (const Place& place : instrument.places) {
    doubles(place.point);
    doubles(place.normal);
    doubles(place.rate);
    doubles(place.gap);
    doubles(place.bulge);
    doubles(place.area);
    doubles(place.B);
    doubles(place.flexibility);
  }
  const auto length = static_cast<std::uint32_t>(out.size());
  std::memcpy(out.data() + 8 + 6 * sizeof length, &length, sizeof length);
  return out;
}

}  // namespace ricochet::player::test
