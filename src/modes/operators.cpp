// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/operators.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "ricochet/error.hpp"

namespace ricochet::modes {

namespace {

std::int64_t local_rows_of(Mat matrix) {
  PetscInt rows = 0;
  parallel::check(MatGetLocalSize(matrix, &rows, nullptr));
  return rows;
}

std::int64_t total_rows_of(Mat matrix) {
  PetscInt rows = 0;
  parallel::check(MatGetSize(matrix, &rows, nullptr));
  return rows;
}

Eigen::VectorXd diagonal_of(MPI_Comm comm, Mat matrix, std::int64_t local_rows) {
  Eigen::VectorXd diagonal(local_rows);
  parallel::Vector values;
  parallel::check(VecCreateMPIWithArray(comm, 1, static_cast<PetscInt>(local_rows), PETSC_DECIDE,
                                        diagonal.data(), values.out()));
  parallel::check(MatGetDiagonal(matrix, values));
  return diagonal;
}

}  // namespace

Operators::Operators(Mat given_stiffness, Mat given_mass, const Eigen::MatrixXd& known)
    : comm(parallel::comm_of(given_stiffness)),
      local_rows(local_rows_of(given_stiffness)),
      total_rows(total_rows_of(given_stiffness)),
      stiffness(given_stiffness),
      mass(given_mass),
      rigid(known),
      rigid_momentum(mass(rigid)),
      below_zero(known.cols()),
      diagonal(diagonal_of(comm, given_stiffness, local_rows)),
      mass_diagonal(diagonal_of(comm, given_mass, local_rows)),
      free_rows(parallel::sum(comm, static_cast<std::int64_t>((mass_diagonal.array() > 0).count()))),
      key(static_cast<std::size_t>(local_rows)) {
  std::iota(key.begin(), key.end(), parallel::sum_before(comm, local_rows));
}

Eigen::MatrixXd Operators::noise(Eigen::Index n, std::uint64_t seed) const {
  // Hashes row and column by splitmix64 (Steele, Lea & Flood 2014).
  const auto mixed = [](std::uint64_t z) {
    z += 0x9e3779b97f4a7c15ULL;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  };
  Eigen::MatrixXd columns(local_rows, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < columns.rows(); ++i) {
      const std::uint64_t bits = mixed(mixed(static_cast<std::uint64_t>(key[static_cast<std::size_t>(i)])) +
                                       mixed(seed + static_cast<std::uint64_t>(j)));
      columns(i, j) = static_cast<double>(bits >> 11) * 0x1p-52 - 1;
    }
  return columns;
}

Eigen::VectorXd Operators::norms(const Eigen::MatrixXd& columns) const {
  Eigen::VectorXd squares = columns.colwise().squaredNorm();
  parallel::sum(comm, squares);
  return squares.cwiseSqrt();
}

Eigen::VectorXd Operators::round_off(const Eigen::Ref<const Eigen::MatrixXd>& shape) const {
  return 8 * std::numeric_limits<double>::epsilon() *
         norms(diagonal.asDiagonal() * shape).cwiseQuotient(norms(stiffness(shape)));
}

Eigen::VectorXd Operators::residuals(const Eigen::Ref<const Eigen::MatrixXd>& shape,
                                     const Eigen::VectorXd& lambda) const {
  Eigen::VectorXd residual(shape.cols());
  // Computes in panels, because both products are as large as their operand.
  constexpr Eigen::Index panel = 64;
  for (Eigen::Index j = 0; j < shape.cols(); j += panel) {
    const Eigen::Index n = std::min(panel, shape.cols() - j);
    const Eigen::MatrixXd force = stiffness(shape.middleCols(j, n));
    const Eigen::MatrixXd defect = force - mass(shape.middleCols(j, n)) * lambda.segment(j, n).asDiagonal();
    residual.segment(j, n) = norms(defect).cwiseQuotient(norms(force));
  }
  return residual;
}

double Operators::stiffest() const {
  double most = 0;
  for (Eigen::Index i = 0; i < local_rows; ++i)
    if (mass_diagonal[i] > 0) most = std::max(most, diagonal[i] / mass_diagonal[i]);
  return parallel::largest(comm, most);
}

ExpectedCount Operators::expected_count() const {
  return [most = stiffest(), rows = static_cast<double>(free_rows)](double lambda) {
    return rows * std::pow(lambda / most, 1.5);
  };
}

void Operators::refuse_band(Hertz up_to, bool from_zero) const {
  const double end = std::pow(RadPerSecond(up_to).value, 2), most = stiffest();
  const auto hertz = [](double lambda) { return std::sqrt(lambda) / (2 * std::numbers::pi); };
  if (end > 1e6 * most)
    throw InputError(fmt::format(
        "modes.up_to_hz = {:.6g}: the mesh has no modes far above {:.2g} Hz: lower it, or refine the mesh",
        up_to.value, hertz(most)));
  if (from_zero && end < 1e-15 * most)
    throw InputError(fmt::format(
        "modes.up_to_hz = {:.6g}: is too near 0 to separate modes of this mesh from rigid motion: give "
        "{:.2g} or more, or a count",
        up_to.value, hertz(1e-15 * most)));
}

}  // namespace ricochet::modes
