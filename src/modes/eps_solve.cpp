// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/eps_solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "src/modes/certified.hpp"
#include "src/modes/certify.hpp"
#include "src/modes/eps_type.hpp"
#include "src/modes/search.hpp"

namespace ricochet::modes {

namespace {

using parallel::check;

/// Shift below all modes, relative to the end of the search; K − σM is definite there.
constexpr double definite_shift = -1e-3;

/// Lets MUMPS factor K − σM, for the ST or for spectrum slicing.
void set_factors(KSP ksp) {
  PC pc = nullptr;
  check(KSPSetType(ksp, KSPPREONLY));
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCCHOLESKY));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

/// Asks a type of SLEPc for all eigenpairs up to `end`, rigid modes included.
void ask(EPS eps, const std::string& type, const Probe& end) {
  ST st = nullptr;
  KSP ksp = nullptr;
  check(EPSGetST(eps, &st));
  if (type == EPSKRYLOVSCHUR) {  // spectrum slicing
    check(EPSSetWhichEigenpairs(eps, EPS_ALL));
    check(EPSSetInterval(eps, definite_shift * end.sigma, end.sigma));
    check(STSetType(st, STSINVERT));
    check(EPSKrylovSchurGetKSP(eps, &ksp));
    // ScaLAPACK at the root would hide a part of the inertia.
    check(PetscOptionsInsertString(nullptr, "-st_mat_mumps_icntl_13 1"));
  } else {
    check(EPSSetTarget(eps, definite_shift * end.sigma));
    check(EPSSetDimensions(eps, parallel::petsc_int(end.below), PETSC_DEFAULT, PETSC_DEFAULT));
    check(EPSSetWhichEigenpairs(eps, EPS_TARGET_MAGNITUDE));
    check(STSetType(st, STSINVERT));
    check(STGetKSP(st, &ksp));
  }
  // K and M have the same pattern, but PETSc 3.18 would then add SBAIJ matrices wrongly on several ranks.
  check(STSetMatStructure(st, SUBSET_NONZERO_PATTERN));
  set_factors(ksp);
}

/// The eigenpairs that an EPS has found below `end`, by ascending eigenvalue, without the first `rigid`.
struct Pairs {
  std::vector<double> lambda;
  Eigen::MatrixXd shape;
};

Pairs pairs_of(EPS eps, const Operators& operators, double end) {
  PetscInt converged = 0;
  check(EPSGetConverged(eps, &converged));
  std::vector<std::pair<double, PetscInt>> found;
  for (PetscInt i = 0; i < converged; ++i) {
    double value = 0;
    check(EPSGetEigenvalue(eps, i, &value, nullptr));
    if (value < end) found.emplace_back(value, i);
  }
  std::ranges::sort(found);
  found.erase(found.begin(), found.begin() + std::min(std::ssize(found), operators.rigid.cols()));
  Pairs pairs;
  pairs.shape.resize(operators.local_rows, std::ssize(found));
  for (const auto& [value, i] : found) {
    const Eigen::Index column = std::ssize(pairs.lambda);
    parallel::Vector x;
    check(VecCreateMPIWithArray(operators.comm, 1, static_cast<PetscInt>(operators.local_rows), PETSC_DECIDE,
                                pairs.shape.col(column).data(), x.out()));
    check(EPSGetEigenvector(eps, i, x, nullptr));
    pairs.lambda.push_back(value);
  }
  // Eigenvectors of SLEPc are M-orthonormal to its tolerance, and may contain rigid motion.
  pairs.shape -= operators.rigid * inner(operators.comm, operators.rigid_momentum, pairs.shape);
  const Eigen::MatrixXd momentum = operators.mass(pairs.shape);
  for (Eigen::Index j = 0; j < pairs.shape.cols(); ++j)
    pairs.shape.col(j) /= std::sqrt(inner(operators.comm, pairs.shape.col(j), momentum.col(j))(0, 0));
  return pairs;
}

}  // namespace

std::string chosen_eps_type(const std::string& given) {
  char type[64] = {};
  PetscBool set = PETSC_FALSE;
  check(PetscOptionsGetString(nullptr, nullptr, "-eps_type", type, sizeof type, &set));
  const std::string chosen = set ? type : given;
  check(EPSRicochetRegister());
  PetscErrorCode (*create)(EPS) = nullptr;
  check(PetscFunctionListFind(EPSList, chosen.c_str(), &create));
  if (create == nullptr)
    throw InputError(fmt::format("PETSC_OPTIONS: -eps_type {}: SLEPc has no such solver", chosen));
  return chosen;
}

bool works_in_teams(const std::string& eps_type) { return eps_type == EPSRICOCHET; }

ModeSet modes_by_eps(const parallel::Teams& teams, const Operators& operators, Mat stiffness, Mat mass,
                     Factorisation& factor, const Request& request, const Checkpoint& checkpoint,
                     const Progress& progress) {
  const std::string type = chosen_eps_type(request.eps_type);
  parallel::Handle<EPS, EPSDestroy> eps;
  check(EPSCreate(operators.comm, eps.out()));
  check(EPSSetOperators(eps, stiffness, mass));
  check(EPSSetProblemType(eps, EPS_GHEP));
  check(EPSSetType(eps, type.c_str()));
  if (type == EPSRICOCHET) {
    Engine engine{teams, operators, factor, request, checkpoint, progress};
    use_engine(eps, engine);
    if (const PetscErrorCode code = EPSSolve(eps); engine.error)
      std::rethrow_exception(engine.error);
    else
      check(code);
    return std::move(engine.found);
  }
  if (teams.count() > 1) throw SolverError(fmt::format("internal: {} works in one team", type));
  progress.begin("inertia counts");
  const Probe end = end_of_search(teams, operators, factor, request);
  factor.release();
  progress.begin(type);
  ask(eps, type, end);
  // SLEPc bounds ‖Kx − λMx‖/|λ|, and the certificate the same relative to ‖Kx‖.
  check(EPSSetTolerances(eps, 0.1 * request.relative_residual, PETSC_DEFAULT));
  check(EPSSetFromOptions(eps));
  check(EPSSolve(eps));
  const Pairs found = pairs_of(eps, operators, end.sigma);

  progress.begin("certificate");
  const Eigen::Index r = operators.rigid.cols();
  ModeSet set;
  Cut all{found.lambda.size(), end};
  const auto [kept, at_cut] =
      request.count ? cut_of(teams, factor, found.lambda, *request.count - r, r).value_or(all) : all;
  set.cut = at_cut.sigma;
  set.static_shift = definite_shift * set.cut;
  set.angular_frequency.assign(static_cast<std::size_t>(r), 0);
  for (std::size_t k = 0; k < kept; ++k)
    set.angular_frequency.push_back(std::sqrt(std::max(found.lambda[k], 0.0)));
  set.store(teams, operators, 0, found.shape.leftCols(static_cast<Eigen::Index>(kept)));
  hold_to_bounds(teams, operators, factor, {at_cut}, request.relative_residual, set);
  return set;
}

}  // namespace ricochet::modes
