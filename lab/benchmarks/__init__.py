# SPDX-License-Identifier: BSD-3-Clause
"""Times beside other programs' on the same problems; scripts/benchmark runs them."""
