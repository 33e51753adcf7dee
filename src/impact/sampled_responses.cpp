// SPDX-License-Identifier: BSD-2-Clause
#include "src/impact/sampled_responses.hpp"

#include <fmt/format.h>

#include "contact/files/table_file.hpp"
#include "contact/table/modal_table.hpp"
#include "contact/table/table_stepper.hpp"
#include "src/store/memory.hpp"

namespace ricochet::impact {
namespace {

/// Throws InputError if the sampled responses, their copy in the convolution and the spectra do not fit into
/// memory.
void check_table(const Impact& impact) {
  const auto points = impact.model->gap.size();
  const double responses = impact.options.contact.scheme == Scheme::impulse ? 2 : 1;
  store::check_memory(
      impact.scene,
      fmt::format("contact.kernel = \"table\": {} steps of {} x {} points", impact.steps, points, points),
      4 * responses * 8 * static_cast<double>(impact.steps) * static_cast<double>(points * points),
      "a shorter time.duration, fewer candidates (contact.spacing), or kernel = \"modes\"");
}

}  // namespace

void add_table(Impact& impact, console::Console& console) {
  console.begin("table");
  if (impact.model) {
    check_table(impact);
    impact.table = store::in_file(impact.scene.file, [&] {
      return contact::table_from_modes(*impact.model, impact.options, impact.steps);
    });
  } else {
    impact.table = contact::read_table(impact.scene.contact.table);
  }
  console.end(fmt::format("{} samples, {} contact points", impact.table->samples(), impact.table->points()));
}

std::unique_ptr<contact::Stepper> table_stepper(const Impact& impact) {
  const scene::Scene& scene = impact.scene;
  auto out = store::in_file(
      scene.file, [&] { return std::make_unique<contact::TableStepper>(*impact.table, impact.options); });
  if (impact.steps > out->available())
    throw InputError(
        fmt::format("{}: time.duration = {:.6g} s: {} has samples for {:.6g} s. Shorten the run, or make the "
                    "table longer (tail = \"linear\" if its responses have died out).",
                    scene.file.string(), scene.time.duration, scene.contact.table.string(),
                    static_cast<double>(out->available()) / scene.time.rate_hz));
  return out;
}

}  // namespace ricochet::impact
