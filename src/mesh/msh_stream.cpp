// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/msh_stream.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

namespace {

/// Longest permitted line: gmsh reads lines into a buffer of 256 bytes.
constexpr std::size_t longest_line = 255;

bool is_space(int c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Printable form of a word with arbitrary bytes.
std::string printed(std::string_view word) {
  std::string text(word.substr(0, 40));
  for (char& c : text)
    if (c < 32 || c == 127) c = '?';
  return text;
}

}  // namespace

MshStream::MshStream(const std::filesystem::path& file)
    : name_(file.filename().string()), stream_(file, std::ios::binary) {
  if (!stream_) fail("cannot be read");
  stream_.seekg(0, std::ios::end);
  size_ = stream_.tellg();
  stream_.seekg(0);
}

void MshStream::fail(const std::string& what) const {
  if (binary_)
    throw InputError(fmt::format("{}: byte {}: {}", name_, before_ + static_cast<std::int64_t>(at_), what));
  throw InputError(fmt::format("{}: line {}: {}", name_, line_, what));
}

void MshStream::fail_at_end(const char* missing) const {
  fail(fmt::format("is cut off: {} is missing: write it again with gmsh", missing));
}

bool MshStream::fill() {
  before_ += static_cast<std::int64_t>(end_);
  stream_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  at_ = 0;
  end_ = static_cast<std::size_t>(stream_.gcount());
  return end_ > 0;
}

int MshStream::next() {
  if (at_ == end_ && !fill()) return EOF;
  return static_cast<unsigned char>(buffer_[at_]);
}

bool MshStream::ended() {
  for (int c = next(); is_space(c); c = next()) {
    if (c == '\n') ++line_;
    ++at_;
  }
  return next() == EOF;
}

std::string_view MshStream::word(const char* expected) {
  if (ended()) fail_at_end(expected);
  word_.clear();
  for (int c = next(); c != EOF && !is_space(c); c = next()) {
    word_ += static_cast<char>(c);
    ++at_;
    if (word_.size() > longest_line)
      fail(fmt::format("a word of more than {} bytes instead of {}", longest_line, expected));
  }
  return word_;
}

std::string MshStream::rest_of_line() {
  std::string rest;
  for (int c = next(); c != EOF && c != '\n'; c = next()) {
    rest += static_cast<char>(c);
    ++at_;
    if (rest.size() > longest_line) fail(fmt::format("a line of more than {} bytes", longest_line));
  }
  while (!rest.empty() && is_space(rest.back())) rest.pop_back();
  while (!rest.empty() && is_space(rest.front())) rest.erase(0, 1);
  return rest;
}

void MshStream::skip_line() {
  int c = next();
  for (; c != EOF && c != '\n'; c = next()) ++at_;
  if (c == '\n') {
    ++line_;
    ++at_;
  }
}

void MshStream::go_to(Place place) {
  line_ = place.line;
  if (before_ <= place.byte && place.byte <= before_ + static_cast<std::int64_t>(end_)) {
    at_ = static_cast<std::size_t>(place.byte - before_);
    return;
  }
  stream_.clear();
  stream_.seekg(place.byte);
  before_ = place.byte;
  at_ = end_ = 0;
}

void MshStream::skip(std::int64_t count, const char* what) {
  if (binary_) {
    const Place end{place().byte + 8 * count, line_};
    if (end.byte > size_) fail_at_end(what);
    go_to(end);
    return;
  }
  for (; count > 0; --count) {
    if (ended()) fail_at_end(what);
    for (int c = next(); c != EOF && !is_space(c); c = next()) ++at_;
  }
}

void MshStream::raw(void* to, std::size_t length, const char* what) {
  auto* bytes = static_cast<char*>(to);
  while (length > 0) {
    if (next() == EOF) fail_at_end(what);
    const std::size_t part = std::min(length, end_ - at_);
    std::memcpy(bytes, &buffer_[at_], part);
    at_ += part;
    bytes += part;
    length -= part;
  }
}

template <class T>
std::int64_t MshStream::integer(const char* what, std::int64_t low, std::int64_t high) {
  std::int64_t value = 0;
  if (binary_) {
    T number{};
    raw(&number, sizeof number, what);
    // Values that are too large become negative and are refused below.
    value = static_cast<std::int64_t>(number);
  } else {
    const std::string_view text = word(what);
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc() || end != text.data() + text.size())
      fail(fmt::format("\"{}\" instead of {}, a whole number", printed(text), what));
  }
  if (value < low || value > high)
    fail(low == high ? fmt::format("{} is {}: must be {}", what, value, low)
                     : fmt::format("{} is {}: must be from {} to {}", what, value, low, high));
  return value;
}
template std::int64_t MshStream::integer<std::int32_t>(const char*, std::int64_t, std::int64_t);
template std::int64_t MshStream::integer<std::uint64_t>(const char*, std::int64_t, std::int64_t);

double MshStream::real(const char* what) {
  double value = std::numeric_limits<double>::quiet_NaN();
  if (binary_) {
    raw(&value, sizeof value, what);
  } else {
    const std::string_view text = word(what);
    const std::size_t sign = text.starts_with('+') ? 1 : 0;
    const auto [end, failure] = std::from_chars(text.data() + sign, text.data() + text.size(), value);
    // A number too small for a double is read as 0, as in gmsh.
    if (failure == std::errc::result_out_of_range &&
        text.find("e-") + text.find("E-") != 2 * std::string_view::npos)
      value = 0;
    else if (failure != std::errc() || end != text.data() + text.size())
      fail(fmt::format("\"{}\" instead of {}, a number", printed(text), what));
  }
  if (!std::isfinite(value)) fail(fmt::format("{} is not finite", what));
  return value;
}

}  // namespace ricochet::mesh
