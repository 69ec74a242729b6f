/* Whether a test runs on an emulated core: doubles, in which its reference is computed, are slow
 * there. */
#ifndef STEADYSTEP_TESTS_EMULATED_H
#define STEADYSTEP_TESTS_EMULATED_H

#ifdef __arm__
enum { EMULATED = 1 };
#else
enum { EMULATED = 0 };
#endif

#endif
