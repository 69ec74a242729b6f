#include "hal/cortex_m/parameter_flash.h"

#include <string.h>

#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/wait.h"
#include "hal/stm32g474/flash_errors.h"
#include "hal/stm32g474/handlers.h"
#include "hal/stm32g474/registers.h"

enum {
    BANK_PAGES = FLASH_BANK_BYTES / FLASH_PAGE_BYTES,
    FIRST_PAGE = BANK_PAGES - PARAMETER_PAGES, /* of bank 2 */
    STORE_BYTES = PARAMETER_PAGES * FLASH_PAGE_BYTES,
    STORE = FLASH_BANK_1 + FLASH_BANK_BYTES + FIRST_PAGE * FLASH_PAGE_BYTES,
    BUSY_WAIT = 2500000, /* passes, > 58 ms; an erase takes 25 ms at most */
};

#define ERRORS                                                                                     \
    (FLASH_SR_OPERR | FLASH_SR_PROGERR | FLASH_SR_WRPERR | FLASH_SR_PGAERR | FLASH_SR_SIZERR |     \
     FLASH_SR_PGSERR | FLASH_SR_MISERR | FLASH_SR_FASTERR)

void parameter_flash_forget_corrected(void)
{
    if (FLASH->eccr & FLASH_ECCR_ECCC) {
        FLASH->eccr = FLASH_ECCR_ECCC;
    }
}

void parameter_flash_check_options(void)
{
    RCC->ahb1enr |= RCC_AHB1ENR_FLASHEN;
    parameter_flash_forget_corrected();
    if ((FLASH->optr & (FLASH_OPTR_DBANK | FLASH_OPTR_BFB2)) != FLASH_OPTR_DBANK) {
        board_fault(BOARD_FAULT_FLASH_OPTIONS);
    }
}

/* End of an operation: whether it ended, and without an error. */
static bool finish(void)
{
    const bool ended = wait_until(&FLASH->sr, FLASH_SR_BSY, 0, BUSY_WAIT);

    return ended && (FLASH->sr & ERRORS) == 0;
}

static bool begin(uint32_t operation)
{
    if (!wait_until(&FLASH->sr, FLASH_SR_BSY, 0, BUSY_WAIT)) {
        return false;
    }
    if (FLASH->cr & FLASH_CR_LOCK) {
        FLASH->keyr = (uint32_t)FLASH_KEY_1;
        FLASH->keyr = (uint32_t)FLASH_KEY_2;
    }
    FLASH->sr = ERRORS | FLASH_SR_EOP;
    FLASH->acr &= ~FLASH_ACR_DCEN; /* reads while writing may corrupt it: ES0430, 2.2.2 */
    FLASH->cr = operation;
    return true;
}

/* Locks; what the data cache holds of the store is old now. */
static void end(void)
{
    FLASH->cr = FLASH_CR_LOCK;
    FLASH->acr &= ~FLASH_ACR_DCEN; /* a reset of the cache needs it off */
    FLASH->acr |= FLASH_ACR_DCRST;
    FLASH->acr &= ~FLASH_ACR_DCRST;
    FLASH->acr |= FLASH_ACR_DCEN;
}

bool parameter_flash_erase(uint32_t page)
{
    bool done = false;

    if (page >= PARAMETER_PAGES) {
        return false;
    }
    const uint32_t operation = FLASH_CR_PER | FLASH_CR_BKER | FLASH_CR_PNB(FIRST_PAGE + page);

    if (begin(operation)) {
        FLASH->cr = operation | FLASH_CR_STRT;
        done = finish();
    }
    end();
    return done;
}

static volatile bool damaged; /* what is being read; set by the handler of the NMI */

bool parameter_flash_take_error(void)
{
    const uint32_t eccr = FLASH->eccr;

    /* Of bank 2 nothing but the store is ever read. */
    if ((eccr & FLASH_ECCR_ECCD) == 0 || (eccr & FLASH_ECCR_BK_ECC) == 0) {
        return false;
    }
    FLASH->eccr = FLASH_ECCR_ECCD | (eccr & FLASH_ECCR_ECCC);
    damaged = true;
    __DSB(); /* the request is down before the handler ends */
    return true;
}

/* Every read is to reach the flash, whose cells cut off by a loss of power are found by it alone.
 */
static bool read_store(uint8_t *to, uint32_t offset, size_t count)
{
    const uint32_t acr = FLASH->acr;

    FLASH->acr = acr & ~FLASH_ACR_DCEN;
    parameter_flash_forget_corrected();
    damaged = false;
    __COMPILER_BARRIER();
    memcpy(to, (const void *)(uintptr_t)(STORE + offset), count);
    __DSB();
    const bool late = (FLASH->eccr & FLASH_ECCR_ECCD) != 0; /* by this the NMI has come */

    __ISB();
    FLASH->acr = acr;
    return !late && !damaged;
}

static bool in_store(uint32_t offset, size_t count)
{
    return offset <= STORE_BYTES && count <= STORE_BYTES - offset;
}

static bool erased(uint32_t offset, size_t count)
{
    for (uint32_t i = 0; i < count; i += PARAMETER_WORD_BYTES) {
        uint8_t word[PARAMETER_WORD_BYTES];

        if (!read_store(word, offset + i, sizeof word)) {
            return false;
        }
        for (size_t k = 0; k < sizeof word; k++) {
            if (word[k] != 0xff) {
                return false;
            }
        }
    }
    return true;
}

/* One double word: two writes, in order, then the flash programs them together. */
static bool program_word(uint32_t offset, const uint8_t *data)
{
    volatile uint32_t *target = (volatile uint32_t *)(uintptr_t)(STORE + offset);
    uint32_t words[2];

    memcpy(words, data, sizeof words);
    target[0] = words[0];
    target[1] = words[1];
    return finish();
}

bool parameter_flash_program(uint32_t offset, const void *data, size_t count)
{
    const uint8_t *bytes = data;
    bool done = true;

    if (!in_store(offset, count) || offset % PARAMETER_WORD_BYTES != 0 ||
        count % PARAMETER_WORD_BYTES != 0 || !erased(offset, count)) {
        return false;
    }
    if (!begin(FLASH_CR_PG)) {
        done = false;
    }
    for (uint32_t i = 0; done && i < count; i += PARAMETER_WORD_BYTES) {
        done = program_word(offset + i, &bytes[i]);
    }
    end();
    return done;
}

bool parameter_flash_read(uint32_t offset, void *data, size_t count)
{
    return in_store(offset, count) && read_store(data, offset, count);
}
