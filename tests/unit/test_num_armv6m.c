/* Everything test_num.c says, of the products a core without long multiply computes. */
#ifndef __ARM_ARCH_6M__
#define __ARM_ARCH_6M__ 1
#endif
#include "tests/unit/test_num.c"
