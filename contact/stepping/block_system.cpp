// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/block_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/stepping/propagator.hpp"

namespace ricochet::contact {
namespace {

template <class T>
const simd::Loops<T>& best_loops();
template <>
const simd::Loops<double>& best_loops() {
  return simd::best().in_double;
}
template <>
const simd::Loops<float>& best_loops() {
  return simd::best().in_float;
}

/// A bound stays one after rounding.
template <class T>
T rounded_up(double bound) {
  return static_cast<T>(bound * (1 + 2.0 * std::numeric_limits<T>::epsilon()));
}

}  // namespace

template <class T>
BlockSystem<T>::BlockSystem(std::shared_ptr<const StepSystem> shared, int steps, double step)
    : plain(std::move(shared)),
      loops(&best_loops<T>()),
      length(steps),
      points(static_cast<int>(plain->gap.size())),
      modes(simd::padded(static_cast<std::size_t>(plain->omega.size()))),
      width(simd::padded(static_cast<std::size_t>(points), simd::point_pad)),
      rest(plain->s),
      band(bands),
      yields(!plain->R.isZero(0)) {
  const StepSystem& system = *plain;
  const auto m = static_cast<std::size_t>(points), L = static_cast<std::size_t>(steps);
  const Eigen::Index N = system.omega.size();
  std::vector<int> elastic;
  for (int n = 0; n < N; ++n)
    if (system.stiffness(n) != 0)
      elastic.push_back(n);
    else if (system.h(n) != 0)
      rigid.push_back(n);
  const auto of_elastic = [&](const Vector& values) {
    std::vector<double> out(modes, 0.0);
    for (int n : elastic) out[static_cast<std::size_t>(n)] = values(n);
    return out;
  };
  stiffness = of_elastic(system.stiffness);
  load = of_elastic(system.load);
  origin = of_elastic(system.q0);
  b = of_elastic(system.b);
  c = of_elastic(system.c);
  e = of_elastic(system.e);
  h = of_elastic(system.h);
  damp_ss = of_elastic(system.damp_ss);
  damp_sr = of_elastic(system.damp_sr);
  damp_rr = of_elastic(system.damp_rr);
  softness = of_elastic(system.stiffness);
  for (int n : elastic) softness[static_cast<std::size_t>(n)] = 1 / system.stiffness(n);

  B.assign(m * modes, T(0));
  for (std::size_t i = 0; i < m; ++i)
    for (int n : elastic)
      B[i * modes + static_cast<std::size_t>(n)] = static_cast<T>(system.B(static_cast<Eigen::Index>(i), n));
  rigid_B.resize(points, static_cast<Eigen::Index>(rigid.size()));
  for (std::size_t r = 0; r < rigid.size(); ++r)
    rigid_B.col(static_cast<Eigen::Index>(r)) = system.B.col(rigid[r]);

  std::sort(elastic.begin(), elastic.end(), [&](int x, int y) { return system.omega(x) < system.omega(y); });
  Eigen::MatrixXd far = Eigen::MatrixXd::Zero(points, bands);
  Vector soft = Vector::Zero(N);
  for (std::size_t k = 0; k < elastic.size(); ++k) {
    const int n = elastic[k], of = static_cast<int>(k * bands / elastic.size());
    band[static_cast<std::size_t>(of)].push_back(n);
    soft(n) = 1 / system.stiffness(n);
    far.col(of) += system.B.col(n).cwiseAbs2() * soft(n);
    rest += system.B.col(n) * (system.load(n) * soft(n));
  }
  const Eigen::MatrixXd bends = system.B * soft.asDiagonal() * system.B.transpose() + system.R;
  largest = bends.cwiseAbs().colwise().maxCoeff().transpose();
  reach.assign(bands * width, T(0));
  for (std::size_t of = 0; of < bands; ++of)
    for (std::size_t i = 0; i < m; ++i)
      reach[of * width + i] =
          rounded_up<T>(std::sqrt(far(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(of))));
  flexibility.assign(m * width, T(0));
  influence.assign(m * width, T(0));
  if (yields) residual.assign(m * width, T(0));
  for (std::size_t j = 0; j < m && yields; ++j)
    for (std::size_t i = 0; i < m; ++i)
      residual[j * width + i] =
          static_cast<T>(system.R(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
  for (std::size_t j = 0; j < m; ++j)
    for (std::size_t i = 0; i < m; ++i)
      flexibility[j * width + i] =
          static_cast<T>(bends(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));

  lag.assign(m * L * width, T(0));
  Vector held = Vector::Zero(N), more(N);  // c of the steps so far
  for (std::size_t d = 0; d < L; ++d) {
    for (Eigen::Index n = 0; n < N; ++n)
      more(n) = mode_response(system.omega(n), system.decay(n), static_cast<double>(d + 1) * step).c;
    Eigen::MatrixXd now = system.B * (more - held).asDiagonal() * system.B.transpose();
    if (d == 0) now += system.R;
    held = more;
    for (std::size_t j = 0; j < m; ++j)
      for (std::size_t i = 0; i < m; ++i) {
        const double value = now(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        lag[(j * L + d) * width + i] = static_cast<T>(value);
        T& bound = influence[j * width + i];
        bound = std::max(bound, rounded_up<T>(std::abs(value)));
      }
  }
}

template struct BlockSystem<double>;
template struct BlockSystem<float>;

}  // namespace ricochet::contact
