# SPDX-License-Identifier: BSD-3-Clause
"""Independent references in NumPy and SciPy. They share no code with sepcal and never import it."""
