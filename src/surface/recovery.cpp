// SPDX-License-Identifier: BSD-2-Clause
#include "src/surface/recovery.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>

namespace ricochet::surface {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Nodes for each coefficient of a polynomial; with hardly more nodes than coefficients, errors of the nodes
/// grow.
constexpr double nodes_per_coefficient = 1.25;
/// How often a patch takes the next elements.
constexpr int most_enlargements = 3;
/// Smallest share of a monomial, squared and summed over the nodes, that lower ones do not represent. Of
/// degree p + 1, nodes in too few planes leave round-off. Of degree p + 2, a small share would make the
/// errors of the nodes grow.
constexpr double least_share = 1e-4, least_share_of_highest = 1e-2;
/// Smallest variance of the nodes along an axis, relative to the largest one; nodes in a plane leave
/// round-off.
constexpr double least_variance = 1e-12;

/// Whether a corner takes part in the mean at a point: at a vertex, the others have round-off.
bool takes_part(double corner_weight) { return std::abs(corner_weight) > 1e-12; }

/// The nodes around a corner and the polynomial through their displacements.
struct Patch {
  std::int64_t corner = -1, label = -1;
  std::vector<std::int64_t> seeds{};  ///< global corners; elements with one of them belong to the patch
  std::vector<std::int64_t> nodes{};  ///< global, of these elements, ascending
  Vector3d place = Vector3d::Zero();  ///< of the corner
  Vector3d centre = Vector3d::Zero();
  Matrix3d scale = Matrix3d::Zero();  ///< to coordinates in which the nodes have unit variance
  MatrixXd inverse{};             ///< of Σ w m mᵀ over the nodes, for the first monomials m; 0 if left out
  std::ptrdiff_t determined = 0;  ///< of the monomials of degree p + 1 at most
  bool enough = false;            ///< nodes for all monomials that are determined
  bool sufficient = false;

  Vector3d local(const Vector3d& x) const { return scale * (x - centre); }
  /// Of a node in the sum of squares. Unequal weights matter where the field varies much over the patch, and
  /// at the border, where all nodes lie on one side.
  double weight(const Vector3d& x) const { return std::pow((scale * (x - place)).squaredNorm() + 0.5, -2); }
};

/// Exponents of all monomials up to degree p + 2, by degree; those of rods in the first coordinate alone.
std::vector<std::array<int, 3>> exponents_of(const mesh::Mesh& mesh) {
  std::vector<std::array<int, 3>> out;
  for (int degree = 0; degree <= mesh.order + 2; ++degree)
    for (int i = degree; i >= 0; --i)
      for (int j = degree - i; j >= 0; --j)
        if (mesh.dim == 3 || i == degree) out.push_back({i, j, degree - i - j});
  return out;
}

using Exponents = std::vector<std::array<int, 3>>;

/// @param exponents  by degree
/// @param power  (3, highest degree + 1), is overwritten; @param out  (monomials)
void monomials(const Exponents& exponents, const Vector3d& x, MatrixXd& power, VectorXd& out) {
  const auto& highest = exponents.back();
  power.setOnes(3, highest[0] + highest[1] + highest[2] + 1);
  for (Index degree = 1; degree < power.cols(); ++degree)
    power.col(degree) = power.col(degree - 1).cwiseProduct(x);
  out.resize(std::ssize(exponents));
  for (std::size_t k = 0; k < exponents.size(); ++k) {
    const auto& [i, j, l] = exponents[k];
    out[static_cast<Index>(k)] = power(0, i) * power(1, j) * power(2, l);
  }
}

/// (monomials, 3) their derivatives.
MatrixXd slopes(const Exponents& exponents, const Vector3d& x) {
  MatrixXd out = MatrixXd::Zero(std::ssize(exponents), 3);
  for (std::size_t k = 0; k < exponents.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      auto [i, j, l] = exponents[k];
      const int factor = exponents[k][c];
      if (factor == 0) continue;
      i -= c == 0, j -= c == 1, l -= c == 2;
      out(static_cast<Index>(k), static_cast<Index>(c)) =
          factor * std::pow(x[0], i) * std::pow(x[1], j) * std::pow(x[2], l);
    }
  return out;
}

/// The values of all ranks on every rank. Collective.
std::vector<std::int64_t> from_all(MPI_Comm comm, const std::vector<std::int64_t>& mine) {
  std::vector<std::int64_t> all = parallel::gather(comm, mine);
  parallel::broadcast(comm, all);
  return all;
}

/// Finds the nodes of insufficient patches, and the corners of their elements, which become their next seeds.
/// Collective.
/// @return by patch
std::vector<std::vector<std::int64_t>> find_nodes(const mesh::Mesh& mesh, std::vector<Patch>& patches) {
  std::unordered_map<std::int64_t, std::vector<std::size_t>> of_seed;
  for (std::size_t k = 0; k < patches.size(); ++k)
    if (!patches[k].sufficient)
      for (const std::int64_t seed : patches[k].seeds) of_seed[seed].push_back(k);
  std::vector<std::vector<std::int64_t>> nodes(patches.size()), corners(patches.size());
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const mesh::Block& block = mesh.blocks[b];
    const auto n = static_cast<std::size_t>(block.nodes_per_element),
               ends = static_cast<std::size_t>(mesh::reference_element(block.gmsh_type).corners);
    for (std::size_t e = 0; e < block.size(); ++e) {
      if (mesh.own[b][e] == 0) continue;
      std::vector<std::int64_t> own;
      for (std::size_t a = 0; a < n; ++a)
        own.push_back(mesh.node[static_cast<std::size_t>(block.node[e * n + a])]);
      std::vector<std::size_t> in;
      for (std::size_t a = 0; a < ends; ++a)
        if (const auto found = of_seed.find(own[a]); found != of_seed.end())
          in.insert(in.end(), found->second.begin(), found->second.end());
      mesh::sort_once(in);
      for (const std::size_t k : in) {
        if (patches[k].label != block.label[e]) continue;
        nodes[k].insert(nodes[k].end(), own.begin(), own.end());
        corners[k].insert(corners[k].end(), own.begin(), own.begin() + static_cast<std::ptrdiff_t>(ends));
      }
    }
  }
  const auto shared = [&](std::vector<std::vector<std::int64_t>>& lists) {
    std::vector<std::int64_t> mine;  // pairs of a patch and a node
    for (std::size_t k = 0; k < lists.size(); ++k) {
      mesh::sort_once(lists[k]);
      for (const std::int64_t node : lists[k]) mine.insert(mine.end(), {static_cast<std::int64_t>(k), node});
      lists[k].clear();
    }
    const std::vector<std::int64_t> all = from_all(mesh.comm, mine);
    for (std::size_t i = 0; i < all.size(); i += 2)
      lists[static_cast<std::size_t>(all[i])].push_back(all[i + 1]);
    for (std::vector<std::int64_t>& list : lists) mesh::sort_once(list);
  };
  shared(nodes);
  shared(corners);
  for (std::size_t k = 0; k < patches.size(); ++k)
    if (!patches[k].sufficient) patches[k].nodes = std::move(nodes[k]);
  return corners;
}

/// Calls visit(node, position) for the nodes of a patch that this rank owns.
template <class Visit>
void for_each_own(const mesh::Mesh& mesh, const Patch& patch, Visit&& visit) {
  for (const std::int64_t node : patch.nodes) {
    if (mesh.owned(node) < 0) continue;
    const auto local =
        static_cast<std::size_t>(std::ranges::lower_bound(mesh.node, node) - mesh.node.begin());
    visit(node, Vector3d(&mesh.position[3 * local]));
  }
}

/// The inverse of a Gram matrix of monomials, of which the lower triangle is read, without those that earlier
/// ones determine, whose rows are 0.
/// @param lower  number of monomials of degree p + 1 at most, which come first
/// @return indices of those that are not left out
std::vector<Index> invert(const MatrixXd& gram, Index lower, MatrixXd& inverse) {
  std::vector<Index> kept;
  MatrixXd factor = MatrixXd::Zero(gram.rows(), gram.rows());  // rows of a Cholesky factor
  for (Index k = 0; k < gram.rows(); ++k) {
    VectorXd row = VectorXd::Zero(gram.rows());
    double rest = gram(k, k);
    for (const Index j : kept) {
      row[j] = (gram(k, j) - row.dot(factor.row(j).transpose())) / factor(j, j);
      rest -= row[j] * row[j];
    }
    if (!(rest > (k < lower ? least_share : least_share_of_highest) * gram(k, k))) continue;
    row[k] = std::sqrt(rest);
    factor.row(k) = row.transpose();
    kept.push_back(k);
  }
  inverse = MatrixXd::Zero(gram.rows(), gram.rows());
  const MatrixXd known = gram(kept, kept);
  const MatrixXd solved = known.llt().solve(MatrixXd::Identity(known.rows(), known.cols()));
  inverse(kept, kept) = solved;
  return kept;
}

/// Fits the polynomials of insufficient patches to their nodes. Collective.
void fit(const mesh::Mesh& mesh, const Exponents& exponents, std::vector<Patch>& patches) {
  const Index n = std::ssize(exponents);
  const auto lower =
      std::ranges::count_if(exponents, [&](const auto& e) { return e[0] + e[1] + e[2] <= mesh.order + 1; });
  MatrixXd power;
  VectorXd m;
  MatrixXd moment =
               MatrixXd::Zero(15, std::ssize(patches)),  // Σ x, Σ x xᵀ and the corner, from the first centre
      gram = MatrixXd::Zero(n * n, std::ssize(patches));
  const auto each = [&](auto&& act) {
    for (std::size_t k = 0; k < patches.size(); ++k)
      if (!patches[k].sufficient) act(patches[k], static_cast<Index>(k));
  };
  each([&](Patch& patch, Index k) {
    for_each_own(mesh, patch, [&](std::int64_t node, const Vector3d& x) {
      const Vector3d from = x - patch.centre;
      moment.col(k).head<3>() += from;
      if (node == patch.corner) moment.col(k).tail<3>() = from;
      Eigen::Map<Matrix3d>(&moment(3, k)) += from * from.transpose();
    });
  });
  parallel::sum(mesh.comm, moment);
  each([&](Patch& patch, Index k) {
    const double count = static_cast<double>(patch.nodes.size());
    const Vector3d mean = moment.col(k).head<3>() / count;
    const Matrix3d variance = Eigen::Map<const Matrix3d>(&moment(3, k)) / count - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(variance);
    for (Index c = 0; c < 3; ++c) {
      const double size = axes.eigenvalues()[2 - c];
      patch.scale.row(c).setZero();
      if (size > least_variance * axes.eigenvalues()[2])
        patch.scale.row(c) = axes.eigenvectors().col(2 - c).transpose() / std::sqrt(size);
    }
    patch.place = patch.centre + moment.col(k).tail<3>();
    patch.centre += mean;
    for_each_own(mesh, patch, [&](std::int64_t, const Vector3d& x) {
      monomials(exponents, patch.local(x), power, m);
      Eigen::Map<MatrixXd>(&gram(0, k), n, n).selfadjointView<Eigen::Lower>().rankUpdate(m, patch.weight(x));
    });
  });
  parallel::sum(mesh.comm, gram);
  each([&](Patch& patch, Index k) {
    const Eigen::Map<const MatrixXd> all(&gram(0, k), n, n);
    const auto enough = [&](Index coefficients) {
      return static_cast<double>(patch.nodes.size()) >=
             nodes_per_coefficient * static_cast<double>(coefficients);
    };
    const std::vector<Index> kept = invert(all, lower, patch.inverse);
    patch.determined = std::ranges::count_if(kept, [&](Index m) { return m < lower; });
    patch.enough = enough(std::ssize(kept));
    if (!patch.enough) invert(all.topLeftCorner(lower, lower), lower, patch.inverse);
    patch.sufficient = patch.enough && patch.determined == lower;
  });
}

/// The patches of all corners of the elements that contain the points. Collective.
std::vector<Patch> patches_of(const mesh::Mesh& mesh, const Exponents& exponents,
                              const std::vector<Located>& points) {
  std::map<std::pair<std::int64_t, std::int64_t>, Vector3d> corners;
  for (const Located& point : points)
    for (std::size_t v = 0; v < point.corner_weight.size(); ++v)
      if (takes_part(point.corner_weight[v]))
        corners.emplace(std::pair(point.node[v], point.label), Vector3d(point.place.data()));
  std::vector<Patch> patches;
  for (const auto& [key, place] : corners)
    patches.push_back({.corner = key.first, .label = key.second, .seeds = {key.first}, .centre = place});
  for (int times = 0; times <= most_enlargements; ++times) {
    std::vector<Patch> before(patches.size());
    for (std::size_t k = 0; k < patches.size(); ++k)
      if (!patches[k].sufficient) before[k] = patches[k];
    std::vector<std::vector<std::int64_t>> next = find_nodes(mesh, patches);
    fit(mesh, exponents, patches);
    for (std::size_t k = 0; k < patches.size(); ++k) {
      patches[k].seeds = std::move(next[k]);
      // More elements that determine no more, as in a plate of one element across, are only farther away.
      if (before[k].enough && patches[k].determined == before[k].determined) {
        patches[k] = before[k];
        patches[k].sufficient = true;
      }
    }
  }
  return patches;
}

}  // namespace

std::vector<GradientShare> recover_gradients(const mesh::Mesh& mesh, const std::vector<Located>& points) {
  const Exponents exponents = exponents_of(mesh);
  const std::vector<Patch> patches = patches_of(mesh, exponents, points);
  const auto patch_of = [&](std::int64_t corner, std::int64_t label) -> const Patch& {
    return *std::ranges::lower_bound(patches, std::pair(corner, label), {},
                                     [](const Patch& p) { return std::pair(p.corner, p.label); });
  };
  std::vector<GradientShare> out;
  MatrixXd power;
  VectorXd m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::map<std::int64_t, Vector3d> sums;
    for (std::size_t v = 0; v < points[i].corner_weight.size(); ++v) {
      if (!takes_part(points[i].corner_weight[v])) continue;
      const Patch& patch = patch_of(points[i].node[v], points[i].label);
      const Exponents used(exponents.begin(), exponents.begin() + patch.inverse.rows());
      const MatrixXd by_monomial = points[i].corner_weight[v] * patch.inverse *
                                   slopes(used, patch.local(Vector3d(points[i].place.data()))) * patch.scale;
      for_each_own(mesh, patch, [&](std::int64_t node, const Vector3d& x) {
        monomials(used, patch.local(x), power, m);
        sums.try_emplace(node, Vector3d::Zero()).first->second +=
            patch.weight(x) * (by_monomial.transpose() * m);
      });
    }
    for (const auto& [node, sum] : sums)
      out.push_back(
          {.point = static_cast<std::int64_t>(i), .node = node, .weight = {sum[0], sum[1], sum[2]}});
  }
  return out;
}

}  // namespace ricochet::surface
