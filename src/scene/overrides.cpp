// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/overrides.hpp"

#include <optional>

#include "base/similar.hpp"
#include "src/scene/table.hpp"

namespace ricochet::scene {

namespace {

InputError refusal(const Override& text, const std::string& what) {
  return InputError(one_line(fmt::format("--set {}: {}", text, what)));
}

struct Part {
  std::string key;
  std::vector<std::size_t> index;
};

/// Splits a path such as "bodies.upper.list[2].x". Dots in quotes do not separate parts.
std::vector<Part> split(const std::string& path, const Override& text) {
  const auto refuse = [&](const std::string& what) {
    return refusal(text, what + ": write KEY=VALUE with a dotted key, as in bodies.upper.velocity=[0,-6,0]");
  };
  std::vector<Part> parts;
  std::size_t at = 0;
  while (true) {
    Part part;
    if (at < path.size() && path[at] == '"') {
      const std::size_t close = path.find('"', at + 1);
      if (close == std::string::npos) throw refuse("the quote is not closed");
      part.key = path.substr(at + 1, close - at - 1);
      at = close + 1;
    } else {
      while (at < path.size() && path[at] != '.' && path[at] != '[') part.key += path[at++];
    }
    if (part.key.empty()) throw refuse("a part of the key is empty");
    while (at < path.size() && path[at] == '[') {
      const std::size_t close = path.find(']', at);
      const std::string digits = close == std::string::npos ? "" : path.substr(at + 1, close - at - 1);
      if (digits.empty() || digits.size() > 6 || digits.find_first_not_of("0123456789") != std::string::npos)
        throw refuse("a list index must be a number in brackets");
      part.index.push_back(std::stoul(digits));
      at = close + 1;
    }
    parts.push_back(part);
    if (parts.size() > 20) throw refuse("the key has more than 20 parts");
    if (at == path.size()) return parts;
    if (path[at] != '.') throw refuse("the key is invalid");
    ++at;
  }
}

/// Position of the first "=" outside quotes.
std::size_t end_of_key(const std::string& text) {
  bool quoted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '"') quoted = !quoted;
    if (text[at] == '=' && !quoted) return at;
  }
  return text.find('=');
}

/// Whether `text` is UTF-8, which TOML requires; other bytes could not be written again. The parser accepts
/// any UTF-8 text in a comment, so the text is parsed as one.
bool is_utf8(const std::string& text) {
  try {
    static_cast<void>(toml::parse("# " + one_line(text)));
    return true;
  } catch (const toml::parse_error&) {
    return false;
  }
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The key of the table that is most similar to `key`; empty if none is.
std::string similar_key(const std::string& key, const toml::table& table) {
  std::vector<std::string> names;
  for (auto&& [name, node] : table) names.emplace_back(name.str());
  return base::most_similar(key, names);
}

}  // namespace

void apply_override(toml::table& root, const Override& text) {
  if (!is_utf8(text)) throw InputError("--set: is not UTF-8: give it in that encoding");
  const std::size_t equals = end_of_key(text);
  if (equals == std::string::npos) throw refusal(text, "has no \"=\": write KEY=VALUE");
  const std::vector<Part> parts = split(trimmed(text.substr(0, equals)), text);
  const std::string value = trimmed(text.substr(equals + 1));
  toml::table parsed;
  try {
    parsed = parse_toml("value = " + value, "--set");
    if (parsed.size() != 1) throw refusal(text, "holds more than one value");
  } catch (const toml::parse_error&) {
    parsed = toml::table{{"value", value}};
  }

  toml::table* table = &root;
  std::string path;                  // of the current part
  std::optional<std::string> meant;  // in place of the first part that the scene does not have
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Part& part = parts[p];
    const bool last = p + 1 == parts.size();
    path += (p > 0 ? "." : "") + part.key;
    if (last && part.index.empty()) {
      table->insert_or_assign(part.key, *parsed.get("value"));
      return;
    }
    if (!table->contains(part.key)) {
      if (!meant) meant = similar_key(part.key, *table);
      if (!part.index.empty())
        throw refusal(text, "the scene has no list " + path +
                                (meant->empty() ? ": add it to the scene, or give the whole list"
                                                : ". Did you mean \"" + *meant + "\"?"));
      table->insert(part.key, toml::table{});
    }
    toml::node* node = table->get(part.key);
    for (std::size_t k = 0; k < part.index.size(); ++k) {
      toml::array* list = node->as_array();
      if (list == nullptr || part.index[k] >= list->size())
        throw refusal(text, fmt::format("{} has no entry [{}]", part.key, part.index[k]));
      if (last && k + 1 == part.index.size()) {
        list->replace(list->cbegin() + static_cast<std::ptrdiff_t>(part.index[k]), *parsed.get("value"));
        return;
      }
      node = list->get(part.index[k]);
    }
    // A key of a material that has a name changes this material.
    if (const auto* name = node->as_string(); name != nullptr && p >= 2 && parts[2].key == "material") {
      table->insert_or_assign(part.key, toml::table{{"like", name->get()}});
      node = table->get(part.key);
    }
    table = node->as_table();
    if (table == nullptr) throw refusal(text, part.key + " is not a table");
  }
}

}  // namespace ricochet::scene
