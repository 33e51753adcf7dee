// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/matrix_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "src/elasticity/pattern.hpp"
#include "src/mesh/body_file.hpp"
#include "src/mesh/connected.hpp"

namespace ricochet::elasticity {

namespace {

using base::hdf5::any;
using base::hdf5::Reader;
using mesh::Mesh;

/// Rows of a sparse matrix, with ascending columns.
struct Rows {
  std::vector<std::int64_t> start{0}, column;
  std::vector<double> value;

  std::int64_t size() const { return std::ssize(start) - 1; }

  double at(std::int64_t i, std::int64_t j) const {
    const auto first = column.begin() + start[static_cast<std::size_t>(i)],
               last = column.begin() + start[static_cast<std::size_t>(i) + 1];
    const auto found = std::lower_bound(first, last, j);
    return found != last && *found == j ? value[static_cast<std::size_t>(found - column.begin())] : 0;
  }

  template <class Visit>
  void for_each(std::int64_t i, Visit&& visit) const {
    for (auto k = static_cast<std::size_t>(start[static_cast<std::size_t>(i)]);
         k < static_cast<std::size_t>(start[static_cast<std::size_t>(i) + 1]); ++k)
      visit(column[k], value[k]);
  }
};

Rows read_rows(const Reader& file, const std::string& name, std::int64_t rows) {
  Rows matrix;
  if (!file.exists(name))
    file.fail(fmt::format("has neither \"/stiffness\" and \"/mass\" nor \"/modes\": one of them is needed."));
  matrix.start = file.read<std::int64_t>(name + "/start", {any});
  if (matrix.size() != rows)
    file.fail(fmt::format("dataset \"{}/start\" is of a matrix of {} rows: {} nodes have {}, three each.",
                          name, matrix.size(), rows / 3, rows));
  matrix.column = file.read<std::int64_t>(name + "/column", {any});
  matrix.value = file.read<double>(name + "/value", {matrix.column.size()});
  if (matrix.start.front() != 0 || !std::ranges::is_sorted(matrix.start) ||
      matrix.start.back() != std::ssize(matrix.column))
    file.fail(fmt::format("dataset \"{}/start\" does not ascend from 0 to the {} entries.", name,
                          matrix.column.size()));
  for (std::int64_t i = 0; i < rows; ++i) {
    std::int64_t last = -1;
    matrix.for_each(i, [&](std::int64_t j, double value) {
      if (j <= last || j >= rows)
        file.fail(
            fmt::format("dataset \"{}/column\" has {} after {} in row {}: columns must ascend and be below "
                        "{}.",
                        name, j, last, i, rows));
      if (!std::isfinite(value)) file.fail(fmt::format("\"{}\" holds {} in row {}.", name, value, i));
      last = j;
    });
  }
  return matrix;
}

void check_symmetric(const Reader& file, const char* name, const Rows& matrix) {
  // Symmetric entries may differ: sums of element matrices by round-off, printed matrices by their last
  // digit.
  constexpr double tolerance = 1e-9;
  for (std::int64_t i = 0; i < matrix.size(); ++i)
    matrix.for_each(i, [&](std::int64_t j, double value) {
      if (i == j) return;
      const double other = matrix.at(j, i);
      if (std::abs(value - other) > tolerance * (std::abs(matrix.at(i, i)) + std::abs(matrix.at(j, j))))
        file.fail(
            fmt::format("\"{}\" is not symmetric: row {} has {:.6g} in column {}, row {} has {:.6g} in "
                        "column {}; both triangles are required.",
                        name, i, value, j, j, other, i));
    });
}

/// Returns, for each displacement (n), whether it has no row. Refuses displacements that have only stiffness
/// or only mass.
std::vector<char> absent_rows(const Reader& file, const Rows& stiffness, const Rows& mass) {
  std::vector<char> absent;
  for (std::int64_t i = 0; i < stiffness.size(); ++i) {
    const double k = stiffness.at(i, i), m = mass.at(i, i);
    if (k < 0 || (k == 0 && m != 0))
      file.fail(
          fmt::format("\"/stiffness\" has {:.6g} on its diagonal in row {} (node {}, {}): must be "
                      "positive, or 0 like the mass if the displacement is fixed.",
                      k, i, i / 3, "xyz"[i % 3]));
    if (m < 0 || (m == 0 && k != 0))
      file.fail(
          fmt::format("\"/mass\" is not positive definite: it has {:.6g} on its diagonal in row {} "
                      "(node {}, {}).",
                      m, i, i / 3, "xyz"[i % 3]));
    absent.push_back(k == 0);
  }
  return absent;
}

/// Returns the index of the connected part of each node. Parts are ordered by their first nodes. Nodes
/// without any row are fixed; if there are such nodes, the body must have only one part, to which they
/// belong.
std::vector<std::int64_t> connected(const Reader& file, const Rows& stiffness,
                                    const std::vector<char>& absent) {
  std::vector<std::int64_t> part(static_cast<std::size_t>(stiffness.size() / 3), 0);
  mesh::Connections connections(part.size());
  for (std::int64_t i = 0; i < stiffness.size(); ++i)
    stiffness.for_each(i, [&](std::int64_t j, double value) {
      if (value != 0) connections.join(i / 3, j / 3);
    });
  const auto is_absent = [&](std::size_t n) {
    return absent[3 * n] + absent[3 * n + 1] + absent[3 * n + 2] == 3;
  };
  std::int64_t parts = 0;
  bool lost = false;
  for (std::size_t n = 0; n < part.size(); ++n) {
    lost = lost || is_absent(n);
    if (is_absent(n)) continue;
    const auto first = static_cast<std::size_t>(connections.first(static_cast<std::int64_t>(n)));
    part[n] = first == n ? parts++ : part[first];
  }
  if (lost && parts > 1)
    file.fail(
        fmt::format("\"/stiffness\" has {} unconnected parts, and nodes without rows that may "
                    "belong to any of them: keep their rows, and name them in the scene's support.",
                    parts));
  return part;
}

/// Distributes rows from rank 0 to their owners. Collective.
Rows share_out(const Rows& whole, const Mesh& mesh) {
  const auto ranks = static_cast<std::size_t>(parallel::size_of(mesh.comm));
  std::vector<std::int64_t> own{3 * mesh.owned_nodes};
  own = parallel::gather(mesh.comm, own);
  std::vector<std::vector<std::int64_t>> start(ranks), column(ranks);
  std::vector<std::vector<double>> value(ranks);
  std::int64_t row = 0;
  for (std::size_t r = 0; r < own.size(); ++r) {
    start[r].push_back(0);
    for (const std::int64_t end = row + own[r]; row < end; ++row) {
      whole.for_each(row, [&](std::int64_t j, double v) {
        column[r].push_back(j);
        value[r].push_back(v);
      });
      start[r].push_back(std::ssize(column[r]));
    }
  }
  return {parallel::exchange(mesh.comm, start)[0], parallel::exchange(mesh.comm, column)[0],
          parallel::exchange(mesh.comm, value)[0]};
}

/// Data of all nodes on each rank, in the order of the file.
struct Nodes {
  std::vector<double> position;     ///< (n,3)
  std::vector<std::int64_t> fixed;  ///< (n) as in Mesh
  Eigen::MatrixXd imposed;          ///< (3n,3S) displacements that moving supports impose on fixed rows
  bool is_fixed(std::int64_t row) const {
    return (fixed[static_cast<std::size_t>(row / 3)] >> (row % 3)) & 1;
  }
  double x(std::int64_t row, int k) const { return position[static_cast<std::size_t>(row / 3 * 3 + k)]; }
};

Eigen::MatrixXd imposed_displacements(const Nodes& nodes, const std::vector<std::string>& moved) {
  Eigen::MatrixXd shape =
      Eigen::MatrixXd::Zero(std::ssize(nodes.position), static_cast<Eigen::Index>(3 * moved.size()));
  if (moved.empty()) return shape;
  for (Eigen::Index row = 0; row < shape.rows(); ++row)
    for (std::size_t s = 0; s < moved.size(); ++s) {
      const auto k = row % 3;
      const bool of_support = (nodes.fixed[static_cast<std::size_t>(row / 3)] >> (3 + s)) & 1;
      if (!of_support || moved[s].find("xyz"[k]) == std::string::npos) continue;
      shape(row, static_cast<Eigen::Index>(3 * s) + k) = 1;
      break;  // a node that belongs to several supports moves only with the first
    }
  return shape;
}

Pattern pattern_of(const Mesh& mesh, const Rows& stiffness, const Rows& mass) {
  Pattern pattern;
  std::vector<std::int64_t> columns;
  for (std::int64_t node = 0; node < mesh.owned_nodes; ++node) {
    columns.assign(1, mesh.first_node + node);
    for (const Rows* matrix : {&stiffness, &mass})
      for (int k = 0; k < 3; ++k)
        matrix->for_each(3 * node + k, [&](std::int64_t j, double) {
          if (j / 3 > mesh.first_node + node) columns.push_back(j / 3);
        });
    mesh::sort_once(columns);
    append_row(pattern, mesh, columns);
  }
  return pattern;
}

/// Fills K and M. Both have the same pattern, the union of their blocks, because K − σM has all of them.
void fill(const Mesh& mesh, const Nodes& nodes, const Rows& stiffness, const Rows& mass, Body& body) {
  const Pattern pattern = pattern_of(mesh, stiffness, mass);
  body.stiffness = create(mesh, pattern);
  body.mass = create(mesh, pattern);
  using Block = std::array<double, 9>;
  std::map<std::int64_t, std::array<Block, 2>> blocks;
  for (std::int64_t own = 0; own < mesh.owned_nodes; ++own) {
    const std::int64_t node = mesh.first_node + own;
    blocks.clear();
    blocks[node] = {};
    for (std::size_t which = 0; which < 2; ++which)
      for (std::int64_t k = 0; k < 3; ++k)
        (which == 0 ? stiffness : mass).for_each(3 * own + k, [&](std::int64_t j, double value) {
          if (j / 3 < node) return;
          Block& block = blocks.try_emplace(j / 3).first->second[which];
          if (!nodes.is_fixed(3 * node + k) && !nodes.is_fixed(j))
            block[static_cast<std::size_t>(3 * k + j % 3)] = value;
        });
    const auto row = static_cast<PetscInt>(node);
    for (const auto& [other, values] : blocks) {
      const auto column = static_cast<PetscInt>(other);
      parallel::check(MatSetValuesBlocked(body.stiffness, 1, &row, 1, &column, values[0].data(), ADD_VALUES));
      parallel::check(MatSetValuesBlocked(body.mass, 1, &row, 1, &column, values[1].data(), ADD_VALUES));
    }
  }
}

/// Sums over the rows of this rank.
struct Sums {
  std::array<double, 10> moments{};  ///< as for finish_inertia; means over the three directions
  std::array<double, 3> mass{};      ///< by direction
  std::array<double, 3> stretch{};   ///< uᵀKu for u = x_k e_k
  double stiffest = 0;
};

Sums sum_up(const Mesh& mesh, const Nodes& nodes, const Rows& stiffness, const Rows& mass, Body& body) {
  Sums sums;
  for (std::int64_t own = 0; own < body.local_rows; ++own) {
    const std::int64_t i = 3 * mesh.first_node + own;
    const auto d = static_cast<int>(i % 3);
    const bool is_fixed = nodes.is_fixed(i);
    Eigen::RowVector<double, 6> load = Eigen::RowVector<double, 6>::Zero();
    mass.for_each(own, [&](std::int64_t j, double value) {
      const auto e = static_cast<int>(j % 3);
      const Vector3 x{nodes.x(j, 0), nodes.x(j, 1), nodes.x(j, 2)};
      for (int k = 0; k < 6; ++k) load[k] += value * rigid_value(mesh, k, x, e);
      if (is_fixed) return;
      if (nodes.is_fixed(j)) body.imposed.inertia.row(own) += value * nodes.imposed.row(j);
    });
    mass.for_each(own, [&](std::int64_t j, double value) {
      if (j % 3 != d) return;
      sums.mass[static_cast<std::size_t>(d)] += value;
      std::size_t m = 0;
      sums.moments[m++] += value / 3;
      for (int a = 0; a < 3; ++a) sums.moments[m++] += value * nodes.x(j, a) / 3;
      for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b) sums.moments[m++] += value * nodes.x(i, a) * nodes.x(j, b) / 3;
    });
    stiffness.for_each(own, [&](std::int64_t j, double value) {
      if (i == j) sums.stiffest = std::max(sums.stiffest, value);
      if (j % 3 == d) sums.stretch[static_cast<std::size_t>(d)] += value * nodes.x(i, d) * nodes.x(j, d);
      if (!is_fixed && nodes.is_fixed(j)) body.imposed.force.row(own) -= value * nodes.imposed.row(j);
    });
    body.imposed.shape.row(own) = nodes.imposed.row(i);
    if (is_fixed)
      body.imposed.momentum += load.head<3>().transpose() * nodes.imposed.row(i);
    else
      body.rigid_load.row(own) = load;
  }
  return sums;
}

}  // namespace

Body read_matrices(Mesh& mesh, const std::filesystem::path& path, const std::vector<std::string>& moved) {
  Rows stiffness, mass;
  std::vector<char> absent;
  std::vector<std::int64_t> part;
  Nodes nodes;
  nodes.position = parallel::gather(mesh.comm, mesh.position);
  nodes.fixed = parallel::gather(mesh.comm, mesh.fixed);
  parallel::on_first_rank(mesh.comm, [&] {
    const Reader file = mesh::open_body_file(path);
    stiffness = read_rows(file, "/stiffness", 3 * mesh.total_nodes);
    mass = read_rows(file, "/mass", 3 * mesh.total_nodes);
    check_symmetric(file, "/stiffness", stiffness);
    check_symmetric(file, "/mass", mass);
    absent = absent_rows(file, stiffness, mass);
    for (std::size_t row = 0; row < absent.size(); ++row)
      if (absent[row] != 0) nodes.fixed[row / 3] |= std::int64_t{1} << (row % 3);
    part = connected(file, stiffness, absent);
  });
  parallel::broadcast(mesh.comm, absent);
  parallel::broadcast(mesh.comm, part);
  parallel::broadcast(mesh.comm, nodes.position);
  parallel::broadcast(mesh.comm, nodes.fixed);
  const auto first = mesh.first_node;
  mesh.fixed.assign(nodes.fixed.begin() + first, nodes.fixed.begin() + first + mesh.owned_nodes);
  mesh.part.assign(part.begin() + first, part.begin() + first + mesh.owned_nodes);
  mesh.parts = *std::ranges::max_element(part) + 1;
  nodes.imposed = imposed_displacements(nodes, moved);

  Body body;
  body.local_rows = 3 * mesh.owned_nodes;
  body.total_rows = 3 * mesh.total_nodes;
  body.rigid_load = Eigen::MatrixXd::Zero(body.local_rows, 6);
  body.imposed.shape = Eigen::MatrixXd::Zero(body.local_rows, nodes.imposed.cols());
  body.imposed.force = body.imposed.inertia = body.imposed.shape;
  body.imposed.momentum = Eigen::MatrixXd::Zero(3, nodes.imposed.cols());
  stiffness = share_out(stiffness, mesh);
  mass = share_out(mass, mesh);
  fill(mesh, nodes, stiffness, mass, body);
  Sums sums = sum_up(mesh, nodes, stiffness, mass, body);
  parallel::sum(mesh.comm, body.imposed.momentum);
  parallel::sum(mesh.comm, sums.mass);
  parallel::sum(mesh.comm, sums.stretch);
  finish_inertia(mesh.comm, sums.moments, body);
  const auto [least, most] = std::ranges::minmax(sums.mass);
  // If rows are missing, the mass in their direction is smaller.
  const bool whole = std::ranges::count(absent, 1) == 0;
  if (!(least > 0) || (whole && most > (1 + 1e-6) * least))
    throw InputError(
        fmt::format("{}: the mass is {:.6g} kg along x, {:.6g} along y, {:.6g} along z: row 3·node + k must "
                    "be displacement k of a node, and masses must be equal in all directions. {}",
                    path.string(), sums.mass[0], sums.mass[1], sums.mass[2], mesh::body_file_advice));
  // A uniform stretch without contraction has the stiffness of pressure waves.
  const double nu = body.poisson, pressure = *std::ranges::max_element(sums.stretch) / body.total_mass;
  body.wave_speed = std::sqrt(pressure * (1 + nu) * (1 - 2 * nu) / (1 - nu));
  finish_rows(mesh, sums.stiffest, body);
  return body;
}

}  // namespace ricochet::elasticity
