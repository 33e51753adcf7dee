// SPDX-License-Identifier: BSD-2-Clause
// An instrument: one body that sounds, the mallets that strike it, and the places where they strike. It holds
// the rows of the contact system for each place, so that a strike needs no geometry, no file and no memory.
//
// It is read from a block of bytes, written by python/ricochet/interchange/instrument.py. All numbers are
// little-endian; N modes of the body, P of the mallet, K mallets, Z places, m contact points of a place.
//
//   8 bytes      "ricochet"
//   u32 (7)      version 2, N, P, K, Z, length of the text in bytes, length of the block in bytes
//   u32 (Z)      m of each place
//   bytes        text: names of the mallets, each followed by a newline, then bytes up to a multiple of 8
//   f64          contact steps per second, at least
//   f64 (N),(N)  body: angular frequencies [rad/s], decay rates [1/s]
//   f64 (N),(N)  velocity of the left and of the right channel for unit modal velocities [kg^-1/2]
//   f64 (P),(P)  mallet: angular frequencies, decay rates
//   f64 (K,2)    mallets: mass as a multiple of the kernel's, compliance of the layer on the tip [m³/N]
//   then for each place:
//   f64 (3),(3)  its point [m] and outward unit normal, in the axes of the body
//   f64 (P)      modal velocity of the mallet that moves towards it at 1 m/s [kg^1/2]
//   f64 (m) × 3  initial gaps g [m], bulges b [m], areas A [m²]
//   f64 (m,N+P)  rows of B of the body and of the mallet [kg^-1/2]
//   f64 (m,m)    residual flexibility R of both [m/N]
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "contact/pairing/types.hpp"
#include "ricochet/units.hpp"

namespace ricochet::player {

/// A mallet with the shape of the kernel's, of another density and with a soft layer on its tip.
struct Mallet {
  std::string name;
  double mass = 1;   ///< as a multiple of the kernel's
  double layer = 0;  ///< compliance: thickness divided by Young's modulus [m³/N]; a patch A yields layer/A
};

/// A place where the mallet can strike, with the contact points of the mallet there.
struct Place {
  Vector3 point{}, normal{};
  contact::Vector rate;         ///< (P) modal velocity of the kernel's mallet at 1 m/s
  contact::Vector gap, area;    ///< (m)
  contact::Vector bulge;        ///< (m) b of patch_spring.hpp [m]
  contact::Matrix B;            ///< (m,N+P)
  contact::Matrix flexibility;  ///< (m,m) R
};

struct Instrument {
  double contact_rate_hz = 0;                  ///< contact steps per second, at least
  contact::Vector omega, decay;                ///< (N) of the body
  contact::Vector left, right;                 ///< (N) velocity of the channels
  contact::Vector mallet_omega, mallet_decay;  ///< (P)
  std::vector<Mallet> mallets;                 ///< (K)
  std::vector<Place> places;                   ///< (Z)
};

/// Reads a block. Throws a one-line InputError that names `origin` if it is truncated, of another version or
/// inconsistent, or contains a value that is not finite or out of range.
Instrument load(std::span<const std::byte> block, const std::string& origin = "instrument");

}  // namespace ricochet::player
