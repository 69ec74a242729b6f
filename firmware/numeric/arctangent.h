/* Direction of a vector; the same integer algorithm in every number format. */
#ifndef STEADYSTEP_ARCTANGENT_H
#define STEADYSTEP_ARCTANGENT_H

#include "firmware/numeric/angle.h"

/*
 * The angle of the vector (x, y), whose components are below 32 in magnitude. Error below 4e-6 turn
 * from a length of 0.1 on, inversely as the length below it; 0 of the vector 0. Some
 * 400 instructions: not for every period.
 */
angle_t angle_of_vector(num_t x, num_t y);

#endif
