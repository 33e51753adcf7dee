// SPDX-License-Identifier: BSD-2-Clause
// This file is empty: it only carries the precompiled headers of the serial tests.
