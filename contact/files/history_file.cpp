// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/history_file.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::optional<double> number(std::string_view text) {
  double value = 0;
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

bool is_name(std::string_view text) {
  return !text.empty() && (std::isalpha(static_cast<unsigned char>(text.front())) || text.front() == '"') &&
         !number(text);
}

}  // namespace

History read_history(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(path))
    throw InputError(
        fmt::format("{}: no such file. A history is a text file of lines \"t, factor\".", path.string()));
  History out{{}, {}};
  int count = 0;
  const auto complain = [&](const std::string& what) {
    throw InputError(fmt::format("{}:{}: {}", path.string(), count, what));
  };
  bool first = true;
  for (std::string raw; std::getline(file, raw);) {
    ++count;
    std::string_view line = raw;
    if (count == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    line = trimmed(line);
    if (line.empty() || line.front() == '#') continue;
    const std::size_t comma = line.find(',');
    const std::string_view left = trimmed(line.substr(0, comma));
    const std::string_view right =
        comma == std::string_view::npos ? std::string_view{} : trimmed(line.substr(comma + 1));
    if (std::exchange(first, false) && is_name(left) && is_name(right)) continue;
    const auto t = number(left), factor = number(right);
    if (!t || !factor)
      complain(fmt::format("\"{}\": must be two numbers, \"t, factor\": a time in seconds and a factor.",
                           line.substr(0, 60)));
    if (!std::isfinite(*t) || !std::isfinite(*factor))
      complain(fmt::format("\"{}\": must be finite. Take the line out.", line.substr(0, 60)));
    if (!out.time.empty() && *t <= out.time.back())
      complain(
          fmt::format("t = {} s comes after {} s: times must ascend. Sort the lines, and merge equal times.",
                      *t, out.time.back()));
    out.time.push_back(*t);
    out.value.push_back(*factor);
  }
  if (out.time.empty())
    throw InputError(fmt::format("{}: holds no line \"t, factor\". Give at least one.", path.string()));
  return out;
}

}  // namespace ricochet::contact
