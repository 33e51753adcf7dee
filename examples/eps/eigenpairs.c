/* SPDX-License-Identifier: BSD-2-Clause */
/* Prints the eigenvalues of K x = λ M x, whose matrices are in files of PETSc:
       mpirun -n 2 eigenpairs -k K.petsc -m M.petsc -eps_nev 20
       mpirun -n 2 eigenpairs -k K.petsc -m M.petsc -eps_interval 1,2000                                         */
#include <ricochet/eps.h>
#include <string.h>

static const char help[] =
  "Prints the eigenvalues of K x = lambda M x:\n"
  "  eigenpairs -k K.petsc -m M.petsc [-eps_nev N | -eps_interval A,B -eps_all]\n"
  "K and M are binary files of PETSc. -help lists all options of PETSc and SLEPc.\n";

/* Answers --help and --version. Refuses other words with two dashes, which PETSc would ignore. Returns whether
   the program ends, with *status. */
static PetscBool answered(int argc, char **argv, int *status)
{
  char version[256];
  for (int k = 1; k < argc; ++k) {
    if (strncmp(argv[k], "--", 2)) continue;
    *status = 0;
    if (!strcmp(argv[k], "--help")) {
      PetscPrintf(PETSC_COMM_WORLD, "%s", help);
    } else if (!strcmp(argv[k], "--version")) {
      PetscGetVersion(version, sizeof version);
      PetscPrintf(PETSC_COMM_WORLD, "eigenpairs, with %s\n", version);
    } else {
      PetscFPrintf(PETSC_COMM_WORLD, stderr, "eigenpairs: %s: is not an option: --help shows them\n", argv[k]);
      *status = 2;
    }
    return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

static PetscErrorCode load(const char *option, Mat *matrix)
{
  char file[PETSC_MAX_PATH_LEN];
  PetscViewer viewer;
  PetscBool given;
  PetscCall(PetscOptionsGetString(NULL, NULL, option, file, sizeof file, &given));
  PetscCheck(given, PETSC_COMM_WORLD, PETSC_ERR_USER_INPUT, "%s FILE is missing", option);
  PetscCall(PetscViewerBinaryOpen(PETSC_COMM_WORLD, file, FILE_MODE_READ, &viewer));
  PetscCall(MatCreate(PETSC_COMM_WORLD, matrix));
  PetscCall(MatLoad(*matrix, viewer));
  return PetscViewerDestroy(&viewer);
}

int main(int argc, char **argv)
{
  Mat K, M;
  EPS eps;
  int status;
  PetscCall(SlepcInitialize(&argc, &argv, NULL, help));
  if (answered(argc, argv, &status)) {
    PetscOptionsClear(NULL); /* or PETSc would list them as unused */
    PetscCall(SlepcFinalize());
    return status;
  }
  PetscCall(load("-k", &K));
  PetscCall(load("-m", &M));

  PetscCall(EPSRicochetRegister());
  PetscCall(EPSCreate(PETSC_COMM_WORLD, &eps));
  PetscCall(EPSSetOperators(eps, K, M));
  PetscCall(EPSSetProblemType(eps, EPS_GHEP));
  PetscCall(EPSSetType(eps, EPSRICOCHET));
  PetscCall(EPSSetFromOptions(eps));
  PetscCall(EPSSolve(eps));
  PetscCall(EPSValuesView(eps, PETSC_VIEWER_STDOUT_WORLD));
  PetscCall(EPSDestroy(&eps));

  PetscCall(MatDestroy(&K));
  PetscCall(MatDestroy(&M));
  return SlepcFinalize();
}
