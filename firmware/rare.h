/*
 * What hardly ever happens stands out of the way of what happens in each period: a branch that is
 * taken costs a core more than one that is not.
 */
#ifndef STEADYSTEP_RARE_H
#define STEADYSTEP_RARE_H

#define RARE(condition) __builtin_expect(!!(condition), 0)

#endif
