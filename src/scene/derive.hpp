// SPDX-License-Identifier: BSD-2-Clause
// Which kernels follow from which without modes being computed, and how.
#pragma once

#include "kernels/algebra.hpp"
#include "kernels/read.hpp"
#include "src/scene/request.hpp"

namespace ricochet::scene {

/// The request that a kernel file answers, by what it says of itself; the body has no name, mesh and
/// placement. Throws InputError that begins with `origin` when this version makes no such kernels.
KernelRequest request_of(const kernels::Header& header, const std::string& origin);

/// Factors that turn the body of `had` into that of `wanted`, for the same candidates; none when bodies or
/// candidates differ in more. Candidates may be fewer, and one direction may be wanted of all. Damping, modes
/// and view are not looked at.
std::optional<kernels::Similarity> similarity(const KernelRequest& had, const KernelRequest& wanted);

/// The kernel that `wanted` asks for, from one that answers `had`. Throws InputError, one line that begins
/// with `kernel of "body"`, when it does not hold what that takes.
kernels::Kernel derived(kernels::Kernel kernel, const KernelRequest& had, const KernelRequest& wanted);

struct Derived {
  kernels::Kernel kernel;
  std::filesystem::path from;
};

/// The kernel that `wanted` asks for, from this file; none where it does not allow that, or can't be read.
std::optional<kernels::Kernel> derive_from(const std::filesystem::path& file, const KernelRequest& wanted);

/// The kernel that `wanted` asks for, from the first kernel file in `folder` that allows it. Files that can't
/// be read count for nothing.
std::optional<Derived> derive_from_any(const std::filesystem::path& folder, const KernelRequest& wanted);

}  // namespace ricochet::scene
