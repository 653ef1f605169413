# SPDX-License-Identifier: BSD-3-Clause
"""Flight programs on an emulated Cortex-M7, held against this machine."""
