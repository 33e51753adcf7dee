// SPDX-License-Identifier: BSD-2-Clause
#include "base/format.hpp"

#include <array>
#include <cassert>
#include <charconv>
#include <cmath>

namespace ricochet::base {
namespace {

/// Positional notation from 1e-4 to below 1e16, scientific notation otherwise.
std::chars_format notation(double value) {
  const double size = std::abs(value);
  return size == 0 || (size >= 1e-4 && size < 1e16) ? std::chars_format::fixed
                                                    : std::chars_format::scientific;
}

std::string formatted(const FormatArgument& argument, std::string_view specification) {
  if (const auto* text = std::get_if<std::string_view>(&argument)) return std::string(*text);
  if (const auto* integer = std::get_if<std::int64_t>(&argument)) return std::to_string(*integer);
  const double real = std::get<double>(argument);
  std::array<char, 64> out;
  std::to_chars_result end{};
  if (specification.empty()) {
    end = std::to_chars(out.data(), out.data() + out.size(), real, notation(real));
  } else {
    assert(specification.starts_with(":.") && specification.ends_with('g'));
    int digits = 0;
    std::from_chars(specification.data() + 2, specification.data() + specification.size() - 1, digits);
    end = std::to_chars(out.data(), out.data() + out.size(), real, std::chars_format::general, digits);
  }
  return {out.data(), end.ptr};
}

}  // namespace

std::string format_arguments(std::string_view text, std::initializer_list<FormatArgument> arguments) {
  std::string out;
  const FormatArgument* next = arguments.begin();
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = text.find('{', at);
    out += text.substr(at, open - at);
    if (open == std::string_view::npos) break;
    const std::size_t close = text.find('}', open);
    assert(close != std::string_view::npos && next != arguments.end());
    out += formatted(*next++, text.substr(open + 1, close - open - 1));
    at = close + 1;
  }
  return out;
}

}  // namespace ricochet::base
