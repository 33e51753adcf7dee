// Result file and summary of a run by table kernels: what forces, gaps and Newton's law tell. Energies,
// motions of the two sides and modal coordinates are not known, and their datasets are absent (FORMAT.md).
#pragma once

#include <cstdint>

#include "contact/output/recorder.hpp"
#include "contact/output/summary.hpp"
#include "contact/table/table.hpp"
#include "contact/table/table_stepper.hpp"

namespace ricochet::contact {

/// As Recorder. `snapshot_every` is not used.
class TableRecorder {
 public:
  /// @param model  where the table came from modes: then places, normals and placements are written; else
  /// null Makes the file and writes the row of t = 0. Throws InputError when the file can't be made.
  TableRecorder(const Table& table, const Model* model, const Stepper& start, const RecorderOptions& options);

  /// After each step. Throws InputError when the disk is full.
  void record(const Stepper& stepper);

  /// Writes what is held back and gives the file its name. Nothing may be called after it.
  void commit(const std::filesystem::path& summary = {});

 private:
  using Rows = base::hdf5::Rows;
  struct BodyRows {
    double mass;
    Rows *velocity, *momentum;
  };

  void write_setting(const Table& table, const Model* model, const RecorderOptions& options);
  void make_rows(const Table& table);
  void state_row(const Stepper& stepper);

  Vector initial_gap_;
  std::int64_t every_;
  bool has_power_;
  base::hdf5::Writer file_;
  Rows *time_ = nullptr, *persistency_ = nullptr;
  Rows *contact_time_ = nullptr, *force_ = nullptr, *gap_ = nullptr;
  std::vector<BodyRows> bodies_;
};

/// As SummaryObserver. Restitution needs one body that is free, or two that press on each other alone. No
/// warnings: how far bodies turn and slide is not known.
class TableObserver {
 public:
  /// @param unpaired  candidates dropped, where the table came from modes
  TableObserver(const Table& table, const Stepper& start, double step, int unpaired = 0);

  void observe(const Stepper& stepper);

  /// The times are the caller's to fill.
  Summary summary() const;

 private:
  std::vector<FreeBody> bodies_;
  Vector gap_;
  double step_;
  Summary out_;
  bool touching_ = false;
  Eigen::Matrix3Xd before_, at_start_, at_end_;  ///< (3,b) mass-mean velocities [m/s]
  Eigen::Matrix3Xd impulse_;                     ///< (3,b) of contact, so far [N s]
};

}  // namespace ricochet::contact
