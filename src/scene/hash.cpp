#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>

#include "kernels/error.hpp"
#include "src/scene/write.hpp"

namespace ricochet::scene {

std::string sha256(const std::string& bytes) {
  std::array<unsigned char, 32> digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw SolverError("SHA-256 is not available in this OpenSSL");
  std::string hex;
  for (unsigned char byte : digest) hex += fmt::format("{:02x}", byte);
  return hex;
}

}  // namespace ricochet::scene
