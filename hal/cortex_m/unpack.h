/*
 * What a program copies to RAM at its start lies packed in flash, behind the rest: tools/pack_image
 * puts it there once the program is linked. It is LZ77 by a binary adaptive range coder, as LZMA's
 * is, with fewer models.
 *
 * A region's bytes come one after the other, each step by a bit "match":
 * - 0: a literal, 8 bits, the highest first; a model for each beginning of them, and for what the
 *   instruction before is: its length, and at odd places more of it
 * - 1: earlier bytes of the region once more. A bit "again" is for the distance of the last match.
 *   Then how many, less one unless again; then how far back, unless again
 *
 * In a region that is there the calls (ARMv7-M, BL of up to 4 MiB either way) are put right.
 *
 * Numbers are from 1 on: as many 1 as bits follow the first, a 0, these bits, the highest first
 * (Elias's gamma code). Models distinguish even and odd places, since instructions are halfwords,
 * and what came before: `enum model`. Coder and models go on from region to region.
 */
#ifndef STEADYSTEP_CORTEX_M_UNPACK_H
#define STEADYSTEP_CORTEX_M_UNPACK_H

#include <stdint.h>

struct unpacked_region {
    void *begin;
    const void *end;
};

/* Fills the regions, which begin at even addresses, in the order of their addresses. Takes 8.5 KB
   of stack, and some 350 cycles for each byte. */
void unpack(const uint8_t *packed, const struct unpacked_region *regions, unsigned count);

#endif
