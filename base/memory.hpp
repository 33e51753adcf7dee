// SPDX-License-Identifier: BSD-2-Clause
// Memory of this process and of its machine.
#pragma once

namespace ricochet::base {

inline constexpr double mib = 1 << 20;

/// Resident memory of this process now [bytes]; 0 if unknown.
double resident_bytes();

/// Returns memory that this process has freed to the system.
void return_freed_memory();

/// From now on, blocks of 32 MiB and more return to the system as soon as they are freed, whatever a library
/// has told the allocator.
void return_large_blocks();

/// Memory that this process may still allocate [bytes]: the least of what is available on the machine, of
/// what its control groups (version 2) leave, and of what `ulimit -v` leaves.
double available_bytes();

}  // namespace ricochet::base
