# SPDX-License-Identifier: BSD-2-Clause
"""What scripts/bench measures: a module for each subcommand, and what they share (timing, tables, runs)."""
