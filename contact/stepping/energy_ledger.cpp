// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/energy_ledger.hpp"

#include <cmath>

namespace ricochet::contact {

void EnergyLedger::Sum::add(double x) noexcept {
  const double sum = value + x;
  carry += std::abs(value) >= std::abs(x) ? (value - sum) + x : (x - sum) + value;
  value = sum;
}

bool EnergyLedger::close(const Energy& end, const Work& work) noexcept {
  if (!std::isfinite(end.kinetic + end.strain + work.contact + end.residual + work.damping + work.forcing +
                     work.friction + work.belts))
    return false;
  damping_.add(work.damping);
  forcing_.add(work.forcing);
  forcing_.add(-work.belts);
  friction_.add(work.friction);
  contact_.add(work.contact - work.friction - work.belts - (end.residual - energy_.residual));
  energy_ = {.kinetic = end.kinetic,
             .strain = end.strain,
             .residual = end.residual,
             .loads = end.loads + forcing_.total() + bodies_.total(),
             .added = energy_.added,
             .damping = damping_.total(),
             .contact = contact_.total(),
             .friction = friction_.total()};
  return true;
}

void EnergyLedger::exchange(const Energy& now) noexcept {
  const double brought = (now.kinetic - energy_.kinetic) + (now.strain - energy_.strain) +
                         (now.residual - energy_.residual),
               loads = energy_.loads + brought;
  bodies_.add(loads - (now.loads + forcing_.total() + bodies_.total()));
  energy_.kinetic = now.kinetic;
  energy_.strain = now.strain;
  energy_.residual = now.residual;
  energy_.loads = loads;
  energy_.added += brought;
}

}  // namespace ricochet::contact
