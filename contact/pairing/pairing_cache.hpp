// Pairings found before, for runs that differ in other things than where bodies stand.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "contact/pairing/surface_projection.hpp"

namespace ricochet::contact {

/// The last few pairings of one thread, by all that they follow from: both surfaces in their places, and what
/// the pair asks for. Candidates are numbered as on whole surfaces.
class Pairings {
 public:
  /// The one that is known for this, else that of `find`, known from now on.
  const Pairing& get(const WorldSurface& a, const WorldSurface& b, const PairRequest& request,
                     const std::function<Pairing()>& find);

 private:
  struct Known {
    WorldSurface a, b;
    PairRequest request;
    Pairing pairing;
  };
  std::vector<Known> known_;
  std::size_t oldest_ = 0;
};

}  // namespace ricochet::contact
