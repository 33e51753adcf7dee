// Compiled once for each instruction set: RICOCHET_SIMD names the function that hands the loops out. Includes
// nothing whose inline functions a linker could take from here and run on a processor that lacks the
// instructions.
#include "contact/simd.hpp"

namespace ricochet::contact::simd {
namespace {

#if defined(__AVX512F__)
constexpr std::size_t bytes = 64, row_tile = 4, step_tile = 4;
#elif defined(__AVX2__)
constexpr std::size_t bytes = 32, row_tile = 2, step_tile = 4;
#else
constexpr std::size_t bytes = 16, row_tile = 2, step_tile = 4;
#endif

/// A register of T, or `count` of them.
template <class T, std::size_t count = bytes / sizeof(T)>
struct Lanes {
  static constexpr std::size_t size = count;
  typedef T type __attribute__((vector_size(count * sizeof(T)), aligned(alignof(T)), may_alias));
  static type load(const T* at) { return *reinterpret_cast<const type*>(at); }
  static void store(T* at, type x) { *reinterpret_cast<type*>(at) = x; }
  static T sum(type x) {
    T total = 0;
    for (std::size_t k = 0; k < count; ++k) total += x[k];
    return total;
  }
};

using Double = Lanes<double>;
/// As many T as there are doubles in a register.
template <class T>
using Narrow = Lanes<T, Double::size>;

/// As many T as steps come together in.
template <class T>
using Eight = Lanes<T, (step_pad * sizeof(T) < bytes ? step_pad : bytes / sizeof(T))>;

struct Coefficients {
  Double::type stiffness, load, b, c, e, h;
  Coefficients(const Modes& m, std::size_t n)
      : stiffness(Double::load(m.stiffness + n)),
        load(Double::load(m.load + n)),
        b(Double::load(m.b + n)),
        c(Double::load(m.c + n)),
        e(Double::load(m.e + n)),
        h(Double::load(m.h + n)) {}
  void step(Double::type& q, Double::type& v, Double::type force) const {
    const Double::type g = force - stiffness * q;
    q += b * v + c * g;
    v = e * v + h * g;
  }
};

template <class T>
void free_motion(const Modes& m, std::size_t steps, const double* q0, const double* v0, T* x) {
  for (std::size_t n = 0; n < m.modes; n += Double::size) {
    const Coefficients mode(m, n);
    Double::type q = Double::load(q0 + n), v = Double::load(v0 + n);
    for (std::size_t l = 0; l < steps; ++l) {
      mode.step(q, v, mode.load);
      Narrow<T>::store(x + l * m.modes + n, __builtin_convertvector(q, typename Narrow<T>::type));
    }
  }
}

template <class T>
void pushed_motion(const Modes& m, std::size_t steps, const T* push, double* q0, double* v0) {
  for (std::size_t n = 0; n < m.modes; n += Double::size) {
    const Coefficients mode(m, n);
    Double::type q = Double::load(q0 + n), v = Double::load(v0 + n);
    for (std::size_t l = 0; l < steps; ++l) {
      const auto pushed = Narrow<T>::load(push + l * m.modes + n);
      mode.step(q, v, mode.load - __builtin_convertvector(pushed, Double::type));
    }
    Double::store(q0 + n, q);
    Double::store(v0 + n, v);
  }
}

template <class T, std::size_t rows, std::size_t steps>
void displacement_tile(std::size_t modes, const T* const* B, const T* x, double* const* u) {
  using V = Lanes<T>;
  typename V::type sum[rows][steps] = {};
  for (std::size_t n = 0; n < modes; n += V::size) {
    typename V::type a[rows];
    for (std::size_t i = 0; i < rows; ++i) a[i] = V::load(B[i] + n);
    for (std::size_t l = 0; l < steps; ++l) {
      const auto y = V::load(x + l * modes + n);
      for (std::size_t i = 0; i < rows; ++i) sum[i][l] += a[i] * y;
    }
  }
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t l = 0; l < steps; ++l) u[i][l] += static_cast<double>(V::sum(sum[i][l]));
}

template <class T, std::size_t rows>
void displacement_rows(std::size_t modes, const T* B, const int* row, const T* x, std::size_t steps,
                       double* u, std::size_t stride) {
  const T* b[rows];
  for (std::size_t i = 0; i < rows; ++i) b[i] = B + static_cast<std::size_t>(row[i]) * modes;
  double* at[rows];
  const auto move_to = [&](std::size_t l) {
    for (std::size_t i = 0; i < rows; ++i) at[i] = u + static_cast<std::size_t>(row[i]) * stride + l;
  };
  std::size_t l = 0;
  for (; l + step_tile <= steps; l += step_tile) {
    move_to(l);
    displacement_tile<T, rows, step_tile>(modes, b, x + l * modes, at);
  }
  for (; l < steps; ++l) {
    move_to(l);
    displacement_tile<T, rows, 1>(modes, b, x + l * modes, at);
  }
}

template <class T>
void displacement(std::size_t modes, const T* B, const int* row, std::size_t rows, const T* x,
                  std::size_t steps, double* u, std::size_t stride) {
  std::size_t i = 0;
  for (; i + row_tile <= rows; i += row_tile)
    displacement_rows<T, row_tile>(modes, B, row + i, x, steps, u, stride);
  for (; i < rows; ++i) displacement_rows<T, 1>(modes, B, row + i, x, steps, u, stride);
}

template <class T, std::size_t steps>
void push_tile(std::size_t modes, const T* B, const int* row, std::size_t rows, const T* force,
               std::size_t stride, T* out) {
  using V = Lanes<T>;
  constexpr std::size_t wide = pad / V::size < 4 ? pad / V::size : 4;
  for (std::size_t n = 0; n < modes; n += wide * V::size) {
    typename V::type sum[steps][wide] = {};
    for (std::size_t k = 0; k < rows; ++k) {
      const T* b = B + static_cast<std::size_t>(row[k]) * modes + n;
      const T* strength = force + static_cast<std::size_t>(row[k]) * stride;
      for (std::size_t w = 0; w < wide; ++w) {
        const auto y = V::load(b + w * V::size);
        for (std::size_t l = 0; l < steps; ++l) sum[l][w] += strength[l] * y;
      }
    }
    for (std::size_t l = 0; l < steps; ++l)
      for (std::size_t w = 0; w < wide; ++w) V::store(out + l * modes + n + w * V::size, sum[l][w]);
  }
}

template <class T>
void push(std::size_t modes, const T* B, const int* row, std::size_t rows, const T* force, std::size_t stride,
          std::size_t steps, T* out) {
  std::size_t l = 0;
  for (; l + step_tile <= steps; l += step_tile)
    push_tile<T, step_tile>(modes, B, row, rows, force + l, stride, out + l * modes);
  for (; l < steps; ++l) push_tile<T, 1>(modes, B, row, rows, force + l, stride, out + l * modes);
}

/// sum[i] += Σ_k force[k] lag[from[k]][row[i]] of `together` points: their lags are read in the order they
/// lie.
template <class T, std::size_t together>
void near_tile(const T* lag, std::size_t points, std::size_t lags, std::size_t steps, const int* from,
               const T* force, const int* row, std::size_t rows, T* sum) {
  const T* of[together];
  for (std::size_t k = 0; k < together; ++k) of[k] = lag + static_cast<std::size_t>(from[k]) * points * lags;
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t at = static_cast<std::size_t>(row[i]) * lags;
    for (std::size_t l = 0; l < steps; l += Eight<T>::size) {
      auto total = Eight<T>::load(sum + i * lags + l);
      for (std::size_t k = 0; k < together; ++k) total += force[k] * Eight<T>::load(of[k] + at + l);
      Eight<T>::store(sum + i * lags + l, total);
    }
  }
}

template <class T>
void near(const T* lag, std::size_t points, std::size_t lags, std::size_t steps, const int* pushing,
          const T* force, std::size_t pushed, const int* row, std::size_t rows, T* sum, double* u,
          std::size_t stride) {
  for (std::size_t k = 0; k < rows * lags; ++k) sum[k] = 0;
  std::size_t k = 0;
  for (; k + 4 <= pushed; k += 4)
    near_tile<T, 4>(lag, points, lags, steps, pushing + k, force + k, row, rows, sum);
  for (; k < pushed; ++k) near_tile<T, 1>(lag, points, lags, steps, pushing + k, force + k, row, rows, sum);
  for (std::size_t i = 0; i < rows; ++i) {
    double* at = u + static_cast<std::size_t>(row[i]) * stride;
    for (std::size_t l = 0; l < steps; ++l) at[l] -= static_cast<double>(sum[i * lags + l]);
  }
}

template <class T>
constexpr Loops<T> loops{free_motion<T>, pushed_motion<T>, displacement<T>, push<T>, near<T>};

}  // namespace

extern const InstructionSet RICOCHET_SIMD;
const InstructionSet RICOCHET_SIMD{RICOCHET_SIMD_NAME, loops<double>, loops<float>};

}  // namespace ricochet::contact::simd
