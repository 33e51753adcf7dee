// SPDX-License-Identifier: BSD-2-Clause
// The page of an instrument.

const played = instrument(document.getElementById("play"), run.instrument);
document.documentElement.dataset.ready = "yes";
