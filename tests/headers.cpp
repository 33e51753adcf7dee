// SPDX-License-Identifier: BSD-2-Clause
// Empty: the precompiled headers of the serial tests belong to it.
