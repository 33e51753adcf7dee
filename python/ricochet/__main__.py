# SPDX-License-Identifier: BSD-2-Clause
import sys

from ricochet.cli import main

sys.exit(main())
