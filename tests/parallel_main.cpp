// SPDX-License-Identifier: BSD-2-Clause
// main of the collective tests: one session, output from every rank. The run fails if any rank fails.
#include <gtest/gtest.h>

#include "src/parallel/blas.hpp"
#include "src/parallel/parallel.hpp"

int main(int argc, char** argv) {
  ricochet::parallel::prepare_blas();
  testing::InitGoogleTest(&argc, argv);
  const ricochet::parallel::Session session;
  const int mine = RUN_ALL_TESTS();
  return static_cast<int>(ricochet::parallel::sum(PETSC_COMM_WORLD, std::int64_t{mine}) != 0);
}
