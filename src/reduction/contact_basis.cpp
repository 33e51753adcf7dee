// SPDX-License-Identifier: BSD-2-Clause
#include "src/reduction/contact_basis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/band.hpp"
#include "src/modes/certify.hpp"
#include "src/modes/symmetric.hpp"
#include "src/parallel/memory.hpp"

namespace ricochet::reduction {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using modes::Factorisation;
using modes::inner;
using modes::ModeSet;
using modes::Operators;

/// Number of blocks about the first shift before a second one is considered, and the number of blocks that it
/// must save, by the observed convergence, to be worth a factorisation.
constexpr int blocks_near_zero = 4;
constexpr double blocks_worth_a_shift = 2;

/// Share of the error bound that may be spent on responses omitted from the first block.
constexpr double compression = 0.05, compression_left = 1 - compression;

/// M-orthonormal vectors, the same in every team, and the projected problem.
class RitzSpace {
 public:
  RitzSpace(const parallel::Teams& teams, const Operators& operators, const MatrixXd& loads, Index seen)
      : teams_(teams), operators_(operators), loads_(loads), seen_(seen), q_(operators.local_rows, 0) {}

  Index size() const { return size_; }

  /// Adds the components of `block` that are not yet in the space, at most `most` vectors. The smallest
  /// directions are omitted while the sum of their squared M-norms stays within `bound`.
  /// @return the new vectors, orthonormal: (local rows, ≤ columns)
  MatrixXd extend(MatrixXd block, double bound, Index most) {
    const auto q = vectors();
    MatrixXd momentum = operators_.mass(block);
    // Two passes suffice (Giraud, Langou & Rozložník 2005); the second reveals columns of noise. Rigid
    // motions are removed too, because their remainder in the vectors would grow with every block.
    for (int pass = 0; pass < 2 && block.cols() > 0; ++pass) {
      block.noalias() -= operators_.rigid * inner(operators_.comm, operators_.rigid, momentum);
      block.noalias() -= q * inner(operators_.comm, q, momentum);
      momentum = operators_.mass(block);
      MatrixXd gram = inner(operators_.comm, block, momentum);
      gram = (gram + gram.transpose().eval()) / 2;
      // Every team must drop the same vectors.
      const VectorXd square = modes::eigen_decomposition(teams_.world(), gram);
      const double floor = pass == 0 ? 1e-14 * square[gram.rows() - 1] : 0.5;
      Index dropped = 0;
      for (double sum = 0; dropped < gram.rows(); ++dropped) {
        sum += pass == 0 ? std::max(square[dropped], 0.0) : 0;
        if (square[dropped] > floor && !(pass == 0 && sum <= bound)) break;
      }
      const Index kept = std::min(gram.rows() - dropped, most);
      const MatrixXd normal =
          gram.rightCols(kept) * square.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
      block = (block * normal).eval();
      momentum = (momentum * normal).eval();
    }
    append(block);
    return block;
  }

  /// Ritz values, and Ritz vectors in terms of the basis.
  struct Pairs {
    VectorXd lambda;
    MatrixXd vectors;
  };
  Pairs ritz() const {
    if (size_ == 0) return {};
    Pairs pairs{{}, stiffness_};
    pairs.lambda = modes::eigen_decomposition(teams_.world(), pairs.vectors);
    return pairs;
  }

  /// Returns the traces of the Ritz vectors on the contact surface, (seen, n).
  MatrixXd trace(const MatrixXd& ritz_vectors) const { return trace_ * ritz_vectors; }

  Eigen::Ref<const MatrixXd> vectors() const { return q_.leftCols(size_); }

 private:
  void append(const MatrixXd& block) {
    const Index n = size_, k = block.cols();
    if (n + k > q_.cols()) q_.conservativeResize(block.rows(), n + std::max(k, n));
    q_.middleCols(n, k) = block;
    size_ = n + k;
    const MatrixXd share = inner(operators_.comm, vectors(), operators_.stiffness(block));
    stiffness_.conservativeResize(size_, size_);
    stiffness_.rightCols(k) = share;
    stiffness_.bottomRows(k) = share.transpose();
    trace_.conservativeResize(seen_, size_);
    trace_.rightCols(k) = inner(operators_.comm, loads_.leftCols(seen_), block);
  }

  const parallel::Teams& teams_;
  const Operators& operators_;
  const MatrixXd& loads_;
  Index seen_, size_ = 0;
  MatrixXd q_;
  MatrixXd stiffness_;  ///< QᵀKQ
  MatrixXd trace_;      ///< LᵀQ for the leading columns of L
};

/// The elastic Ritz pairs that determine the flexibility.
struct Seen {
  VectorXd lambda;
  MatrixXd trace;  ///< (seen, n)
  kernels::BandModes modes() const {
    return {{lambda.data(), static_cast<std::size_t>(lambda.size())},
            {trace.data(), static_cast<std::size_t>(trace.size())}};
  }
};

/// Returns the loads without their rigid part. Loads after the first `seen` that are entirely rigid, such as
/// gravity on a free body, are removed.
MatrixXd elastic(const Operators& operators, const MatrixXd& loads, Index seen) {
  MatrixXd rest = loads;
  rest.noalias() -= operators.rigid_momentum * inner(operators.comm, operators.rigid, loads);
  const VectorXd size = operators.norms(loads), left = operators.norms(rest);
  Index kept = 0;  // in place, because the matrix may be the largest of all
  for (Index j = 0; j < loads.cols(); ++j) {
    const bool nothing = left[j] <= 1e-9 * size[j];
    if (nothing) rest.col(j).setZero();
    if (j >= seen && nothing) continue;
    if (kept != j) rest.col(kept) = rest.col(j);
    ++kept;
  }
  rest.conservativeResize(Eigen::NoChange, kept);
  return rest;
}

/// Scales the response to each load after the first `seen` to the size of the largest response to the first
/// `seen` loads. One bound then applies to all.
void balance(const Operators& operators, MatrixXd& response, Index seen) {
  const VectorXd square =
      inner(operators.comm, response, operators.mass(response)).diagonal().cwiseMax(1e-300);
  const double largest = square.head(seen).maxCoeff();
  for (Index j = seen; j < response.cols(); ++j) response.col(j) *= std::sqrt(largest / square[j]);
}

/// Throws InputError on every rank if the next block, of at most `columns` vectors, does not fit into memory:
/// its momenta, the responses, their momenta and a product, and the space, which doubles. Collective.
void refuse_to_grow(const parallel::Teams& teams, const Operators& operators, Index size, Index columns) {
  const double mib =
      static_cast<double>(operators.local_rows * (4 * columns + 2 * size)) * sizeof(double) / (1 << 20);
  const double need = parallel::largest(teams.world(), mib), room = parallel::available_mib(teams.world());
  if (need > 0.9 * room)
    throw InputError(
        fmt::format("the contact-adapted basis of {} vectors would need {:.0f} MiB a rank more, {:.0f} "
                    "are free: name a smaller contact surface, set contact.reach or contact.spacing, or "
                    "raise modes.flexibility_error",
                    size + columns, need, room));
}

}  // namespace

double shift_near_zero(Hertz band) {
  const double omega = RadPerSecond(band).value;
  return -1e-5 * omega * omega;
}

ModeSet contact_basis(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                      Factorisation& factor, const MatrixXd& loads, Index seen, const ContactRequest& request,
                      const modes::Progress& progress) {
  const Operators operators(mesh, body);
  operators.refuse_band(request.band, false);
  const RadPerSecond band(request.band);
  const double square = band.value * band.value;
  const Index r = operators.rigid.cols();
  const Index most = request.count ? std::max<Index>(*request.count - r, 0) : body.free_rows - r;
  const MatrixXd elastic_loads = elastic(operators, loads, seen);
  RitzSpace space(teams, operators, loads, seen);
  MatrixXd block;
  Seen before, now;
  double change = 1, error = 1, bound = 0, blocks_left = 0;
  bool second = false;
  for (int number = 0;; ++number) {
    const bool turn =
        !second && number >= blocks_near_zero && (request.count || blocks_left > blocks_worth_a_shift);
    second = second || turn;
    if (number == 0 || turn) {
      progress.begin(turn ? "contact basis, second shift" : "contact basis");
      factor.factor(turn ? -square : shift_near_zero(request.band));
    }
    refuse_to_grow(teams, operators, space.size(), number == 0 || turn ? elastic_loads.cols() : block.cols());
    MatrixXd next =
        modes::shared_solve(teams, factor, number == 0 || turn ? elastic_loads : operators.mass(block));
    if (number == 0 || turn) balance(operators, next, seen);
    // Directions may be omitted only if the residual flexibility represents them.
    if (number == 0 && !request.count && request.residual_flexibility) {
      const double flexibility = inner(operators.comm, loads.leftCols(seen), next.leftCols(seen)).norm();
      bound = compression * request.flexibility_error * flexibility / square;
    }
    block = {};
    MatrixXd again = turn ? next : MatrixXd();
    block = space.extend(std::move(next), number == 0 ? bound : turn ? 1e-3 * bound : 0, most - space.size());
    if (turn && block.cols() == 0) block = space.extend(std::move(again), 0, most - space.size());
    // Without new vectors, the space is complete: it contains everything that the loads can excite, or
    // everything that moves within the band.
    const bool exhausted = block.cols() == 0;
    if (exhausted) {
      error = 0;
      break;
    }
    const auto ritz = space.ritz();
    before = std::move(now);
    now = {ritz.lambda, space.trace(ritz.vectors)};
    const double last = change;
    if (number > 0)
      change = kernels::flexibility_error(before.modes(), now.modes(), band, request.residual_flexibility);
    change = parallel::of_rank(teams.world(), 0, change);
    // The change is about the error of the previous space. The error of this one is smaller by the rate of
    // convergence, which increases.
    const double pace = number > 1 && change < last ? change / last : 1;
    error = change * pace;
    if (space.size() >= most || (!request.count && error <= compression_left * request.flexibility_error))
      break;
    blocks_left = pace < 1 ? std::log(error / request.flexibility_error) / -std::log(pace)
                           : std::numeric_limits<double>::infinity();
    const double done = std::log(error) / std::log(request.flexibility_error);
    progress.at(request.count ? space.size() : static_cast<std::int64_t>(100 * std::max(done, 0.0)),
                request.count ? most : 100);
  }

  ModeSet set;
  set.exact = false;
  set.angular_frequency.assign(static_cast<std::size_t>(r), 0.0);
  const auto ritz = space.ritz();
  for (const double lambda : ritz.lambda) set.angular_frequency.push_back(std::sqrt(lambda));
  const auto [first, columns] = teams.share(space.size());
  set.store(teams, operators, first, space.vectors() * ritz.vectors.middleCols(first, columns));
  set.cut = square;
  set.static_shift = shift_near_zero(request.band);
  if (bound > 0) error += compression * request.flexibility_error;
  modes::certify_basis(teams, operators, request.band, error, set);
  return set;
}

double expected_basis_mib(const Factorisation& factor, std::int64_t local_rows, std::int64_t loads,
                          std::int64_t count) {
  // The elastic loads, and in the first block the responses, their momenta and a product of both.
  constexpr double first_block = 4;
  // The space, which grows by doubling, the Ritz vectors and their copies.
  constexpr double space = 5;
  const auto b = static_cast<double>(loads), vectors = static_cast<double>(count);
  const double column = static_cast<double>(local_rows) * sizeof(double) / (1 << 20);
  return factor.expected_mib() + column * std::max(first_block * b, b + space * vectors);
}

Hertz needed_up_to(const parallel::Teams& teams, const mesh::Mesh& mesh, const ModeSet& basis,
                   const MatrixXd& loads, Index seen, Hertz band, double error) {
  const MatrixXd trace = basis.gather(teams, inner(mesh.comm, loads.leftCols(seen), basis.shape));
  const auto rigid = std::count(basis.angular_frequency.begin(), basis.angular_frequency.end(), 0.0);
  const VectorXd lambda =
      Eigen::Map<const VectorXd>(basis.angular_frequency.data() + rigid,
                                 static_cast<Index>(basis.angular_frequency.size()) - rigid)
          .array()
          .square();
  const Seen all{lambda, trace.rightCols(lambda.size())};
  std::vector<std::size_t> from_above(static_cast<std::size_t>(lambda.size()));
  for (std::size_t k = 0; k < from_above.size(); ++k) from_above[k] = from_above.size() - 1 - k;
  const std::size_t left =
      kernels::Contributions(all.modes(), static_cast<RadPerSecond>(band)).dispensable(from_above, error);
  if (from_above.empty()) return band;
  // At least the lowest vector is kept. The factor is a margin, because Ritz values differ slightly from the
  // modes that they approximate.
  const std::size_t highest = from_above[std::min(left, from_above.size() - 1)];
  return to_hertz(RadPerSecond{1.001 * std::sqrt(lambda[static_cast<Index>(highest)])});
}

}  // namespace ricochet::reduction
