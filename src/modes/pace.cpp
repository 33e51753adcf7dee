// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/pace.hpp"

#include <algorithm>
#include <cmath>

#include "src/modes/symmetric.hpp"
#include "src/modes/tall.hpp"

namespace ricochet::modes {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Seconds of one iteration with this number of vectors, of which `modes` become shapes.
double iteration_seconds(const Pace& pace, double vectors, double modes) {
  // The projected problem is solved each time the basis has grown by 15 %: a geometric series of cubes.
  const double projected = pace.projected / (1 - std::pow(1.15, -3));
  // A product Q S takes half of the operations of an orthogonalisation.
  return pace.vector * vectors + pace.pair * (vectors * vectors / 2 + vectors * modes / 2) +
         projected * vectors * vectors * vectors;
}

}  // namespace

Pace measure(const Operators& operators, Factorisation& factor, double factor_seconds) {
  const LanczosOptions options;
  constexpr Index basis = 64, projected = 160;
  MatrixXd block = operators.mass(operators.noise(options.block, options.seed));
  Pace pace{.factor = factor_seconds};
  pace.vector = seconds_of(operators.comm,
                           [&] {
                             block = factor.solve(block);
                             block = operators.mass(operators.mass(block));
                           }) /
                static_cast<double>(options.block);
  const MatrixXd q = operators.noise(basis, options.seed);
  pace.pair = seconds_of(operators.comm, [&] { tall_subtract(q, inner(operators.comm, q, block), block); }) /
              static_cast<double>(basis * options.block);
  MatrixXd matrix = MatrixXd::NullaryExpr(projected, projected, [](Index i, Index j) {
    return 1 / (1 + std::abs(static_cast<double>(i - j))) + (i == j ? static_cast<double>(i) : 0);
  });
  pace.projected = seconds_of(operators.comm, [&] { eigen_decomposition(operators.comm, matrix); }) /
                   std::pow(static_cast<double>(projected), 3);
  return pace;
}

double expected_seconds(const Pace& pace, const CountModel& model, const std::vector<Task>& tasks,
                        int teams) {
  double sum = 0, slowest = 0;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    if (k % static_cast<std::size_t>(teams) == 0) {
      sum += slowest + pace.factor;
      slowest = 0;
    }
    const Interval& wanted = tasks[k].wanted;
    slowest = std::max(slowest, iteration_seconds(pace, expected_vectors(model, tasks[k]),
                                                  model.count_at(wanted.to) - model.count_at(wanted.from)));
  }
  return sum + slowest;
}

double expected_dense_seconds(const Pace& pace, std::int64_t rows) {
  // A Cholesky factorisation and two transformations cost about as much as the eigenpairs.
  return 2 * pace.projected * std::pow(static_cast<double>(rows), 3);
}

}  // namespace ricochet::modes
