// SPDX-License-Identifier: BSD-2-Clause
#include "contact/static/load_path.hpp"

#include <set>

namespace ricochet::contact {
namespace {

LoadCase unloaded(const Model& model) {
  return {.load = Vector::Zero(model.omega.size()),
          .s = Vector::Zero(model.rows()),
          .belt = Vector::Zero(model.rows())};
}

/// Supports and half-spaces never jump: their displacement at t = 0 has always existed.
void add_supports_and_belts(const Model& model, double t, LoadCase& to) {
  for (const Model::Forcing& one : model.forcing)
    if (one.support) to.s += one.history.at(t) * one.displacement;
  for (const Model::Belt& belt : model.belts) to.belt += belt.history.at(t) * belt.slide;
}

/// @param left  whether loads that jump at t have not jumped yet
LoadCase case_at(const Model& model, double t, bool left) {
  LoadCase out = unloaded(model);
  out.time = t;
  out.load = model.load;
  out.s = model.static_displacement;
  for (const Model::Forcing& one : model.forcing) {
    if (one.support) continue;
    const double h = left && t <= one.history.time.front() ? 0 : one.history.at(t);
    out.load.segment(one.first_mode, one.force.size()) += h * one.force;
    out.s += h * one.displacement;
  }
  add_supports_and_belts(model, t, out);
  return out;
}

}  // namespace

std::vector<LoadCase> load_path(const Model& model) {
  std::set<double> times{0};
  const auto add_knots = [&](const History& history) {
    for (const double t : history.time)
      if (t > 0) times.insert(t);
  };
  for (const Model::Forcing& one : model.forcing) add_knots(one.history);
  for (const Model::Belt& belt : model.belts) add_knots(belt.history);

  std::vector<LoadCase> out{unloaded(model)};
  add_supports_and_belts(model, 0, out.back());
  for (const double t : times)
    for (const bool left : {true, false}) {
      LoadCase next = case_at(model, t, left);
      if (out.size() == 1 || !next.equals(out.back()))
        out.push_back(std::move(next));
      else
        out.back().time = t;
    }
  return out;
}

LoadCase between(const LoadCase& a, const LoadCase& b, double share) {
  if (share == 1) return b;
  return {.time = a.time + share * (b.time - a.time),
          .load = a.load + share * (b.load - a.load),
          .s = a.s + share * (b.s - a.s),
          .belt = a.belt + share * (b.belt - a.belt)};
}

}  // namespace ricochet::contact
