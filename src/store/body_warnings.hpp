// SPDX-License-Identifier: BSD-2-Clause
// Mass, size and wave speed of a body, and warnings about a body that is probably not the intended one.
#pragma once

#include <string>
#include <vector>

#include "ricochet/kernel.hpp"
#include "src/scene/elastic_law.hpp"

namespace ricochet::store {

/// Lengths of the body along the axes of its mesh [m]; 0 if the kernel does not contain its outline.
Vector3 size_of(const kernels::Kernel& kernel);

/// "mass 0.23 kg, size 0.06 x 0.04 x 0.04 m, wave speed 5172 m/s"
std::string figures_of(const scene::Body& body, const kernels::Kernel& kernel);

/// Warnings, each with its figure: a mass, a size or a wave speed that no usual body has, a mesh in parts
/// that are not joined, supports on lines or points, and linear elements that lock.
std::vector<std::string> warnings_of(const scene::Body& body, const kernels::Kernel& kernel);

}  // namespace ricochet::store
