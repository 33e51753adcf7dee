// SPDX-License-Identifier: BSD-2-Clause
#include "contact/rows/history.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::contact {

std::size_t History::passed(double t) const noexcept {
  return static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
}

bool History::dead() const noexcept {
  if (!(time.front() < 0)) return false;
  const auto last = value.begin() + static_cast<std::ptrdiff_t>(passed(0)) - 1;
  return std::all_of(last, value.end(), [&](double v) { return v == *last; });
}

double History::slope_after(std::size_t knot) const noexcept {
  return knot + 1 < time.size() ? (value[knot + 1] - value[knot]) / (time[knot + 1] - time[knot]) : 0;
}

double History::at(double t) const noexcept {
  const std::size_t next = passed(t);
  return next == 0 ? 0 : value[next - 1] + slope_after(next - 1) * (t - time[next - 1]);
}

double History::slope(double t) const noexcept {
  const std::size_t next = passed(t);
  return next == 0 ? 0 : slope_after(next - 1);
}

double History::integral(double from, double to) const noexcept {
  double sum = 0;
  for (std::size_t next = passed(from); from < to; ++next) {
    const double end = next < time.size() ? std::min(to, time[next]) : to;
    sum += (end - from) * at(0.5 * (from + end));
    from = end;
  }
  return sum;
}

double History::double_integral(double from, double to) const noexcept {
  double sum = 0;
  for (std::size_t next = passed(from); from < to; ++next) {
    const double end = next < time.size() ? std::min(to, time[next]) : to, length = end - from,
                 middle = 0.5 * (from + end);
    sum += length * (at(middle) * (to - middle) - slope(middle) * length * length / 12);
    from = end;
  }
  return sum;
}

double History::peak(double from, double to) const noexcept {
  double most = std::max(std::abs(at(from)), std::abs(at(to)));
  for (std::size_t next = passed(from); next < time.size() && time[next] <= to; ++next)
    most = std::max(most, std::abs(value[next]));
  return most;
}

double History::steepest(double from, double to) const noexcept {
  double most = std::abs(slope(from));
  for (std::size_t next = passed(from); next < time.size() && time[next] <= to; ++next)
    most = std::max(most, std::abs(slope_after(next)));
  return most;
}

}  // namespace ricochet::contact
