// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/table.hpp"

#include <algorithm>
#include <cmath>

#include "src/scene/expected.hpp"
#include "src/scene/keys.hpp"
#include "src/scene/near_miss.hpp"

namespace ricochet::scene {

bool convert(const toml::node& node, double& number) {
  if (node.is_number()) number = *node.value<double>();
  return node.is_number();
}

bool convert(const toml::node& node, std::int64_t& number) {
  if (node.is_integer()) number = node.as_integer()->get();
  return node.is_integer();
}

bool convert(const toml::node& node, bool& on) {
  if (node.is_boolean()) on = node.as_boolean()->get();
  return node.is_boolean();
}

bool convert(const toml::node& node, std::string& text) {
  if (node.is_string()) text = node.as_string()->get();
  return node.is_string();
}

bool convert(const toml::node& node, std::vector<std::string>& texts) {
  texts.resize(1);
  return convert(node, texts[0]) || convert<std::string>(node, texts);
}

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

Table::Table(const toml::table& table, const Section& keys, std::filesystem::path file, std::string where)
    : Table(table, std::move(file), std::move(where)) {
  keys_ = &keys;
  for (auto&& [name, node] : table_)
    if (const std::string key(name.str()); keys.find(key) == nullptr)
      complain(key, unknown_key(keys, key, node.is_table()));
}

bool Table::has_named_entries(const std::string& key, const Section& keys) const {
  const toml::table* table = table_[key].as_table();
  return table != nullptr && std::ranges::all_of(*table, [&](const auto& entry) {
           return entry.second.is_table() ||
                  (entry.second.is_string() && keys.find(entry.first.str()) == nullptr);
         });
}

std::string Table::value_of(const std::string& key) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) node = table_.at_path(key).node();
  return node == nullptr ? "" : " = " + shortened(printed(*node));
}

void Table::complain(const std::string& key, const std::string& what) const {
  throw InputError(
      one_line(fmt::format("{}: {}{}: {}", file_.filename().string(), dotted(key), value_of(key), what)));
}

void Table::check_range(const Key& key, double value) const {
  const Range& range = key.range;
  if (range.holds(value)) {
    if (range.low_open && range.low == "0" && value < 1 / largest_number)
      complain(key.name, "must be at least 1e-30");
    return;
  }
  if (range.low == "0" && !range.low_open && range.high.empty()) complain(key.name, "must not be negative");
  complain(key.name, fmt::format("must be {}{}", range.text(), range.remark));
}

void Table::check(const Key& key, double number) const {
  if (!std::isfinite(number)) complain(key.name, "must be finite");
  if (std::abs(number) > largest_number) complain(key.name, "must be from -1e30 to 1e30");
  check_range(key, number);
}

void Table::check(const Key& key, const std::string& text) const {
  const auto& choices = key.range.choices;
  if (!choices.empty() && std::ranges::count(choices, text) == 0)
    complain(key.name, "must be " + key.range.text());
}

void Table::check(const Key& key, Vector3& vector) const {
  const bool is_direction = key.type == Type::direction;
  for (const double x : vector) {
    if (!std::isfinite(x)) complain(key.name, "must be finite");
    if (std::abs(x) > largest_number && !is_direction)
      complain(key.name, "must consist of numbers from -1e30 to 1e30");
    if (!is_direction) check_range(key, x);
  }
  if (!is_direction) return;
  const double length = std::hypot(vector[0], vector[1], vector[2]);
  if (!(length > 0)) complain(key.name, "must not be zero");
  // If the length is already 1 up to round-off, another division would change the last digit, and a written
  // scene would differ from the original.
  if (std::abs(length - 1) >= 1e-15)
    for (double& x : vector) x /= length;
}

const toml::node* Table::given(const Key& key) const {
  const toml::node* node = table_.get(key.name);
  if (node == nullptr) return nullptr;
  const auto word = node->value<std::string>();
  const bool is_word = word && key.type == Type::number && std::ranges::count(key.range.choices, *word) > 0;
  const bool is_empty = key.type == Type::texts && node->is_array() && node->as_array()->empty();
  return is_word || is_empty ? nullptr : node;
}

bool Table::read(const Key& key, int& number) const {
  std::int64_t given = number;
  const bool has_value = read(key, given);
  number = static_cast<int>(given);
  return has_value;
}

bool Table::read(const Key& key, std::filesystem::path& path) const {
  std::string text;
  const bool has_value = read(key, text);
  if (has_value) path = (file_.parent_path() / text).lexically_normal();
  return has_value;
}

std::optional<Table> Table::free_table(const Key& key) const {
  const toml::node* node = table_.get(key.name);
  if (node == nullptr) return std::nullopt;
  if (!node->is_table()) refuse_type(key, *node);
  return Table(*node->as_table(), file_, dotted(key.name));
}

template <class T>
bool Table::read(const Key& key, std::map<std::string, T>& values) const {
  const auto inner = free_table(key);
  if (!inner) return false;
  for (auto&& [name, node] : inner->table_) {
    const Key entry{.name = std::string(name.str()), .type = type_of<T>};
    inner->read(entry, values[entry.name]);
  }
  return true;
}
template bool Table::read(const Key&, std::map<std::string, double>&) const;
template bool Table::read(const Key&, std::map<std::string, std::string>&) const;

std::optional<Table> Table::table(const std::string& key, const Section& keys) const {
  const auto found = free_table(*keys_->find(key));
  if (!found) return std::nullopt;
  return Table(found->table_, keys, file_, found->where_);
}

std::vector<std::pair<std::string, Table>> Table::named(const std::string& key, const Section& keys,
                                                        std::map<std::string, std::string>* texts) const {
  std::vector<std::pair<std::string, Table>> result;
  const auto all = free_table(*keys_->find(key));
  if (!all) return result;
  for (auto&& [inner, node] : all->table_) {
    const std::string name(inner.str());
    if (texts != nullptr && node.is_string()) {
      (*texts)[name] = node.as_string()->get();
      continue;
    }
    if (!node.is_table()) all->complain(name, expected_table(keys, name, all->dotted(name)));
    result.emplace_back(name, Table(*node.as_table(), keys, file_, all->dotted(name)));
  }
  return result;
}

std::vector<Table> Table::array(const std::string& key, const Section& keys) const {
  std::vector<Table> result;
  const toml::node* node = table_.get(key);
  if (node == nullptr) return result;
  const auto* list = node->as_array();
  if (list == nullptr) refuse_type(*keys_->find(key), *node);
  for (std::size_t k = 0; k < list->size(); ++k) {
    const auto* entry = list->get(k)->as_table();
    if (entry == nullptr) refuse_type(*keys_->find(key), *node);
    result.emplace_back(*entry, keys, file_, fmt::format("{}[{}]", dotted(key), k));
  }
  return result;
}

void Table::refuse_type(const Key& key, const toml::node& given) const {
  complain(key.name, expected(key, dotted(key.name), given));
}

}  // namespace ricochet::scene
