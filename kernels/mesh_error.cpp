// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/mesh_error.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::kernels {

namespace {

/// Beyond these, an estimate says only that the mesh is too coarse, and other changes would be no modes.
constexpr double most_of_square = 0.5, most_of_trace = 0.3;

/// Relative error of the traces of a mode by that of its frequency. Near the first two factors for small
/// errors, it grows like the error of the mode in the energy norm, √(δω/ω), for larger ones: on three bodies
/// of tetrahedra, with errors of frequencies of 0.14 to 3.5 %, it was 0.35 to 0.8 of this.
double error_of_trace(double of_frequency, int order) {
  const double factor = order <= 2 ? 3 : 10;
  return std::min({factor * of_frequency, 0.6 * std::sqrt(of_frequency), most_of_trace});
}

/// Multiplies the traces and frequencies of modes, which keep their static flexibility B Bᵀ/ω².
/// @param factor  (N)
void multiply_traces(Kernel& kernel, const std::vector<double>& factor) {
  const std::size_t n = kernel.modes.size();
  for (std::size_t k = 0; k < n; ++k) kernel.modes.angular_frequency[k] *= factor[k];
  for (std::size_t k = 0; k < kernel.surface.shape.size(); ++k) kernel.surface.shape[k] *= factor[k % n];
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

bool has_mesh_error(const Kernel& kernel) { return kernel.modes.mesh_error.size() == kernel.modes.size(); }

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

Kernel without_frequency_error(Kernel kernel) {
  std::vector<double> factor;
  for (const double error : kernel.modes.mesh_error)
    factor.push_back(std::sqrt(1 - std::min(error, most_of_square)));
  multiply_traces(kernel, factor);
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

Kernel with_trace_error(Kernel kernel) {
  std::vector<double> factor;
  for (const double square : kernel.modes.mesh_error) {
    const double error = error_of_trace(square / 2, kernel.order);
    factor.push_back(1 + (factor.size() % 2 == 0 ? error : -error));
  }
  multiply_traces(kernel, factor);
  return kernel;
}

}  // namespace ricochet::kernels
