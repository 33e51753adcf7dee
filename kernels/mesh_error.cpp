// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/mesh_error.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace ricochet::kernels {

namespace {

using Eigen::Index;
template <class T>
using RowsOf = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The end of the modes from `from` on whose errors no mode beyond shares.
Index end_of_group(const Eigen::Ref<const Eigen::MatrixXd>& error, Index from) {
  Index end = from + 1;
  for (Index n = from; n < end; ++n)
    for (Index m = error.rows() - 1; m >= end; --m)
      if (error(m, n) != 0) end = m + 1;
  return end;
}

/// Adds a multiple of the unit matrix to the block of two candidates, and to its mirror image.
void add(Surface& surface, std::size_t i, std::size_t j, double value) {
  const auto r = static_cast<std::size_t>(surface.residual_components());
  const std::size_t rows = r * surface.size();
  const auto add_whole = [&](auto& matrix) {
    using Number = typename std::decay_t<decltype(matrix)>::value_type;
    for (std::size_t d = 0; d < r; ++d) {
      matrix[(r * i + d) * rows + r * j + d] += static_cast<Number>(value);
      if (i != j) matrix[(r * j + d) * rows + r * i + d] += static_cast<Number>(value);
    }
  };
  if (!surface.residual_flexibility.empty()) add_whole(surface.residual_flexibility);
  if (!surface.compact) return;
  CompactFlexibility& compact = *surface.compact;
  if (!compact.compressed()) return add_whole(compact.whole);
  const auto first = compact.near_candidate.begin() + compact.near_first[i],
             end = compact.near_candidate.begin() + compact.near_first[i + 1];
  const auto block = std::lower_bound(first, end, static_cast<std::int64_t>(j));
  if (block == end || *block != static_cast<std::int64_t>(j)) return;
  const auto at = static_cast<std::size_t>(block - compact.near_candidate.begin());
  for (std::size_t d = 0; d < 3; ++d) compact.near_block[9 * at + 4 * d] += static_cast<float>(value);
}

}  // namespace

bool has_mesh_error(const Kernel& kernel) {
  return kernel.modes.stiffness_error.size() == kernel.modes.size() * kernel.modes.size();
}

std::vector<std::pair<std::size_t, std::size_t>> neighbours(const Surface& surface) {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  const auto corners = static_cast<std::size_t>(surface.element_corners);
  for (std::size_t e = 0; e + corners <= surface.element.size(); e += corners)
    for (std::size_t a = 0; a < corners; ++a)
      for (std::size_t b = 0; b < corners; ++b) {
        const auto i = static_cast<std::size_t>(surface.element[e + a]),
                   j = static_cast<std::size_t>(surface.element[e + b]);
        if (i < j) out.emplace_back(i, j);
      }
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Kernel without_stiffness_error(Kernel kernel) {
  std::vector<double>& omega = kernel.modes.angular_frequency;
  const std::vector<double> had = omega;
  const Index n = std::ssize(omega);
  const Eigen::Map<const Eigen::MatrixXd> error(kernel.modes.stiffness_error.data(), n, n);
  const Index elastic = std::ranges::upper_bound(omega, 0.0) - omega.begin();
  for (Index from = elastic, end = from; from < n; from = end) {
    end = end_of_group(error, from);
    const Index width = end - from;
    const auto inverse = Eigen::Map<const Eigen::VectorXd>(&omega[from], width).cwiseInverse().eval();
    Eigen::MatrixXd flexible = error.block(from, from, width, width);
    flexible.diagonal().array() += 1;
    flexible = inverse.asDiagonal() * flexible * inverse.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> exact(flexible);
    for (Index k = 0; k < width; ++k) omega[from + k] = 1 / std::sqrt(exact.eigenvalues()[width - 1 - k]);
    const Eigen::MatrixXd combined = exact.eigenvectors().rowwise().reverse();
    for_each_of_modes(kernel, [&]<class T>(std::vector<T>& values) {
      Eigen::Map<RowsOf<T>> rows(values.data(), std::ssize(values) / n, n);
      rows.middleCols(from, width) *= combined.cast<T>();
    });
  }
  // Nodes of rods have their exact static displacements, so that B Bᵀ/ω² of each mode remains.
  if (kernel.surface.corners() == 1)
    for (std::size_t k = 0; k < kernel.surface.shape.size(); ++k)
      if (const auto m = static_cast<Index>(k) % n; m >= elastic)
        kernel.surface.shape[k] *= omega[m] / had[m];
  return kernel;
}

Kernel without_flexibility_error(Kernel kernel) {
  Surface& surface = kernel.surface;
  const std::vector<double>& error = surface.mesh_error;
  for (std::size_t i = 0; i < error.size(); ++i) add(surface, i, i, error[i]);
  for (const auto& [i, j] : neighbours(surface))
    add(surface, i, j, -surface.mesh_error_coupling * std::sqrt(error[i] * error[j]));
  return kernel;
}

}  // namespace ricochet::kernels
