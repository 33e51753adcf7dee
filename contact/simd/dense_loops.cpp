// SPDX-License-Identifier: BSD-2-Clause
// Compiled once for each instruction set, which RICOCHET_DENSE names, and with the restrictions of lanes.hpp.
#include "contact/simd/dense.hpp"

#include "contact/simd/lanes.hpp"

namespace ricochet::contact::simd {
namespace {

using V = Lanes<double>;

/// A matrix of which a tile is used.
template <class Number>
struct Tile {
  Number* at;
  std::size_t stride;
  Number* column(std::size_t j) const { return at + j * stride; }
};

template <std::size_t registers, std::size_t columns>
void product_tile(std::size_t k, Tile<const double> A, Tile<const double> B, Tile<double> C) {
  V::type sum[columns][registers];
  for (std::size_t j = 0; j < columns; ++j)
    for (std::size_t r = 0; r < registers; ++r) sum[j][r] = V::load(C.column(j) + r * V::size);
  for (std::size_t l = 0; l < k; ++l) {
    V::type a[registers];
    for (std::size_t r = 0; r < registers; ++r) a[r] = V::load(A.column(l) + r * V::size);
    for (std::size_t j = 0; j < columns; ++j)
      for (std::size_t r = 0; r < registers; ++r) sum[j][r] -= B.column(j)[l] * a[r];
  }
  for (std::size_t j = 0; j < columns; ++j)
    for (std::size_t r = 0; r < registers; ++r) V::store(C.column(j) + r * V::size, sum[j][r]);
}

template <std::size_t columns>
void product_strip(std::size_t m, std::size_t k, Tile<const double> A, Tile<const double> B, Tile<double> C) {
  constexpr std::size_t registers = 2, rows = registers * V::size;
  std::size_t i = 0;
  for (; i + rows <= m; i += rows)
    product_tile<registers, columns>(k, {A.at + i, A.stride}, B, {C.at + i, C.stride});
  for (; i + V::size <= m; i += V::size)
    product_tile<1, columns>(k, {A.at + i, A.stride}, B, {C.at + i, C.stride});
  for (; i < m; ++i)
    for (std::size_t j = 0; j < columns; ++j) {
      double sum = C.column(j)[i];
      for (std::size_t l = 0; l < k; ++l) sum -= A.column(l)[i] * B.column(j)[l];
      C.column(j)[i] = sum;
    }
}

void subtract_product(std::size_t m, std::size_t n, std::size_t k, const double* A, std::size_t of_A,
                      const double* B, std::size_t of_B, double* C, std::size_t of_C) {
  std::size_t j = 0;
  const auto strips = [&]<std::size_t together>() {
    for (; j + together <= n; j += together)
      product_strip<together>(m, k, {A, of_A}, {B + j * of_B, of_B}, {C + j * of_C, of_C});
  };
  if (V::size == 8) strips.template operator()<8>();  // wide registers are also twice as many
  strips.template operator()<4>();
  strips.template operator()<1>();
}

/// Four columns at once read and write y once.
void symmetric_product(std::size_t n, const double* A, std::size_t of_A, const double* x, double* y) {
  constexpr std::size_t together = 4;
  std::size_t j = 0;
  for (; j + together <= n; j += together) {
    const double* column[together];
    for (std::size_t k = 0; k < together; ++k) column[k] = A + (j + k) * of_A;
    for (std::size_t k = 0; k < together; ++k) {
      y[j + k] += column[k][j + k] * x[j + k];
      for (std::size_t i = k + 1; i < together; ++i) {
        y[j + i] += column[k][j + i] * x[j + k];
        y[j + k] += column[k][j + i] * x[j + i];
      }
    }
    V::type sum[together] = {};
    std::size_t i = j + together;
    for (; i + V::size <= n; i += V::size) {
      const auto xi = V::load(x + i);
      auto yi = V::load(y + i);
      for (std::size_t k = 0; k < together; ++k) {
        const auto a = V::load(column[k] + i);
        yi += x[j + k] * a;
        sum[k] += xi * a;
      }
      V::store(y + i, yi);
    }
    for (std::size_t k = 0; k < together; ++k) {
      y[j + k] += V::sum(sum[k]);
      for (std::size_t rest = i; rest < n; ++rest) {
        y[rest] += column[k][rest] * x[j + k];
        y[j + k] += column[k][rest] * x[rest];
      }
    }
  }
  for (; j < n; ++j) {
    y[j] += A[j * of_A + j] * x[j];
    for (std::size_t i = j + 1; i < n; ++i) {
      y[i] += A[j * of_A + i] * x[j];
      y[j] += A[j * of_A + i] * x[i];
    }
  }
}

void subtract_columns(std::size_t n, const double* const* column, const double* factor, double* x) {
  const double *const a = column[0], *const b = column[1], *const c = column[2], *const d = column[3];
  const double p = factor[0], q = factor[1], r = factor[2], s = factor[3];
  std::size_t i = 0;
  for (; i + V::size <= n; i += V::size)
    V::store(x + i, V::load(x + i) - ((p * V::load(a + i) + q * V::load(b + i)) +
                                      (r * V::load(c + i) + s * V::load(d + i))));
  for (; i < n; ++i) x[i] -= (p * a[i] + q * b[i]) + (r * c[i] + s * d[i]);
}

/// Each value is final before it is subtracted from the others, which do not wait for one another.
void solve_factor(std::size_t n, const double* L, std::size_t of_L, const double* reciprocal, double* x) {
  for (std::size_t c = 0; c < n; ++c) {
    const double* const column = L + c * of_L;
    const double value = x[c] *= reciprocal[c];
    for (std::size_t k = c + 1; k < n; ++k) x[k] -= column[k] * value;
  }
  for (std::size_t c = n; c-- > 0;) {
    const double* const row = L + c;
    const double value = x[c] *= reciprocal[c];
    for (std::size_t k = 0; k < c; ++k) x[k] -= row[k * of_L] * value;
  }
}

void three_products(std::size_t n, const double* const* row, const double* x, double* y) {
  V::type sum[3][2] = {};
  std::size_t i = 0;
  for (; i + 2 * V::size <= n; i += 2 * V::size)
    for (std::size_t r = 0; r < 2; ++r) {
      const auto xi = V::load(x + i + r * V::size);
      for (std::size_t k = 0; k < 3; ++k) sum[k][r] += V::load(row[k] + i + r * V::size) * xi;
    }
  for (std::size_t k = 0; k < 3; ++k) {
    y[k] = V::sum(sum[k][0] + sum[k][1]);
    for (std::size_t rest = i; rest < n; ++rest) y[k] += row[k][rest] * x[rest];
  }
}

/// Four numbers, the last of which is not used.
struct Triple {
  using Part = Lanes<double, (V::size < 4 ? V::size : 4)>;
  static constexpr std::size_t parts = 4 / Part::size;
  Part::type part[parts];

  static Triple load(const double* x) {
    Triple out;
    for (std::size_t k = 0; k < parts; ++k) out.part[k] = Part::load(x + k * Part::size);
    return out;
  }
  double operator[](std::size_t i) const { return part[i / Part::size][i % Part::size]; }
  void add(double factor, const Triple& x) {
    for (std::size_t k = 0; k < parts; ++k) part[k] += factor * x.part[k];
  }
  void add_to(double* out, std::size_t count) const {
    for (std::size_t k = 0; k < count; ++k) out[k] += (*this)[k];
  }
};

void displace(const Lever* levers, std::size_t count, const double* u, const double* v, std::size_t of_u,
              const double* shift, const double* turn, double* A, double* B, std::size_t of_A) {
  for (std::size_t f = 0; f < count; ++f) {
    const Lever& lever = levers[f];
    Triple D[3], G[3];
    for (std::size_t x = 0; x < 3; ++x) {
      D[x] = Triple::load(lever.direction[x]);
      G[x] = Triple::load(lever.moment[x]);
    }
    for (std::size_t i = 0; i < levers[0].rows; ++i) {
      const std::size_t out = (levers[0].first + i) * of_A + lever.first;
      const auto of_candidates = [&](const double* of) {
        Triple mean{}, along{};
        for (std::size_t j = 0; j < lever.count; ++j)
          mean.add(lever.weight[j], Triple::load(of + i * of_u + lever.at[j]));
        for (std::size_t x = 0; x < 3; ++x) along.add(mean[x], D[x]);
        return along;
      };
      Triple moved = of_candidates(u);
      for (std::size_t x = 0; x < 3; ++x) {
        moved.add(shift[3 * i + x], D[x]);
        moved.add(turn[3 * i + x], G[x]);
      }
      moved.add_to(A + out, lever.rows);
      if (v != nullptr) of_candidates(v).add_to(B + out, lever.rows);
    }
  }
}

}  // namespace

extern const Dense RICOCHET_DENSE;
const Dense RICOCHET_DENSE{subtract_product, symmetric_product, subtract_columns,
                           solve_factor,     three_products,    displace};

}  // namespace ricochet::contact::simd
