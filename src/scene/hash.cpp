// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/hash.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>

#include <array>

#include "ricochet/error.hpp"

namespace ricochet::scene {

std::string sha256(const std::string& bytes) {
  std::array<unsigned char, 32> digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw SolverError("SHA-256 is not available in this OpenSSL");
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

}  // namespace ricochet::scene
