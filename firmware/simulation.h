/*
 * What only a simulation asks of a drive: a law, an observer and an order of impulses that are
 * there for comparison with a paper, an initial angle that is wrong on purpose, a board without
 * delay. The images of boards leave it out (option STEADYSTEP_SIMULATION); a drive that is asked
 * for it there refuses to start. A choice that is left out keeps its number in the stored record.
 */
#ifndef STEADYSTEP_SIMULATION_H
#define STEADYSTEP_SIMULATION_H

#ifdef STEADYSTEP_WITHOUT_SIMULATION
enum { SERVES_SIMULATION = 0 };
#else
enum { SERVES_SIMULATION = 1 };
#endif

#endif
