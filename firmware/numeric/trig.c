#include "firmware/numeric/trig.h"

/*
 * The angle is split into the nearest 128th of a turn, whose cosine C and sine S the table holds,
 * and a rest of x turns, |x| <= 1/256:
 *   s = sin(2 pi x) = x (s1 + s3 x^2),   c = cos(2 pi x) - 1 = c2 x^2
 *   cos = C + (C c - S s),   sin = S + (S c + C s)
 * s1 and s3 are the series', c2 has the least largest error, 2.6e-9.
 */
#define STEP_BITS 25 /* 2^-32 turn in 1/128 turn */
#define S1        6.283185307179586
#define S3        (-41.341702240399755)
#define C2        (-19.738387943505494)

/* The first quarter turn; the others are this one turned, so that the symmetries are exact. */
#define QUARTER_TURN(P)                                                                            \
    P(1.0, 0.0)                                                                                    \
    P(0.9987954562051724, 0.049067674327418015)                                                    \
    P(0.9951847266721969, 0.0980171403295606)                                                      \
    P(0.989176509964781, 0.14673047445536175)                                                      \
    P(0.9807852804032304, 0.19509032201612825)                                                     \
    P(0.970031253194544, 0.24298017990326387)                                                      \
    P(0.9569403357322088, 0.29028467725446233)                                                     \
    P(0.9415440651830208, 0.33688985339222005)                                                     \
    P(0.9238795325112867, 0.3826834323650898)                                                      \
    P(0.9039892931234433, 0.4275550934302821)                                                      \
    P(0.881921264348355, 0.47139673682599764)                                                      \
    P(0.8577286100002721, 0.5141027441932217)                                                      \
    P(0.8314696123025452, 0.5555702330196022)                                                      \
    P(0.8032075314806449, 0.5956993044924334)                                                      \
    P(0.773010453362737, 0.6343932841636455)                                                       \
    P(0.7409511253549591, 0.6715589548470183)                                                      \
    P(0.7071067811865476, 0.7071067811865475)                                                      \
    P(0.6715589548470183, 0.7409511253549591)                                                      \
    P(0.6343932841636455, 0.773010453362737)                                                       \
    P(0.5956993044924335, 0.8032075314806448)                                                      \
    P(0.5555702330196023, 0.8314696123025452)                                                      \
    P(0.5141027441932217, 0.8577286100002721)                                                      \
    P(0.4713967368259978, 0.8819212643483549)                                                      \
    P(0.4275550934302822, 0.9039892931234433)                                                      \
    P(0.38268343236508984, 0.9238795325112867)                                                     \
    P(0.33688985339222005, 0.9415440651830208)                                                     \
    P(0.29028467725446233, 0.9569403357322089)                                                     \
    P(0.24298017990326398, 0.970031253194544)                                                      \
    P(0.19509032201612833, 0.9807852804032304)                                                     \
    P(0.14673047445536175, 0.989176509964781)                                                      \
    P(0.09801714032956077, 0.9951847266721968)                                                     \
    P(0.049067674327418126, 0.9987954562051724)

#define FIRST(c, s)  {UNIT(c), UNIT(s)},
#define SECOND(c, s) {UNIT(-(s)), UNIT(c)},
#define THIRD(c, s)  {UNIT(-(c)), UNIT(-(s))},
#define FOURTH(c, s) {UNIT(s), UNIT(-(c))},

static const struct sincos table[] = {QUARTER_TURN(FIRST) QUARTER_TURN(SECOND) QUARTER_TURN(THIRD)
                                          QUARTER_TURN(FOURTH)};

/*
 * Of up to an eighth of a turn, with the least largest error relative to x^2:
 *   sin = x (s1 + x^2 (s3 + x^2 s5)),   cos = 1 + x^2 (c2 + x^2 (c4 + x^2 c6))
 */
#define SMALL_S3 (-41.335927203572254)
#define SMALL_S5 80.12112079926058
#define SMALL_C2 (-19.739201717459647)
#define SMALL_C4 64.93121440317827
#define SMALL_C6 (-84.05645428205922)

#if STEADYSTEP_NUM == NUM_FIXED

/* A coefficient for x in 2^-23 turn, which is 16 bits; the cube is below half a bit. */
#define Q(x, bits) ((int32_t)((x) * (double)(1 << (bits)) + ((x) < 0 ? -0.5 : 0.5)))

static struct sincos turn_on(struct sincos from, int32_t rest)
{
    const int32_t x = rest >> 9;
    const int32_t s = (x * Q(S1 / 256.0, 20)) >> 15;
    const int32_t c = (((x * x) >> 15) * Q(C2 / 65536.0, 20)) >> 15;
    const int32_t half = 1 << 19;
    const struct sincos to = {from.cos + ((from.cos * c - from.sin * s + half) >> 20),
                              from.sin + ((from.sin * c + from.cos * s + half) >> 20)};

    return to;
}

/* In eighths of a turn everything is below one, and Q15. */
#define EIGHTHS(x, power) Q((x) / (double)(1 << (3 * (power))), 15)

struct sincos sincos_of_small(num_t turns)
{
    const int32_t half = 1 << 14;
    const int32_t x = (turns + (1 << (NUM_FRACTION_BITS - 19))) >> (NUM_FRACTION_BITS - 18);
    const int32_t x2 = (x * x) >> 15;
    const int32_t s = EIGHTHS(SMALL_S3, 3) + ((x2 * EIGHTHS(SMALL_S5, 5)) >> 15);
    const int32_t c = EIGHTHS(SMALL_C4, 4) + ((x2 * EIGHTHS(SMALL_C6, 6)) >> 15);
    const struct sincos to = {UNIT(1.0) +
                                  ((x2 * (EIGHTHS(SMALL_C2, 2) + ((x2 * c) >> 15)) + half) >> 15),
                              (x * (EIGHTHS(S1, 1) + ((x2 * s) >> 15)) + half) >> 15};

    return to;
}

#else

static struct sincos turn_on(struct sincos from, int32_t rest)
{
    const num_t x = num_from_2_32(rest);
    const num_t x2 = x * x;
    const num_t s = x * (NUM(S1) + x2 * NUM(S3));
    const num_t c = x2 * NUM(C2);
    const struct sincos to = {from.cos + (from.cos * c - from.sin * s),
                              from.sin + (from.sin * c + from.cos * s)};

    return to;
}

struct sincos sincos_of_small(num_t turns)
{
    const num_t x = turns;
    const num_t x2 = x * x;
    const struct sincos to = {UNIT(1.0) +
                                  x2 * (NUM(SMALL_C2) + x2 * (NUM(SMALL_C4) + x2 * NUM(SMALL_C6))),
                              x * (NUM(S1) + x2 * (NUM(SMALL_S3) + x2 * NUM(SMALL_S5)))};

    return to;
}

#endif

struct sincos sincos_of(angle_t angle)
{
    const uint32_t step = (angle + (1u << (STEP_BITS - 1))) >> STEP_BITS;

    const int32_t rest = (int32_t)(angle << (32 - STEP_BITS)) >> (32 - STEP_BITS);

    return turn_on(table[step], rest);
}
