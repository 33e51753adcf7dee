// SPDX-License-Identifier: BSD-2-Clause
// The contact forces of a sample of a simulation: means over its steps.
#pragma once

#include <span>
#include <vector>

#include "contact/stepping/floating_stepper.hpp"

namespace ricochet {

class SampleForces {
 public:
  /// What determines the others.
  struct Means {
    contact::Vector normal;     ///< (m) [N]
    contact::Vector along;      ///< (n − m) along the tangents [N]
    bool begins_sample = true;  ///< whether the next step is the first one of a sample
    void archive(auto& a) { a(normal, along, begins_sample); }
  };

  /// Refers to the model and the stepper.
  /// @param floating  the stepper, with finite rotations; otherwise null
  SampleForces(const contact::Model& model, const contact::Stepper& stepper,
               const contact::FloatingStepper* floating);

  /// Adds the force of the last contact step to the mean over the sample.
  void add() noexcept;
  void set(const Means& means) noexcept;
  /// Takes the forces of the rows that a model has in common with an earlier one.
  void take(const SampleForces& earlier, std::span<const contact::Correspondence::Run> rows) noexcept;
  /// Takes the forces of a pair away.
  void silence(const contact::Model::PairBlock& pair) noexcept;

  const Means& means() const { return means_; }
  const contact::Vector& normal() const { return means_.normal; }
  const contact::Matrix& tangential() const { return tangential_; }  ///< (m,3) world axes [N]
  double total() const noexcept;                                     ///< of the normal forces [N]
  /// Calls f(i) for each point that may have a force, in no order.
  void for_each_point(const auto& f) const {
    if (floating_ == nullptr)
      for (Eigen::Index i = 0; i < normal().size(); ++i) f(i);
    else
      for (const int row : listed_)
        if (row < normal().size()) f(Eigen::Index{row});
  }

 private:
  double& of_row(Eigen::Index row) noexcept {
    return row < normal().size() ? means_.normal(row) : means_.along(row - normal().size());
  }
  void clear() noexcept;
  void list() noexcept;
  void turn_to_world() noexcept;

  const contact::Model& model_;
  const contact::Stepper& stepper_;
  const contact::FloatingStepper* floating_;
  Means means_;
  contact::Matrix tangential_;
  /// With finite rotations, whose rows are those of all pairs: rows with a force in the sample.
  std::vector<int> listed_;
  std::vector<char> is_listed_;  ///< (n)
};

}  // namespace ricochet
