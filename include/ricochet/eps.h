/* SPDX-License-Identifier: BSD-2-Clause */
/* The eigensolver of Ricochet as a type of SLEPc's EPS: all eigenpairs of K x = λ M x in an interval, or the lowest
   ones, with a proof that none is missing. K and M are symmetric, M is positive semidefinite, and scalars are real. */
#ifndef RICOCHET_EPS_H
#define RICOCHET_EPS_H

#include <slepceps.h>

#define EPSRICOCHET "ricochet"

/* What proves a set of eigenpairs. */
typedef struct {
  PetscInt shifts;                /* number of shifts */
  const PetscReal *shift;         /* (shifts) ascending; valid until the next solve */
  const PetscInt *eigenvalues;    /* (shifts) eigenvalues of the set below each shift, which equal the inertia */
  PetscReal residual;             /* largest ‖K x − λ M x‖ / ‖K x‖, with K − a M in place of K if a ≠ 0, see below */
  PetscReal orthonormality;       /* largest entry of |Xᵀ M X − I| */
  PetscReal origin;               /* a: lower end of the search; eigenvalues below it were counted, not computed */
} EPSRicochetCertificate;

/* Registers the type. Call it after SlepcInitialize. Programs that cannot be changed load it with the option
   -dll_append libricochet-eps.so instead. */
PETSC_EXTERN PetscErrorCode EPSRicochetRegister(void);

/* Sets the number of eigenpairs that are sought from one factorisation (default 260; option
   -eps_ricochet_per_shift). With more, the basis costs more than another factorisation; with fewer, it needs
   less memory. */
PETSC_EXTERN PetscErrorCode EPSRicochetSetPerShift(EPS eps, PetscInt pairs);

/* Divides the ranks into this number of parts, which must divide the number of ranks (default 1; option
   -eps_ricochet_partitions). Each part holds K and M and works on slices of its own, which is faster than sharing a
   factorisation as long as the memory suffices. */
PETSC_EXTERN PetscErrorCode EPSRicochetSetPartitions(EPS eps, PetscInt partitions);

/* Returns the certificate of the last solve. */
PETSC_EXTERN PetscErrorCode EPSRicochetGetCertificate(EPS eps, EPSRicochetCertificate *certificate);

#endif
