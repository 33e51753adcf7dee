// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the hash by which kernels are found again.
#pragma once

#include <string>

namespace ricochet::scene {

/// SHA-256 of `bytes`, in hexadecimal digits. Throws SolverError if OpenSSL does not offer it.
std::string sha256(const std::string& bytes);

}  // namespace ricochet::scene
