// SPDX-License-Identifier: BSD-2-Clause
#include "src/programs/memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

#include "ricochet/error.hpp"

namespace ricochet::programs {
namespace {

/// Memory that this process may use [bytes].
double usable() {
  const double there =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return there;
  return std::min(there, static_cast<double>(limit.rlim_cur));
}

}  // namespace

void check_memory(const scene::Scene& scene, const std::string& purpose, double needed,
                  const std::string& remedy) {
  const double there = usable();
  if (needed > 0.8 * there)
    throw InputError(fmt::format("{}: {} need {:.3g} GB of memory, and there are {:.3g}. Set {}.",
                                 scene.file.string(), purpose, needed * 1e-9, there * 1e-9, remedy));
}

}  // namespace ricochet::programs
