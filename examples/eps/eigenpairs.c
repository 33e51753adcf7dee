/* SPDX-License-Identifier: BSD-2-Clause */
/* Prints the eigenvalues of K x = λ M x, whose matrices are in files of PETSc:
       mpirun -n 2 eigenpairs -k K.petsc -m M.petsc -eps_nev 20
       mpirun -n 2 eigenpairs -k K.petsc -m M.petsc -eps_interval 1,2000                                         */
#include <ricochet/eps.h>

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
  PetscCall(SlepcInitialize(&argc, &argv, NULL, NULL));
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
