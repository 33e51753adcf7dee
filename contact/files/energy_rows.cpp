// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/energy_rows.hpp"

#include <array>
#include <utility>

namespace ricochet::contact {
namespace {

constexpr std::array<std::pair<const char*, double Energy::*>, 7> energy_terms{
    {{"/energy/kinetic", &Energy::kinetic},
     {"/energy/strain", &Energy::strain},
     {"/energy/residual", &Energy::residual},
     {"/energy/loads", &Energy::loads},
     {"/energy/damping", &Energy::damping},
     {"/energy/contact", &Energy::contact},
     {"/energy/friction", &Energy::friction}}};

}  // namespace

EnergyRows::EnergyRows(base::hdf5::Writer& file) : rows_{&file.rows("/energy/total", {}, "J")} {
  for (const auto& [name, term] : energy_terms) rows_.push_back(&file.rows(name, {}, "J"));
}

void EnergyRows::append(const Energy& energy) {
  rows_.front()->append(energy.total());
  for (std::size_t k = 0; k < energy_terms.size(); ++k) rows_[k + 1]->append(energy.*energy_terms[k].second);
}

}  // namespace ricochet::contact
