// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/pressure_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "contact/model/coarsening.hpp"

namespace ricochet::contact {
namespace {

/// Share of Young's modulus up to which strains are small: a uniform pressure p compresses by about p/E.
constexpr double largest_share = 0.02;

}  // namespace

PressureCheck::PressureCheck(const Model& model, std::vector<MaterialLimits> limits)
    : model_(model),
      limits_(std::move(limits)),
      per_area_((model.area.array() > 0).select(model.area.array().inverse(), 0.0)),
      reach_(Vector::Zero(model.points())),
      largest_(model.pairs.size(), 0),
      time_(model.pairs.size(), 0) {
  limits_.resize(model.bodies.size());
}

void PressureCheck::observe(const Vector& force, double time) {
  for (std::size_t p = 0; p < largest_.size(); ++p) {
    const Model::PairBlock& pair = model_.pairs[p];
    if (pair.points == 0) continue;
    const double of_one_point = force.segment(pair.first_point, pair.points)
                                    .cwiseProduct(per_area_.segment(pair.first_point, pair.points))
                                    .maxCoeff();
    if (!(of_one_point > largest_[p])) continue;  // no mean exceeds it
    pressed_.clear();
    for (Eigen::Index i = pair.first_point; i < pair.first_point + pair.points; ++i)
      if (force(i) > 0) pressed_.push_back(i);
    double pressure = 0;
    for (const Eigen::Index i : pressed_) pressure = std::max(pressure, mean_around(i, pair, force));
    if (!(pressure > largest_[p])) continue;
    largest_[p] = pressure;
    time_[p] = time;
  }
}

double PressureCheck::mean_around(Eigen::Index i, const Model::PairBlock& pair, const Vector& force) {
  if (reach_(i) == 0) reach_(i) = reach_of_neighbours(model_.point_a, i, pair.first_point, pair.points);
  double push = 0, area = 0;
  for (const Eigen::Index j : pressed_) {
    if ((model_.point_a.row(i) - model_.point_a.row(j)).norm() > reach_(i)) continue;
    push += force(j);
    area += model_.area(j);
  }
  return area > 0 ? push / area : 0;
}

void PressureCheck::compare(int body, double pressure, double time, Excess& strain, Excess& yielding) const {
  const MaterialLimits& limits = limits_[static_cast<std::size_t>(body)];
  const std::string& name = model_.bodies[static_cast<std::size_t>(body)].name;
  const std::string found =
      fmt::format("the pressure on {} reaches {:.3g} MPa at {:.4g} s", name, pressure * 1e-6, time);
  if (limits.young > 0 && pressure / limits.young > strain.share)
    strain = {pressure / limits.young,
              fmt::format("{}, {:.3g} % of its Young's modulus (above {:g} %): strains are too large for "
                          "linear elasticity. Lower the speed, or round the edge that is pressed",
                          found, 100 * pressure / limits.young, 100 * largest_share)};
  if (limits.yield > 0 && pressure / limits.yield > yielding.share)
    yielding = {
        pressure / limits.yield,
        fmt::format("{}, above yield = {:.3g} MPa: it would deform permanently, which the model leaves "
                    "out, so force and rebound are too large",
                    found, limits.yield * 1e-6)};
}

std::vector<std::string> PressureCheck::warnings() const {
  Excess strain, yielding;
  for (std::size_t p = 0; p < largest_.size(); ++p) {
    compare(model_.pairs[p].a, largest_[p], time_[p], strain, yielding);
    if (model_.pairs[p].b >= 0) compare(model_.pairs[p].b, largest_[p], time_[p], strain, yielding);
  }
  std::vector<std::string> out;
  if (strain.share > largest_share) out.push_back(std::move(strain.text));
  if (yielding.share > 1) out.push_back(std::move(yielding.text));
  return out;
}

}  // namespace ricochet::contact
