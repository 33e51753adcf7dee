// SPDX-License-Identifier: BSD-2-Clause
#include "src/parallel/memory.hpp"

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

namespace ricochet::parallel {

namespace {

constexpr double mib = 1 << 20;

/// Returns the number in a file, or infinity if the file contains no number ("max") or cannot be read.
double number_in(const std::string& file) {
  double value = 0;
  return std::ifstream(file) >> value ? value : std::numeric_limits<double>::infinity();
}

/// Returns the memory that this process may still allocate under the limits of its control group (version 2)
/// and of the parents of that group [bytes].
double left_by_control_groups() {
  double left = std::numeric_limits<double>::infinity();
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
  return std::numeric_limits<double>::infinity();
}

}  // namespace

double available_mib(MPI_Comm comm) {
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  const double mine = std::min(available_to_machine(), left_by_control_groups()) / mib / size_of(machine);
  MPI_Comm_free(&machine);
  return -largest(comm, -mine);
}

}  // namespace ricochet::parallel
