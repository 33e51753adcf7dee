// SPDX-License-Identifier: BSD-2-Clause
#include "src/kernel/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "kernels/algebra.hpp"
#include "src/accuracy/scene_dial.hpp"
#include "src/kernel/discretise.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/modes/certify.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::kernel {

namespace {

/// A count that a kernel claims.
struct Claim {
  double sigma;
  std::int64_t below;
};

/// The counts of the certificate, and those in some gaps between modes.
std::vector<Claim> claims_of(const kernels::Modes& modes) {
  constexpr std::size_t gaps = 8;
  std::vector<Claim> claims;
  const kernels::Certificate& certificate = modes.certificate;
  for (std::size_t s = 0; s < certificate.shift.size(); ++s)
    claims.push_back({certificate.shift[s], static_cast<std::int64_t>(certificate.modes_below[s])});
  if (certificate.left_out > 0) return claims;  // truncated: neighbours in the file aren't neighbours
  std::vector<Claim> between;
  for (std::size_t n = 0; n + 1 < modes.size(); ++n) {
    const double low = std::pow(modes.angular_frequency[n], 2),
                 high = std::pow(modes.angular_frequency[n + 1], 2);
    if (high > (1 + kernels::multiple_mode) * low && high > 0)
      between.push_back({(low + high) / 2, static_cast<std::int64_t>(n) + 1});
  }
  std::mt19937_64 random(1);
  std::ranges::shuffle(between, random);
  between.resize(std::min(between.size(), gaps));
  claims.insert(claims.end(), between.begin(), between.end());
  return claims;
}

}  // namespace

int verify_kernels(const scene::Scene& given, const console::Options& options, MPI_Comm comm,
                   console::Console& console) {
  scene::Scene scene;
  store::Kernels stored;
  parallel::on_all_ranks(comm, [&] {
    store::KernelStore store;
    scene = accuracy::closed(given, options.out, store).scene;
    stored = store::read_kernels(scene, options.out, store);
    for (std::size_t k = 0; k < stored.kernel.size(); ++k)
      if (const kernels::Modes& modes = stored.kernel[k]->modes; modes.contact_adapted() || modes.imported())
        throw InputError(fmt::format("{}: its vectors are {}: --verify counts modes that Ricochet found",
                                     stored.file[k],
                                     modes.imported() ? "imported" : "a contact-adapted basis, not modes"));
  });
  OpenedMeshes meshes(comm, console);
  bool agree = true;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const std::string& name = scene.bodies[k].name;
    const mesh::GmshSession gmsh;
    scene::KernelRequest request = scene::kernel_request(scene, scene.bodies[k]);
    const Discretised made = discretise(request, 0, meshes, comm, console);
    const std::vector<Claim> claims = claims_of(stored.kernel[k]->modes);
    console.begin(name + ": inertia counts", static_cast<std::int64_t>(claims.size()));
    std::int64_t done = 0;
    bool of_body = true;
    for (const Claim& claim : claims) {
      const modes::Probe counted = modes::count_below(*made.teams, *made.factor, claim.sigma);
      if (counted.below != claim.below) {
        of_body = false;
        console.warn(fmt::format("{}: {} modes lie below {:.6g} Hz, but the kernel has {}", name,
                                 counted.below, std::sqrt(claim.sigma) / (2 * std::numbers::pi),
                                 claim.below));
      }
      console.advance(++done, static_cast<std::int64_t>(claims.size()));
    }
    console.end();
    if (of_body) console.say(fmt::format("{}: {} counts agree", name, claims.size()));
    agree = agree && of_body;
  }
  return agree ? 0 : 1;
}

}  // namespace ricochet::kernel
