// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/gauges.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

/// Adds a response (rows, columns) times x; an empty one is none.
void add(const std::vector<double>& response, const Vector& x, Eigen::Map<Vector>& out) noexcept {
  if (response.empty() || x.isZero(0)) return;
  const Eigen::Map<const Matrix> all(response.data(), out.size(), x.size());
  out.noalias() += all.lazyProduct(x);
}

void evaluate(const kernels::Sensitivity& seen, const BodyCoordinates& at, double* values,
              Eigen::Index rows) noexcept {
  Eigen::Map<Vector> out(values, rows);
  out.setZero();
  add(seen.shape, at.modal, out);
  add(seen.residual_flexibility, at.force, out);
  add(seen.body_force_residual, at.gravity, out);
  add(seen.load_residual, at.load, out);
  add(seen.motion_residual, at.motion, out);
}

}  // namespace

bool has_gauges(const Model& model) {
  return std::ranges::any_of(model.bodies, [](const auto& body) { return !body.kernel->gauges.empty(); });
}

Gauges::Gauges(const Model& model, const StepOptions& options) : coordinates_(model) {
  for (std::size_t k = 0; k < model.bodies.size(); ++k)
    for (const kernels::Gauge& gauge : model.bodies[k].kernel->gauges) {
      if (std::ranges::any_of(gauges_, [&](const Gauge& known) { return known.kernel->name == gauge.name; }))
        throw InputError(
            base::format("output.gauge: \"{}\" names two points. Give each its own name.", gauge.name));
      gauges_.push_back({&gauge, k, values_.size()});
      values_.resize(values_.size() + stress_rows + (gauge.strain ? 1 : 0));
    }
  const std::optional<Turning> turning = initial_turning(model, options);
  set(0, model.q0, Vector::Zero(model.rows()), turning ? &*turning : nullptr);
}

void Gauges::set(double time, const Vector& q, const Vector& p, const Turning* turning) noexcept {
  coordinates_.set(time, q, p, turning);
  for (const Gauge& gauge : gauges_) {
    const BodyCoordinates& at = coordinates_[gauge.body];
    evaluate(gauge.kernel->stress, at, &values_[gauge.first], stress_rows);
    if (gauge.kernel->strain) evaluate(*gauge.kernel->strain, at, &values_[gauge.first + stress_rows], 1);
  }
}

}  // namespace ricochet::contact
