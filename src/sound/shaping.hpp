// SPDX-License-Identifier: BSD-2-Clause
// What makes the motion of a receiver a sound: without rigid motion, and with a soft end.
//
// Sounds are (frames, channels), row-major.
#pragma once

#include <vector>

namespace ricochet::sound {

/// Butterworth's high-pass filter of fourth order, −3 dB at `corner_hz`, in place. The sound is continued
/// before its start by its first frame, so that a body which moves at a constant velocity is silent from the
/// start.
/// @param corner_hz  above 0 and below half of `rate_hz`
void high_pass(std::vector<float>& sound, int channels, double corner_hz, double rate_hz);

/// Multiplies the last `frames` frames by a raised cosine that ends at 0; the whole sound if it is shorter.
void fade_out(std::vector<float>& sound, int channels, double frames);

}  // namespace ricochet::sound
