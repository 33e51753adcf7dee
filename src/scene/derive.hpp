// SPDX-License-Identifier: BSD-2-Clause
// Kernels derived from other kernels without computing modes.
#pragma once

#include "kernels/algebra.hpp"
#include "kernels/read.hpp"
#include "src/scene/request.hpp"

namespace ricochet::scene {

/// The request that a kernel file answers, from its header; the body has no name, mesh and placement. Throws
/// InputError that begins with `origin` if this version would not make such a kernel.
KernelRequest request_of(const kernels::Header& header, const std::string& origin);

/// Factors that turn the body of `had` into that of `wanted`, for the same candidates; none if bodies or
/// candidates differ in more. The candidates may be a subset, and one direction may be requested of all
/// three. Damping, modes and view are not compared.
std::optional<kernels::Similarity> similarity(const KernelRequest& had, const KernelRequest& wanted);

/// Derives the kernel that `wanted` requests from one that answers `had`. Throws InputError, one line that
/// begins with `kernel of "body"`, if the kernel does not contain the data that this needs.
kernels::Kernel derived(kernels::Kernel kernel, const KernelRequest& had, const KernelRequest& wanted);

struct Derived {
  kernels::Kernel kernel;
  std::filesystem::path from;
};

/// Derives the kernel that `wanted` requests from this file; none if it is not possible or the file cannot be
/// read.
std::optional<kernels::Kernel> derive_from(const std::filesystem::path& file, const KernelRequest& wanted);

/// Derives the kernel that `wanted` requests from the first suitable kernel file in `folder`. Unreadable
/// files are ignored.
std::optional<Derived> derive_from_any(const std::filesystem::path& folder, const KernelRequest& wanted);

}  // namespace ricochet::scene
