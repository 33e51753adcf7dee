# SPDX-License-Identifier: BSD-2-Clause
# Edits the output of help2man: the usage becomes the synopsis, and examples keep their lines.
/^[.]SH DESCRIPTION$/ {
  N
  s/^[.]SH DESCRIPTION\nusage: \(.*\)$/.SH SYNOPSIS\n\1\n.SH DESCRIPTION/
}
/^[.]IP$/ a .nf
/^[.]IP$/,/^[.][STP]/ {
  /^[.][STP]/ i .fi
}
