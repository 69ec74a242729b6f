/* IN_PLACE: a function of the integrators that is compiled into each place that calls it. Without
   optimisation it is called like any other: a debug build is then a fifth as large. */
#ifndef STEADYSTEP_PLANT_IN_PLACE_H
#define STEADYSTEP_PLANT_IN_PLACE_H

#ifdef __OPTIMIZE__
#define IN_PLACE [[gnu::always_inline]] inline
#else
#define IN_PLACE inline
#endif

#endif
