// What `accuracy` does in ricochet-contact: it chooses step, contact points and precision, and estimates
// errors.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "contact/output/summary.hpp"
#include "src/programs/contact_parts.hpp"

namespace ricochet::programs {

struct Judged {
  int thinnings = 0;                                 ///< of the model's contact points, before it is run
  std::optional<contact::ErrorEstimate> estimate{};  ///< none: nothing touches
  std::vector<std::string> warnings;  ///< of the kernels; what is not known, or not as accurate as asked for

  /// @param summary  contact::Summary or contact::EquilibriumSummary
  template <class Summary>
  void into(Summary& summary) const {
    summary.error_estimate = estimate;
    summary.warnings.insert(summary.warnings.end(), warnings.begin(), warnings.end());
  }
};

/// The model, its contact points thinned so many times.
contact::Model thinned(contact::Model model, int times);

/// Runs the scene, which has an accuracy, several times. Sets the rate and the precision that it leaves open,
/// and says how often its contact points may be thinned where it gives no spacing.
/// @param folder  of the kernels of other order, beside those of the scene
/// @param known  as of contact::pair
/// Throws InputError as building the model and running it do.
Judged choose_and_judge(scene::Scene& scene, const Kernels& kernels, const std::filesystem::path& folder,
                        contact::Pairings& known);

/// "0.0031: mesh 0.0029, modes …"
std::string told(const contact::ErrorEstimate& estimate);

}  // namespace ricochet::programs
