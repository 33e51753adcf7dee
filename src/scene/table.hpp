// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: checked access to a TOML table.
#pragma once

#include <fmt/format.h>

#include <toml++/toml.h>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ricochet/error.hpp"
#include "ricochet/units.hpp"
#include "src/scene/keys.hpp"

namespace ricochet::scene {

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

/// Reads the keys of one table, enforces the ranges of its section and records which keys were read. Errors
/// are one line: "FILE: dotted.key = value: what. fix." Throws std::logic_error if a key is read that the
/// section does not describe. A table is opened only after all its names are known to its section, so a
/// misspelt key is reported before any key that is missing because of it.
class Table {
 public:
  /// `keys` must outlive the table.
  Table(const toml::table& table, const Section& keys, std::string file, std::string where)
      : Table(table, &keys, std::move(file), std::move(where)) {}

  /// No value if the key is absent or has one of the texts that it accepts in place of a number.
  std::optional<double> number(const std::string& key);
  std::optional<std::int64_t> integer(const std::string& key);
  std::optional<std::vector<std::int64_t>> integers(const std::string& key);
  /// At least one number, each within the range of the key.
  std::optional<std::vector<double>> list(const std::string& key);
  /// At least one pair of numbers, each number within the range of the key.
  std::optional<std::vector<std::array<double, 2>>> pairs(const std::string& key);
  std::optional<bool> boolean(const std::string& key);
  std::optional<std::string> text(const std::string& key);
  std::optional<Vector3> vector(const std::string& key);
  /// Three numbers, not all 0, normalised to length 1.
  std::optional<Vector3> direction(const std::string& key);
  /// Two numbers, neither negative; `names` appear in the error.
  std::optional<std::array<double, 2>> pair(const std::string& key, const char* names);
  /// A string or a list of strings.
  std::vector<std::string> texts(const std::string& key);
  std::optional<Table> table(const std::string& key, const Section& keys);
  /// The entries of a table of tables, [bodies], sorted by name. Empty if it is absent.
  std::vector<std::pair<std::string, Table>> named(const std::string& key, const Section& keys);
  /// The entries of an array of tables.
  std::vector<Table> array(const std::string& key, const Section& keys);
  /// A table whose entries must all be strings.
  std::map<std::string, std::string> strings(const std::string& key);
  std::map<std::string, double> numbers(const std::string& key);

  /// Throws InputError if the table has a key that its section does not describe, with what to write. The
  /// functions above call this for each table that they open.
  void refuse_unknown() const;
  /// Throws InputError if the table has a key that was not read, because other keys make it meaningless.
  void refuse_unread() const;

  /// @param key  a key of this table or the dotted name of a nested key; empty: the table itself
  [[noreturn]] void complain(const std::string& key, const std::string& what) const;
  double required_number(const std::string& key);
  /// Returns `value`, which was read for `key`. Throws InputError "is missing: `remedy`" if there is none.
  template <class T>
  T required(const std::string& key, std::optional<T> value, const char* remedy) const {
    if (!value) complain(key, std::string("is missing: ") + remedy);
    return *std::move(value);
  }
  const std::string& where() const { return where_; }
  const toml::table& raw() const { return table_; }

 private:
  /// If `keys` is null, any name is accepted.
  Table(const toml::table& table, const Section* keys, std::string file, std::string where)
      : table_(table), keys_(keys), file_(std::move(file)), where_(std::move(where)) {}
  /// Returns the value of the key, or null if it is absent. Records that the key was read.
  const toml::node* value(const std::string& key, Type type);
  [[noreturn]] void refuse_type(const std::string& key, const toml::node& given) const;
  std::optional<Table> free_table(const std::string& key, Type type);
  Vector3 vector_at(const std::string& key, const toml::node& node, double largest) const;
  /// Throws InputError unless the number is finite, not too large, and within the range of the key.
  double checked(const std::string& key, double number) const;
  /// The entry of the list `node` as a checked number.
  double entry_of(const std::string& key, const toml::node& node, const toml::node& entry) const;
  void check_range(const std::string& key, double value) const;
  /// The dotted name of `key`, or that of the table itself if `key` is empty.
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
