/*
 * Complex numbers of the start-up design code, in double, from + - x / alone. Not inlined: a call
 * is a third of its software products.
 */
#ifndef STEADYSTEP_COMPLEX_NUMBER_H
#define STEADYSTEP_COMPLEX_NUMBER_H

struct complex_number {
    double re;
    double im;
};

struct complex_number complex_difference(struct complex_number x, struct complex_number y);
__attribute__((noinline)) struct complex_number complex_product(struct complex_number x,
                                                                struct complex_number y);
__attribute__((noinline)) struct complex_number complex_quotient(struct complex_number x,
                                                                 struct complex_number y);

/* |x|^2 */
__attribute__((noinline)) double complex_square_of_size(struct complex_number x);

#endif
