# SPDX-License-Identifier: BSD-2-Clause
# What help2man makes of --help: the usage becomes the synopsis, and examples are printed line by line.
/^[.]SH DESCRIPTION$/ {
  N
  s/^[.]SH DESCRIPTION\nusage: \(.*\)$/.SH SYNOPSIS\n\1\n.SH DESCRIPTION/
}
/^[.]IP$/ a .nf
/^[.]IP$/,/^[.][STP]/ {
  /^[.][STP]/ i .fi
}
