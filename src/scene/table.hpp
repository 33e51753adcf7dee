// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: checked access to a TOML table.
#pragma once

#include <fmt/format.h>

#include <toml++/toml.h>
#include <array>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ricochet/error.hpp"
#include "ricochet/units.hpp"
#include "src/scene/keys.hpp"

namespace ricochet::scene {

/// `text` as TOML. Throws what the parser throws, and InputError that begins with `origin` for keys that nest
/// deeper than tables can be taken down again.
toml::table parse_toml(const std::string& text, const std::string& origin);

/// `text` with line breaks and other control characters as spaces: complaints are one line whatever keys
/// hold.
std::string one_line(std::string text);

/// Numbers farther from 1 than this factor are refused: their squares, and products with their like, leave
/// what arithmetic can hold.
constexpr double largest_number = 1e30;

/// Reads keys of one table, holds them to what its section says, remembers which, and complains in one line:
/// "FILE: dotted.key = value: what. fix." A key that its section does not describe is a std::logic_error.
class Table {
 public:
  /// `keys` must outlive the table.
  Table(const toml::table& table, const Section& keys, std::string file, std::string where)
      : Table(table, &keys, std::move(file), std::move(where)) {}

  bool has(const std::string& key);
  std::optional<double> number(const std::string& key);
  std::optional<std::int64_t> integer(const std::string& key);
  std::optional<std::vector<std::int64_t>> integers(const std::string& key);
  std::optional<bool> boolean(const std::string& key);
  std::optional<std::string> text(const std::string& key);
  std::optional<Vector3> vector(const std::string& key);
  /// A vector of any length but 0, at length 1.
  std::optional<Vector3> direction(const std::string& key);
  /// Two numbers, neither negative; `names` are for the complaint.
  std::optional<std::array<double, 2>> pair(const std::string& key, const char* names);
  /// A string or a list of strings.
  std::vector<std::string> texts(const std::string& key);
  std::optional<Table> table(const std::string& key, const Section& keys);
  /// Sub-tables by name, in order of names.
  std::vector<std::pair<std::string, Table>> tables(const Section& keys) const;
  /// Entries of an array of tables.
  std::vector<Table> array(const std::string& key, const Section& keys);
  /// Every entry must be a string: group → components.
  std::map<std::string, std::string> strings(const std::string& key);
  std::map<std::string, double> numbers(const std::string& key);

  /// Throws for a key that no call asked for, naming the nearest known one.
  void refuse_unknown() const;

  [[noreturn]] void complain(const std::string& key, const std::string& what) const;
  double required_number(const std::string& key);
  const std::string& where() const { return where_; }
  const toml::table& raw() const { return table_; }

 private:
  /// No keys: names are the user's.
  Table(const toml::table& table, const Section* keys, std::string file, std::string where)
      : table_(table), keys_(keys), file_(std::move(file)), where_(std::move(where)) {}
  /// The key's value, null when it is not given. Remembers that it was asked for.
  const toml::node* value(const std::string& key, std::initializer_list<Type> types);
  std::optional<Table> free_table(const std::string& key, Type type);
  Vector3 vector_at(const std::string& key, const toml::node& node, double largest) const;
  void check_range(const std::string& key, double value) const;
  /// The table itself when `key` is empty.
  std::string dotted(const std::string& key) const {
    return where_.empty() || key.empty() ? where_ + key : where_ + "." + key;
  }
  std::string value_of(const std::string& key) const;
  const toml::table& table_;
  const Section* keys_;
  std::string file_, where_;
  std::set<std::string> known_;
};

}  // namespace ricochet::scene
