// SPDX-License-Identifier: BSD-2-Clause
// The page of modes without an impact.

const shown = player(section("motion"), run.motion, () => {});
new Modes(section("modes"), run.modes, shown, true);
document.documentElement.dataset.ready = "yes";
