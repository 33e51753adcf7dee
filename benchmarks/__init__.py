# SPDX-License-Identifier: BSD-2-Clause
"""The measurements of scripts/bench: a module for each subcommand, and shared modules."""
