// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "src/scene/expected.hpp"
#include "src/scene/near_miss.hpp"

namespace ricochet::scene {

namespace {

double number_of(const toml::node& node) {
  return node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
}

}  // namespace

std::string shortened(const std::string& line) {
  if (line.size() <= 60) return line;
  std::size_t end = 57;
  while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xC0) == 0x80) --end;
  return line.substr(0, end) + "…";
}

std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
  return text;
}

toml::table parse_toml(const std::string& text, const std::string& origin) {
  // Each dot of a key creates a table, and tables are destroyed recursively, so tens of thousands would
  // exhaust the stack. The parser limits all other nesting. Consecutive dots do not occur in keys, and the
  // numbers of a list are not a key.
  constexpr int most = 100;
  int line = 1, dots = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '\n') ++line;
    if (std::string_view("\n=,[]{}").find(text[at]) != std::string_view::npos) dots = 0;  // a key ends
    if (text[at] == '.' && (at == 0 || text[at - 1] != '.') && ++dots > most)
      throw InputError(fmt::format("{}:{}: more than {} dots: no key is nested so deeply; break the line",
                                   origin, line, most));
  }
  return toml::parse(text);
}

std::string Table::value_of(const std::string& key) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) node = table_.at_path(key).node();
  return node == nullptr ? "" : " = " + shortened(printed(*node));
}

void Table::complain(const std::string& key, const std::string& what) const {
  throw InputError(one_line(fmt::format("{}: {}{}: {}", file_, dotted(key), value_of(key), what)));
}

const toml::node* Table::value(const std::string& key, Type type) {
  if (keys_ != nullptr) {
    const Key* described = keys_->find(key);
    const bool either = described != nullptr && described->type == Type::number_or_table &&
                        (type == Type::number || type == Type::table);
    if (described == nullptr || (described->type != type && !either))
      throw std::logic_error(fmt::format("{}: \"{}\" is read, but src/scene/keys.cpp does not describe it so",
                                         keys_->title, key));
  }
  known_.insert(key);
  return table_.get(key);
}

void Table::check_range(const std::string& key, double value) const {
  if (keys_ == nullptr) return;
  const Range& range = keys_->find(key)->range;
  if (range.holds(value)) {
    if (range.low_open && range.low == "0" && value < 1 / largest_number)
      complain(key, "must be at least 1e-30");
    return;
  }
  if (range.low == "0" && !range.low_open && range.high.empty()) complain(key, "must not be negative");
  complain(key, fmt::format("must be {}{}", range.text(), range.remark));
}

std::optional<double> Table::number(const std::string& key) {
  const toml::node* node = value(key, Type::number);
  if (node == nullptr) return std::nullopt;
  if (const auto word = node->value<std::string>();
      word && keys_ != nullptr && std::ranges::count(keys_->find(key)->range.choices, *word) > 0)
    return std::nullopt;
  if (!node->is_number()) refuse_type(key, *node);
  return checked(key, number_of(*node));
}

double Table::checked(const std::string& key, double number) const {
  if (!std::isfinite(number)) complain(key, "must be finite");
  if (std::abs(number) > largest_number) complain(key, "must be from -1e30 to 1e30");
  check_range(key, number);
  return number;
}

double Table::required_number(const std::string& key) {
  const auto found = number(key);
  if (!found) {
    const std::string unit = keys_ == nullptr ? "" : keys_->find(key)->unit;
    complain(key, "is missing: give a number" + (unit.empty() || unit == "1" ? "" : " in " + unit));
  }
  return *found;
}

std::optional<std::int64_t> Table::integer(const std::string& key) {
  const toml::node* node = value(key, Type::integer);
  if (node == nullptr) return std::nullopt;
  if (!node->is_integer()) refuse_type(key, *node);
  const std::int64_t number = node->as_integer()->get();
  check_range(key, static_cast<double>(number));
  return number;
}

std::optional<std::vector<std::int64_t>> Table::integers(const std::string& key) {
  const toml::node* node = value(key, Type::integers);
  if (node == nullptr) return std::nullopt;
  const auto* list = node->as_array();
  if (list == nullptr) refuse_type(key, *node);
  std::vector<std::int64_t> values;
  for (const toml::node& entry : *list) {
    if (!entry.is_integer()) refuse_type(key, *node);
    values.push_back(entry.as_integer()->get());
  }
  return values;
}

double Table::entry_of(const std::string& key, const toml::node& node, const toml::node& entry) const {
  if (!entry.is_number()) refuse_type(key, node);
  return checked(key, number_of(entry));
}

std::optional<std::vector<double>> Table::list(const std::string& key) {
  const toml::node* node = value(key, Type::list);
  if (node == nullptr) return std::nullopt;
  const auto* entries = node->as_array();
  if (entries == nullptr || entries->empty()) refuse_type(key, *node);
  std::vector<double> numbers;
  for (const toml::node& entry : *entries) numbers.push_back(entry_of(key, *node, entry));
  return numbers;
}

std::optional<std::vector<std::array<double, 2>>> Table::pairs(const std::string& key) {
  const toml::node* node = value(key, Type::pairs);
  if (node == nullptr) return std::nullopt;
  const auto* rows = node->as_array();
  if (rows == nullptr || rows->empty()) refuse_type(key, *node);
  std::vector<std::array<double, 2>> pairs;
  for (const toml::node& row : *rows) {
    const auto* two = row.as_array();
    if (two == nullptr || two->size() != 2) refuse_type(key, *node);
    pairs.push_back({entry_of(key, *node, *two->get(0)), entry_of(key, *node, *two->get(1))});
  }
  return pairs;
}

std::optional<bool> Table::boolean(const std::string& key) {
  const toml::node* node = value(key, Type::boolean);
  if (node == nullptr) return std::nullopt;
  if (!node->is_boolean()) refuse_type(key, *node);
  return node->as_boolean()->get();
}

std::optional<std::string> Table::text(const std::string& key) {
  const toml::node* node = value(key, Type::text);
  if (node == nullptr) return std::nullopt;
  if (!node->is_string()) refuse_type(key, *node);
  const std::string text = node->as_string()->get();
  const auto& choices = keys_->find(key)->range.choices;
  if (!choices.empty() && std::find(choices.begin(), choices.end(), text) == choices.end())
    complain(key, "must be " + keys_->find(key)->range.text());
  return text;
}

Vector3 Table::vector_at(const std::string& key, const toml::node& node, double largest) const {
  const auto* list = node.as_array();
  if (list == nullptr || list->size() != 3) refuse_type(key, node);
  Vector3 vector{};
  for (std::size_t k = 0; k < 3; ++k) {
    const toml::node& entry = *list->get(k);
    if (!entry.is_number()) refuse_type(key, node);
    vector[k] = number_of(entry);
    if (!std::isfinite(vector[k])) complain(key, "must be finite");
    if (std::abs(vector[k]) > largest) complain(key, "must consist of numbers from -1e30 to 1e30");
  }
  return vector;
}

std::optional<Vector3> Table::vector(const std::string& key) {
  const toml::node* node = value(key, Type::vector);
  if (node == nullptr) return std::nullopt;
  return vector_at(key, *node, largest_number);
}

std::optional<Vector3> Table::direction(const std::string& key) {
  const toml::node* node = value(key, Type::direction);
  if (node == nullptr) return std::nullopt;
  const Vector3 given = vector_at(key, *node, std::numeric_limits<double>::max());
  const double length = std::hypot(given[0], given[1], given[2]);
  if (!(length > 0)) complain(key, "must not be zero");
  // The length is already 1 up to round-off. Another division would change the last digit, and a written
  // scene would differ from the original.
  if (std::abs(length - 1) < 1e-15) return given;
  return Vector3{given[0] / length, given[1] / length, given[2] / length};
}

std::optional<std::array<double, 2>> Table::pair(const std::string& key, const char* names) {
  const toml::node* node = value(key, Type::pair);
  if (node == nullptr) return std::nullopt;
  const auto* list = node->as_array();
  if (list == nullptr || list->size() != 2) complain(key, fmt::format("must be two numbers, {}", names));
  std::array<double, 2> numbers{};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto number = list->get(k)->value<double>();
    if (!number || !std::isfinite(*number) || *number < 0)
      complain(key, "must be two numbers, neither negative");
    numbers[k] = *number;
  }
  return numbers;
}

std::vector<std::string> Table::texts(const std::string& key) {
  const toml::node* node = value(key, Type::texts);
  if (node == nullptr) return {};
  if (node->is_string()) return {node->as_string()->get()};
  std::vector<std::string> texts;
  if (!node->is_array()) refuse_type(key, *node);
  for (const toml::node& entry : *node->as_array()) {
    if (!entry.is_string()) refuse_type(key, *node);
    texts.push_back(entry.as_string()->get());
  }
  return texts;
}

std::optional<Table> Table::free_table(const std::string& key, Type type) {
  const toml::node* node = value(key, type);
  if (node == nullptr) return std::nullopt;
  if (!node->is_table()) refuse_type(key, *node);
  return Table(*node->as_table(), nullptr, file_, dotted(key));
}

std::optional<Table> Table::table(const std::string& key, const Section& keys) {
  auto found = free_table(key, Type::table);
  if (found) {
    found->keys_ = &keys;
    found->refuse_unknown();
  }
  return found;
}

std::vector<std::pair<std::string, Table>> Table::named(const std::string& key, const Section& keys) {
  std::vector<std::pair<std::string, Table>> result;
  const auto all = free_table(key, Type::table);
  if (!all) return result;
  for (auto&& [inner, node] : all->table_) {
    const std::string name(inner.str());
    if (!node.is_table()) all->complain(name, expected_table(keys, name, all->dotted(name)));
    result.emplace_back(name, Table(*node.as_table(), keys, file_, all->dotted(name)));
    result.back().second.refuse_unknown();
  }
  return result;
}

std::vector<Table> Table::array(const std::string& key, const Section& keys) {
  std::vector<Table> result;
  const toml::node* node = value(key, Type::tables);
  if (node == nullptr) return result;
  const auto* list = node->as_array();
  if (list == nullptr) refuse_type(key, *node);
  for (std::size_t k = 0; k < list->size(); ++k) {
    const auto* entry = list->get(k)->as_table();
    if (entry == nullptr) refuse_type(key, *node);
    result.emplace_back(*entry, keys, file_, fmt::format("{}[{}]", dotted(key), k));
    result.back().refuse_unknown();
  }
  return result;
}

std::map<std::string, std::string> Table::strings(const std::string& key) {
  std::map<std::string, std::string> result;
  if (auto inner = free_table(key, Type::strings))
    for (auto&& [name, node] : inner->raw()) {
      if (!node.is_string()) inner->complain(std::string(name.str()), "must be a string, in quotes");
      result[std::string(name.str())] = node.as_string()->get();
    }
  return result;
}

std::map<std::string, double> Table::numbers(const std::string& key) {
  std::map<std::string, double> result;
  if (auto inner = free_table(key, Type::numbers))
    for (auto&& [name, node] : inner->raw())
      result[std::string(name.str())] = inner->required_number(std::string(name.str()));
  return result;
}

void Table::refuse_type(const std::string& key, const toml::node& given) const {
  complain(key, keys_ == nullptr ? "must be a number" : expected(*keys_->find(key), dotted(key), given));
}

void Table::refuse_unknown() const {
  for (auto&& [name, node] : table_)
    if (const std::string key(name.str()); keys_->find(key) == nullptr)
      complain(key, unknown_key(*keys_, key, node.is_table()));
}

void Table::refuse_unread() const {
  for (auto&& [name, node] : table_)
    if (const std::string key(name.str()); known_.count(key) == 0)
      complain(key, "has no effect with the other keys of this table: leave it out");
}

}  // namespace ricochet::scene
