#include "firmware/numeric/trig.h"

/*
 * The angle is split into the nearest quarter turn and a rest x in -1...1 eighths of a turn:
 *   sin(x pi/4) = x (s1 + s3 x^2 + s5 x^4 + s7 x^6),  cos(x pi/4) = 1 + c2 x^2 + c4 x^4 + c6 x^6
 */
#define S1 0.7853981525434107
#define S3 (-0.08074536727538684)
#define S5 0.0024898719758618126
#define S7 (-3.587726271097463e-05)
#define C2 (-0.30842448849618576)
#define C4 0.015850397631179562
#define C6 (-0.00031916016887587745)

#if STEADYSTEP_NUM == NUM_FIXED

/* A coefficient with as many fraction bits as its 16-bit product with x^2 leaves room for. */
#define Q(x, bits) ((int32_t)((x) * (double)(1 << (bits)) + ((x) < 0 ? -0.5 : 0.5)))

struct sincos sincos_of_small(int32_t angle)
{
    int32_t x = (angle + (1 << 13)) >> 14;
    int32_t x2 = (x * x) >> 15;
    int32_t sine = Q(S5, 22) + ((Q(S7, 27) * x2) >> 20);
    int32_t cosine = Q(C4, 20) + (((Q(C6, 24) * x2) >> 15) >> 4);
    struct sincos r;

    sine = Q(S3, 18) + (((sine * x2) >> 15) >> 4);
    sine = Q(S1, 16) + (((sine * x2) >> 15) >> 2);
    cosine = Q(C2, 17) + (((cosine * x2) >> 15) >> 3);
    r.sin = (x * sine + (1 << 15)) >> 16;
    r.cos = UNIT(1.0) + ((x2 * cosine + (1 << 16)) >> 17);
    return r;
}

#else

struct sincos sincos_of_small(int32_t angle)
{
    num_t x = (num_t)angle * NUM(1.0 / 536870912.0);
    num_t x2 = x * x;
    struct sincos r;

    r.sin = x * (NUM(S1) + x2 * (NUM(S3) + x2 * (NUM(S5) + x2 * NUM(S7))));
    r.cos = NUM(1.0) + x2 * (NUM(C2) + x2 * (NUM(C4) + x2 * NUM(C6)));
    return r;
}

#endif

struct sincos sincos_of(angle_t angle)
{
    uint32_t quarter = (angle + (1u << 29)) >> 30;
    struct sincos r = sincos_of_small((int32_t)(angle - (quarter << 30)));

    if ((quarter & 1u) != 0u) {
        unit_t cosine = r.cos;
        r.cos = -r.sin;
        r.sin = cosine;
    }
    if ((quarter & 2u) != 0u) {
        r.cos = -r.cos;
        r.sin = -r.sin;
    }
    return r;
}
