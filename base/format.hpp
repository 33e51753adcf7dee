// SPDX-License-Identifier: BSD-2-Clause
// Formatting of messages for the core, which depends on the standard library alone. Replaces std::format
// until the supported compilers have it.
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace ricochet::base {

/// A value in a message. A number prints as the shortest text that reads back to it, or with N digits for
/// "{:.Ng}".
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

/// Replaces "{}" and "{:.Ng}" by the arguments, in order.
std::string format_arguments(std::string_view text, std::initializer_list<FormatArgument> arguments);

template <class... Arguments>
std::string format(std::string_view text, const Arguments&... arguments) {
  return format_arguments(text, {FormatArgument(arguments)...});
}

}  // namespace ricochet::base
