// SPDX-License-Identifier: BSD-2-Clause
// The keys of a scene, and of the settings that accuracy chooses (src/accuracy/settings.cpp). A key is
// declared once, with the member of the settings that holds its value. This declaration reads the key from a
// Table, writes it as TOML, which kernels are hashed by, and gives its line in the reference.
#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "src/scene/range.hpp"
#include "src/scene/scene.hpp"
#include "src/scene/table.hpp"
#include "src/scene/write.hpp"

namespace ricochet::scene {

enum class Type {
  number,
  integer,
  integers,
  list,   ///< numbers, at least one
  pairs,  ///< pairs of numbers, at least one
  boolean,
  text,
  texts,  ///< a string or a list of strings
  pair,   ///< two numbers, neither negative
  three,  ///< three numbers that are no vector
  number_or_three,
  axes,       ///< two vectors
  vector,     ///< three numbers
  direction,  ///< three numbers, not all 0
  table,
  number_or_table,
  text_or_table,
  tables,   ///< an array of tables
  numbers,  ///< numbers under names that the user chooses
  strings,  ///< strings under names that the user chooses
};

/// Access to the value of a key in a struct of settings, which is passed by its address.
struct AnyAccess {
  Type type = Type::number;
  std::vector<std::string> choices{};
  /// Sets the value if the table gives the key, and returns whether it does. Throws InputError. Null: the key
  /// is read and written by a function of its own.
  std::function<bool(const Table&, const Key&, void*)> read{};
  /// The value as TOML, with paths relative to the folder; empty: no value.
  std::function<std::string(const void*, const std::filesystem::path&)> write{};
  std::function<bool(const void*)> is_written{};  ///< null: always
  std::function<bool(const void*)> applies{};     ///< whether the key may be given; null: always
  std::string condition{};                        ///< in words: `scheme = "static"`
};

struct Key {
  std::string name;
  Type type;
  std::string unit{};
  std::string fallback{};  ///< as in the reference: a value in backticks, "none", or "–" for a required key
  Range range{};
  std::string meaning{};
  /// A table or a vector as a scene would give it; errors show it. Sections of the file: their title and
  /// keys.
  std::string example{};
  /// What to give if a required key is missing. Empty: a number, or a rule of the scene requires the key.
  std::string remedy{};
  AnyAccess access{};
};

/// A table of the scene. Its keys are written, and listed in the reference, in the order of their
/// declaration.
struct Section {
  std::string title;    ///< as in the scene: "[bodies.NAME]"
  std::string meaning;  ///< a sentence
  std::vector<Key> keys;

  /// Returns null if the table has no such key.
  const Key* find(std::string_view name) const;

 protected:
  void read_into(const Table& table, void* settings) const;
  /// The keys that are written, as lines or as an inline table.
  std::string text_of(const void* settings, const std::filesystem::path& folder, bool in_braces) const;
};

constexpr Type type_for(const double*) { return Type::number; }
constexpr Type type_for(const Hertz*) { return Type::number; }
constexpr Type type_for(const int*) { return Type::integer; }
constexpr Type type_for(const std::int64_t*) { return Type::integer; }
constexpr Type type_for(const bool*) { return Type::boolean; }
constexpr Type type_for(const std::string*) { return Type::text; }
constexpr Type type_for(const std::filesystem::path*) { return Type::text; }
constexpr Type type_for(const Vector3*) { return Type::vector; }
constexpr Type type_for(const std::vector<std::int64_t>*) { return Type::integers; }
constexpr Type type_for(const std::vector<double>*) { return Type::list; }
constexpr Type type_for(const std::vector<std::array<double, 2>>*) { return Type::pairs; }
constexpr Type type_for(const std::vector<std::string>*) { return Type::texts; }
constexpr Type type_for(const std::map<std::string, double>*) { return Type::numbers; }
constexpr Type type_for(const std::map<std::string, std::string>*) { return Type::strings; }
template <class T>
constexpr Type type_for(const std::optional<T>*) {
  return type_for(static_cast<const T*>(nullptr));
}
/// The type of a key whose value is a T.
template <class T>
constexpr Type type_of = type_for(static_cast<const T*>(nullptr));

/// Access to a value of the settings S.
template <class S>
struct Access : AnyAccess {
  Access(Type of_tables) : AnyAccess{of_tables} {}  ///< read by a function of its own

  /// @param get  (const Table&, const Key&, S&) → bool, as AnyAccess::read
  /// @param put  const S& → string, as AnyAccess::write
  template <class Get, class Put>
  Access(Type of, Get get, Put put)
      : AnyAccess{of,
                  {},
                  [get](const Table& table, const Key& key, void* s) {
                    return get(table, key, *static_cast<S*>(s));
                  },
                  [put](const void* s, const auto&) { return std::string(put(*static_cast<const S*>(s))); }} {
  }

  /// @param member  of S or of its base B
  template <class T, class B>
  Access(T B::*member)
      : Access(
            type_of<T>,
            [member](const Table& table, const Key& key, S& s) { return table.read(key, s.*member); },
            [member](const S& s) { return toml_value(s.*member); }) {
    if constexpr (std::is_same_v<T, std::filesystem::path>)
      write = [member](const void* s, const std::filesystem::path& folder) {
        return toml_path(static_cast<const S*>(s)->*member, folder);
      };
  }

  /// Leaves the key out if it has its default.
  Access if_changed() && {
    is_written = [write = write](const void* s) { return write(s, {}) != write(&defaults(), {}); };
    return std::move(*this);
  }
  /// Refuses the key in other settings.
  Access only(bool (*given)(const S&), const char* in_words) && {
    applies = [given](const void* s) { return given(*static_cast<const S*>(s)); };
    condition = in_words;
    return std::move(*this);
  }
  static const S& defaults() {
    static const S settings{};
    return settings;
  }
};
template <class S, class T>
Access(T S::*) -> Access<S>;
template <class S, class Put>
Access(Type, bool (*)(const Table&, const Key&, S&), Put) -> Access<S>;

/// A direction, which is normalised: a member of S or of its base B.
template <class S, class T, class B>
Access<S> direction(T B::*member) {
  Access<S> access(member);
  access.type = Type::direction;
  return access;
}

/// An enumeration, or an optional one, in S or in its base B; `names` in the order of its members.
template <class S, class T, class B>
Access<S> choice(T B::*member, const std::vector<std::string>& names) {
  using Value = typename decltype(std::optional(std::declval<T>()))::value_type;
  Access<S> access(
      Type::text,
      [member, names](const Table& table, const Key& key, S& s) {
        std::string name;
        const bool given = table.read(key, name);
        if (given) s.*member = static_cast<Value>(std::ranges::find(names, name) - names.begin());
        return given;
      },
      [member, names](const S& s) {
        const std::optional<Value> value = s.*member;
        return value ? toml_string(names[static_cast<std::size_t>(*value)]) : "";
      });
  access.choices = names;
  return access;
}

/// The default of a key in the reference, and Key::remedy.
struct Fallback {
  std::string text, remedy{};
  Fallback(std::string words, std::string missing = "")
      : text(std::move(words)), remedy(std::move(missing)) {}
  Fallback(const char* words) : text(words) {}
};
inline const char* const none = "none";
/// The default of the member. So is the beginning of a text that starts with a comma.
inline const char* const initial = "";
inline Fallback required(const std::string& remedy = "") { return {"–", remedy}; }

inline Range any() { return {}; }
inline Range above(const char* low) { return {.low = low, .low_open = true}; }
inline Range at_least(const char* low) { return {.low = low}; }
inline Range from_to(const char* low, const char* high, const char* remark = "") {
  return {.low = low, .high = high, .remark = remark};
}

/// The declaration of a key with a value in S.
template <class S>
struct Declared {
  std::string name;
  Access<S> access;
  std::string unit = {};
  Fallback fallback = none;
  Range range = {};
  std::string meaning = {};
  std::string example = {};
};

/// A table of the scene that is read into an S.
template <class S>
struct SectionOf : Section {
  SectionOf(std::string title, std::string meaning, std::vector<Declared<S>> declared)
      : Section{std::move(title), std::move(meaning), {}} {
    for (Declared<S>& one : declared) {
      std::string fallback = one.fallback.text;
      if (fallback.empty() || fallback.front() == ',')
        fallback = '`' + one.access.write(&Access<S>::defaults(), {}) + '`' + fallback;
      if (!one.access.choices.empty()) one.range.choices = one.access.choices;
      keys.push_back({one.name, one.access.type, one.unit, fallback, one.range, one.meaning, one.example,
                      one.fallback.remedy, std::move(one.access)});
    }
  }
  /// This section with further keys, which are read and written by the section `more`.
  SectionOf with_keys_of(const Section& more) && {
    for (const Key& key : more.keys) {
      keys.push_back(key);
      keys.back().access = {};
    }
    return std::move(*this);
  }
  SectionOf without(const std::set<std::string_view>& names) const {
    SectionOf rest = *this;
    std::erase_if(rest.keys, [&](const Key& key) { return names.contains(key.name); });
    return rest;
  }
  /// Sets the values of the keys that the table gives. Throws InputError for a value of another type or out
  /// of range, for a required key that is missing, and for a key that does not apply.
  void read(const Table& table, S& settings) const { read_into(table, &settings); }
  /// The keys as lines of TOML. `folder`: paths are written relative to it.
  std::string write(const S& settings, const std::filesystem::path& folder = {}) const {
    return text_of(&settings, folder, false);
  }
  /// The keys as an inline table.
  std::string inline_table(const S& settings) const { return text_of(&settings, {}, true); }
};

/// An array of tables, each of which is an E.
template <class S, class E>
Access<S> list(std::vector<E> S::*member, const SectionOf<E>& section) {
  return {Type::tables,
          [member, &section](const Table& table, const Key& key, S& s) {
            for (const Table& entry : table.array(key.name, section))
              section.read(entry, (s.*member).emplace_back());
            return table.has(key.name);
          },
          [member, &section](const S& s) {
            std::string text;
            for (const E& one : s.*member) text += (text.empty() ? "" : ", ") + section.inline_table(one);
            return '[' + text + ']';
          }};
}

extern const SectionOf<Scene> scene_keys;
extern const SectionOf<Body> body_keys, matter_keys;  ///< matter: what its kernel depends on, except its mesh
extern const SectionOf<FineBall> refine_keys;
extern const SectionOf<Material> material_keys;
extern const SectionOf<CentreLine> about_keys;
extern const SectionOf<Damping> damping_keys;
extern const SectionOf<Obstacle> obstacle_keys;
extern const SectionOf<Modes> modes_keys;
extern const SectionOf<Contact> contact_keys;
extern const SectionOf<Pair> pair_keys;
extern const SectionOf<Friction> friction_keys;
extern const SectionOf<Motion> rigid_motion_keys;
extern const SectionOf<Time> time_keys;
extern const SectionOf<Loads> loads_keys;
extern const SectionOf<Forcing> traction_keys, point_keys, motion_keys;
extern const SectionOf<Output> output_keys;
extern const SectionOf<Receiver> receiver_keys;
extern const SectionOf<Gauge> gauge_keys;
extern const SectionOf<Sound> sound_keys;
extern const SectionOf<Strike> strike_keys;

/// All sections, in the order of the reference.
std::vector<const Section*> all_sections();

}  // namespace ricochet::scene
