// SPDX-License-Identifier: BSD-2-Clause
// Spectra of sampled signals: the band that a force fills, and magnitudes in bands of a third of an octave.
#pragma once

#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// The frequency below which all but `rest` of the energy of a signal lies; 0 if the signal is 0.
/// @param rest  share of ∫ |F(f)|² df, between 0 and 1
Hertz band_filled(const std::vector<double>& signal, double step, double rest);

/// Magnitudes √(∫ |V(f)|² df) in bands of a third of an octave, f_k 2^(±1/6) with f_k = 1 kHz · 2^(k/3), from
/// 20 Hz to 20 kHz. Bands above half of the rate are 0, so that signals of different rates are comparable.
Vector third_octaves(const std::vector<double>& signal, double step);

}  // namespace ricochet::contact
