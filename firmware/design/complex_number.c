#include "firmware/design/complex_number.h"

struct complex_number complex_difference(struct complex_number x, struct complex_number y)
{
    return (struct complex_number){x.re - y.re, x.im - y.im};
}

struct complex_number complex_product(struct complex_number x, struct complex_number y)
{
    return (struct complex_number){x.re * y.re - x.im * y.im, x.re * y.im + x.im * y.re};
}

double complex_square_of_size(struct complex_number x)
{
    return x.re * x.re + x.im * x.im;
}

struct complex_number complex_quotient(struct complex_number x, struct complex_number y)
{
    const double square = complex_square_of_size(y);

    return (struct complex_number){(x.re * y.re + x.im * y.im) / square,
                                   (x.im * y.re - x.re * y.im) / square};
}
