// SPDX-License-Identifier: BSD-2-Clause
#include "player/instrument.hpp"

#include <bit>
#include <cstring>

#include "ricochet/error.hpp"

namespace ricochet::player {
namespace {

static_assert(std::endian::native == std::endian::little, "blocks are read as they are");

constexpr std::size_t head = 8 + 7 * sizeof(std::uint32_t);
constexpr std::uint32_t most =
    1U << 20;  // modes, mallets, places and points; keeps products from overflowing

[[noreturn]] void refuse(const std::string& origin, const std::string& what) {
  throw InputError(origin + ": " + what + " Write it again with ricochet export.");
}

/// Takes values from the front of a block.
class Reader {
 public:
  Reader(std::span<const std::byte> block, const std::string& origin) : rest_(block), origin_(origin) {}

  template <class T>
  void take(T* values, std::size_t count) {
    if (count > rest_.size() / sizeof(T)) refuse(origin_, "is shorter than its header announces.");
    std::memcpy(values, rest_.data(), count * sizeof(T));
    rest_ = rest_.subspan(count * sizeof(T));
  }
  std::uint32_t number() {
    std::uint32_t value = 0;
    take(&value, 1);
    return value;
  }
  /// Values from `least` on.
  template <class Array>
  Array array(Eigen::Index rows, Eigen::Index columns, const char* what, double least) {
    if (static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(columns) > rest_.size())
      refuse(origin_, "is shorter than its header announces.");
    Array out(rows, columns);
    take(out.data(), static_cast<std::size_t>(out.size()));
    if (!out.allFinite() || (out.array() < least).any())
      refuse(origin_, std::string(what) + ": contains a value that is out of range or not finite.");
    return out;
  }
  contact::Vector vector(Eigen::Index n, const char* what, double least = any) {
    return array<contact::Vector>(n, 1, what, least);
  }
  bool empty() const { return rest_.empty(); }

  static constexpr double any = -1e300;

 private:
  std::span<const std::byte> rest_;
  const std::string& origin_;
};

}  // namespace

Instrument load(std::span<const std::byte> block, const std::string& origin) {
  if (block.size() < head || std::memcmp(block.data(), "ricochet", 8) != 0)
    refuse(origin, "is not a block of an instrument.");
  Reader in(block.subspan(8), origin);
  if (const std::uint32_t version = in.number(); version != 2)
    refuse(origin, "has version " + std::to_string(version) + ", but this player reads version 2.");
  const std::uint32_t N = in.number(), P = in.number(), K = in.number(), Z = in.number(), text = in.number(),
                      length = in.number();
  if (length != block.size()) refuse(origin, "is not as long as its header announces.");
  for (const std::uint32_t count : {N, P, K, Z})
    if (count == 0 || count > most) refuse(origin, "has no modes, no mallets or no places.");

  if (text > length || Z > length) refuse(origin, "is shorter than its header announces.");
  std::vector<std::uint32_t> points(Z);
  in.take(points.data(), Z);
  std::string names(text, '\0');
  in.take(names.data(), text);
  const std::size_t before = head + Z * sizeof(std::uint32_t) + text;
  std::uint64_t padding = 0;
  in.take(reinterpret_cast<std::byte*>(&padding), (8 - before % 8) % 8);

  Instrument out;
  in.take(&out.contact_rate_hz, 1);
  if (!(out.contact_rate_hz > 0 && out.contact_rate_hz < 1e9)) refuse(origin, "has no contact rate.");
  out.omega = in.vector(N, "angular frequencies", 0);
  out.decay = in.vector(N, "decay rates", 0);
  out.left = in.vector(N, "left channel");
  out.right = in.vector(N, "right channel");
  out.mallet_omega = in.vector(P, "angular frequencies of the mallet", 0);
  out.mallet_decay = in.vector(P, "decay rates of the mallet", 0);
  const auto mallets = in.array<contact::Matrix>(K, 2, "mallets", 0);
  for (std::uint32_t k = 0, at = 0; k < K; ++k) {
    const std::size_t end = names.find('\n', at);
    if (end == std::string::npos || !(mallets(k, 0) > 0))
      refuse(origin, "has a mallet without name or mass.");
    out.mallets.push_back({names.substr(at, end - at), mallets(k, 0), mallets(k, 1)});
    at = static_cast<std::uint32_t>(end + 1);
  }
  for (const std::uint32_t m : points) {
    if (m == 0 || m > most) refuse(origin, "has a place without contact points.");
    Place place;
    in.take(place.point.data(), 3);
    in.take(place.normal.data(), 3);
    place.rate = in.vector(P, "velocity of the mallet");
    place.gap = in.vector(m, "gaps");
    place.bulge = in.vector(m, "bulges", 0);
    place.area = in.vector(m, "areas", 0);
    place.B = in.array<contact::Matrix>(m, N + P, "contact rows", Reader::any);
    place.flexibility = in.array<contact::Matrix>(m, m, "residual flexibility", Reader::any);
    if (!(place.area.minCoeff() > 0) || !(place.flexibility.diagonal().minCoeff() >= 0))
      refuse(origin, "has a contact point without area, or whose residual flexibility is negative.");
    out.places.push_back(std::move(place));
  }
  if (!in.empty()) refuse(origin, "is longer than its header announces.");
  return out;
}

}  // namespace ricochet::player
