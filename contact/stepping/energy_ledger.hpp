// SPDX-License-Identifier: BSD-2-Clause
// The energy ledger of a run: energies at the end of a step, and work summed over all steps.
#pragma once

#include "ricochet/energy.hpp"

namespace ricochet::contact {

/// Work over one or more steps [J].
struct Work {
  double damping = 0;  ///< ∫ 2δ q̇²
  double forcing = 0;  ///< ∫ f·q̇ of the loads with histories, ∫ Γ (dū/dt) q̈ of the supports
  double contact = 0;  ///< taken from the bodies by all contact forces
  // With friction. The ledger then closes only if the forces that drive the modes are those that move the
  // points.
  double friction = 0;  ///< τ̄ᵀ d, the heat: part of `contact`
  double belts = 0;     ///< p̄ᵀ × displacement of moving obstacles: part of `contact`, done by them

  void archive(auto& a) { a(damping, forcing, contact, friction, belts); }
};

class EnergyLedger {
 public:
  /// @param start  energies at t = 0
  explicit EnergyLedger(const Energy& start) : energy_(start) {}

  const Energy& energy() const { return energy_; }

  /// Closes the ledger after one or more steps. Returns false and changes nothing if a value is not finite.
  /// @param end  kinetic, strain and residual energy, and the work of constant loads, at the end
  bool close(const Energy& end, const Work& work) noexcept;

  /// Takes energies that change because bodies are added or removed as work from outside.
  /// @param now  as `end` above, of the bodies that are there now
  void exchange(const Energy& now) noexcept;

  void archive(auto& a) {
    Energy& e = energy_;
    a(e.kinetic, e.strain, e.residual, e.loads, e.added, e.damping, e.contact, e.friction);
    a(damping_, contact_, friction_, forcing_, bodies_);
  }

 private:
  /// A compensated sum (Neumaier), for ledgers of millions of steps.
  struct Sum {
    double value = 0, carry = 0;
    void add(double x) noexcept;
    double total() const { return value + carry; }
    void archive(auto& a) { a(value, carry); }
  };

  Energy energy_;
  Sum damping_, contact_, friction_, forcing_;
  Sum bodies_;  ///< work of constant loads on bodies that are not there, and the energy of those added
};

}  // namespace ricochet::contact
