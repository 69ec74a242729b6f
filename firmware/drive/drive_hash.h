/*
 * drive_hash: what a drive has computed, in 64 bits (FNV-1a). It begins with every gain of the
 * design, once, and goes on with the duties, the state and the inner signals of each period, bit
 * for bit. Equal hashes prove that two drives did the same: on another compiler, another core,
 * another board.
 *
 * What is hashed of a period is taken and added in two steps, so that a host that only sees the
 * memory of a drive can add it: drive_hash_add knows no number format.
 */
#ifndef STEADYSTEP_DRIVE_HASH_H
#define STEADYSTEP_DRIVE_HASH_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct drive;
struct drive_params;
struct hal_outputs;

enum { DRIVE_HASH_WORDS = 9 };

/*
 * One period, in the order in which it is hashed:
 *   0  high counts: A+ << 16 | A-
 *   1  high counts: B+ << 16 | B-
 *   2  state << 1 | bridge_on
 *   3  estimated position, whole electrical turns (two's complement)
 *   4  estimated position, fraction of a turn in 2^-32
 *   5  estimated speed       5...8: per-unit, num_bits() of numeric/num.h
 *   6  estimated load torque
 *   7  current d, measured
 *   8  current q
 */
struct drive_hash_row {
    uint32_t word[DRIVE_HASH_WORDS];
};

/* The hash over the gains of a drive that has been initialised: where the sum of periods begins. */
uint64_t drive_hash_gains(const struct drive_params *params);

/* What drive and outputs show after a control interrupt. */
struct drive_hash_row drive_hash_row(const struct drive *drive, const struct hal_outputs *outputs);

static inline uint64_t drive_hash_word(uint64_t hash, uint32_t word)
{
    return (hash ^ word) * UINT64_C(0x100000001b3);
}

/* The hash after one more period. */
static inline uint64_t drive_hash_add(uint64_t hash, struct drive_hash_row row)
{
    for (size_t i = 0; i < DRIVE_HASH_WORDS; i++) {
        hash = drive_hash_word(hash, row.word[i]);
    }
    return hash;
}

#ifdef __cplusplus
}
#endif

#endif
