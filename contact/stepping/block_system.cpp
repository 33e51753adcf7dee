// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/block_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ricochet::contact {

template <class T>
BlockSystem<T>::BlockSystem(std::shared_ptr<const StepSystem> shared, int steps, double step, double at_once)
    : plain(std::move(shared)),
      loops(&simd::loops_of<T>(*simd::available().back())),
      length(steps),
      points(static_cast<int>(plain->model->rows())),
      contacts(static_cast<int>(plain->gap.size())),
      modes(simd::padded(plain->model->omega.size())),
      width(simd::padded(points, simd::point_pad)),
      gap(Vector::Constant(points, std::numeric_limits<double>::infinity())),
      tangential(static_cast<std::size_t>(contacts), -1),
      law(tangential),
      matrices(std::make_unique<BlockMatrices<T>>(*plain, steps, step, at_once)),
      softness(Vector::Zero(modes)),
      band(bands),
      yields(!plain->model->R.isZero(0)) {
  const StepSystem& system = *plain;
  const Model& model = *system.model;
  gap.head(contacts) = system.gap;
  for (std::size_t f = 0; f < model.friction.size(); ++f) {
    tangential[model.friction[f].point] = model.friction[f].tangential;
    law[model.friction[f].point] = static_cast<int>(f);
  }
  const auto m = static_cast<std::size_t>(points);
  const Eigen::Index N = model.omega.size();
  ModeConstants of_elastic(*plain);
  std::vector<int> ascending;  // elastic modes, by frequency
  for (int n = 0; n < N; ++n)
    if (system.stiffness(n) != 0) {
      ascending.push_back(n);
      softness(n) = 1 / system.stiffness(n);
    } else {
      if (system.h(n) != 0) rigid.push_back(n);
      for (Vector* x : of_elastic.all()) (*x)(n) = 0;
    }
  elastic.modes = modes;
  constants.assign(of_elastic.all().size() * modes, 0.0);
  double* at = constants.data();
  for (const auto& [from, to] : {std::pair{&of_elastic.stiffness, &elastic.stiffness},
                                 {&of_elastic.b, &elastic.b},
                                 {&of_elastic.c, &elastic.c},
                                 {&of_elastic.e, &elastic.e},
                                 {&of_elastic.h, &elastic.h},
                                 {&of_elastic.load, &elastic.force},
                                 {&of_elastic.q0, &elastic.origin},
                                 {&of_elastic.damp_ss, &elastic.damp_ss},
                                 {&of_elastic.damp_sr, &elastic.damp_sr},
                                 {&of_elastic.damp_rr, &elastic.damp_rr}}) {
    std::copy(from->begin(), from->end(), at);
    *to = at;
    at += modes;
  }

  B.assign(m * modes, T(0));
  for (std::size_t i = 0; i < m; ++i)
    for (int n : ascending) B[i * modes + n] = static_cast<T>(model.B(i, n));
  rigid_B = model.B(Eigen::all, rigid);

  std::sort(ascending.begin(), ascending.end(),
            [&](int x, int y) { return model.omega(x) < model.omega(y); });
  Eigen::MatrixXd far = Eigen::MatrixXd::Zero(points, bands);
  for (std::size_t k = 0; k < ascending.size(); ++k) {
    const int n = ascending[k], of = static_cast<int>(k * bands / ascending.size());
    band[of].push_back(n);
    far.col(of) += model.B.col(n).cwiseAbs2() * softness(n);
  }
  // The flexibility is positive semidefinite, so that |a_ij| ≤ (a_ii a_jj)^½.
  const Vector bends = far.rowwise().sum() + model.R.diagonal();
  if (points > 0) largest = (bends * bends.maxCoeff()).cwiseMax(0).cwiseSqrt();
  reach.assign(bands * width, 0);
  for (std::size_t of = 0; of < bands; ++of)
    for (std::size_t i = 0; i < m; ++i) reach[of * width + i] = rounded_up(std::sqrt(far(i, of)));
}

template struct BlockSystem<double>;
template struct BlockSystem<float>;

}  // namespace ricochet::contact
