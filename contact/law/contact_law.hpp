// SPDX-License-Identifier: BSD-2-Clause
// One step of compliant contact, the same for single steps, look-ahead blocks, tables and the player: from
// the displacements that the contact points would have without contact in this step, to the forces p⁺ at its
// end, their mean p̄, and what contact and friction remove.
//
//   0 ≤ λ⁺ ⟂ S p⁺ + s(λ⁺) − (û − M h − g) ≥ 0,   S = a M + R,   h = b p + c p⁻,   p̄ = a p⁺ + h
//   Coulomb's law for τ⁺ and the slip d = u⁺ − u − belt of tangential rows
//   u⁺ = û − M h − S p⁺ − s(λ⁺) = û − M p̄ − R p⁺ − s(λ⁺)
//
// The weights a, b, c are chosen for each island (mean_force.hpp). An open point between two islands belongs
// to neither. It is checked once both are solved: if it closes, the islands merge and are solved together.
//
// A step holds some rows of a Model, in any order, and takes the others for open. Vectors are by position
// among the rows that are held. Only the constructors allocate.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "contact/complementarity/contact_solver.hpp"
#include "contact/law/islands.hpp"
#include "contact/law/mean_force.hpp"
#include "contact/law/slip.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

/// Flexibilities of held rows that are not stored as matrices.
class RowFlexibility {
 public:
  virtual ~RowFlexibility() = default;
  /// y = R p of some of the rows. @param at  their positions: those of a point together  @param p, y  by
  /// index among these
  virtual void yield(std::span<const int> at, const Vector& p, Vector& y) noexcept = 0;
  virtual Symmetric S() noexcept = 0;  ///< M + R
};

/// Flexibilities of k held rows over a step: the leading (k,k) of each matrix.
struct StepMatrices {
  Symmetric R;                     ///< residual; empty: 0
  Symmetric S;                     ///< M + R
  Symmetric S_mean;                ///< a M + R; unused unless steps are conserving
  RowFlexibility* rows = nullptr;  ///< if given, in place of R, and of S if that is empty
  static Symmetric none() { return Eigen::Map<const Eigen::MatrixXd>(nullptr, 0, 0); }
};

/// A step of an island, or of all, that is solved but not accepted yet.
struct StepTrial {
  SolveStatus status = SolveStatus::solved;
  SolveResidual violation{};  ///< of complementarity; 0 unless the solver was cut short
  bool opens = true;          ///< whether λ⁺ is 0
  bool cools = false;         ///< whether the heat of a slip falls below 0
  bool several = false;       ///< whether the forces are known not to be the only solution
  double removed = 0;         ///< energy that contact and friction remove [J]
  double heat = 0;            ///< of friction: part of `removed` [J]
  double belts = 0;           ///< τ̄ᵀ × displacement of moving half-spaces [J]
  double at_start = 0;        ///< energy in the residual and in springs before the step [J]
  double in_residual = 0;     ///< the same after it [J]
  double in_modes = 0;        ///< λ̄ᵀMλ̄ [J]
};

/// Rows that a step of bodies that turn may hold. They are few among those of all pairs, and vectors by
/// position have as many entries.
inline constexpr Eigen::Index most_held = 8192;
inline Eigen::Index capacity_of(const Model& model) {
  return model.turns ? std::min(model.rows(), most_held) : model.rows();
}

class ContactLaw {
 public:
  /// For compliant steps of a model.
  ContactLaw(const Model& model, const StepOptions& options);
  /// For n rows without friction that belong to one body. @param springs  whether rows may have springs
  ContactLaw(Eigen::Index rows, const SolveOptions& solver, bool springs = false)
      : ContactLaw(rows, rows, solver, springs) {}

  /// Holds these rows, at most as many as the capacity, from now on, whatever forces they had. Tangential
  /// rows come with their normal row.
  void hold(std::span<const int> rows) noexcept;
  /// The matrices of the next step differ from those of the last one although the rows do not.
  void change_matrices() noexcept;

  double& gap(Eigen::Index row) { return gap_(row); }  ///< g [m]; ∞ in tangential rows
  double gap(Eigen::Index row) const { return gap_(row); }
  PatchSpring& spring(Eigen::Index row) { return springs_[static_cast<std::size_t>(row)]; }

  /// û and u before the step [m]; the caller sets them before `solve`
  Vector free, start;

  /// Computes R p and M p of the forces so far, unless they are known.
  void know_products(const StepMatrices& matrices, const MeanForce& before) noexcept;
  const Vector& rest() const { return products_.now.R; }  ///< R p by these forces [m]

  /// Solves the step. @param before  the forces so far  @param slip  null if no point has friction
  StepTrial solve(const StepMatrices& matrices, const MeanForce& before, Slip* slip) noexcept;
  /// Completes the step that was solved last. @param end  (n) p⁺, in rows of the model
  void accept(MeanForce& mean, const Vector& end) noexcept;

  // Of the step that was solved last
  const Vector& force() const { return force_; }      ///< p̄ [N]
  const Vector& end() const { return end_; }          ///< p⁺ [N]
  const Vector& u() const { return u_; }              ///< u⁺ [m]
  const Vector& yielded() const { return yielded_; }  ///< R p⁺ + s(λ⁺) [m]

  SolveStatistics statistics() const { return euler_.statistics() + mean_.statistics(); }
  ContactSolver& solver() { return euler_; }

  void archive(auto& a) {
    a(free, start, gap_, springs_, euler_, mean_, rows_, position_, products_);
    a(force_, end_, u_, yielded_, next_, problem_);
  }

 private:
  /// The rows of one island.
  struct Island {
    Eigen::Index size = 0;
    std::vector<int> held, last;  ///< positions; those of the problem that was solved before
    bool has_matrices = false;    ///< whether the matrices below are those of the step
    Vector free, start, rest, gap, belt, before, now;
    Vector in_modes_now, in_modes_before, force, end, u, end_rest, in_modes, end_in_modes, right;
    std::vector<int> pair, law;
    std::vector<PatchSpring> springs;
    std::vector<FrictionContact> contacts;
    ReservedMatrix R, S, S_mean;  ///< of an island that does not hold all rows
    /// The others are those of the step that is solved.
    void archive(auto& a) { a(size, held, last, has_matrices, R, S, S_mean); }
  };

  ContactLaw(Eigen::Index rows, Eigen::Index capacity, const SolveOptions& solver, bool springs);
  bool merge_at_closed_points(const StepMatrices& matrices, const MeanForce& before) noexcept;
  bool take_rows(int island, const MeanForce& before) noexcept;
  void store_forces() noexcept;
  StepTrial solve_island(int island, const StepMatrices& matrices, const MeanForce& before,
                         Slip* slip) noexcept;
  void gather(const StepMatrices& matrices) noexcept;
  void gather(const MeanForce& before, const Slip* slip) noexcept;
  Symmetric whole(const StepMatrices& matrices) noexcept;
  bool begin_with(const MeanWeights& weights) noexcept;
  void account(const FrictionSolver* friction, Slip* slip, StepTrial& out) noexcept;
  StepTrial attempt(const StepMatrices& matrices, const MeanWeights& weights, Slip* slip) noexcept;
  void share_bank(int island, double bank) noexcept;

  // Of the scene
  Eigen::Index contacts_ = 0;         ///< m
  Vector gap_;                        ///< (n)
  std::vector<PatchSpring> springs_;  ///< (m); empty if no point has one
  std::vector<Model::FrictionPoint> friction_;
  std::vector<int> friction_of_;  ///< (m) index in friction_, or −1
  bool moves_ = false;            ///< whether bodies turn, so that gaps may be below 0 at the start
  bool keeps_depth_ = false;      ///< in the step that is solved: points beyond their gaps are not pushed out
  ContactSolver euler_, mean_;    ///< of S, of S_mean

  std::vector<int> rows_, position_;  ///< held rows; position of each row
  std::vector<int> all_;              ///< (capacity) 0, 1, …
  /// Displacements by the forces at an instant, by position [m].
  struct Product {
    Vector R, M;  ///< R p, M p
    void archive(auto& a) { a(R, M); }
  };
  /// By those at the start of the step, at the start of the one before, and at the end.
  struct Products {
    bool known = false;
    Product now, before, after;  ///< of before, R p is not used
    void archive(auto& a) { a(known, now, before, after); }
  };
  Products products_;
  Vector force_, end_, u_, yielded_;

  Islands islands_{1, {{0, -1}}};
  std::vector<std::optional<StepTrial>> trials_;  ///< of islands that are solved
  std::vector<MeanForce::Pair> next_;             ///< of pairs
  std::vector<double> credit_;                    ///< of pairs: removed − heat [J]
  Island problem_;
};

}  // namespace ricochet::contact
