/*
 * IN_PLACE: a function of the integrators that is compiled into each place that calls it. Without
 * optimisation it is called like any other: a debug build is then a fifth as large.
 *
 * FOR_EACH_PROCESSOR: a function that gcc compiles for processors with AVX, too; the loader
 * chooses. Its operations are the same, and so are its bits: only their operands need fewer moves.
 */
#ifndef STEADYSTEP_PLANT_IN_PLACE_H
#define STEADYSTEP_PLANT_IN_PLACE_H

#ifdef __OPTIMIZE__
#define IN_PLACE [[gnu::always_inline]] inline
#else
#define IN_PLACE inline
#endif

#if defined(__OPTIMIZE__) && defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__)
#define FOR_EACH_PROCESSOR [[gnu::target_clones("avx", "default")]]
#else
#define FOR_EACH_PROCESSOR
#endif

#endif
