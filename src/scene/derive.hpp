// SPDX-License-Identifier: BSD-2-Clause
// Derives kernels from other kernels without computing modes.
#pragma once

#include "kernels/algebra.hpp"
#include "kernels/read.hpp"
#include "src/scene/request.hpp"

namespace ricochet::scene {

/// Factors that turn the body of `had` into the body of `wanted`; no value if the bodies or their candidates
/// differ in any other way. The candidates of `wanted` may be a subset of those of `had`, and it may request
/// one direction where `had` has all three components. Its loads, moving supports and
/// receivers must be the same. Damping, modes and view are not compared.
std::optional<kernels::Similarity> similarity(const KernelRequest& had, const KernelRequest& wanted);

/// Derives the kernel that `wanted` requests from a kernel that answers `had`. Throws a one-line InputError
/// that begins with `kernel of "body"` if the kernel does not contain the necessary data.
kernels::Kernel derived(kernels::Kernel kernel, const KernelRequest& had, const KernelRequest& wanted);

struct Derived {
  kernels::Kernel kernel;
  std::filesystem::path from;
};

/// Derives the kernel that `wanted` requests from this file. Returns no value if that is impossible or if the
/// file cannot be read.
std::optional<kernels::Kernel> derive_from(const std::filesystem::path& file, const KernelRequest& wanted);

/// Derives the kernel that `wanted` requests from the first suitable kernel file in `folder`. Ignores files
/// that cannot be read.
std::optional<Derived> derive_from_any(const std::filesystem::path& folder, const KernelRequest& wanted);

}  // namespace ricochet::scene
