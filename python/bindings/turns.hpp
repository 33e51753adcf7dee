// SPDX-License-Identifier: BSD-2-Clause
// Whose turn it is to change a simulation that several threads of Python share.
#pragma once

#include <pybind11/pybind11.h>

#include <mutex>
#include <stdexcept>

namespace ricochet::python {

/// Lets one thread at a time change a simulation, and others read it between its blocks of steps. Members
/// that say so need the GIL, which makes the flag exclusive; the mutex is taken without it only, so that no
/// thread waits for the mutex while another one waits for the GIL. A callback of a step may read.
class Turns {
 public:
  /// A change, from here to the end of its life. Needs the GIL. Throws std::runtime_error if another thread
  /// makes one.
  class Change {
   public:
    explicit Change(Turns& turns) : turns_(turns) {
      if (turns_.changes_) throw std::runtime_error("another thread is stepping this Simulation");
      turns_.changes_ = true;
    }
    ~Change() { turns_.changes_ = false; }
    Change(const Change&) = delete;
    Change& operator=(const Change&) = delete;

   private:
    Turns& turns_;
  };

  /// Runs `work` without the GIL, and keeps readers out. Needs the GIL and a Change.
  template <class Work>
  auto unlocked(Work&& work) {
    const pybind11::gil_scoped_release released;
    const std::lock_guard alone(mutex_);
    return work();
  }

  /// Runs `work` with the GIL while no thread steps. Needs the GIL.
  template <class Work>
  auto settled(Work&& work) {
    std::unique_lock alone(mutex_, std::defer_lock);
    {
      const pybind11::gil_scoped_release released;
      alone.lock();
    }
    return work();
  }

 private:
  bool changes_ = false;
  std::recursive_mutex mutex_;
};

}  // namespace ricochet::python
