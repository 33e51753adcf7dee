// SPDX-License-Identifier: BSD-2-Clause
#include "base/similar.hpp"

#include <algorithm>
#include <cctype>

namespace ricochet::base {

namespace {

/// Levenshtein distance.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t corner = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, corner + (a[i - 1] == b[j - 1] ? 0 : 1)});
      corner = above;
    }
  }
  return row[b.size()];
}

}  // namespace

std::string plain(const std::string& word) {
  std::string text;
  for (const char c : word)
    if (c != '-' && c != '_' && c != ' ')
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string most_similar(const std::string& word, const std::vector<std::string>& known) {
  const std::string own = plain(word);
  std::string nearest;
  std::size_t best = std::max<std::size_t>(2, own.size() / 3) + 1;
  for (const std::string& name : known) {
    const std::string other = plain(name);
    const bool part = (own.size() > 2 && other.starts_with(own)) ||
                      (other.size() > 4 && own.find(other) != std::string::npos);
    // Half of the letters at least must agree: "gap" is not similar to "mesh".
    const std::size_t edits = own == other ? 0 : part ? 1 : distance(own, other);
    if (edits < best && 2 * edits <= std::max(own.size(), other.size())) {
      best = edits;
      nearest = name;
    }
  }
  return nearest;
}

}  // namespace ricochet::base
