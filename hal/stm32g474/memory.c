/* What the compiler calls to copy and to clear. The C library's two take 460 bytes for a speed that
   nothing needs here: of the control interrupt only what begins or ends clears by a call. */
#include <stddef.h>
#include <stdint.h>

void *memcpy(void *restrict to, const void *restrict from, size_t count)
{
    uint8_t *written = to;
    const uint8_t *read = from;

    while (count-- > 0u) {
        *written++ = *read++;
    }
    return to;
}

/* Beside the handlers of a crash: flash may be what has failed. */
__attribute__((section(".ccm.fault.memset"))) void *memset(void *to, int value, size_t count)
{
    const uint32_t word = 0x01010101u * (uint8_t)value;
    const size_t whole = (uintptr_t)to % 4u == 0u ? count / 4u : 0u; /* structures are aligned */
    uint32_t *words = to;
    uint32_t *const words_end = words + whole;

    while (words != words_end) {
        *words++ = word;
    }
    for (uint8_t *bytes = (uint8_t *)words; bytes != (uint8_t *)to + count;) {
        *bytes++ = (uint8_t)value;
    }
    return to;
}
