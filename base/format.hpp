// SPDX-License-Identifier: BSD-2-Clause
// Formatting of messages for the core, which depends on the standard library alone. Replaces std::format
// until all supported compilers provide it.
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

namespace ricochet::base {

/// A value in a message.
using FormatArgument = std::variant<std::string_view, double, std::int64_t>;

FormatArgument format_argument(const auto& value) {
  if constexpr (std::integral<std::decay_t<decltype(value)>>)
    return static_cast<std::int64_t>(value);
  else
    return value;
}

/// Replaces "{}" and "{:.Ng}" by the arguments, in order. A number is printed as the shortest text that
/// parses back to the same value, or with N digits.
std::string format_arguments(std::string_view text, std::initializer_list<FormatArgument> arguments);

template <class... Arguments>
std::string format(std::string_view text, const Arguments&... arguments) {
  return format_arguments(text, {format_argument(arguments)...});
}

}  // namespace ricochet::base
