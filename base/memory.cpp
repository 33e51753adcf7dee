// SPDX-License-Identifier: BSD-2-Clause
#include "base/memory.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

namespace ricochet::base {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// Returns the number in a file, or infinity if the file contains no number ("max") or cannot be read.
double number_in(const std::string& file) {
  double value = 0;
  return std::ifstream(file) >> value ? value : unlimited;
}

double left_by_control_groups() {
  double left = unlimited;
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    if (line.rfind("0::", 0) != 0) continue;
    std::string path = line.substr(3);
    for (;;) {
      const std::string folder = "/sys/fs/cgroup" + (path == "/" ? "" : path);
      const double limit = number_in(folder + "/memory.max"), used = number_in(folder + "/memory.current");
      if (limit < left + used) left = limit - used;
      if (path.empty() || path == "/") break;
      path = path.substr(0, path.rfind('/'));
    }
  }
  return left;
}

double available_to_machine() {
  std::ifstream info("/proc/meminfo");
  for (std::string line; std::getline(info, line);) {
    std::istringstream words(line);
    std::string name;
    double kib = 0;
    if (words >> name >> kib && name == "MemAvailable:") return kib * 1024;
  }
  return unlimited;
}

/// Pages of address space and of resident memory.
struct Pages {
  double size = 0, resident = 0;
};

Pages pages() {
  Pages out;
  std::ifstream("/proc/self/statm") >> out.size >> out.resident;
  return out;
}

double bytes_of_page() { return static_cast<double>(sysconf(_SC_PAGESIZE)); }

double left_by_user_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
  return static_cast<double>(limit.rlim_cur) - pages().size * bytes_of_page();
}

}  // namespace

double resident_bytes() { return pages().resident * bytes_of_page(); }

void return_freed_memory() { malloc_trim(0); }

void return_large_blocks() {
  constexpr int large = 1 << 25;  // the most that glibc accepts; smaller blocks are sooner used again
  mallopt(M_MMAP_MAX, 1 << 16);
  mallopt(M_MMAP_THRESHOLD, large);
  mallopt(M_TRIM_THRESHOLD, 2 * large);
}

double available_bytes() {
  return std::max(0.0, std::min({available_to_machine(), left_by_control_groups(), left_by_user_limit()}));
}

}  // namespace ricochet::base
