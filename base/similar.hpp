// SPDX-License-Identifier: BSD-2-Clause
// Suggestions for misspelled words: keys, names and options.
#pragma once

#include <string>
#include <vector>

namespace ricochet::base {

/// The word in lower case, without hyphens, underscores and spaces.
std::string plain(const std::string& word);

/// The word of `known` that is most similar to `word`: equal but for case, hyphens and underscores; a part of
/// it or its beginning; or within two edits, or a third of its length. Empty if none is similar.
std::string most_similar(const std::string& word, const std::vector<std::string>& known);

}  // namespace ricochet::base
