// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/validate.hpp"

#include <fmt/format.h>

#include "ricochet/error.hpp"

namespace ricochet::modes {

void validate_matrices(const mesh::Mesh& mesh, const elasticity::Body& body, Factorisation& factor,
                       const std::string& origin) {
  const Operators operators(mesh, body);
  const double most = operators.stiffest();

  // Printed matrices have about 13 digits, and sums over many elements add round-off.
  constexpr double grounded = 1e-9;
  const Eigen::Index rigid = operators.rigid.cols();
  if (rigid > 0) {
    const double diagonal = parallel::largest(mesh.comm, operators.diagonal.cwiseAbs().maxCoeff());
    const double left = operators.norms(operators.stiffness(operators.rigid))
                            .cwiseQuotient(diagonal * operators.norms(operators.rigid))
                            .maxCoeff();
    if (left > grounded)
      throw InputError(fmt::format(
          "{}: the stiffness resists rigid motion (by {:.2g} of its largest entry): leave supports out of it "
          "and name them in the scene's support, or leave out the rows that they hold; row 3·node + k must "
          "be displacement k of a node",
          origin, left));
  }

  // At this shift, −σM dominates K, so that there are negative pivots only if M is not positive definite.
  constexpr double beyond = 1e6;
  factor.factor(-beyond * most);
  if (factor.below() > 0)
    throw InputError(fmt::format("{}: the mass is not positive definite: {} of its eigenvalues are negative",
                                 origin, factor.below()));

  // Round-off gives rigid motions eigenvalues of about 1e-16 times the highest.
  constexpr double zero = 1e-13;
  factor.factor(-zero * most);
  const std::int64_t negative = factor.below();
  factor.factor(zero * most);
  const std::int64_t at_zero = factor.below() - negative;
  if (negative > 0)
    throw InputError(fmt::format("{}: the stiffness has {} negative eigenvalues: it is not that of a body",
                                 origin, negative));
  if (at_zero != rigid)
    throw InputError(fmt::format(
        "{}: the stiffness has {} modes at zero frequency, but {} rigid motions are free: there may be "
        "unconnected parts, or nodes without an element",
        origin, at_zero, rigid));
}

}  // namespace ricochet::modes
