// SPDX-License-Identifier: BSD-2-Clause
// Checked access to a TOML table, by the declarations of its keys (keys.hpp).
#pragma once

#include <fmt/format.h>

#include <toml++/toml.h>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ricochet/error.hpp"
#include "ricochet/units.hpp"

namespace ricochet::scene {

struct Key;
struct Section;

/// Parses `text` as TOML. Throws the exceptions of the parser. Throws InputError that begins with `origin` if
/// keys are nested so deeply that destroying the tables would exhaust the stack.
toml::table parse_toml(const std::string& text, const std::string& origin);

/// Replaces control characters by spaces, so that every error is one line, whatever the keys contain.
std::string one_line(std::string text);

/// The line, cut to at most 60 bytes without splitting a character.
std::string shortened(const std::string& line);

/// Numbers must be 0 or have a magnitude between 1/largest_number and largest_number, so that their squares
/// and products do not overflow.
constexpr double largest_number = 1e30;

/// Each sets the value and returns true if the node has its type. A list has at least one entry.
bool convert(const toml::node& node, double& number);
bool convert(const toml::node& node, std::int64_t& number);
bool convert(const toml::node& node, bool& on);
bool convert(const toml::node& node, std::string& text);
/// A string or a list of strings.
bool convert(const toml::node& node, std::vector<std::string>& texts);
template <class T, std::size_t n>
bool convert(const toml::node& node, std::array<T, n>& values) {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->size() != n) return false;
  for (std::size_t k = 0; k < n; ++k)
    if (!convert(*list->get(k), values[k])) return false;
  return true;
}
template <class T>
bool convert(const toml::node& node, std::vector<T>& values) {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->empty()) return false;
  values.resize(list->size());
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!convert(*list->get(k), values[k])) return false;
  return true;
}

/// Reads the values of one table and enforces types and ranges. Errors are one line: "FILE: dotted.key =
/// value: what. fix." A table is opened only after all its names are known to its section, so a misspelt key
/// is reported before any key that is missing because of it.
class Table {
 public:
  /// @param keys  must outlive the table
  /// @param file  the scene as the user named it: errors begin with its name, and paths start at its folder
  /// Throws InputError, with what to write, if the table has a key that its section does not describe.
  Table(const toml::table& table, const Section& keys, std::filesystem::path file, std::string where = "");

  bool has(const std::string& key) const { return table_.contains(key); }
  bool has_table(const std::string& key) const { return table_[key].is_table(); }
  bool has_text(const std::string& key) const { return table_[key].is_string(); }
  bool has_list(const std::string& key) const { return table_[key].is_array(); }
  /// Whether the key is a table of tables alone, or of tables and strings under names that `keys` does not
  /// have.
  bool has_named_entries(const std::string& key, const Section& keys) const;

  /// Sets the value and returns true if the table has the key; false for one of the words that the key
  /// accepts in place of a number, and for an empty list of strings. Throws InputError for another type or a
  /// value out of range.
  template <class T>
  bool read(const Key& key, T& value) const {
    const toml::node* node = given(key);
    if (node == nullptr) return false;
    if (!convert(*node, value)) refuse_type(key, *node);
    check(key, value);
    return true;
  }
  template <class T>
  bool read(const Key& key, std::optional<T>& value) const {
    T given{};
    const bool has_value = read(key, given);
    if (has_value) value = std::move(given);
    return has_value;
  }
  template <class T>
  bool read(const Key& key, std::map<std::string, T>& values) const;
  bool read(const Key& key, Hertz& frequency) const { return read(key, frequency.value); }
  bool read(const Key& key, int& number) const;
  bool read(const Key& key, std::filesystem::path& path) const;

  std::optional<Table> table(const std::string& key, const Section& keys) const;
  /// The entries of a table of tables, [bodies], sorted by name. Empty if it is absent.
  /// @param texts  gets the entries that are strings; null: they are refused
  std::vector<std::pair<std::string, Table>> named(const std::string& key, const Section& keys,
                                                   std::map<std::string, std::string>* texts = nullptr) const;
  /// The entries of an array of tables.
  std::vector<Table> array(const std::string& key, const Section& keys) const;

  /// @param key  a key of this table or the dotted name of a nested key; empty: the table itself
  [[noreturn]] void complain(const std::string& key, const std::string& what) const;

 private:
  /// A table in which any name is accepted.
  Table(const toml::table& table, std::filesystem::path file, std::string where)
      : table_(table), file_(std::move(file)), where_(std::move(where)) {}
  const toml::node* given(const Key& key) const;  ///< null if it is absent, or has no value as above
  [[noreturn]] void refuse_type(const Key& key, const toml::node& given) const;
  std::optional<Table> free_table(const Key& key) const;
  /// Throws InputError unless the number is finite, not too large, and within the range of the key.
  void check(const Key& key, double number) const;
  void check(const Key& key, std::int64_t number) const { check_range(key, static_cast<double>(number)); }
  void check(const Key& key, const std::string& text) const;
  /// Normalises a direction.
  void check(const Key& key, Vector3& vector) const;
  void check(const Key&, bool) const {}
  void check(const Key& key, const auto& values) const {
    for (const auto& value : values) check(key, value);
  }
  void check_range(const Key& key, double value) const;
  /// The dotted name of `key`, or that of the table itself if `key` is empty.
  std::string dotted(const std::string& key) const {
    return where_.empty() || key.empty() ? where_ + key : where_ + "." + key;
  }
  std::string value_of(const std::string& key) const;
  const toml::table& table_;
  const Section* keys_ = nullptr;
  std::filesystem::path file_;
  std::string where_;
};

}  // namespace ricochet::scene
