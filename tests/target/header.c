/* SPDX-License-Identifier: BSD-3-Clause */
/* The self-test of an exported header, HEADER, by its name. */
#include HEADER

int self_test(void);

int self_test(void) { return SELF_TEST(); }
