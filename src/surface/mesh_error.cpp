// SPDX-License-Identifier: BSD-2-Clause
#include "src/surface/mesh_error.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "kernels/flexibility.hpp"
#include "kernels/mesh_error.hpp"
#include "src/elasticity/rigid.hpp"
#include "src/elasticity/surplus.hpp"
#include "src/modes/product.hpp"
#include "src/surface/fine_surface.hpp"

namespace ricochet::surface {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Errors of the stiffness of the lowest `count` modes, relative to ω_m ω_n (N,N). An error of 1 means that
/// nothing is known of a mode but its order of magnitude.
std::vector<double> errors_of_modes(const parallel::Teams& teams, const mesh::Mesh& mesh,
                                    const std::vector<scene::Material>& materials,
                                    const modes::ModeSet& modes, std::size_t count,
                                    const parallel::Progress& progress) {
  std::vector<Index> elastic, number;  // of this team: columns, and among all modes
  std::vector<double> omega;
  for (std::size_t j = 0; j < modes.index.size(); ++j)
    if (const double w = modes.angular_frequency[static_cast<std::size_t>(modes.index[j])];
        w > 0 && std::cmp_less(modes.index[j], count)) {
      elastic.push_back(static_cast<Index>(j));
      number.push_back(modes.index[j]);
      omega.push_back(w);
    }
  const Eigen::Map<const VectorXd> frequency(omega.data(), std::ssize(omega));
  const auto inverse = frequency.cwiseInverse().asDiagonal();
  MatrixXd found = inverse *
                   elasticity::stiffness_errors(mesh, materials, modes.shape(Eigen::all, elastic),
                                                frequency.cwiseAbs2(), progress) *
                   inverse;
  const VectorXd limit = found.diagonal().cwiseSqrt().cwiseMax(1).cwiseInverse();
  found = limit.asDiagonal() * found * limit.asDiagonal();
  MatrixXd mine = MatrixXd::Zero(static_cast<Index>(count), std::ssize(modes.index));
  mine(number, elastic) = found;
  const MatrixXd all = modes.gather(teams, mine);
  return {all.data(), all.data() + count * count};
}

/// Number of different normals around a candidate, at most 3: on a face, on a crease, at a corner.
std::vector<std::size_t> kinds_of(const kernels::Surface& surface) {
  const kernels::WholeSurface whole = kernels::whole_surface(surface);
  std::vector<std::vector<Eigen::Vector3d>> normals(whole.area.size());
  const auto corners = static_cast<std::size_t>(whole.element_corners);
  for (std::size_t k = 0; k < whole.element_normal.size() / 3; ++k) {
    const Eigen::Map<const Eigen::Vector3d> normal(&whole.element_normal[3 * k]);
    auto& known = normals[static_cast<std::size_t>(whole.element[k])];
    if (std::ranges::none_of(known, [&](const auto& n) { return n.dot(normal) > std::cos(crease_angle); }))
      known.push_back(normal);
  }
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < surface.size(); ++i)
    out.push_back(std::clamp<std::size_t>(
        corners == 3 ? normals[static_cast<std::size_t>(whole.held[i])].size() : 1, 1, 3));
  return out;
}

/// The candidate of each kind that is nearest to the middle of all candidates of this kind.
std::vector<std::size_t> samples(const kernels::Surface& surface, const std::vector<std::size_t>& kind) {
  const Eigen::Map<const Eigen::Matrix3Xd> places(surface.places().data(), 3, std::ssize(kind));
  std::vector<std::size_t> out;
  for (std::size_t wanted = 1; wanted <= 3; ++wanted) {
    std::vector<Index> of_kind;
    for (std::size_t i = 0; i < kind.size(); ++i)
      if (kind[i] == wanted) of_kind.push_back(static_cast<Index>(i));
    if (of_kind.empty()) continue;
    const Eigen::Vector3d middle = places(Eigen::all, of_kind).rowwise().mean();
    out.push_back(static_cast<std::size_t>(
        *std::ranges::min_element(of_kind, {}, [&](Index i) { return (places.col(i) - middle).norm(); })));
  }
  return out;
}

/// Static flexibility of each candidate along its normal, by R and by the elastic modes [m/N].
std::vector<double> own_flexibility(const kernels::Kernel& kernel) {
  const kernels::Surface& surface = kernel.surface;
  const kernels::Flexibility flexibility(surface);
  const auto c = static_cast<std::size_t>(surface.components),
             r = static_cast<std::size_t>(surface.residual_components());
  const std::size_t n = kernel.modes.size();
  std::vector<double> out;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const double* normal = &surface.normal[3 * i];
    double& sum = out.emplace_back(0);
    if (!flexibility.empty()) {
      std::array<double, 9> block{};
      flexibility.block(i, i, block.data());
      for (std::size_t a = 0; a < r; ++a)
        for (std::size_t b = 0; b < r; ++b) sum += block[a * r + b] * (r == 1 ? 1 : normal[a] * normal[b]);
    }
    for (std::size_t k = 0; k < n; ++k) {
      if (kernel.modes.angular_frequency[k] == 0) continue;
      double trace = 0;
      for (std::size_t d = 0; d < c; ++d)
        trace += surface.shape[(c * i + d) * n + k] * (c == 1 ? 1 : normal[d]);
      sum += std::pow(trace / kernel.modes.angular_frequency[k], 2);
    }
  }
  return out;
}

/// Forces on candidates, and the error of the displacement under them.
class Presses {
 public:
  /// Factors K on springs.
  Presses(const parallel::Teams& teams, const mesh::Mesh& mesh, const std::vector<scene::Material>& materials,
          const elasticity::Body& body, modes::Factorisation& factor, const Patches& patches,
          const reduction::Loads& loads)
      : teams_(teams),
        mesh_(mesh),
        materials_(materials),
        mass_(body.mass),
        factor_(factor),
        patches_(patches),
        loads_(patches.geometry.direction ? loads : along_normals(loads, patches.geometry)),
        rigid_(elasticity::rigid_modes(mesh, body)) {
    factor.release();
    factor.factor_on_springs(reduction::determinate_rows(mesh.comm, rigid_, factor.entries().first));
  }

  struct Found {
    double flexibility, error;  ///< mean displacement, and its error [m/N]
  };

  /// Under a unit force that is spread over candidates like their areas. Each acts along its own normal in
  /// the solution, and along that of the first one in the growth of the error.
  Found under(const std::vector<std::size_t>& candidates) const {
    const kernels::Surface& surface = patches_.geometry;
    double area = 0;
    std::map<std::int64_t, double> share;
    for (const std::size_t i : candidates) {
      area += surface.area[i];
      for (const auto& [vertex, part] : patches_.share[i]) share[vertex] += part;
    }
    VectorXd load = VectorXd::Zero(loads_.rows());
    for (const std::size_t i : candidates)
      load += surface.area[i] / area * VectorXd(loads_.col(static_cast<Index>(i)));
    Vector3 force;
    for (std::size_t d = 0; d < 3; ++d)
      force[d] = surface.direction ? (*surface.direction)[d] : surface.normal[3 * candidates.front() + d];
    const VectorXd acceleration = rigid_ * modes::inner(mesh_.comm, rigid_, load),
                   balanced = load - mass_(acceleration),
                   solution = modes::shared_solve(teams_, factor_, balanced);
    return {modes::inner(mesh_.comm, balanced, solution)(0, 0),
            elasticity::work_of_growth(mesh_, materials_, raised_load(mesh_.contact, share, area, force),
                                       solution, acceleration)};
  }

 private:
  const parallel::Teams& teams_;
  const mesh::Mesh& mesh_;
  const std::vector<scene::Material>& materials_;
  modes::BlockProduct mass_;
  modes::Factorisation& factor_;
  const Patches& patches_;
  reduction::Loads loads_;
  MatrixXd rigid_;
};

/// The coupling κ with which n like candidates, each with the error d and −κ d to its neighbours, have the
/// error found under a force that is spread over all of them.
/// @param alone  d, @param together  the error under the spread force [m/N], @param count  n
/// @param inside  number of pairs of neighbours among them, @param around  number of neighbours of one
double coupling_of(double alone, double together, std::size_t count, std::size_t inside, std::size_t around) {
  if (inside == 0 || !(alone > 0)) return 0;
  const auto n = static_cast<double>(count);
  return std::clamp((n * alone - n * n * together) / (2 * static_cast<double>(inside) * alone), 0.0,
                    1 / static_cast<double>(around));
}

}  // namespace

void estimate_mesh_error(const parallel::Teams& teams, const mesh::Mesh& mesh,
                         const std::vector<scene::Material>& materials, const elasticity::Body& body,
                         modes::Factorisation& factor, const modes::ModeSet& modes, const Patches& patches,
                         const reduction::Loads& loads, kernels::Kernel& kernel,
                         const parallel::Progress& progress) {
  kernels::Surface& surface = kernel.surface;
  kernel.modes.stiffness_error =
      errors_of_modes(teams, mesh, materials, modes, kernel.modes.size(), progress);
  surface.mesh_error.assign(surface.size(), 0.0);
  if (mesh.dim == 1 || surface.size() == 0) return;  // nodes of rods have their exact static displacements
  const Presses presses(teams, mesh, materials, body, factor, patches, loads);
  const std::vector<std::size_t> kind = kinds_of(patches.geometry);
  std::vector<std::vector<std::size_t>> neighbours(surface.size());
  for (const auto& [i, j] : kernels::neighbours(patches.geometry)) {
    neighbours[i].push_back(j);
    neighbours[j].push_back(i);
  }
  std::array<double, 4> error{};
  bool coupled = false;
  for (const std::size_t i : samples(patches.geometry, kind)) {
    const Presses::Found found = presses.under({i});
    if (found.flexibility > 0) error[kind[i]] = found.error / found.flexibility;
    if (std::exchange(coupled, true)) continue;
    std::vector<std::size_t> together{i};
    std::ranges::copy(neighbours[i], std::back_inserter(together));
    std::size_t inside = 0;
    for (const std::size_t j : together)
      for (const std::size_t k : neighbours[j])
        inside += j < k && std::ranges::count(together, k) > 0 ? 1 : 0;
    surface.mesh_error_coupling = coupling_of(found.error, presses.under(together).error, together.size(),
                                              inside, neighbours[i].size());
  }
  const std::vector<double> own = own_flexibility(kernel);
  for (std::size_t i = 0; i < surface.size(); ++i) surface.mesh_error[i] = error[kind[i]] * own[i];
}

}  // namespace ricochet::surface
