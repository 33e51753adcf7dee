// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/eps_type.hpp"

#include <slepc/private/epsimpl.h>

#include <cmath>

#include "src/modes/certified.hpp"
#include "src/modes/certify.hpp"
#include "src/modes/eps_matrices.hpp"

namespace ricochet::modes {

namespace {

using parallel::check;

/// What one EPS of this type holds.
struct Data {
  PetscInt per_shift = 260, partitions = 1;
  Engine* engine = nullptr;
  ModeSet set;
  double origin = 0;
  // The certificate: shifts, and eigenvalues of the EPS below each.
  std::vector<PetscReal> shifts;
  std::vector<PetscInt> counts;
};

Data& data_of(EPS eps) { return *static_cast<Data*>(eps->data); }

/// Runs a task of C++ within a function of PETSc, which must not throw.
template <class Task>
PetscErrorCode guarded(EPS eps, PetscErrorCode code, const Task& task) {
  try {
    task();
  } catch (const std::exception& error) {
    return PetscError(PetscObjectComm(reinterpret_cast<PetscObject>(eps)), __LINE__, "EPSSolve_Ricochet",
                      __FILE__, code, PETSC_ERROR_INITIAL, "%s", error.what());
  }
  return 0;
}

/// The vectors of the deflation space (local rows, n), which SLEPc has made M-orthonormal.
Eigen::MatrixXd deflation_of(EPS eps) {
  PetscInt n = 0;
  check(BVGetNumConstraints(eps->V, &n));
  Eigen::MatrixXd vectors(eps->nloc, n);
  for (PetscInt j = 0; j < n; ++j) {
    Vec column = nullptr;
    const PetscScalar* values = nullptr;
    check(BVGetColumn(eps->V, j - n, &column));
    check(VecGetArrayRead(column, &values));
    vectors.col(j) = Eigen::Map<const Eigen::VectorXd>(values, eps->nloc);
    check(VecRestoreArrayRead(column, &values));
    check(BVRestoreColumn(eps->V, j - n, &column));
  }
  return vectors;
}

/// A shift below all eigenvalues, so that the lowest are the first above it; near zero, if K is semidefinite.
double below_all(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                 double end) {
  for (double shift = -1e-3 * end; shift > -1e3 * operators.stiffest(); shift *= 10)
    if (count_below(teams, factor, shift).below == 0) return shift;
  throw SolverError("no lower bound of the spectrum is found: M may not be positive semidefinite");
}

/// Solves with the matrices of the EPS. Its ranks are divided into teams, each with a copy of them.
/// @return the shapes of the set (rows of this rank, all), known ones first
Eigen::MatrixXd solve_own(EPS eps) {
  Data& data = data_of(eps);
  Mat stiffness = nullptr, mass = nullptr;
  check(EPSGetOperators(eps, &stiffness, eps->isgeneralized ? &mass : nullptr));
  const parallel::Teams teams(PetscObjectComm(reinterpret_cast<PetscObject>(eps)), data.partitions);
  const Eigen::MatrixXd deflation = deflation_of(eps);
  const Eigen::Index known = deflation.cols();
  Request request{.relative_residual = eps->tol, .modes_per_shift = data.per_shift};
  data.origin = 0;
  if (eps->which == EPS_ALL) {
    data.origin = eps->inta;
    request.up_to = to_hertz(RadPerSecond{std::sqrt(eps->intb - eps->inta)});
  } else {
    request.count = eps->nev + known;
    if (known == 0) {
      const Pair pair = paired(teams, stiffness, mass, 0);
      const Operators operators(pair.stiffness, pair.mass, Eigen::MatrixXd(pair.rows(), 0));
      Factorisation factor(pair.stiffness, pair.mass);
      const CountModel model(0, {}, operators.expected_count());
      data.origin = below_all(teams, operators, factor, model.lambda_at(static_cast<double>(eps->nev)));
    }
  }
  const Pair pair = paired(teams, stiffness, mass, data.origin);
  const TeamRows rows(teams, stiffness, pair.stiffness);
  Operators operators(pair.stiffness, pair.mass, rows.to_team(deflation));
  if (request.count) request.count = std::min(*request.count, operators.free_rows);
  Factorisation factor(pair.stiffness, pair.mass);
  // An interval that begins at zero begins above the known modes, as for a free body.
  if (eps->which == EPS_ALL && !(known > 0 && data.origin == 0))
    operators.below_zero = count_below(teams, factor, 0).below;
  data.set = certified_modes(teams, operators, factor, request, Checkpoint(), Progress());
  return rows.to_all(data.set.shape, data.set.index, std::ssize(data.set.angular_frequency));
}

/// Passes a set to the EPS without its first modes, which are known.
void hand_over(EPS eps, const Eigen::MatrixXd& shape, Eigen::Index known) {
  Data& data = data_of(eps);
  const ModeSet& set = data.set;
  const auto n = static_cast<PetscInt>(std::ssize(set.angular_frequency) - known);
  check(PetscFree4(eps->eigr, eps->eigi, eps->errest, eps->perm));
  check(PetscMalloc4(n, &eps->eigr, n, &eps->eigi, n, &eps->errest, n, &eps->perm));
  check(BVSetNumConstraints(eps->V, 0));
  check(BVResize(eps->V, std::max<PetscInt>(n, 1), PETSC_FALSE));
  for (PetscInt k = 0; k < n; ++k) {
    const auto from = static_cast<std::size_t>(k + known);
    eps->eigr[k] = data.origin + std::pow(set.angular_frequency[from], 2);
    eps->eigi[k] = 0;
    eps->errest[k] = set.residual[from];
    eps->perm[k] = k;
    Vec column = nullptr;
    PetscScalar* values = nullptr;
    check(BVGetColumn(eps->V, k, &column));
    check(VecGetArray(column, &values));
    Eigen::Map<Eigen::VectorXd>(values, eps->nloc) = shape.col(known + k);
    check(VecRestoreArray(column, &values));
    check(BVRestoreColumn(eps->V, k, &column));
  }
  eps->nconv = n;
  eps->ncv = std::max<PetscInt>(n, 1);
  eps->its = static_cast<PetscInt>(set.certificate.shift.size());
}

PetscErrorCode solve(EPS eps) {
  Data& data = data_of(eps);
  return guarded(eps, PETSC_ERR_CONV_FAILED, [&] {
    if (Engine* engine = std::exchange(data.engine, nullptr)) {
      try {
        engine->found = certified_modes(engine->teams, engine->operators, engine->factor, engine->request,
                                        engine->checkpoint, engine->progress);
      } catch (...) {
        engine->error = std::current_exception();
        throw;
      }
      eps->reason = EPS_CONVERGED_USER;
      return;
    }
    PetscInt known = 0;
    check(BVGetNumConstraints(eps->V, &known));
    const Eigen::MatrixXd shape = solve_own(eps);
    data.set.shape.resize(0, 0);
    hand_over(eps, shape, known);
    eps->reason = EPS_CONVERGED_TOL;
    data.counts.assign(data.set.certificate.modes_below.begin(), data.set.certificate.modes_below.end());
    for (PetscInt& count : data.counts) count -= known;
    data.shifts = data.set.certificate.shift;
    for (PetscReal& shift : data.shifts) shift += data.origin;
  });
}

PetscErrorCode set_up(EPS eps) {
  PetscFunctionBegin;
  EPSCheckHermitianDefinite(eps);
  EPSCheckUnsupported(eps, EPS_FEATURE_BALANCE | EPS_FEATURE_ARBITRARY | EPS_FEATURE_REGION |
                               EPS_FEATURE_EXTRACTION | EPS_FEATURE_CONVERGENCE | EPS_FEATURE_STOPPING |
                               EPS_FEATURE_TWOSIDED);
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(eps));
  if (!eps->which) eps->which = EPS_SMALLEST_REAL;
  PetscCheck(eps->which == EPS_SMALLEST_REAL || eps->which == EPS_ALL, comm, PETSC_ERR_SUP,
             "The solver '%s' finds the smallest real eigenvalues, or all in an interval (EPSSetInterval)",
             EPSRICOCHET);
  PetscCheck(eps->which != EPS_ALL ||
                 (eps->inta < eps->intb && eps->intb < PETSC_MAX_REAL && eps->inta > PETSC_MIN_REAL),
             comm, PETSC_ERR_USER_INPUT,
             "The solver '%s' needs an interval with two finite ends (EPSSetInterval)", EPSRICOCHET);
  eps->ncv = 1;
  eps->mpd = 1;
  eps->max_it = 1;
  if (eps->tol == PETSC_DEFAULT) eps->tol = SLEPC_DEFAULT_TOL;
  PetscCall(EPSAllocateSolution(eps, 0));
  PetscCall(EPS_SetInnerProduct(eps));  // in which SLEPc orthonormalises the deflation space
  PetscFunctionReturn(0);
}

PetscErrorCode sort_by_value(EPS eps) {
  PetscFunctionBegin;
  eps->sc->comparison = SlepcCompareSmallestReal;
  eps->sc->comparisonctx = nullptr;
  eps->sc->map = nullptr;
  eps->sc->mapobj = nullptr;
  PetscFunctionReturn(0);
}

/// The engine factors by itself: the ST must not factor M.
PetscErrorCode set_default_transformation(EPS eps) {
  KSP ksp = nullptr;
  PC pc = nullptr;
  PetscFunctionBegin;
  PetscCall(STSetType(eps->st, STSHIFT));
  PetscCall(STGetKSP(eps->st, &ksp));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCNONE));
  PetscFunctionReturn(0);
}

PetscErrorCode set_from_options(EPS eps, PetscOptionItems* PetscOptionsObject) {
  PetscInt pairs = data_of(eps).per_shift;
  PetscBool given = PETSC_FALSE;
  PetscFunctionBegin;
  PetscOptionsHeadBegin(PetscOptionsObject, "EPS Ricochet Options");
  PetscCall(PetscOptionsInt("-eps_ricochet_per_shift", "Eigenpairs sought from one factorisation",
                            "EPSRicochetSetPerShift", pairs, &pairs, &given));
  if (given) PetscCall(EPSRicochetSetPerShift(eps, pairs));
  PetscInt partitions = data_of(eps).partitions;
  PetscCall(PetscOptionsInt("-eps_ricochet_partitions",
                            "Parts of the communicator that work on slices of their own",
                            "EPSRicochetSetPartitions", partitions, &partitions, &given));
  if (given) PetscCall(EPSRicochetSetPartitions(eps, partitions));
  PetscOptionsHeadEnd();
  PetscFunctionReturn(0);
}

PetscErrorCode view(EPS eps, PetscViewer viewer) {
  PetscBool text = PETSC_FALSE;
  PetscFunctionBegin;
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(viewer), PETSCVIEWERASCII, &text));
  if (!text) PetscFunctionReturn(0);
  const Data& data = data_of(eps);
  PetscCall(PetscViewerASCIIPrintf(viewer, "  eigenpairs per shift: %d, partitions: %d\n",
                                   static_cast<int>(data.per_shift), static_cast<int>(data.partitions)));
  for (std::size_t s = 0; s < data.counts.size(); ++s)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  inertia: %d eigenvalues of the set below %g\n",
                                     static_cast<int>(data.counts[s]), data.shifts[s]));
  PetscFunctionReturn(0);
}

PetscErrorCode destroy(EPS eps) {
  delete static_cast<Data*>(eps->data);
  eps->data = nullptr;
  return 0;
}

PetscErrorCode create(EPS eps) {
  PetscFunctionBegin;
  eps->data = new Data;
  eps->categ = EPS_CATEGORY_CONTOUR;
  eps->useds = PETSC_FALSE;
  eps->ops->solve = solve;
  eps->ops->setup = set_up;
  eps->ops->setupsort = sort_by_value;
  eps->ops->setfromoptions = set_from_options;
  eps->ops->destroy = destroy;
  eps->ops->view = view;
  eps->ops->setdefaultst = set_default_transformation;
  PetscFunctionReturn(0);
}

}  // namespace

void use_engine(EPS eps, Engine& engine) { data_of(eps).engine = &engine; }

}  // namespace ricochet::modes

PetscErrorCode EPSRicochetRegister() {
  PetscFunctionBegin;
  PetscCall(EPSRegister(EPSRICOCHET, ricochet::modes::create));
  PetscFunctionReturn(0);
}

/// PETSc calls the function of this name in a library that it loads by -dll_append.
PETSC_EXTERN PetscErrorCode PetscDLLibraryRegister_ricochet_eps() {
  PetscFunctionBegin;
  PetscCall(EPSRicochetRegister());
  PetscFunctionReturn(0);
}

PetscErrorCode EPSRicochetSetPerShift(EPS eps, PetscInt pairs) {
  PetscBool ours = PETSC_FALSE;
  PetscFunctionBegin;
  PetscValidHeaderSpecific(eps, EPS_CLASSID, 1);
  PetscCheck(pairs > 0, PetscObjectComm(reinterpret_cast<PetscObject>(eps)), PETSC_ERR_ARG_OUTOFRANGE,
             "The number of eigenpairs per shift is %d: it must be positive", static_cast<int>(pairs));
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(eps), EPSRICOCHET, &ours));
  if (ours) ricochet::modes::data_of(eps).per_shift = pairs;
  PetscFunctionReturn(0);
}

PetscErrorCode EPSRicochetSetPartitions(EPS eps, PetscInt partitions) {
  PetscBool ours = PETSC_FALSE;
  PetscFunctionBegin;
  PetscValidHeaderSpecific(eps, EPS_CLASSID, 1);
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(eps));
  PetscCheck(partitions > 0 && ricochet::parallel::size_of(comm) % partitions == 0, comm,
             PETSC_ERR_ARG_OUTOFRANGE,
             "The number of partitions is %d: it must divide the number of ranks, %d",
             static_cast<int>(partitions), ricochet::parallel::size_of(comm));
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(eps), EPSRICOCHET, &ours));
  if (ours) ricochet::modes::data_of(eps).partitions = partitions;
  PetscFunctionReturn(0);
}

PetscErrorCode EPSRicochetGetCertificate(EPS eps, EPSRicochetCertificate* certificate) {
  PetscBool ours = PETSC_FALSE;
  PetscFunctionBegin;
  PetscValidHeaderSpecific(eps, EPS_CLASSID, 1);
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(eps), EPSRICOCHET, &ours));
  PetscCheck(ours && eps->state >= EPS_STATE_SOLVED, PetscObjectComm(reinterpret_cast<PetscObject>(eps)),
             PETSC_ERR_ARG_WRONGSTATE, "Only a solver of type '%s' has a certificate, after EPSSolve",
             EPSRICOCHET);
  ricochet::modes::Data& data = ricochet::modes::data_of(eps);
  const ricochet::kernels::Certificate& from = data.set.certificate;
  certificate->shifts = static_cast<PetscInt>(data.counts.size());
  certificate->shift = data.shifts.data();
  certificate->eigenvalues = data.counts.data();
  certificate->residual = 0;
  for (PetscInt k = 0; k < eps->nconv; ++k)
    certificate->residual = std::max(certificate->residual, eps->errest[k]);
  certificate->orthonormality = from.orthonormality;
  certificate->origin = data.origin;
  PetscFunctionReturn(0);
}
