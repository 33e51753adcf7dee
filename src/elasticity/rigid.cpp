// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/rigid.hpp"

#include <fmt/format.h>

#include <cmath>

#include "ricochet/error.hpp"

namespace ricochet::elasticity {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// A node that this rank owns.
struct Node {
  std::size_t local;
  std::int64_t row;
};

Eigen::Map<const Vector3d> place_of(const mesh::Mesh& mesh, const Node& node) {
  return Eigen::Map<const Vector3d>(&mesh.position[3 * node.local]);
}

/// A node that two pieces of a part share.
struct Joint {
  Node node;
  Index a, b;  ///< numbers of the pieces in their part
};

/// A connected part, or its pieces, on this rank.
struct Part {
  std::vector<std::vector<Node>> nodes;  ///< of each piece; shared nodes belong to the first of theirs
  std::vector<std::vector<Node>> all;    ///< of each piece, with all shared ones
  std::vector<Joint> joints;
  Index pieces() const { return std::ssize(nodes); }
};

std::vector<Part> parts_of(const mesh::Mesh& mesh) {
  std::vector<Part> parts(static_cast<std::size_t>(mesh.parts));
  const bool jointed = std::ssize(mesh.pieces) > mesh.parts;
  // By piece: its part, and its number there.
  std::vector<std::pair<std::size_t, Index>> where;
  for (std::size_t p = 0; p < (jointed ? mesh.pieces.size() : parts.size()); ++p) {
    const std::size_t of = jointed ? static_cast<std::size_t>(mesh.pieces[p].part) : p;
    where.emplace_back(of, parts[of].pieces());
    parts[of].nodes.emplace_back();
  }
  for (Part& part : parts) part.all = part.nodes;
  const std::vector<std::int64_t>& piece = jointed ? mesh.piece : mesh.part;
  const auto at = [&](std::int64_t p) { return where[static_cast<std::size_t>(p)]; };
  mesh.for_each_owned([&](std::size_t i, std::int64_t row) {
    const auto [part, number] = at(piece[i]);
    parts[part].nodes[static_cast<std::size_t>(number)].push_back({i, row});
    parts[part].all[static_cast<std::size_t>(number)].push_back({i, row});
  });
  for (const auto& [i, other] : mesh.joint) {
    const auto [part, number] = at(other);
    const Node node{i, mesh.owned(mesh.node[i])};
    parts[part].all[static_cast<std::size_t>(number)].push_back(node);
    parts[part].joints.push_back({node, at(piece[i]).second, number});
  }
  return parts;
}

/// Rigid motions of one piece, (6, m). Each column is a combination of e_x, e_y, e_z, e_x × x, e_y × x,
/// e_z × x about the origin. Motions refer to the centroid of the piece's nodes, and rotations are scaled by
/// its size, so that entries are of order one. Collective.
MatrixXd rigid_motions(const mesh::Mesh& mesh, const std::vector<Node>& nodes) {
  if (mesh.dim == 1) {
    MatrixXd motion = MatrixXd::Zero(6, 1);
    for (int k = 0; k < 3; ++k) motion(k, 0) = mesh.axis[static_cast<std::size_t>(k)];
    return motion;
  }
  Eigen::Matrix<double, 5, 1> sums = Eigen::Matrix<double, 5, 1>::Zero();
  for (const Node& node : nodes) {
    const Vector3d x = place_of(mesh, node);
    sums.head<3>() += x;
    sums[3] += x.squaredNorm();
    sums[4] += 1;
  }
  parallel::sum(mesh.comm, sums);
  const Vector3d middle = sums.head<3>() / sums[4];
  const double size = std::sqrt(std::max(sums[3] / sums[4] - middle.squaredNorm(), 1e-300));
  MatrixXd motion = MatrixXd::Identity(6, 6);
  for (int k = 0; k < 3; ++k) {
    motion(3 + k, 3 + k) = 1 / size;
    motion.block<3, 1>(0, 3 + k) = -Vector3d::Unit(k).cross(middle) / size;
  }
  return motion;
}

/// The displacements of a node in these motions, (components, m).
MatrixXd displacement(const mesh::Mesh& mesh, const Node& node, const MatrixXd& motion) {
  MatrixXd here(3, motion.cols());
  for (Index k = 0; k < motion.cols(); ++k) {
    const Vector3d turn = motion.block<3, 1>(3, k);
    here.col(k) = motion.block<3, 1>(0, k) + turn.cross(place_of(mesh, node));
  }
  if (mesh.dim == 1) here = Eigen::Map<const Eigen::RowVector3d>(mesh.axis.data()) * here;
  return here;
}

/// What the pieces of a part can do: m motions each.
struct Motions {
  std::vector<MatrixXd> of;  ///< of each piece, (6, m)
  MatrixXd whole;            ///< (pieces · m, m): the motions of the part as a whole
  MatrixXd resistance;       ///< (pieces · m, pieces · m): Gram matrix of what supports and joints forbid
};

/// Collective.
Motions motions_of(const mesh::Mesh& mesh, const Part& part) {
  // The eigenvectors below take seconds, and pieces by the hundred are a mistake.
  constexpr Index most = 200;
  const Index n = part.pieces();
  if (n > most)
    throw InputError(
        fmt::format("a part of the mesh consists of {} pieces that are joined at edges or points only, and "
                    "at most {} are "
                    "possible: join them at faces, or leave them out",
                    n, most));
  Motions out;
  for (const std::vector<Node>& nodes : part.all) out.of.push_back(rigid_motions(mesh, nodes));
  const Index m = out.of.front().cols();
  out.whole = MatrixXd::Identity(n * m, m);
  for (Index p = 1; p < n; ++p)
    out.whole.middleRows(p * m, m) =
        out.of[static_cast<std::size_t>(p)].colPivHouseholderQr().solve(out.of[0]);
  const auto here = [&](const Node& node, Index p) {
    return displacement(mesh, node, out.of[static_cast<std::size_t>(p)]);
  };
  // Each interface counts by the mean over its nodes, so that one of few nodes is not lost beside large ones.
  MatrixXd shared = MatrixXd::Zero(n, n), held = MatrixXd::Zero(n * m, n * m);
  for (const Joint& joint : part.joints) shared(joint.a, joint.b) += 1;
  parallel::sum(mesh.comm, shared);
  out.resistance = MatrixXd::Zero(n * m, n * m);
  for (const auto& [node, a, b] : part.joints) {
    const MatrixXd of_a = here(node, a), of_b = here(node, b);
    const double weight = 1 / shared(a, b);
    out.resistance.block(a * m, a * m, m, m) += weight * of_a.transpose() * of_a;
    out.resistance.block(b * m, b * m, m, m) += weight * of_b.transpose() * of_b;
    out.resistance.block(a * m, b * m, m, m) -= weight * of_a.transpose() * of_b;
    out.resistance.block(b * m, a * m, m, m) -= weight * of_b.transpose() * of_a;
  }
  Eigen::VectorXd supports = Eigen::VectorXd::Zero(n);
  for (Index p = 0; p < n; ++p)
    for (const Node& node : part.nodes[static_cast<std::size_t>(p)])
      for (int k = 0; k < mesh.components(); ++k)
        if (mesh.is_fixed(node.local, k)) {
          const Eigen::RowVectorXd row = here(node, p).row(k);
          held.block(p * m, p * m, m, m) += row.transpose() * row;
          supports[p] += 1;
        }
  parallel::sum(mesh.comm, supports);
  for (Index p = 0; p < n; ++p)
    out.resistance.block(p * m, p * m, m, m) += held.block(p * m, p * m, m, m) / std::max(supports[p], 1.0);
  parallel::sum(mesh.comm, out.resistance);
  return out;
}

/// Basis of the null space of a Gram matrix, (n, left).
MatrixXd null_space(const MatrixXd& gram) {
  const Index n = gram.rows();
  if (gram.isZero(0)) return MatrixXd::Identity(n, n);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram);
  Index left = 0;
  while (left < n && eigen.eigenvalues()[left] < 1e-9 * eigen.eigenvalues()[n - 1]) ++left;
  return eigen.eigenvectors().leftCols(left);
}

/// A basis of the same space that does not depend on round-off, and hence not on the number of ranks: the
/// projections of `first` and of the unit vectors, in this order, that are not close to those before them.
MatrixXd canonical(const MatrixXd& basis, const MatrixXd& first) {
  const Index n = basis.rows();
  MatrixXd candidates(n, first.cols() + n), out(n, basis.cols());
  candidates << first, MatrixXd::Identity(n, n);
  candidates = basis * (basis.transpose() * candidates).eval();
  for (Index k = 0; k < out.cols(); ++k) {
    const Eigen::RowVectorXd norms = candidates.colwise().norm();
    Index next = 0;
    while (norms[next] < 0.7 * norms.maxCoeff()) ++next;
    out.col(k) = candidates.col(next).normalized();
    candidates -= out.col(k) * (out.col(k).transpose() * candidates).eval();
  }
  return out;
}

/// Basis of the motions that supports and joints leave free. Those of the whole part come first.
MatrixXd left_free(const Motions& motions) {
  const MatrixXd basis = null_space(motions.resistance);
  if (basis.isIdentity(0)) return basis;
  const Eigen::HouseholderQR<MatrixXd> whole(motions.whole);
  return canonical(basis,
                   whole.householderQ() * MatrixXd::Identity(motions.whole.rows(), motions.whole.cols()));
}

/// M times columns, (local rows, r). Collective.
MatrixXd momentum_of(const Body& body, const mesh::Mesh& mesh, const MatrixXd& columns) {
  MatrixXd out(columns.rows(), columns.cols());
  const auto local = static_cast<PetscInt>(columns.rows());
  for (Index j = 0; j < columns.cols(); ++j) {
    parallel::Vector x, y;
    parallel::check(VecCreateMPIWithArray(mesh.comm, mesh.components(), local, PETSC_DECIDE,
                                          columns.col(j).data(), x.out()));
    parallel::check(
        VecCreateMPIWithArray(mesh.comm, mesh.components(), local, PETSC_DECIDE, out.col(j).data(), y.out()));
    parallel::check(MatMult(body.mass, x, y));
  }
  return out;
}

/// Returns the M-orthonormal rigid motions of one connected part that its supports leave free, (local rows,
/// r). Collective.
MatrixXd rigid_modes_of(const mesh::Mesh& mesh, const Body& body, const Part& part) {
  const int c = mesh.components();
  const Motions motions = motions_of(mesh, part);
  const MatrixXd free = left_free(motions);
  MatrixXd modes = MatrixXd::Zero(body.local_rows, free.cols()), load = modes;
  for (Index p = 0; p < part.pieces(); ++p) {
    const MatrixXd& motion = motions.of[static_cast<std::size_t>(p)];
    const MatrixXd combined = motion * free.middleRows(p * motion.cols(), motion.cols());
    for (const Node& node : part.nodes[static_cast<std::size_t>(p)]) {
      modes.middleRows(node.row * c, c) = displacement(mesh, node, combined);
      for (int k = 0; k < c; ++k)
        if (mesh.is_fixed(node.local, k)) modes.row(node.row * c + k).setZero();
      // Fixed rows of the modes are zero, so their entries in the loads do not matter.
      load.middleRows(node.row * c, c) = body.rigid_load.middleRows(node.row * c, c) * combined;
    }
  }
  // The inertia of a shared node is that of all its pieces, whose motions differ.
  if (part.pieces() > 1) load = momentum_of(body, mesh, modes);
  MatrixXd gram = modes.transpose() * load;
  parallel::sum(mesh.comm, gram);
  if (modes.size() == 0) return modes;  // BLAS refuses a matrix without rows
  const Eigen::LLT<MatrixXd> cholesky((gram + gram.transpose()) / 2);
  return cholesky.matrixL().solve(modes.transpose()).transpose();
}

}  // namespace

MatrixXd rigid_modes(const mesh::Mesh& mesh, const Body& body) {
  MatrixXd all(body.local_rows, 0);
  for (const Part& part : parts_of(mesh)) {
    const MatrixXd modes = rigid_modes_of(mesh, body, part);
    all.conservativeResize(Eigen::NoChange, all.cols() + modes.cols());
    all.rightCols(modes.cols()) = modes;
  }
  return all;
}

std::int64_t mechanisms(const mesh::Mesh& mesh) {
  std::int64_t count = 0;
  for (const Part& part : parts_of(mesh)) {
    if (part.pieces() < 2) continue;
    const Motions motions = motions_of(mesh, part);
    const MatrixXd &whole = motions.whole, as_whole = whole.transpose() * motions.resistance * whole;
    const double scale = motions.resistance.norm() * whole.squaredNorm();
    count += null_space(motions.resistance).cols();
    // Without supports, round-off remains.
    count -= as_whole.norm() < 1e-9 * scale ? whole.cols() : null_space(as_whole).cols();
  }
  return count;
}

}  // namespace ricochet::elasticity
