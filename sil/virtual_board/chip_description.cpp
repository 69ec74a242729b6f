#include "sil/virtual_board/chip_description.h"

namespace virtual_board
{

namespace
{

constexpr Ticks cycle_of(std::uint64_t frequency_Hz)
{
    return ticks_per_s / frequency_Hz;
}

} // namespace

const ChipDescription &stm32g474()
{
    static const ChipDescription chip = {
        "STM32G474",
        {"Cortex-M4F", Architecture::armv7em, true, 4, 102, 12, 10, 6, 17},
        {
            {"CCM SRAM", 0x10000000, 32 * 1024, 0x20018000},
            {"SRAM1, SRAM2", 0x20000000, 96 * 1024, 0},
        },
        {0x08000000, 512 * 1024},
        {0x08040000, 256 * 1024}, /* bank 2 */
        {0x10000000, 32 * 1024},
        25, /* TIM1_UP_TIM16 */
        cycle_of(16'000'000),
    };
    return chip;
}

const ChipDescription &stm32g071()
{
    static const ChipDescription chip = {
        "STM32G071",
        {"Cortex-M0+", Architecture::armv6m, false, 2, 32, 15, 12, 9, 0},
        {
            {"SRAM", 0x20000000, 36 * 1024, 0},
        },
        {0x08000000, 128 * 1024},
        {0x0801e000, 8 * 1024},
        {0, 0},
        12, /* ADC_COMP */
        cycle_of(16'000'000),
    };
    return chip;
}

} // namespace virtual_board
