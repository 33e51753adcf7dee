// SPDX-License-Identifier: BSD-2-Clause
// Names that most tests of contact use.
#pragma once

#include <gmock/gmock.h>

#include <Eigen/Dense>

#include "ricochet/energy.hpp"
#include "ricochet/kernel.hpp"
#include "ricochet/quantity.hpp"
#include "ricochet/step_options.hpp"
#include "ricochet/step_status.hpp"

namespace ricochet::contact::test {

using Eigen::MatrixXd, Eigen::VectorXd;
using kernels::Kernel;
using ricochet::Admittance, ricochet::ContactStep, ricochet::Energy, ricochet::Instant, ricochet::Precision,
    ricochet::Quantity, ricochet::Scheme, ricochet::StepOptions, ricochet::StepStatus;
using ::testing::AllOf, ::testing::ElementsAre, ::testing::HasSubstr, ::testing::IsEmpty,
    ::testing::StartsWith;

}  // namespace ricochet::contact::test
