// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "ricochet/error.hpp"

namespace ricochet::scene {

namespace {

std::filesystem::path part_file(const std::filesystem::path& mesh, std::size_t number) {
  return mesh.parent_path() / fmt::format("{}_{}{}", mesh.stem().string(), number, mesh.extension().string());
}

/// Number of the last existing part; 0 if there is none.
std::size_t last_part(const std::filesystem::path& mesh) {
  std::size_t last = 0;
  const std::filesystem::path folder = mesh.parent_path().empty() ? "." : mesh.parent_path();
  const std::string start = mesh.stem().string() + '_';
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() != mesh.extension() || stem.rfind(start, 0) != 0) continue;
    const std::string digits = stem.substr(start.size());
    if (digits.empty() || digits.size() > 9 || digits[0] == '0' ||
        digits.find_first_not_of("0123456789") != std::string::npos)
      continue;
    last = std::max<std::size_t>(last, std::stoul(digits));
  }
  return last;
}

}  // namespace

std::vector<std::filesystem::path> part_files(const std::filesystem::path& mesh) {
  std::vector<std::filesystem::path> files;
  if (mesh.extension() != ".msh" || std::filesystem::exists(mesh) ||
      !std::filesystem::is_regular_file(part_file(mesh, 1)))
    return files;
  const std::size_t last = last_part(mesh);
  for (std::size_t number = 1; number <= last; ++number) {
    files.push_back(part_file(mesh, number));
    if (!std::filesystem::is_regular_file(files.back()))
      throw InputError(
          fmt::format("{}: no such file, but there are parts of {} up to {}: keep all of them together",
                      files.back().filename().string(), mesh.filename().string(),
                      part_file(mesh, last).filename().string()));
  }
  return files;
}

}  // namespace ricochet::scene
