// SPDX-License-Identifier: BSD-2-Clause
// Streams the motion of the surfaces of the bodies and the contact forces into <stem>.h5, with <stem>.xdmf
// for ParaView beside it (docs/formats/result.md). Both files get their final names when they are complete.
//
//   MotionFile motion(stepper, model, {.stem = "out/two-disks.motion", .every = 8});
//   while (…) { stepper.step(); motion.record(stepper); }
//   motion.commit();
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "contact/figures/surface_stress.hpp"
#include "contact/figures/visualisation_surface.hpp"
#include "contact/files/obstacle_surface.hpp"
#include "contact/model/model.hpp"
#include "contact/static/equilibrium.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

struct MotionOptions {
  std::filesystem::path stem;  ///< path of both files without .h5 and .xdmf
  std::string title{}, created_by{};
  std::vector<std::string> pairs{};  ///< one name per pair of the model
  std::int64_t every = 1;            ///< number of output samples between frames
};

class MotionFile {
 public:
  /// Creates the file and writes the frame of `start`, a stepper that has made no steps. The kernel of every
  /// body must have a visualisation surface, and `model` must outlive the file. Throws InputError if the file
  /// cannot be created.
  MotionFile(const Stepper& start, const Model& model, const MotionOptions& options);

  /// Creates the file for bodies at rest, without frames. Throws as above.
  MotionFile(const Model& model, const MotionOptions& options);

  /// Call it after each step of `stepper`. Throws InputError if the disk is full.
  void record(const Stepper& stepper);
  /// Writes a frame. Throws as above.
  void record(const Equilibrium& equilibrium);

  /// Gives the files their final names. It must be the last call.
  /// @param run  identifier of the run, which its other files contain as well
  void commit(const std::string& run = {});

  std::filesystem::path xdmf() const;  ///< the file to open in ParaView

 private:
  /// The contact points of a pair, as they move with body a.
  struct Patch {
    std::string name;
    const Model::PairBlock* pair = nullptr;
    int corners = 1;                    ///< per element: 1 if the points form no surface
    std::vector<std::int64_t> element;  ///< by point of the pair
    std::vector<SurfacePoint> place;    ///< closest point of the visualisation surface of a, for each point
    Matrix offset;  ///< (points,3) from that closest point to the contact point, at the start [m]
  };

  MotionFile(const Model& model, const StepOptions& step, const MotionOptions& options);
  Patch patch_of(const Model::PairBlock& pair, const std::string& name) const;
  void write_setting(const MotionOptions& options);
  void frame(double t, const Vector& q, const Vector& v, const Vector& u, const Vector& force,
             const Vector& end_force, std::span<const ContactState> states, const Turning* turning);
  void contact_frame(std::size_t pair, const std::string& number, const Vector& u, const Vector& force,
                     std::span<const ContactState> states, const SurfaceMotion& surface,
                     const Turning* turning);
  void write_xdmf() const;

  const Model& model_;
  std::filesystem::path stem_;
  std::int64_t every_;
  base::hdf5::Writer file_;
  std::vector<VisualisationSurface> surfaces_;        ///< by body
  std::vector<std::optional<SurfaceStress>> stress_;  ///< by body, if its kernel has it
  AllCoordinates coordinates_;
  std::vector<Patch> patches_;
  std::vector<ObstacleSurface> obstacles_;
  std::vector<double> time_;  ///< of the frames
};

}  // namespace ricochet::contact
