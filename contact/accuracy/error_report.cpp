// SPDX-License-Identifier: BSD-2-Clause
#include "contact/accuracy/error_report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace ricochet::contact {
namespace {

/// Figures of a summary whose error was not requested are doubtful above this multiple of the accuracy.
constexpr double tolerable = 3;

/// How a share that is unknown can be measured, in brackets.
std::string way_to_measure(Cause cause) {
  switch (cause) {
    case Cause::mesh:
      return " (run ricochet-kernel with this accuracy; elements of order 1 and imported matrices have no "
             "estimate)";
    case Cause::modes:
      return " (results change more with each wider band, or it has too few modes: raise modes.up_to_hz)";
    case Cause::spacing:
      return " (fewer points would not hold the bodies in the same way, or touches repeat on a sharp edge, "
             "which yields the more, the finer the mesh: compare runs with finer elements where they touch, "
             "or with a lower contact.spacing)";
    case Cause::basis:
      return " (Ritz vectors of rods ring: use modes.basis = \"modes\")";
    default:
      return "";
  }
}

}  // namespace

std::string formatted(const ErrorEstimate& estimate) {
  std::string text = fmt::format("{:.2g}", estimate.total());
  if (estimate.requested.size() > 1) text += fmt::format(" of the {}", name_of(estimate.worst()));
  for (const auto& [cause, errors] : estimate.by_cause) {
    const auto share = estimate.share(cause);
    if (share == 0) continue;
    text += fmt::format("{} {} {}", text.find(':') == std::string::npos ? ":" : ",", name_of(cause),
                        share ? fmt::format("{:.2g}", *share) : "unknown");
  }
  if (estimate.until_s)
    text += fmt::format("; up to the end of the first touch at {:.6g} s", *estimate.until_s);
  return text;
}

std::vector<std::string> warnings(const ErrorEstimate& estimate, double accuracy) {
  std::vector<std::string> out;
  std::string unknown;
  for (const auto& [cause, errors] : estimate.by_cause)
    if (!errors)
      unknown += (unknown.empty() ? "" : ", ") + std::string(name_of(cause)) + way_to_measure(cause);
  if (const auto largest = largest_cause(estimate);
      largest && estimate.scatter() * estimate.total() > accuracy)
    out.push_back(fmt::format(
        "the error of the {} is estimated at {:.2g}{}, above accuracy = {:g}; its largest share ({:.2g}) is "
        "that of the {}: use {}",
        name_of(estimate.worst()), estimate.total(),
        estimate.total() > accuracy
            ? ""
            : fmt::format(" and, at a front, often {:g} times as large", estimate.scatter()),
        accuracy, *estimate.share(*largest), name_of(*largest), advice_on(*largest)));
  if (!unknown.empty()) out.push_back(fmt::format("the error estimate leaves out: {}", unknown));
  for (const Quantity figure : {Quantity::peak_force, Quantity::duration})
    if (const double error = estimate.total(figure);
        error > tolerable * accuracy && std::ranges::count(estimate.requested, figure) == 0)
      out.push_back(fmt::format(
          "the error of the {} is estimated at {:.2g}, and accuracy = {:g} was not requested for it: if it "
          "matters, add \"{}\" to accuracy_of",
          name_of(figure), error, accuracy, name_of(figure)));
  return out;
}

std::optional<Cause> largest_cause(const ErrorEstimate& estimate) {
  std::optional<Cause> out;
  double largest = 0;
  for (const auto& [cause, errors] : estimate.by_cause)
    if (const double share = estimate.share(cause).value_or(0); share > largest) {
      largest = share;
      out = cause;
    }
  return out;
}

}  // namespace ricochet::contact
