/*
 * Instructions that other cores have and this one does not, each of which is a HardFault at its own
 * address; and one that it has. The handler logs where, and goes on behind.
 */
#include "program.h"

__attribute__((used)) static void report(uint32_t *frame)
{
    const uint32_t address = frame[6];
    const uint32_t first_half = *(const volatile uint16_t *)address;

    PROBE->log = address;
    frame[6] = address + (first_half >= 0xe800u ? 4u : 2u);
}

HARD_FAULT_CALLS(report)

/* `name` begins at the instruction. */
#define INSTRUCTION(name, code)                                                                    \
    __asm volatile(".global " #name " \n.type " #name ", STT_FUNC \n" #name ": " code ::           \
                       : "r0", "r1", "r2", "memory")

void program(void)
{
#if __ARM_ARCH == 7
    CPACR = 0xfu << 20;
    INSTRUCTION(armv8m_test_target, ".inst.w 0xe841f000 \n");  /* TT r0, r1 */
    INSTRUCTION(armv8m_load_acquire, ".inst.w 0xe8d10faf \n"); /* LDA r0, [r1] */
    INSTRUCTION(double_precision, ".inst.w 0xee300b00 \n");    /* VADD.F64 d0, d0, d0 */
    INSTRUCTION(divide, "movs r1, #1 \n sdiv r0, r1, r1 \n");
#else
    __asm volatile("nop");
    INSTRUCTION(armv7m_divide, ".inst.w 0xfb91f0f1 \n"); /* SDIV r0, r1, r1 */
    INSTRUCTION(armv7m_move, ".inst.w 0xf2400001 \n");   /* MOVW r0, #1 */
    INSTRUCTION(armv7m_float, ".inst.w 0xee300a00 \n");  /* VADD.F32 s0, s0, s0 */
    INSTRUCTION(multiply, "movs r0, r1 \n muls r0, r1, r0 \n");
#endif
    PROBE->end = 1;
    for (;;) {
    }
}
