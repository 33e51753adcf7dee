#include "src/modes/modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ricochet::modes {

namespace {

using parallel::check;

/// Modes per slice: one factorisation serves them all; beyond this the basis of the iteration costs more than
/// another one.
constexpr std::int64_t slice_modes = 120;

/// Relative distance of eigenvalues that count as one multiple mode.
constexpr double multiple = 1e-6;

struct Counter {
  const elasticity::Body& body;
  std::int64_t below(double lambda) const { return Factorisation(body.stiffness, body.mass, lambda).below(); }
};

/// Upper end whose count is at least `count` with little to spare, and that count.
std::pair<double, std::int64_t> end_for(const Counter& counter, std::int64_t count, double start) {
  double low = 0, high = start;
  std::int64_t at_high = counter.below(high);
  // The count grows like λ^(3/2) in a solid (Weyl); probes follow that law, a little beyond.
  while (at_high < count) {
    low = high;
    high *=
        std::clamp(1.2 * std::pow(static_cast<double>(count + 1) / static_cast<double>(at_high + 1), 2.0 / 3),
                   1.3, 16.0);
    at_high = counter.below(high);
  }
  const std::int64_t spare = std::max<std::int64_t>(6, count / 8);
  while (at_high > count + spare && high - low > 1e-4 * high) {
    const double middle = low > 0 ? std::sqrt(low * high) : high / 4;
    const std::int64_t n = counter.below(middle);
    if (n >= count) {
      high = middle;
      at_high = n;
    } else {
      low = middle;
    }
  }
  return {high, at_high};
}

/// All elastic modes in (from, to), `expected` of them by inertia, by shift-and-invert Krylov–Schur about the
/// middle.
struct Slice {
  double from, to;
  std::int64_t expected;
};

void solve_slice(const mesh::Mesh& mesh, const elasticity::Body& body, const Slice& slice,
                 const Eigen::MatrixXd& rigid, double tolerance, std::vector<double>& values,
                 Eigen::MatrixXd& shapes) {
  parallel::EigenSolver eps;
  check(EPSCreate(mesh.comm, eps.out()));
  check(EPSSetOperators(eps, body.stiffness, body.mass));
  check(EPSSetProblemType(eps, EPS_GHEP));
  check(EPSSetType(eps, EPSKRYLOVSCHUR));
  const double sigma = (slice.from + slice.to) / 2;
  check(EPSSetTarget(eps, sigma));
  check(EPSSetWhichEigenpairs(eps, EPS_TARGET_MAGNITUDE));
  const auto wanted = parallel::petsc_int(slice.expected);
  check(EPSSetDimensions(eps, wanted, PETSC_DEFAULT, PETSC_DEFAULT));
  // A hundredth of the wanted residual: multiple modes show up only when the rest has converged well.
  check(EPSSetTolerances(eps, std::max(1e-2 * tolerance, 1e-13), 1000));

  ST st = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  check(EPSGetST(eps, &st));
  check(STSetType(st, STSINVERT));
  check(STSetMatStructure(st, SUBSET_NONZERO_PATTERN));
  check(STGetKSP(st, &ksp));
  check(KSPSetType(ksp, KSPPREONLY));
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCCHOLESKY));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));

  std::vector<parallel::Vector> space(static_cast<std::size_t>(rigid.cols()));
  std::vector<Vec> raw;
  Eigen::MatrixXd rigid_copy = rigid;
  for (Eigen::Index j = 0; j < rigid.cols(); ++j) {
    check(VecCreateMPIWithArray(mesh.comm, mesh.components(), static_cast<PetscInt>(rigid.rows()),
                                PETSC_DECIDE, rigid_copy.col(j).data(),
                                space[static_cast<std::size_t>(j)].out()));
    raw.push_back(space[static_cast<std::size_t>(j)]);
  }
  if (!raw.empty()) check(EPSSetDeflationSpace(eps, static_cast<PetscInt>(raw.size()), raw.data()));
  check(EPSSolve(eps));

  PetscInt converged = 0;
  check(EPSGetConverged(eps, &converged));
  std::vector<std::pair<double, PetscInt>> inside;
  for (PetscInt i = 0; i < converged; ++i) {
    double value = 0;
    check(EPSGetEigenvalue(eps, i, &value, nullptr));
    if (value > slice.from && value <= slice.to) inside.emplace_back(value, i);
  }
  if (static_cast<std::int64_t>(inside.size()) != slice.expected)
    throw SolverError(fmt::format("modes: {} found between {:.6g} and {:.6g} Hz but inertia proves {}",
                                  inside.size(),
                                  std::sqrt(std::max(slice.from, 0.0)) / (2 * std::numbers::pi),
                                  std::sqrt(slice.to) / (2 * std::numbers::pi), slice.expected));
  std::sort(inside.begin(), inside.end());
  const Eigen::Index first = shapes.cols();
  shapes.conservativeResize(body.local_rows, first + static_cast<Eigen::Index>(inside.size()));
  for (std::size_t k = 0; k < inside.size(); ++k) {
    parallel::Vector x;
    check(VecCreateMPIWithArray(mesh.comm, mesh.components(), static_cast<PetscInt>(body.local_rows),
                                PETSC_DECIDE, shapes.col(first + static_cast<Eigen::Index>(k)).data(),
                                x.out()));
    check(EPSGetEigenvector(eps, inside[k].second, x, nullptr));
    values.push_back(inside[k].first);
  }
}

std::vector<Slice> plan(const Counter& counter, double end, std::int64_t at_end, std::int64_t rigid) {
  const std::int64_t elastic = at_end - rigid;
  const std::int64_t slices = (elastic + slice_modes - 1) / slice_modes;
  std::vector<Slice> planned;
  double from = 0;
  std::int64_t at_from = rigid;
  for (std::int64_t s = 1; s <= slices; ++s) {
    const double to =
        s == slices ? end : end * std::pow(static_cast<double>(s) / static_cast<double>(slices), 2.0 / 3);
    const std::int64_t at_to = s == slices ? at_end : counter.below(to);
    if (at_to > at_from) planned.push_back({from, to, at_to - at_from});
    from = to;
    at_from = at_to;
  }
  return planned;
}

/// Signs that do not depend on the ranks: among entries within 0.1 % of the largest, the first in reading
/// order is positive.
void fix_signs(const mesh::Mesh& mesh, Eigen::MatrixXd& shapes) {
  const int c = mesh.components();
  std::vector<std::int64_t> order(static_cast<std::size_t>(shapes.rows()));
  for (std::size_t i = 0; i < mesh.node.size(); ++i) {
    const std::int64_t row = mesh.node[i] - mesh.first_node;
    if (row < 0 || row >= mesh.owned_nodes) continue;
    for (int k = 0; k < c; ++k) order[static_cast<std::size_t>(row * c + k)] = mesh.canonical[i] * c + k;
  }
  for (Eigen::Index j = 0; j < shapes.cols(); ++j) {
    double top = shapes.rows() > 0 ? shapes.col(j).cwiseAbs().maxCoeff() : 0;
    top = parallel::largest(mesh.comm, top);
    struct {
      double order;
      int rank;
    } mine{1e300, parallel::rank_of(mesh.comm)}, first{};
    double value = 0;
    for (Eigen::Index i = 0; i < shapes.rows(); ++i)
      if (std::abs(shapes(i, j)) >= 0.999 * top &&
          static_cast<double>(order[static_cast<std::size_t>(i)]) < mine.order) {
        mine.order = static_cast<double>(order[static_cast<std::size_t>(i)]);
        value = shapes(i, j);
      }
    MPI_Allreduce(&mine, &first, 1, MPI_DOUBLE_INT, MPI_MINLOC, mesh.comm);
    MPI_Bcast(&value, 1, MPI_DOUBLE, first.rank, mesh.comm);
    if (value < 0) shapes.col(j) = -shapes.col(j);
  }
}

/// Column 2-norms over all ranks.
Eigen::VectorXd norms(MPI_Comm comm, const Eigen::MatrixXd& x) {
  Eigen::VectorXd squares = x.colwise().squaredNorm();
  parallel::sum(comm, squares.data(), static_cast<std::size_t>(squares.size()));
  return squares.cwiseSqrt();
}

/// ‖Kφ − λMφ‖₂ / ‖Kφ‖₂ of each column.
Eigen::VectorXd residuals(const mesh::Mesh& mesh, const elasticity::Body& body, const Eigen::MatrixXd& shapes,
                          const std::vector<double>& lambda) {
  const Eigen::MatrixXd force = multiply(body.stiffness, shapes);
  const Eigen::Map<const Eigen::VectorXd> values(lambda.data(), static_cast<Eigen::Index>(lambda.size()));
  const Eigen::MatrixXd defect = force - multiply(body.mass, shapes) * values.asDiagonal();
  return norms(mesh.comm, defect).cwiseQuotient(norms(mesh.comm, force));
}

/// Subspace iteration with a Rayleigh–Ritz step until every residual is below `tolerance`, three times at
/// most.
///
/// A slice's solver stops by a measure relative to |λ − σ|, which for the lowest modes of a thin body is
/// thousands of times λ. About σ < 0, far below the cut, what lies outside the span shrinks by (λ − σ)/(λ_cut
/// − σ) and the projected problem sorts out the inside.
void polish(const mesh::Mesh& mesh, const elasticity::Body& body, const Eigen::MatrixXd& rigid, double cut,
            double tolerance, std::vector<double>& lambda, Eigen::MatrixXd& shapes) {
  if (shapes.cols() == 0 || residuals(mesh, body, shapes, lambda).maxCoeff() <= tolerance) return;
  const Factorisation factor(body.stiffness, body.mass, -0.01 * cut);
  const Eigen::MatrixXd rigid_inertia = multiply(body.mass, rigid);
  for (int step = 0; step < 3; ++step) {
    shapes = factor.solve(multiply(body.mass, shapes));
    shapes -= rigid * inner(mesh.comm, rigid_inertia, shapes);
    shapes *= norms(mesh.comm, shapes).cwiseInverse().asDiagonal();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> projected(
        inner(mesh.comm, shapes, multiply(body.stiffness, shapes)),
        inner(mesh.comm, shapes, multiply(body.mass, shapes)));
    shapes *= projected.eigenvectors();
    const Eigen::VectorXd& values = projected.eigenvalues();
    lambda.assign(values.begin(), values.end());
    if (residuals(mesh, body, shapes, lambda).maxCoeff() <= tolerance) return;
  }
}

}  // namespace

ModeSet compute_modes(const mesh::Mesh& mesh, const elasticity::Body& body, const Request& request,
                      const parallel::Progress& progress) {
  const Counter counter{body};
  const Eigen::MatrixXd rigid = elasticity::rigid_modes(mesh, body);
  const std::int64_t r = rigid.cols();
  if (request.count && *request.count > body.free_rows)
    throw InputError(
        fmt::format("modes.count = {}: the body has {} free displacements: ask for fewer, or refine the mesh",
                    *request.count, body.free_rows));

  double end = 0;
  std::int64_t at_end = 0;
  if (request.up_to) {
    end = std::pow(static_cast<RadPerSecond>(*request.up_to).value, 2);
    at_end = counter.below(end);
  } else {
    // First guess: a half wave over the cube root of the volume would do for a compact body; the search needs
    // no more.
    const double size = std::cbrt(body.total_mass);
    std::tie(end, at_end) =
        end_for(counter, *request.count, std::pow(body.wave_speed / std::max(size, 1e-3), 2));
  }
  if (at_end < r)
    throw SolverError(fmt::format("modes: inertia counts {} modes, fewer than the {} rigid ones", at_end, r));

  std::vector<double> lambda;
  Eigen::MatrixXd elastic(body.local_rows, 0);
  const std::vector<Slice> slices = plan(counter, end, at_end, r);
  for (std::size_t s = 0; s < slices.size(); ++s) {
    if (progress) progress(static_cast<std::int64_t>(s), static_cast<std::int64_t>(slices.size()));
    solve_slice(mesh, body, slices[s], rigid, request.relative_residual, lambda, elastic);
  }

  polish(mesh, body, rigid, end, request.relative_residual, lambda, elastic);

  ModeSet set;
  std::int64_t kept = at_end - r;
  set.cut = end;
  if (request.count && r + kept > *request.count) {
    kept = std::max<std::int64_t>(*request.count - r, 0);
    // A multiple mode is kept whole.
    while (kept > 0 && r + kept < at_end &&
           lambda[static_cast<std::size_t>(kept)] <
               (1 + multiple) * lambda[static_cast<std::size_t>(kept) - 1])
      ++kept;
    if (r + kept < at_end) {
      const double last = kept > 0 ? lambda[static_cast<std::size_t>(kept) - 1] : 0;
      set.cut = (last + lambda[static_cast<std::size_t>(kept)]) / 2;
      at_end = counter.below(set.cut);
    }
  }
  set.shape.resize(body.local_rows, r + kept);
  set.shape << rigid, elastic.leftCols(kept);
  set.angular_frequency.assign(static_cast<std::size_t>(r), 0);
  for (std::int64_t k = 0; k < kept; ++k)
    set.angular_frequency.push_back(std::sqrt(lambda[static_cast<std::size_t>(k)]));
  fix_signs(mesh, set.shape);

  // The certificate: counts, residuals, M-orthonormality, each from what is about to be returned.
  const Eigen::MatrixXd gram = inner(mesh.comm, set.shape, multiply(body.mass, set.shape));
  parallel::Vector diagonal;
  check(MatCreateVecs(body.stiffness, diagonal.out(), nullptr));
  check(MatGetDiagonal(body.stiffness, diagonal));
  double stiffest = 0;
  check(VecNorm(diagonal, NORM_INFINITY, &stiffest));
  const Eigen::VectorXd rigid_force = norms(mesh.comm, multiply(body.stiffness, rigid)),
                        rigid_norm = norms(mesh.comm, rigid);
  const Eigen::VectorXd elastic_residual =
      residuals(mesh, body, set.shape.rightCols(kept), {lambda.begin(), lambda.begin() + kept});
  for (Eigen::Index j = 0; j < set.shape.cols(); ++j) {
    set.residual.push_back(j < r ? rigid_force[j] / (stiffest * rigid_norm[j]) : elastic_residual[j - r]);
    if (set.residual.back() > request.relative_residual)
      throw SolverError(
          fmt::format("modes: mode {} at {:.6g} Hz has a residual of {:.2g}, above {:.2g}: loosen "
                      "modes.relative_residual",
                      j + 1, to_hertz({set.angular_frequency[static_cast<std::size_t>(j)]}).value,
                      set.residual.back(), request.relative_residual));
  }
  auto& certificate = set.certificate;
  certificate.upto_hz = std::sqrt(set.cut) / (2 * std::numbers::pi);
  certificate.count_by_inertia = at_end;
  certificate.count_found = set.shape.cols();
  certificate.orthonormality =
      (gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff();
  certificate.complete =
      certificate.count_by_inertia == certificate.count_found && certificate.orthonormality < 1e-8;
  if (!certificate.complete)
    throw SolverError(
        fmt::format("modes: {} found but inertia proves {} below {:.6g} Hz, M-orthonormal to {:.2g}",
                    certificate.count_found, certificate.count_by_inertia, certificate.upto_hz,
                    certificate.orthonormality));
  return set;
}

}  // namespace ricochet::modes
