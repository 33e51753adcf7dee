// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/modes.hpp"

#include "src/scene/table.hpp"

namespace ricochet::scene {

Modes read_modes(Table& root, bool may_stay_open) {
  Modes modes;
  auto table = root.table("modes", modes_keys);
  if (!table && may_stay_open) {
    modes.basis = Basis::contact;
    return modes;
  }
  if (!table) root.complain("modes", "is missing: give up_to_hz or count");
  if (const auto band = table->number("up_to_hz")) modes.up_to = Hertz{*band};
  modes.count = table->integer("count");
  modes.flexibility_error = table->number("flexibility_error");
  modes.residual_flexibility = table->boolean("residual_flexibility").value_or(modes.residual_flexibility);
  if (const auto components = table->text("residual_components")) modes.all_components = *components == "all";
  if (const auto basis = table->text("basis")) {
    if (*basis == "contact") modes.basis = Basis::contact;
  } else if (may_stay_open && modes.open()) {
    modes.basis = Basis::contact;
  }
  if (const auto threshold = table->number("low_rank")) {
    if (*threshold != 0 && modes.basis != Basis::contact)
      table->complain("low_rank", "does not allow an inertia count: use it with basis = \"contact\"");
    modes.low_rank = *threshold;
  }
  if (const auto solver = table->text("solver")) {
    if (*solver != modes.solver && modes.basis == Basis::contact)
      table->complain("solver", "finds certified modes: leave it out with basis = \"contact\"");
    modes.solver = *solver;
  }
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
  modes.relative_residual = table->number("relative_residual").value_or(modes.relative_residual);
  table->refuse_unread();
  return modes;
}

}  // namespace ricochet::scene
