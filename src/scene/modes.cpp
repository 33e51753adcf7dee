// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/modes.hpp"

#include "src/scene/keys.hpp"

namespace ricochet::scene {

const SectionOf<Modes> modes_keys{
    "[modes]",
    "",
    {{"basis", choice<Modes>(&Modes::basis, {"modes", "contact"}), "", initial, any(),
      "`\"modes\"`: certified modes of the body. `\"contact\"`: contact-adapted basis, load-dependent Ritz "
      "vectors for the loads that contact can apply"},
     {"up_to_hz", &Modes::up_to, "Hz", none, above("0"),
      "keep all modes up to this frequency. With `flexibility_error` or `basis = \"contact\"`: end of the "
      "frequency band in which the contact surface must respond accurately"},
     {"count", &Modes::count, "", none, at_least("1"),
      "number of modes or Ritz vectors, rigid modes included. The lowest modes are kept; a multiple mode at "
      "the end is kept whole"},
     {"flexibility_error", &Modes::flexibility_error, "1",
      "1e-3 for Ritz vectors without `count`, otherwise none", from_to("1e-6", "0.5"),
      "relative error allowed in the flexibility of the contact surface over the band"},
     {"solver", Access(&Modes::solver).if_changed(), "", initial,
      Range{.choices = {"ricochet", "krylovschur", "subspace", "arnoldi"}},
      "solver that finds the modes, as a type of SLEPc's EPS. Whichever it is, the same certificate proves "
      "that no mode is missing. For `basis = \"modes\"`"},
     {"low_rank", Access(&Modes::low_rank).if_changed(), "1", initial,
      Range{.low = "1e-12", .high = "1e-3", .or_zero = true},
      "threshold of MUMPS's block low-rank factorisation, for `basis = \"contact\"` only; 0: full rank. It "
      "saves memory on large solid bodies. The solves have about this relative error, so keep it well below "
      "`flexibility_error`"},
     {"residual_components", choice<Modes>(&Modes::all_components, {"auto", "all"}).if_changed(), "", initial,
      any(),
      "components of the residual flexibility. `\"auto\"`: only the normal of each candidate if no pair is "
      "tilted against it by more than 3 degrees, otherwise all three. `\"all\"`: always all three"},
     {"residual_flexibility", &Modes::residual_flexibility, "", initial, any(),
      "keep the static flexibility of the modes that are left out"},
     {"relative_residual", &Modes::relative_residual, "1", initial, from_to("1e-14", "1e-2"),
      "bound on ‖Kφ − ω²Mφ‖ / ‖Kφ‖ of each mode. A mode above it is an error, unless round-off explains it. "
      "Ritz vectors are not checked"}}};

Modes read_modes(const Table& root, bool may_stay_open) {
  Modes modes;
  const auto table = root.table("modes", modes_keys);
  if (!table && may_stay_open) {
    modes.basis = Basis::contact;
    return modes;
  }
  if (!table) root.complain("modes", "is missing: give up_to_hz or count");
  modes_keys.read(*table, modes);
  if (!table->has("basis") && may_stay_open && modes.open()) modes.basis = Basis::contact;
  if (modes.low_rank != 0 && modes.basis != Basis::contact)
    table->complain("low_rank", "does not allow an inertia count: use it with basis = \"contact\"");
  if (modes.solver != Modes{}.solver && modes.basis == Basis::contact)
    table->complain("solver", "finds certified modes: leave it out with basis = \"contact\"");
  if (may_stay_open && modes.open()) {
    if (modes.basis == Basis::modes && !modes.residual_flexibility)
      root.complain("modes", "accuracy needs residual_flexibility = true, to represent truncated modes");
  } else if (modes.basis == Basis::contact) {
    if (!modes.up_to)
      root.complain("modes", "basis = \"contact\" needs up_to_hz, the band in which contact acts");
    if (modes.count && modes.flexibility_error)
      root.complain("modes", "give one of count and flexibility_error");
    if (!modes.count && !modes.flexibility_error) modes.flexibility_error = 1e-3;
  } else {
    if (modes.up_to.has_value() == modes.count.has_value())
      root.complain("modes", "give one of up_to_hz and count");
    if (modes.flexibility_error && !modes.up_to)
      root.complain("modes", "flexibility_error needs up_to_hz, the band in which contact acts");
    if (modes.flexibility_error && !modes.residual_flexibility)
      root.complain("modes",
                    "flexibility_error needs residual_flexibility = true, to represent truncated modes");
  }
  return modes;
}

}  // namespace ricochet::scene
