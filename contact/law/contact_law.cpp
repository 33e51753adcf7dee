// SPDX-License-Identifier: BSD-2-Clause
#include "contact/law/contact_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "contact/simd/dense.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Largest ratio of the yields of R and of the modes at which R yields little. In an elastic bar whose
/// modes are resolved up to half the rate, the ratio is 0.26 at any Δ: ∫ 1/x² dx over x > π divided by
/// ∫ (1 − cos x)/x² dx over x < π. In solids, the near field of the patches makes R dominate.
constexpr double shock_share = 0.5;

/// Whether contact begins with a shock that the modes carry; λ̄ = a λ⁺ where contact begins.
bool is_shock(const StepTrial& trial) noexcept {
  const double a = conserving_mean.end;
  return 2 * a * a * trial.in_residual < shock_share * trial.in_modes;
}

/// Weights with which points that open empty the bank.
MeanWeights reduced(const StepTrial& opening, double bank) noexcept {
  const double square = opening.in_modes, linear = opening.removed + square - opening.at_start;
  const double x =
      (linear + std::sqrt(linear * linear + 4 * square * (bank + opening.at_start))) / (2 * square);
  // Just below the root, so that round-off does not overdraw the bank.
  const double share = std::clamp(x * (1 - 1e-9), 0.0, 1.0);
  return {conserving_mean.end, share * conserving_mean.start, share * conserving_mean.before};
}

/// y = A x of the leading n rows of a symmetric A.
void multiply(const Symmetric& A, const Vector& x, Index n, Vector& y) noexcept {
  y.head(n).setZero();
  simd::add_product(static_cast<std::size_t>(n), A.data(), static_cast<std::size_t>(A.outerStride()),
                    x.data(), y.data());
}

/// y = R x of the rows at some positions.
void yield(const StepMatrices& matrices, std::span<const int> at, const Vector& x, Vector& y) noexcept {
  if (matrices.rows != nullptr)
    matrices.rows->yield(at, x, y);
  else if (matrices.R.size() > 0)
    multiply(matrices.R, x, std::ssize(at), y);
  else
    y.head(std::ssize(at)).setZero();
}

/// The rows and columns at some positions. Eigen would copy the positions of a std::vector, which allocates.
auto submatrix(const Symmetric& A, std::span<const int> at) { return A(at, at); }

SolveOptions options_of(const StepOptions& options) {
  return {.same_matrix = true, .max_pivots = options.contact.max_pivots};
}

std::vector<int> first_rows(Index n) {
  std::vector<int> out(static_cast<std::size_t>(n));
  std::iota(out.begin(), out.end(), 0);
  return out;
}

}  // namespace

ContactLaw::ContactLaw(Index rows, Index capacity, const SolveOptions& solver, bool springs)
    : contacts_(rows),
      gap_(Vector::Zero(rows)),
      springs_(springs ? static_cast<std::size_t>(rows) : 0),
      friction_of_(static_cast<std::size_t>(rows), -1),
      euler_(static_cast<int>(capacity), solver, false, springs),
      mean_(static_cast<int>(capacity), solver, false, springs),
      all_(first_rows(capacity)) {
  for (Vector* x : {&free, &start, &force_, &end_, &u_, &yielded_, &products_.now.R, &products_.now.M,
                    &products_.before.R, &products_.before.M, &products_.after.R, &products_.after.M})
    x->setZero(capacity);
  position_.assign(static_cast<std::size_t>(rows), -1);
  trials_.resize(1);
  next_.resize(1);
  credit_.assign(1, 0);
  Island& p = problem_;
  for (Vector* x : {&p.free, &p.start, &p.rest, &p.gap, &p.belt, &p.before, &p.now, &p.force, &p.end, &p.u,
                    &p.end_rest, &p.in_modes, &p.right, &p.in_modes_now, &p.in_modes_before, &p.end_in_modes})
    x->setZero(capacity);
  for (std::vector<int>* x : {&rows_, &p.held, &p.last, &p.pair, &p.law})
    x->reserve(static_cast<std::size_t>(capacity));
  p.springs.reserve(springs ? static_cast<std::size_t>(capacity) : 0);
  hold(all_);
}

ContactLaw::ContactLaw(const Model& model, const StepOptions& options)
    : ContactLaw(model.rows(), capacity_of(model), options_of(options), !model.springs().empty()) {
  contacts_ = model.points();
  gap_.setConstant(std::numeric_limits<double>::infinity());
  gap_.head(contacts_) = model.gap;
  moves_ = options.rigid.rotation == Rotation::finite;
  springs_ = model.springs();
  friction_ = model.friction;
  for (std::size_t f = 0; f < friction_.size(); ++f)
    friction_of_[static_cast<std::size_t>(friction_[f].point)] = static_cast<int>(f);
  const Index capacity = capacity_of(model);
  problem_.contacts.reserve(std::min(friction_.size(), static_cast<std::size_t>(capacity)));
  if (!friction_.empty())
    for (ContactSolver* solver : {&euler_, &mean_})
      *solver = ContactSolver(static_cast<int>(capacity), options_of(options), true, !springs_.empty());
  const std::size_t pairs = model.pairs.size();
  if (pairs < 2) return;
  std::vector<Islands::Sides> sides;
  for (const Model::PairBlock& pair : model.pairs) sides.push_back({pair.a, pair.b});
  islands_ = Islands(static_cast<int>(std::ssize(model.bodies)), std::move(sides));
  trials_.resize(model.bodies.size());
  next_.resize(pairs);
  credit_.resize(pairs);
  for (ReservedMatrix* x : {&problem_.R, &problem_.S, &problem_.S_mean}) *x = ReservedMatrix(capacity);
}

void ContactLaw::hold(std::span<const int> rows) noexcept {
  products_.known = false;
  if (std::equal(rows.begin(), rows.end(), rows_.begin(), rows_.end())) return;
  for (const int row : rows_) position_[row] = -1;
  rows_.assign(rows.begin(), rows.end());
  for (std::size_t k = 0; k < rows_.size(); ++k) position_[rows_[k]] = static_cast<int>(k);
  problem_.last.clear();
  euler_.reset();
  mean_.reset();
}

void ContactLaw::change_matrices() noexcept {
  products_.known = problem_.has_matrices = false;
  euler_.change_matrix();
  mean_.change_matrix();
}

/// M = (S_mean − R)/a. Steps of backward Euler do not use M p.
void ContactLaw::know_products(const StepMatrices& matrices, const MeanForce& before) noexcept {
  if (std::exchange(products_.known, true)) return;
  const Index k = std::ssize(rows_);
  const auto at = std::span(all_).first(rows_.size());
  const std::span<const int> rows = rows_;
  Vector &now = problem_.now, &then = problem_.before;
  now.head(k) = before.end()(rows);
  yield(matrices, at, now, products_.now.R);
  if (!before.is_conserving()) return;
  then.head(k) = before.before()(rows);
  yield(matrices, at, then, products_.before.R);
  for (Product* x : {&products_.now, &products_.before}) x->M.head(k).setZero();
  {
    simd::ColumnSum of_now(rows_.size(), products_.now.M.data()),
        of_then(rows_.size(), products_.before.M.data());
    for (Index j = 0; j < k; ++j) {
      const double* const column = matrices.S_mean.col(j).data();
      if (now(j) != 0) of_now.subtract(column, -now(j));
      if (then(j) != 0) of_then.subtract(column, -then(j));
    }
  }
  for (Product* x : {&products_.now, &products_.before})
    x->M.head(k) = (x->M - x->R).head(k) / conserving_mean.end;
}

StepTrial ContactLaw::solve(const StepMatrices& matrices, const MeanForce& before, Slip* slip) noexcept {
  know_products(matrices, before);
  if (slip != nullptr) slip->begin_trial();
  islands_.separate();
  for (std::optional<StepTrial>& trial : trials_) trial.reset();
  for (int pair = 0; pair < islands_.pairs(); ++pair) {
    next_[pair] = {.reserve = before.pairs()[pair].reserve, .bank = before.pairs()[pair].bank};
    if (before.pairs()[pair].carries) islands_.join(pair);
  }
  islands_.assign();
  StepTrial total;
  do {
    for (const int island : islands_.of_pairs()) {
      if (island < 0 || trials_[island]) continue;
      trials_[island] = solve_island(island, matrices, before, slip);
      if (!has_forces(trials_[island]->status)) return *trials_[island];
    }
  } while (merge_at_closed_points(matrices, before));
  for (int island = 0; island < islands_.count(); ++island) {
    if (!trials_[island] || !islands_.exists(island)) continue;
    const StepTrial& trial = *trials_[island];
    if (trial.status == SolveStatus::limited) total.status = trial.status;
    if (trial.violation.scale > 0) total.violation = trial.violation;
    total.several = total.several || trial.several;
    total.removed += trial.removed;
    total.heat += trial.heat;
    total.belts += trial.belts;
    total.at_start += trial.at_start;
    total.in_residual += trial.in_residual;
  }
  return total;
}

/// Computes u⁺ at points between islands. Merges the islands of those that close.
bool ContactLaw::merge_at_closed_points(const StepMatrices& matrices, const MeanForce& before) noexcept {
  if (std::count(islands_.of_pairs().begin(), islands_.of_pairs().end(), -1) == 0) return false;
  const Index k = std::ssize(rows_);
  const auto is_between = [&](Index i) { return islands_.of(before.pair_of_row()[rows_[i]]) < 0; };
  for (Index i = 0; i < k; ++i)
    if (is_between(i)) force_(i) = end_(i) = 0;
  bool merged = false, knows_yield = false;
  Vector &of_end = problem_.end_rest, &of_force = problem_.rest;  // R p⁺, R p̄
  for (Index i = 0; i < k; ++i) {
    if (!is_between(i)) continue;
    const int pair = before.pair_of_row()[rows_[i]];
    if (!std::exchange(knows_yield, true)) {
      const auto at = std::span(all_).first(rows_.size());
      yield(matrices, at, end_, of_end);
      yield(matrices, at, force_, of_force);
    }
    const bool conserving = before.is_conserving();
    const Symmetric& S = conserving ? matrices.S_mean : matrices.S;
    const auto in_modes = [&](const Vector& x, const Vector& yields) {
      const double both = S.col(i).head(k).dot(x.head(k)) - yields(i);
      return conserving ? both / conserving_mean.end : both;
    };
    products_.after.R(i) = yielded_(i) = of_end(i);
    products_.after.M(i) = in_modes(end_, of_end);
    u_(i) = free(i) - in_modes(force_, of_force) - products_.after.R(i);
    if (u_(i) <= gap_(rows_[i])) continue;
    if (islands_.joins(pair)) continue;  // another point has just closed
    trials_[islands_.of_a(pair)].reset();
    islands_.join(pair);
    merged = true;
  }
  if (merged) islands_.assign();
  return merged;
}

/// Takes the rows of an island. Returns false if it has no forces and nothing closes; it then keeps the
/// factors of another one.
bool ContactLaw::take_rows(int island, const MeanForce& before) noexcept {
  Island& p = problem_;
  p.held.clear();
  for (std::size_t k = 0; k < rows_.size(); ++k)
    if (islands_.of(before.pair_of_row()[rows_[k]]) == island) p.held.push_back(static_cast<int>(k));
  return !std::all_of(p.held.begin(), p.held.end(), [&](int at) {
    const int row = rows_[at];
    return before.end()(row) == 0 && before.before()(row) == 0 && (row >= contacts_ || free(at) < gap_(row));
  });
}

/// Solves an island with the weights that its bank allows, and stores its forces.
StepTrial ContactLaw::solve_island(int island, const StepMatrices& matrices, const MeanForce& before,
                                   Slip* slip) noexcept {
  Island& p = problem_;
  if (!take_rows(island, before)) {
    for (const int at : p.held) {
      u_(at) = free(at);
      force_(at) = end_(at) = yielded_(at) = products_.after.R(at) = products_.after.M(at) = 0;
    }
    return {};
  }
  const bool all = p.held.size() == rows_.size();
  if (p.held != p.last) {
    euler_.reset();
    mean_.reset();
    p.last = p.held;
    p.has_matrices = false;
  }
  if (!p.has_matrices) {
    p.S.begin(0);
    if (!all) gather(matrices);
  }
  p.has_matrices = true;
  gather(before, slip);

  bool shock = false, begins = true;
  double bank = 0, reserve = 0;
  for (int k = 0; k < islands_.pairs(); ++k) {
    if (islands_.of(k) != island) continue;
    const MeanForce::Pair& pair = before.pairs()[k];
    shock = shock || pair.shock;
    begins = begins && !pair.carries;
    bank += pair.bank;
    reserve += pair.reserve;
  }
  const StepMatrices part =
      all ? matrices
          : StepMatrices{.R = p.R.view(), .S = p.S.view(), .S_mean = p.S_mean.view(), .rows = matrices.rows};
  const auto left = [&](const StepTrial& trial) { return bank + trial.removed - trial.heat; };
  const bool mean = before.is_conserving() && !shock;
  MeanForce::Pair next{.weights = mean ? conserving_mean : backward_euler, .restarts = shock};
  StepTrial trial = attempt(part, next.weights, slip);
  if (mean && has_forces(trial.status)) {
    next.shock = next.restarts = begins && is_shock(trial);
    if (trial.opens && left(trial) < 0) trial = attempt(part, next.weights = reduced(trial, bank), slip);
    if (next.shock || trial.cools || left(trial) < 0)
      trial = attempt(part, next.weights = backward_euler, slip);
  }
  if (moves_ && has_forces(trial.status) && left(trial) + reserve < 0) {
    keeps_depth_ = true;
    trial = attempt(part, next.weights = backward_euler, slip);
    keeps_depth_ = false;
  }
  if (!has_forces(trial.status)) return trial;
  store_forces();
  // For points that are pushed out
  const double paid = moves_ ? std::clamp(-left(trial), 0.0, reserve) : 0;
  for (int k = 0; k < islands_.pairs(); ++k) {
    if (islands_.of(k) != island) continue;
    next_[k] = next;
    next_[k].bank = before.pairs()[k].bank + credit_[k];
    next_[k].reserve = before.pairs()[k].reserve;
    if (paid > 0) next_[k].reserve *= 1 - paid / reserve;
  }
  share_bank(island, left(trial) + paid);
  return trial;
}

/// Stores the forces of an island, and what they do, by position among all rows that are held.
void ContactLaw::store_forces() noexcept {
  const Island& p = problem_;
  for (Index k = 0; k < p.size; ++k) {
    const int at = p.held[k];
    force_(at) = p.force(k);
    end_(at) = p.end(k);
    u_(at) = p.u(k);
    products_.after.R(at) = yielded_(at) = p.end_rest(k);
    products_.after.M(at) = p.end_in_modes(k);
    if (!springs_.empty() && p.end(k) > 0 && p.springs[k].bulge > 0)
      yielded_(at) += p.springs[k].displacement(p.end(k));
  }
}

/// Gathers the matrices of an island.
void ContactLaw::gather(const StepMatrices& matrices) noexcept {
  Island& p = problem_;
  const Index n = std::ssize(p.held);
  const auto take = [&](const Symmetric& from, ReservedMatrix& to) {
    auto out = to.begin(from.size() > 0 ? n : 0);
    if (from.size() > 0) out = submatrix(from, p.held);
  };
  take(matrices.R, p.R);
  take(matrices.S, p.S);
  take(matrices.S_mean, p.S_mean);
}

/// Gathers displacements, forces and contacts of an island.
void ContactLaw::gather(const MeanForce& before, const Slip* slip) noexcept {
  Island& p = problem_;
  p.size = std::ssize(p.held);
  p.pair.resize(static_cast<std::size_t>(p.size));
  p.springs.clear();
  p.contacts.clear();
  p.law.clear();
  for (Index k = 0; k < p.size; ++k) {
    const int at = p.held[k], row = rows_[at];
    p.free(k) = free(at);
    p.start(k) = start(at);
    p.rest(k) = products_.now.R(at);
    p.in_modes_now(k) = products_.now.M(at);
    p.in_modes_before(k) = products_.before.M(at);
    p.gap(k) = gap_(row);
    p.belt(k) = slip != nullptr && row >= contacts_ ? slip->belt()(row) : 0;
    p.now(k) = before.end()(row);
    p.before(k) = before.before()(row);
    p.pair[static_cast<std::size_t>(k)] = before.pair_of_row()[row];
    if (!springs_.empty()) p.springs.push_back(row < contacts_ ? springs_[row] : PatchSpring{});
    if (row >= contacts_ || friction_of_[row] < 0) continue;
    p.law.push_back(friction_of_[row]);
    // Of the row among those held; below, of its position in the island.
    p.contacts.push_back({static_cast<int>(k), position_[friction_[friction_of_[row]].tangential], 0});
  }
  if (p.held.size() == rows_.size()) return;
  for (FrictionContact& contact : p.contacts)
    contact.tangential =
        static_cast<int>(std::lower_bound(p.held.begin(), p.held.end(), contact.tangential) - p.held.begin());
}

/// Sets p̄ and u⁺ without λ⁺, M times the former, and the right-hand side of the problem. Returns whether a
/// point closes.
bool ContactLaw::begin_with(const MeanWeights& weights) noexcept {
  Island& p = problem_;
  // The energy theorem requires u ≤ g at the start. A step that max_pivots cuts short may end with u > g, and
  // so may one of bodies that turn. From then on, max(g, u) at the start of a step replaces g: a point beyond
  // g cannot go deeper, and it is not pushed out, because that would do work.
  const bool deep = keeps_depth_ || euler_.was_limited() || mean_.was_limited();
  bool closed = false;
  for (Index k = 0; k < p.size; ++k) {
    p.force(k) = weights.start * p.now(k) + weights.before * p.before(k);
    p.in_modes(k) = weights.start * p.in_modes_now(k) + weights.before * p.in_modes_before(k);  // M h
    p.u(k) = p.free(k) - p.in_modes(k);
    p.end(k) = 0;
    if (std::isinf(p.gap(k))) {
      p.right(k) = p.u(k) - p.start(k) - p.belt(k);
      continue;
    }
    p.right(k) = p.u(k) - p.gap(k);
    if (deep) p.right(k) -= std::max(p.start(k) - p.gap(k), 0.0);
    closed = closed || !(p.right(k) < 0);  // NaN included
  }
  return closed;
}

/// Adds up the energies of the step that was solved, and of each pair.
void ContactLaw::account(const FrictionSolver* friction, Slip* slip, StepTrial& out) noexcept {
  const Island& p = problem_;
  std::fill(credit_.begin(), credit_.end(), 0.0);
  const auto remove = [&](int pair, double energy) {
    out.removed += energy;
    credit_[pair] += energy;
  };
  for (Index k = 0; k < p.size; ++k) {
    const double now = p.now(k), end = p.end(k), mean = p.force(k);
    if (now == 0 && end == 0 && mean == 0) continue;
    out.opens = out.opens && end == 0;
    out.belts += mean * p.belt(k);
    double stored = 0.5 * now * p.rest(k), stores = 0.5 * end * p.end_rest(k);
    double moved = p.u(k) - p.start(k) - p.belt(k) + p.end_rest(k) - p.rest(k);
    if (!p.springs.empty() && p.springs[k].bulge > 0) {
      const PatchSpring& spring = p.springs[k];
      stored += spring.energy(now);
      stores += spring.energy(end);
      moved += spring.displacement(end) - spring.displacement(now);
    }
    out.at_start += stored;
    out.in_residual += stores;
    out.in_modes += mean * p.in_modes(k);
    remove(p.pair[k], mean * moved + stored - stores);
  }
  for (std::size_t f = 0; f < p.contacts.size(); ++f) {
    const int t = p.contacts[f].tangential;
    const Eigen::Vector2d d = (p.u - p.start - p.belt).segment<2>(t);
    const double heat = slip->record(
        p.law[f], friction != nullptr ? friction->states()[f] : ContactState::open, &p.force(t), d.data());
    out.heat += heat;
    credit_[p.pair[p.contacts[f].normal]] -= heat;
    out.cools = out.cools || slip->cools(p.law[f]);
  }
}

/// S of the island, gathered when it is needed unless it is given.
Symmetric ContactLaw::whole(const StepMatrices& matrices) noexcept {
  if (matrices.S.size() > 0) return matrices.S;
  const Symmetric S = matrices.rows->S();
  Island& p = problem_;
  if (S.rows() == p.size) return S;
  if (p.S.view().size() == 0) p.S.begin(p.size) = submatrix(S, p.held);
  return p.S.view();
}

/// Solves an island with a mean.
StepTrial ContactLaw::attempt(const StepMatrices& matrices, const MeanWeights& weights, Slip* slip) noexcept {
  Island& p = problem_;
  const Index n = p.size;
  const bool euler = weights == backward_euler;
  const Symmetric S = euler ? whole(matrices) : matrices.S_mean;
  StepTrial out;
  const FrictionSolver* friction = nullptr;
  bool has_product = false;
  if (begin_with(weights)) {
    for (std::size_t f = 0; f < p.contacts.size(); ++f) {
      FrictionContact& contact = p.contacts[f];
      contact.coefficient = slip->coefficient(friction_[p.law[f]].law, p.law[f], p.now(contact.normal) > 0,
                                              p.right.segment<2>(contact.tangential).norm());
    }
    p.end.head(n) = p.now.head(n);
    ContactSolver& solver = euler ? euler_ : mean_;
    out.status = solver.solve(S.topLeftCorner(n, n), p.right.head(n), p.springs, p.contacts, p.end.head(n));
    if (!has_forces(out.status)) return out;
    out.violation = solver.residual();
    if (!p.contacts.empty()) {
      friction = &solver.friction();
      out.several = friction->several();
      has_product = p.springs.empty() && solver.product(p.end.head(n), p.right.head(n));  // S p⁺
    }
  }
  if (!has_product) multiply(S, p.end, n, p.right);
  yield(matrices, p.held, p.end, p.end_rest);
  for (Index k = 0; k < n; ++k) {
    const double in_modes = p.right(k) - p.end_rest(k);  // of p̄, by p⁺
    p.force(k) += weights.end * p.end(k);
    p.u(k) -= p.right(k);
    p.in_modes(k) += in_modes;  // M p̄
    p.end_in_modes(k) = euler ? in_modes : in_modes / conserving_mean.end;
  }
  yield(p.springs, p.end, p.u);
  account(friction, slip, out);
  return out;
}

/// Makes the parts of the pairs in the bank of an island ≥ 0: what contact at a pair has gained is paid by
/// the others, in proportion to what theirs removed.
void ContactLaw::share_bank(int island, double bank) noexcept {
  double positive = 0;
  for (int k = 0; k < islands_.pairs(); ++k)
    if (islands_.of(k) == island) positive += std::max(next_[k].bank, 0.0);
  bool first = true;  // round-off may leave a bank just below 0
  for (int k = 0; k < islands_.pairs(); ++k) {
    if (islands_.of(k) != island) continue;
    next_[k].bank = positive > 0 && bank > 0 ? std::max(next_[k].bank, 0.0) * (bank / positive)
                    : first                  ? bank
                                             : 0;
    first = false;
  }
}

void ContactLaw::accept(MeanForce& mean, const Vector& end) noexcept {
  products_.before.M.swap(products_.now.M);
  products_.now.M.swap(products_.after.M);
  products_.now.R.swap(products_.after.R);
  // Where the history restarts, the force before is not the one of the step before.
  if (std::any_of(next_.begin(), next_.end(), [](const MeanForce::Pair& pair) { return pair.restarts; }))
    products_.known = false;
  if (moves_)
    mean.advance(rows_, end, next_);  // all rows with a force are held
  else
    mean.advance(end, next_);
}

}  // namespace ricochet::contact
