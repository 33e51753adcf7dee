// SPDX-License-Identifier: BSD-2-Clause
// Compiled once for each instruction set, which RICOCHET_SIMD names, and with the restrictions of lanes.hpp.
#include "contact/simd/loops.hpp"

#include "contact/simd/lanes.hpp"

namespace ricochet::contact::simd {
namespace {

#if defined(__AVX512F__)
constexpr std::size_t row_tile = 4, step_tile = 4;
#else
constexpr std::size_t row_tile = 2, step_tile = 4;
#endif

using Double = Lanes<double>;
/// A vector of as many T as a register has doubles.
template <class T>
using Narrow = Lanes<T, Double::size>;

template <class T>
Double::type widened(typename Narrow<T>::type x) {
  return __builtin_convertvector(x, Double::type);
}

/// Number of registers of modes that are stepped side by side, because each waits for its previous step.
constexpr std::size_t wide = 4, group = wide * Double::size;
static_assert(pad % group == 0);

struct Group {
  Double::type q[wide], v[wide];
  Group(const double* q0, const double* v0) {
    for (std::size_t w = 0; w < wide; ++w) {
      q[w] = Double::load(q0 + w * Double::size);
      v[w] = Double::load(v0 + w * Double::size);
    }
  }
};

/// q⁺ = q + b q̇ + c (load − ω²q), q̇⁺ = e q̇ + h (load − ω²q), with the factors of q and the constant terms
/// computed first: each step then waits for two operations only.
template <class T>
void free_motion(const Modes& m, std::size_t steps, const double* q0, const double* v0, const double* forced,
                 T* x) {
  for (std::size_t first = 0; first < m.modes; first += group) {
    Group at(q0 + first, v0 + first);
    Double::type q_q[wide], v_q[wide], q_load[wide], v_load[wide];
    for (std::size_t w = 0; w < wide; ++w) {
      const std::size_t n = first + w * Double::size;
      const Double::type c = Double::load(m.c + n), h = Double::load(m.h + n),
                         stiffness = Double::load(m.stiffness + n), load = Double::load(m.load + n);
      q_q[w] = 1 - c * stiffness;
      v_q[w] = -h * stiffness;
      q_load[w] = c * load;
      v_load[w] = h * load;
    }
    for (std::size_t l = 0; l < steps; ++l)
      for (std::size_t w = 0; w < wide; ++w) {
        const std::size_t n = first + w * Double::size;
        const Double::type q = at.q[w], v = at.v[w];
        at.q[w] = q_q[w] * q + (Double::load(m.b + n) * v + q_load[w]);
        at.v[w] = Double::load(m.e + n) * v + (v_q[w] * q + v_load[w]);
        if (forced) {
          at.q[w] += Double::load(forced + 2 * l * m.modes + n);
          at.v[w] += Double::load(forced + (2 * l + 1) * m.modes + n);
        }
        Narrow<T>::store(x + l * m.modes + n, __builtin_convertvector(at.q[w], typename Narrow<T>::type));
      }
  }
}

struct Spent {
  Double::type damping = {}, contact = {};
};

/// Makes `steps` steps of the modes from `first` on; the changes of force begin at `force`.
template <class T, std::size_t steps>
void pushed_tile(const Modes& m, const Pushes<T>& pushes, const T* force, std::size_t first, Group& at,
                 double* rates, Spent& spent) {
  typename Narrow<T>::type push[steps][wide] = {};
  for (std::size_t k = 0; k < pushes.rows; ++k) {
    const auto row = static_cast<std::size_t>(pushes.row[k]);
    const T* B = pushes.B + row * m.modes + first;
    const T* strength = force + row * pushes.stride;
    for (std::size_t w = 0; w < wide; ++w) {
      const auto b = Narrow<T>::load(B + w * Double::size);
      for (std::size_t l = 0; l < steps; ++l) push[l][w] += strength[l] * b;
    }
  }
  // The constants of a register are loaded once for all steps, and its sums are weighted once.
#pragma GCC unroll 4
  for (std::size_t w = 0; w < wide; ++w) {
    const std::size_t n = first + w * Double::size;
    const Double::type load = Double::load(m.load + n), stiffness = Double::load(m.stiffness + n),
                       b = Double::load(m.b + n), c = Double::load(m.c + n), e = Double::load(m.e + n),
                       h = Double::load(m.h + n), q_before = at.q[w];
    Double::type q = q_before, v = at.v[w], gg = {}, gv = {}, vv = {}, pushed = {};
    for (std::size_t l = 0; l < steps; ++l) {
      const Double::type p = widened<T>(push[l][w]);
      const Double::type g = load - p - stiffness * q, dq = b * v + c * g;
      gg += g * g;
      gv += g * v;
      vv += v * v;
      pushed += p * dq;
      q += dq;
      v = e * v + h * g;
      if (rates) Double::store(rates + l * m.modes + n, v);
    }
    spent.damping += Double::load(m.damp_ss + n) * gg + Double::load(m.damp_sr + n) * gv +
                     Double::load(m.damp_rr + n) * vv;
    spent.contact += Double::load(m.held + n) * (q - q_before) + pushed;
    at.q[w] = q;
    at.v[w] = v;
  }
}

template <class T>
void pushed_motion(const Modes& m, const Pushes<T>& pushes, std::size_t steps, double* q0, double* v0,
                   double* rates, Sums& sums) {
  Spent spent;
  Double::type kinetic = {}, strain = {}, loads = {};
  for (std::size_t first = 0; first < m.modes; first += group) {
    Group at(q0 + first, v0 + first);
    std::size_t l = 0;
    const auto to = [&] { return rates ? rates + l * m.modes : nullptr; };
    for (; l + step_tile <= steps; l += step_tile)
      pushed_tile<T, step_tile>(m, pushes, pushes.force + l, first, at, to(), spent);
    for (; l < steps; ++l) pushed_tile<T, 1>(m, pushes, pushes.force + l, first, at, to(), spent);
    for (std::size_t w = 0; w < wide; ++w) {
      const std::size_t n = first + w * Double::size;
      kinetic += at.v[w] * at.v[w];
      strain += Double::load(m.stiffness + n) * at.q[w] * at.q[w];
      loads += Double::load(m.force + n) * (at.q[w] - Double::load(m.origin + n));
      Double::store(q0 + n, at.q[w]);
      Double::store(v0 + n, at.v[w]);
    }
  }
  sums.kinetic += 0.5 * Double::sum(kinetic);
  sums.strain += 0.5 * Double::sum(strain);
  sums.loads += Double::sum(loads);
  sums.damping += Double::sum(spent.damping);
  sums.contact += Double::sum(spent.contact);
}

template <class T, std::size_t rows, std::size_t steps>
void displacement_tile(std::size_t modes, const T* const* B, const int* row, const T* x, double* u,
                       std::size_t stride) {
  using V = Lanes<T>;
  constexpr std::size_t count = (rows * steps + V::size - 1) / V::size * V::size;
  typename V::type sum[count] = {};
  for (std::size_t n = 0; n < modes; n += V::size) {
    typename V::type a[rows];
    for (std::size_t i = 0; i < rows; ++i) a[i] = V::load(B[i] + n);
    for (std::size_t l = 0; l < steps; ++l) {
      const auto y = V::load(x + l * modes + n);
      for (std::size_t i = 0; i < rows; ++i) sum[l * rows + i] += a[i] * y;
    }
  }
  T total[count];
  for (std::size_t k = 0; k < count; k += V::size) V::store(total + k, V::sums(sum + k));
  for (std::size_t l = 0; l < steps; ++l)
    for (std::size_t i = 0; i < rows; ++i)
      u[l * stride + static_cast<std::size_t>(row[i])] += static_cast<double>(total[l * rows + i]);
}

template <class T, std::size_t rows>
void displacement_rows(std::size_t modes, const T* B, const int* row, const T* x, std::size_t steps,
                       double* u, std::size_t stride) {
  const T* b[rows];
  for (std::size_t i = 0; i < rows; ++i) b[i] = B + static_cast<std::size_t>(row[i]) * modes;
  std::size_t l = 0;
  for (; l + step_tile <= steps; l += step_tile)
    displacement_tile<T, rows, step_tile>(modes, b, row, x + l * modes, u + l * stride, stride);
  for (; l < steps; ++l) displacement_tile<T, rows, 1>(modes, b, row, x + l * modes, u + l * stride, stride);
}

template <class T>
void displacement(std::size_t modes, const T* B, const int* row, std::size_t rows, const T* x,
                  std::size_t steps, double* u, std::size_t stride) {
  std::size_t i = 0;
  for (; i + row_tile <= rows; i += row_tile)
    displacement_rows<T, row_tile>(modes, B, row + i, x, steps, u, stride);
  for (; i + 2 <= rows; i += 2) displacement_rows<T, 2>(modes, B, row + i, x, steps, u, stride);
  for (; i < rows; ++i) displacement_rows<T, 1>(modes, B, row + i, x, steps, u, stride);
}

template <class T, std::size_t across>
void combine_tile(const T* A, std::size_t stride, const int* row, std::size_t rows, const T* factor, T* out) {
  using V = Lanes<T>;
  typename V::type sum[across] = {};
  for (std::size_t k = 0; k < rows; ++k) {
    const T* a = A + static_cast<std::size_t>(row[k]) * stride;
    for (std::size_t w = 0; w < across; ++w) sum[w] += factor[k] * V::load(a + w * V::size);
  }
  for (std::size_t w = 0; w < across; ++w) V::store(out + w * V::size, sum[w]);
}

template <class T>
void combine(std::size_t width, const T* A, std::size_t stride, const int* row, std::size_t rows,
             const T* factor, T* out) {
  constexpr std::size_t one = Lanes<T>::size, across = 8;
  std::size_t i = 0;
  for (; i + across * one <= width; i += across * one)
    combine_tile<T, across>(A + i, stride, row, rows, factor, out + i);
  for (; i < width; i += one) combine_tile<T, 1>(A + i, stride, row, rows, factor, out + i);
}

template <class T, std::size_t across, std::size_t steps>
void near_tile(std::size_t width, const T* lag, std::size_t lags, const int* block, std::size_t blocks,
               const T* force, double* u, std::size_t stride) {
  using V = Lanes<T>;
  typename V::type sum[steps][across] = {};
  for (std::size_t k = 0; k < blocks; ++k) {
    const T* from = lag + static_cast<std::size_t>(block[k]) * lags * width;
    for (std::size_t l = 0; l < steps; ++l)
      for (std::size_t w = 0; w < across; ++w)
        sum[l][w] += force[k] * V::load(from + l * width + w * V::size);
  }
  constexpr std::size_t total = across * V::size;
  for (std::size_t l = 0; l < steps; ++l) {
    T row[total];
    for (std::size_t w = 0; w < across; ++w) V::store(row + w * V::size, sum[l][w]);
    double* at = u + l * stride;
    for (std::size_t n = 0; n < total; n += Double::size)
      Double::store(at + n, Double::load(at + n) - widened<T>(Narrow<T>::load(row + n)));
  }
}

template <class T>
void near(std::size_t width, const T* lag, std::size_t lags, const int* block, std::size_t blocks,
          const T* force, std::size_t steps, double* u, std::size_t stride) {
  constexpr std::size_t one = Lanes<T>::size, across = 2;
  std::size_t l = 0;
  const auto strip = [&]<std::size_t together>() {
    const T* from = lag + l * width;
    double* to = u + l * stride;
    std::size_t i = 0;
    for (; i + across * one <= width; i += across * one)
      near_tile<T, across, together>(width, from + i, lags, block, blocks, force, to + i, stride);
    for (; i < width; i += one)
      near_tile<T, 1, together>(width, from + i, lags, block, blocks, force, to + i, stride);
  };
  for (; l + step_tile <= steps; l += step_tile) strip.template operator()<step_tile>();
  for (; l < steps; ++l) strip.template operator()<1>();
}

template <class T>
constexpr Loops<T> loops{free_motion<T>, pushed_motion<T>, displacement<T>, combine<T>, near<T>};

}  // namespace

extern const InstructionSet RICOCHET_SIMD;
const InstructionSet RICOCHET_SIMD{RICOCHET_SIMD_NAME, loops<double>, loops<float>};

}  // namespace ricochet::contact::simd
