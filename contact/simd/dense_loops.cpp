// SPDX-License-Identifier: BSD-2-Clause
// Compiled once for each instruction set, which RICOCHET_DENSE names, and with the restrictions of lanes.hpp.
#include "contact/simd/dense.hpp"

#include "contact/simd/factor_loops.hpp"
#include "contact/simd/lanes.hpp"

namespace ricochet::contact::simd {
namespace {

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

double norm(std::size_t n, const double* A, std::size_t of_A) {
  double most = 0;
  for (std::size_t j = 0; j < n; ++j) {
    const double* const column = A + j * of_A;
    V::type sums = {};
    std::size_t i = 0;
    for (; i + V::size <= n; i += V::size) sums += V::magnitude(V::load(column + i));
    double sum = V::sum(sums);
    for (; i < n; ++i) sum += column[i] < 0 ? -column[i] : column[i];
    if (!(sum <= most)) most = sum;  // NaN included
  }
  return most;
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

/// y_v = A x_v of some vectors.
template <std::size_t rows, std::size_t vectors>
void row_products_tile(std::size_t n, Tile<const double> A, const double* const* x, double* const* y,
                       std::size_t first) {
  constexpr std::size_t registers = (rows + V::size - 1) / V::size * V::size;
  V::type sum[vectors][registers] = {};
  std::size_t i = 0;
  for (; i + V::size <= n; i += V::size) {
    V::type xi[vectors];
    for (std::size_t v = 0; v < vectors; ++v) xi[v] = V::load(x[v] + i);
    for (std::size_t k = 0; k < rows; ++k) {
      const auto a = V::load(A.column(k) + i);
      for (std::size_t v = 0; v < vectors; ++v) sum[v][k] += a * xi[v];
    }
  }
  for (std::size_t v = 0; v < vectors; ++v) {
    double total[registers];
    for (std::size_t k = 0; k < registers; k += V::size) V::store(total + k, V::sums(sum[v] + k));
    for (std::size_t rest = i; rest < n; ++rest)
      for (std::size_t k = 0; k < rows; ++k) total[k] += A.column(k)[rest] * x[v][rest];
    for (std::size_t k = 0; k < rows; ++k) y[v][first + k] = total[k];
  }
}

template <std::size_t rows>
void add_rows_tile(std::size_t n, Tile<const double> A, const double* y, double* x) {
  std::size_t i = 0;
  for (; i + V::size <= n; i += V::size) {
    auto sum = V::load(x + i);
    for (std::size_t k = 0; k < rows; ++k) sum += y[k] * V::load(A.column(k) + i);
    V::store(x + i, sum);
  }
  for (; i < n; ++i)
    for (std::size_t k = 0; k < rows; ++k) x[i] += y[k] * A.column(k)[i];
}

constexpr std::size_t most_rows = 6;  // at once: sums of that many rows do not wait for one another

template <std::size_t vectors>
void products(std::size_t rows, std::size_t n, Tile<const double> A, const double* const* x,
              double* const* y) {
  std::size_t k = 0;
  for (; k + most_rows <= rows; k += most_rows)
    row_products_tile<most_rows, vectors>(n, {A.column(k), A.stride}, x, y, k);
  for (; k < rows; k += 3) row_products_tile<3, vectors>(n, {A.column(k), A.stride}, x, y, k);
}

void row_products(std::size_t rows, std::size_t n, const double* A, std::size_t of_A, const double* x,
                  double* y) {
  products<1>(rows, n, {A, of_A}, &x, &y);
}

void two_row_products(std::size_t rows, std::size_t n, const double* A, std::size_t of_A,
                      const double* const* x, double* const* y) {
  products<2>(rows, n, {A, of_A}, x, y);
}

void add_rows(std::size_t rows, std::size_t n, const double* A, std::size_t of_A, const double* y,
              double* x) {
  std::size_t k = 0;
  for (; k + most_rows <= rows; k += most_rows) add_rows_tile<most_rows>(n, {A + k * of_A, of_A}, y + k, x);
  for (; k < rows; k += 3) add_rows_tile<3>(n, {A + k * of_A, of_A}, y + k, x);
}

void free_motion(std::size_t n, const Oscillators& m, const double* q, const double* v, double* dq) {
  std::size_t i = 0;
  for (; i + V::size <= n; i += V::size) {
    const auto at = [&](const double* x) { return V::load(x + i); };
    V::store(dq + i, at(m.b) * at(v) + at(m.c) * (at(m.load) - at(m.stiffness) * at(q)));
  }
  for (; i < n; ++i) dq[i] = m.b[i] * v[i] + m.c[i] * (m.load[i] - m.stiffness[i] * q[i]);
}

void move_modes(std::size_t n, const Oscillators& m, const double* push, const double* q, const double* v,
                double* next_q, double* next_v, double* work) {
  V::type spent = {}, gained = {};
  std::size_t i = 0;
  for (; i + V::size <= n; i += V::size) {
    const auto at = [&](const double* x) { return V::load(x + i); };
    const auto q0 = at(q), v0 = at(v), g = at(m.load) + at(push) - at(m.stiffness) * q0,
               dq = at(m.b) * v0 + at(m.c) * g;
    spent += at(m.damp_ss) * g * g + at(m.damp_sr) * g * v0 + at(m.damp_rr) * v0 * v0;
    gained += at(m.applied) * dq;
    V::store(next_q + i, q0 + dq);
    V::store(next_v + i, at(m.e) * v0 + at(m.h) * g);
  }
  work[0] += V::sum(spent);
  work[1] += V::sum(gained);
  for (; i < n; ++i) {
    const double g = m.load[i] + push[i] - m.stiffness[i] * q[i], dq = m.b[i] * v[i] + m.c[i] * g;
    work[0] += m.damp_ss[i] * g * g + m.damp_sr[i] * g * v[i] + m.damp_rr[i] * v[i] * v[i];
    work[1] += m.applied[i] * dq;
    next_q[i] = q[i] + dq;
    next_v[i] = m.e[i] * v[i] + m.h[i] * g;
  }
}

void add_energy(std::size_t n, const double* stiffness, const double* load, const double* origin,
                const double* lift, const double* q, const double* v, double* energy) {
  V::type kinetic = {}, strain = {}, loads = {};
  std::size_t i = 0;
  for (; i + V::size <= n; i += V::size) {
    const auto x = V::load(q + i), rate = V::load(v + i) + V::load(lift + i);
    kinetic += rate * rate;
    strain += V::load(stiffness + i) * x * x;
    loads += V::load(load + i) * (x - V::load(origin + i));
  }
  double sums[3] = {V::sum(kinetic), V::sum(strain), V::sum(loads)};
  for (; i < n; ++i) {
    sums[0] += (v[i] + lift[i]) * (v[i] + lift[i]);
    sums[1] += stiffness[i] * q[i] * q[i];
    sums[2] += load[i] * (q[i] - origin[i]);
  }
  energy[0] += 0.5 * sums[0];
  energy[1] += 0.5 * sums[1];
  energy[2] += sums[2];
}

using Four = Lanes<double, 4>;

/// The lanes are the rows of the first lever.
void displace(const Yield& body, const Lever* levers, std::size_t count, std::size_t from, std::size_t to,
              double* u, bool adds, double* out) {
  const Lever& pushed = levers[0];
  Four::type along[4] = {Four::load(pushed.row[0]), Four::load(pushed.row[1]), Four::load(pushed.row[2])};
  Four::transpose(along);
  Four::type shift[3], turn[3], moment[3];
  for (std::size_t z = 0; z < 3; ++z) shift[z] = body.shift * along[z];
  for (std::size_t z = 0; z < 3; ++z)
    moment[z] = pushed.arm[(z + 1) % 3] * along[(z + 2) % 3] - pushed.arm[(z + 2) % 3] * along[(z + 1) % 3];
  for (std::size_t y = 0; y < 3; ++y)
    turn[y] = body.turn[y][0] * moment[0] + body.turn[y][1] * moment[1] + body.turn[y][2] * moment[2];

  // Columns of a M + R for the mean of the candidates that are pushed, then their products with `along`
  const std::size_t first = 3 * from / V::size * V::size, rows = 3 * to, height = (rows + 7) / 8 * 8;
  double* const columns = u + 4 * height;
  for (std::size_t z = 0; z < 3; ++z)
    for (std::size_t i = first; i < rows; i += V::size) {
      V::type sum = {};
      for (std::size_t j = 0; j < pushed.count; ++j) {
        const std::size_t at = (3 * pushed.at[j] + z) * body.stride + i;
        auto entries = body.share * V::load(body.M + at);
        if (body.R != nullptr) entries += V::load(body.R + at);
        sum += pushed.weight[j] * entries;
      }
      V::store(columns + z * height + i, sum);
    }
  for (std::size_t i = 3 * from; i < rows; ++i)
    Four::store(u + 4 * i,
                columns[i] * along[0] + columns[height + i] * along[1] + columns[2 * height + i] * along[2]);

  const auto move = [&](const Lever& lever, auto sum_at, auto lever_rows) {
    Four::type moved[3];
    for (std::size_t y = 0; y < 3; ++y) {
      moved[y] = shift[y] + turn[(y + 1) % 3] * lever.arm[(y + 2) % 3];
      moved[y] -= turn[(y + 2) % 3] * lever.arm[(y + 1) % 3];
    }
    for (std::size_t j = 0; j < lever.count; ++j)
      for (std::size_t y = 0; y < 3; ++y)
        moved[y] += lever.weight[j] * Four::load(u + 4 * (3 * lever.at[j] + y));
    for (std::size_t x = 0; x < lever_rows; ++x) {
      double* const at = out + 4 * (lever.first + x);
      Four::type sum = sum_at(at);
      for (std::size_t y = 0; y < 3; ++y) sum += lever.row[x][y] * moved[y];
      Four::store(at, sum);
    }
  };
  const auto move_all = [&](auto sum_at) {
    for (std::size_t f = 0; f < count; ++f) {
      if (levers[f].rows == 3)
        move(levers[f], sum_at, std::integral_constant<std::size_t, 3>());
      else
        move(levers[f], sum_at, std::integral_constant<std::size_t, 1>());
    }
  };
  if (adds)
    move_all([](const double* at) { return Four::load(at); });
  else
    move_all([](const double*) { return Four::type{}; });
}

void spread(std::size_t n, std::size_t first, std::size_t columns, const double* out, double* A,
            std::size_t of_A) {
  // The rows after the last one, up to a multiple of 8, belong to no other column.
  const std::size_t whole = (first + 3) / 4 * 4;
  for (std::size_t c = 0; c < columns; ++c)
    for (std::size_t i = first; i < n && i < whole; ++i) A[(first + c) * of_A + i] = out[4 * i + c];
  if (columns == 3)  // The fourth entry of a row is set later, with the next columns.
    for (std::size_t i = first + columns; i < n; ++i)
      Four::store(A + i * of_A + first, Four::load(out + 4 * i));
  else
    for (std::size_t i = first + 1; i < n; ++i) A[i * of_A + first] = out[4 * i];
  for (std::size_t i = whole; i < n; i += 4) {
    Four::type x[4];
    for (std::size_t k = 0; k < 4; ++k) x[k] = Four::load(out + 4 * (i + k));
    Four::transpose(x);
    for (std::size_t c = 0; c < columns; ++c) Four::store(A + (first + c) * of_A + i, x[c]);
  }
}

/// The lanes are axes of the body. The fourth one belongs to the next candidate and is multiplied by 0.
void yield(std::size_t candidates, const double* R, std::size_t of_R, const Lever* levers, const Pull* pulls,
           std::size_t count, const double* p, double* scratch, double* y) {
  const std::size_t rows = 3 * candidates, height = rows + 8;
  double *const forces = scratch, *const moved = scratch + height;
  for (std::size_t i = 0; i < 2 * height; ++i) scratch[i] = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const Lever& lever = levers[pulls[c].lever];
    const double* const of_rows = p + pulls[c].row;
    auto force = of_rows[0] * Four::load(lever.row[0]);
    if (lever.rows == 3)
      force += of_rows[1] * Four::load(lever.row[1]) + of_rows[2] * Four::load(lever.row[2]);
    for (std::size_t j = 0; j < lever.count; ++j) {
      double* const at = forces + 3 * lever.at[j];
      Four::store(at, Four::load(at) + lever.weight[j] * force);
    }
  }
  for (std::size_t j = 0; j < rows; j += 4) {
    const double* column[4];
    double factor[4];
    for (std::size_t k = 0; k < 4; ++k) {
      column[k] = R + (j + k < rows ? j + k : j) * of_R;
      factor[k] = -forces[j + k];  // 0 beyond the last one
    }
    subtract_columns(rows, column, factor, moved);
  }
  for (std::size_t c = 0; c < count; ++c) {
    const Lever& lever = levers[pulls[c].lever];
    Four::type way = {};
    for (std::size_t j = 0; j < lever.count; ++j)
      way += lever.weight[j] * Four::load(moved + 3 * lever.at[j]);
    Four::type along[4] = {way * Four::load(lever.row[0]), way * Four::load(lever.row[1]),
                           way * Four::load(lever.row[2])};
    const auto of_rows = Four::sums(along);
    for (std::size_t x = 0; x < lever.rows; ++x) y[pulls[c].row + x] += of_rows[x];
  }
}

}  // namespace

extern const Dense RICOCHET_DENSE;
const Dense RICOCHET_DENSE{subtract_product,
                           factor_panel,
                           solve_lower,
                           invert_blocks,
                           symmetric_product,
                           norm,
                           subtract_columns,
                           solve_factor,
                           solve_factors,
                           row_products,
                           two_row_products,
                           add_rows,
                           free_motion,
                           move_modes,
                           add_energy,
                           displace,
                           spread,
                           yield};

}  // namespace ricochet::contact::simd
