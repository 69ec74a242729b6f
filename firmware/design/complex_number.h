/* Complex arithmetic of the designs: + - x / only, the same result on every machine. */
#ifndef STEADYSTEP_COMPLEX_NUMBER_H
#define STEADYSTEP_COMPLEX_NUMBER_H

struct complex_number {
    double re;
    double im;
};

static inline struct complex_number complex_difference(struct complex_number x,
                                                       struct complex_number y)
{
    return (struct complex_number){x.re - y.re, x.im - y.im};
}

static inline struct complex_number complex_product(struct complex_number x,
                                                    struct complex_number y)
{
    return (struct complex_number){x.re * y.re - x.im * y.im, x.re * y.im + x.im * y.re};
}

/* |x|^2. */
static inline double complex_square(struct complex_number x)
{
    return x.re * x.re + x.im * x.im;
}

static inline struct complex_number complex_quotient(struct complex_number x,
                                                     struct complex_number y)
{
    const double square = complex_square(y);

    return (struct complex_number){(x.re * y.re + x.im * y.im) / square,
                                   (x.im * y.re - x.re * y.im) / square};
}

#endif
