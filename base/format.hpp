// SPDX-License-Identifier: BSD-2-Clause
// Messages of the core, which needs the standard library alone: std::format's place until compilers have it.
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace ricochet::base {

/// A value of a message. Numbers print as the shortest text that reads back to them; in "{:.Ng}" with N
/// digits.
class FormatArgument {
 public:
  FormatArgument(std::string_view text) : kind_(Kind::text), text_(text) {}
  FormatArgument(const std::string& text) : FormatArgument(std::string_view(text)) {}
  FormatArgument(const char* text) : FormatArgument(std::string_view(text)) {}
  FormatArgument(double value) : kind_(Kind::real), real_(value) {}
  template <std::integral Integer>
  FormatArgument(Integer value) : kind_(Kind::integer), integer_(static_cast<std::int64_t>(value)) {}

  std::string formatted(std::string_view specification) const;

 private:
  enum class Kind { text, real, integer };
  Kind kind_;
  std::string_view text_{};
  double real_ = 0;
  std::int64_t integer_ = 0;
};

/// Replaces "{}" and "{:.Ng}" by the arguments in their order.
std::string format_arguments(std::string_view text, std::initializer_list<FormatArgument> arguments);

template <class... Arguments>
std::string format(std::string_view text, const Arguments&... arguments) {
  return format_arguments(text, {FormatArgument(arguments)...});
}

}  // namespace ricochet::base
