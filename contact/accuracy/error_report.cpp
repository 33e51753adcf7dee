// SPDX-License-Identifier: BSD-2-Clause
#include "contact/accuracy/error_report.hpp"

#include <fmt/format.h>

namespace ricochet::contact {

std::string formatted(const ErrorEstimate& estimate) {
  std::string text = fmt::format("{:.2g}", estimate.total());
  for (const auto& cause : estimate.causes())
    text += fmt::format("{} {} {}", text.find(':') == std::string::npos ? ":" : ",", cause.name,
                        cause.share ? fmt::format("{:.2g}", *cause.share) : "unknown");
  return text;
}

std::vector<std::string> warnings(const ErrorEstimate& estimate, double accuracy) {
  std::vector<std::string> out;
  std::string unknown;
  ErrorEstimate::Cause worst{"", 0, ""};
  for (const auto& cause : estimate.causes()) {
    if (!cause.share) unknown += (unknown.empty() ? "" : ", ") + std::string(cause.name);
    if (cause.share.value_or(0) > *worst.share) worst = cause;
  }
  if (estimate.total() > accuracy)
    out.push_back(fmt::format(
        "the error is estimated at {:.2g}, above accuracy = {:g}; its largest share ({:.2g}) is that of "
        "the {}: use {}",
        estimate.total(), accuracy, *worst.share, worst.name, worst.advice));
  if (!unknown.empty())
    out.push_back(fmt::format("the error estimate leaves out: {}{}", unknown,
                              estimate.mesh
                                  ? ""
                                  : " (for that of the mesh, run ricochet-kernel with this accuracy; "
                                    "mesh files have one order only)"));
  return out;
}

}  // namespace ricochet::contact
