// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/error_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace ricochet::contact {
namespace {

double error_of(const Errors& errors, Quantity quantity) {
  const auto found = errors.find(quantity);
  return found == errors.end() ? 0 : found->second;
}

struct Text {
  const char *name, *advice;
};

/// In the order of the enumeration.
constexpr std::array<Text, 9> texts{{
    {"mesh", "a finer mesh or a higher bodies.*.order"},
    {"modes", "a higher modes.up_to_hz or modes.count"},
    {"basis", "a lower modes.flexibility_error"},
    {"step", "a higher time.rate_hz"},
    {"eigensolver", "a lower modes.relative_residual or modes.low_rank"},
    {"precision", "time.precision = \"double\""},
    {"spacing", "a smaller contact.spacing, or a finer mesh where bodies touch"},
    {"zone", "a larger contact.reach"},
    {"rotation", "motion.rotation = \"linear\", if bodies hardly turn"},
}};

}  // namespace

double ErrorEstimate::combined(const std::vector<double>& shares) const {
  double sum = 0;
  for (const double share : shares) sum += front ? share : share * share;
  return front ? sum : std::sqrt(sum);
}

double ErrorEstimate::total(Quantity quantity) const {
  std::vector<double> shares;
  for (const auto& [cause, errors] : by_cause)
    if (errors) shares.push_back(error_of(*errors, quantity));
  return combined(shares);
}

Quantity ErrorEstimate::worst() const {
  return *std::ranges::max_element(requested, {}, [&](Quantity quantity) { return total(quantity); });
}

bool ErrorEstimate::meets(double accuracy) const {
  return scatter() * total() <= accuracy &&
         std::ranges::all_of(by_cause, [](const auto& of) { return of.second.has_value(); });
}

std::optional<double> ErrorEstimate::share(Cause cause) const {
  const auto found = by_cause.find(cause);
  if (found == by_cause.end() || !found->second) return std::nullopt;
  return error_of(*found->second, worst());
}

std::vector<Quantity> ErrorEstimate::quantities() const {
  std::set<Quantity> all;
  for (const auto& [cause, errors] : by_cause)
    if (errors)
      for (const auto& [quantity, error] : *errors) all.insert(quantity);
  return {all.begin(), all.end()};
}

const char* name_of(Cause cause) { return texts[static_cast<std::size_t>(cause)].name; }
const char* advice_on(Cause cause) { return texts[static_cast<std::size_t>(cause)].advice; }

}  // namespace ricochet::contact
