// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/surface_stress.hpp"

#include <algorithm>

#include "contact/figures/stress_measures.hpp"

namespace ricochet::contact {

using Eigen::Index;

SurfaceStress::SurfaceStress(const kernels::Kernel& kernel)
    : nodes_(std::ssize(kernel.view->node) / 3),
      stress_(stress_rows * nodes_),
      von_mises_(Eigen::VectorXf::Zero(nodes_)) {
  const kernels::SensitivityOf<float>& seen = *kernel.view->stress;
  const auto add = [&](const std::vector<float>& values, const Vector BodyCoordinates::*of) {
    if (values.empty()) return;
    parts_.push_back({values.data(), std::ssize(values) / (stress_rows * nodes_), of});
    columns_ += parts_.back().width;
  };
  add(seen.shape, &BodyCoordinates::modal);
  add(seen.residual_flexibility, &BodyCoordinates::force);
  add(seen.body_force_residual, &BodyCoordinates::gravity);
  add(seen.load_residual, &BodyCoordinates::load);
  add(seen.motion_residual, &BodyCoordinates::motion);
}

void SurfaceStress::gather(const BodyCoordinates& at, double* x) const noexcept {
  for (const Part& part : parts_) {
    const Vector& values = at.*part.of;
    if (values.size() == part.width)
      x = std::copy_n(values.data(), part.width, x);
    else  // without R, no forces are known
      x = std::fill_n(x, part.width, 0.0);
  }
}

void SurfaceStress::copy(Index first_node, Index count, std::span<const Index> columns,
                         double* out) const noexcept {
  const Index rows = stress_rows * count;
  for (const Index column : columns) {
    Index within = column;
    const Part* part = parts_.data();
    for (; within >= part->width; ++part) within -= part->width;
    const float* from = part->value + stress_rows * first_node * part->width + within;
    for (Index row = 0; row < rows; ++row, from += part->width) *out++ = *from;
  }
}

const Eigen::VectorXf& SurfaceStress::von_mises(const BodyCoordinates& at) {
  using Values = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  stress_.setZero();
  for (const Part& part : parts_)
    if (const Vector& x = at.*part.of; x.size() == part.width && !x.isZero(0))
      stress_.noalias() += Eigen::Map<const Values>(part.value, stress_.size(), part.width) * x.cast<float>();
  for (Index v = 0; v < nodes_; ++v) {
    const Eigen::Matrix<double, stress_rows, 1> s =
        stress_.segment<stress_rows>(stress_rows * v).cast<double>();
    von_mises_[v] = static_cast<float>(contact::von_mises(s.data()));
  }
  return von_mises_;
}

}  // namespace ricochet::contact
