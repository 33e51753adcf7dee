// Internal to src/scene: checked access to a TOML table.
#pragma once

#include <fmt/format.h>

#include <toml++/toml.h>
#include <set>
#include <string>
#include <vector>

#include "kernels/error.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::scene {

/// `text` with the keys of one "--set" applied, each value parsed as TOML, else taken as a bare string.
void apply_override(toml::table& root, const Override& text);

/// `text` as TOML. Throws what the parser throws, and InputError that begins with `origin` for keys that nest
/// deeper than tables can be taken down again.
toml::table parse_toml(const std::string& text, const std::string& origin);

/// `text` with line breaks and other control characters as spaces: complaints are one line whatever keys
/// hold.
std::string one_line(std::string text);

/// Numbers farther from 1 than this factor are refused: their squares, and products with their like, leave
/// what arithmetic can hold.
constexpr double largest_number = 1e30;

/// Reads keys of one table, remembers which, and complains in one line: "FILE: dotted.key = value: what.
/// fix."
class Table {
 public:
  Table(const toml::table& table, std::string file, std::string where)
      : table_(table), file_(std::move(file)), where_(std::move(where)) {}

  bool has(const std::string& key) {
    known_.insert(key);
    return table_.contains(key);
  }
  std::optional<double> number(const std::string& key);
  std::optional<std::int64_t> integer(const std::string& key);
  std::optional<std::vector<std::int64_t>> integers(const std::string& key);
  std::optional<bool> boolean(const std::string& key);
  std::optional<std::string> text(const std::string& key);
  std::optional<Vector3> vector(const std::string& key, double largest = largest_number);
  /// A string or a list of strings.
  std::vector<std::string> texts(const std::string& key);
  std::optional<Table> table(const std::string& key);
  /// Sub-tables by name, in order of names.
  std::vector<std::pair<std::string, Table>> tables() const;
  /// Entries of an array of tables.
  std::vector<Table> array(const std::string& key);
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
  /// The table itself when `key` is empty.
  std::string dotted(const std::string& key) const {
    return where_.empty() || key.empty() ? where_ + key : where_ + "." + key;
  }
  std::string value_of(const std::string& key) const;
  const toml::table& table_;
  std::string file_, where_;
  std::set<std::string> known_;
};

/// The keys of a body that its kernel depends on, but for its mesh.
void read_body_matter(Table& table, Body& body);

/// The table [modes] of `root`, where `accuracy` may choose what is left open.
Modes read_modes(Table& root, const std::optional<double>& accuracy = {});

/// [contact], once the scene's bodies and obstacles are known.
Contact read_contact(Table& root, const Scene& scene);

/// A vector of any length but 0, at length 1.
std::optional<Vector3> direction(Table& table, const std::string& key);

/// A number that must be there and above 0.
double positive(Table& table, const std::string& key);

}  // namespace ricochet::scene
