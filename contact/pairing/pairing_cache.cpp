#include "contact/pairing/pairing_cache.hpp"

#include <algorithm>
#include <utility>

namespace ricochet::contact {

namespace {

/// Two for each pair that asks for a gap, before and after it has moved a body: of four such pairs.
constexpr std::size_t most = 8;

}  // namespace

const Pairing& Pairings::get(const WorldSurface& a, const WorldSurface& b, const PairRequest& request,
                             const std::function<Pairing()>& find) {
  const auto same = std::ranges::find_if(
      known_, [&](const Known& known) { return known.request == request && known.a == a && known.b == b; });
  if (same != known_.end()) return same->pairing;
  Known found{a, b, request, find()};
  if (known_.size() < most) return known_.emplace_back(std::move(found)).pairing;
  Known& replaced = known_[std::exchange(oldest_, (oldest_ + 1) % most)];
  replaced = std::move(found);
  return replaced.pairing;
}

}  // namespace ricochet::contact
