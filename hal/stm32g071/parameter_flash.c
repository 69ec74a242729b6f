/*
 * The last two pages of the flash, which are the store's pages 2 and 3, of the settings. Pages 0
 * and 1 would be of what a drive with an encoder learns, and there is none. The chip has one bank:
 * while a page is erased (up to 40 ms) or a word programmed (0.1 ms) the core stalls at its next
 * fetch from flash. Both are refused while the bridge is on.
 *
 * A loss of power meanwhile leaves double words that fail the ECC. Reading one raises NMI; its
 * handler lets a read of the store answer "not readable", and the log of records skips that slot
 * until its page is erased. Any other NMI is a crash.
 */
#include "hal/cortex_m/parameter_flash.h"

#include <string.h>

#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/wait.h"
#include "hal/stm32g071/bridge.h"
#include "hal/stm32g071/watchdog.h"

enum {
    STORE_BYTES = PARAMETER_PAGES * FLASH_PAGE_BYTES,
    FIRST_PAGE = FLASH_BANK_BYTES / FLASH_PAGE_BYTES - PARAMETER_PAGES,
    SETTINGS_PAGE = 2,
    BUSY_WAIT = 700000 /* passes, > 43 ms, < 160 ms; an erase takes 40 ms at most */
};

#define STORE (FLASH_BANK_1 + FLASH_BANK_BYTES - (uint32_t)STORE_BYTES)
/* Unlocks FLASH->cr after FLASH_KEY1. */
#define KEY2 0xcdef89abu
#define ERRORS                                                                                     \
    (FLASH_SR_OPERR | FLASH_SR_PROGERR | FLASH_SR_WRPERR | FLASH_SR_PGAERR | FLASH_SR_SIZERR |     \
     FLASH_SR_PGSERR)

/* Of what is read, from here on and by the handler of the NMI. */
static volatile bool reads_store, damaged;

static bool in_store(uint32_t offset, size_t count)
{
    return offset >= SETTINGS_PAGE * FLASH_PAGE_BYTES && offset <= STORE_BYTES &&
           count <= STORE_BYTES - offset;
}

/* Nobody else can feed the watchdog while the core stalls, or while this waits. */
static bool idle(void)
{
    watchdog_feed();
    return wait_until(&FLASH->sr, FLASH_SR_BSY1 | FLASH_SR_CFGBSY, 0, BUSY_WAIT);
}

/* End of an operation: whether it ended, and without an error. */
static bool finished(void)
{
    const bool good = idle() && (FLASH->sr & ERRORS) == 0;

    FLASH->sr = ERRORS | FLASH_SR_EOP;
    return good;
}

static void lock(void)
{
    FLASH->cr = FLASH_CR_LOCK;
    bridge_release();
}

/* Behind a true one a lock() follows. */
static bool unlock(void)
{
    if (!bridge_hold_open()) {
        return false;
    }
    if (!idle()) {
        bridge_release();
        return false;
    }
    if ((FLASH->cr & FLASH_CR_LOCK) != 0) {
        FLASH->keyr = FLASH_KEY1;
        FLASH->keyr = KEY2;
    }
    FLASH->sr = ERRORS | FLASH_SR_EOP; /* old ones */
    return true;
}

bool parameter_flash_erase(uint32_t page)
{
    if (page < SETTINGS_PAGE || page >= PARAMETER_PAGES || !unlock()) {
        return false;
    }
    FLASH->cr = FLASH_CR_PER | FLASH_CR_PNB(FIRST_PAGE + page);
    FLASH->cr |= FLASH_CR_STRT;
    const bool good = finished();
    lock();
    return good;
}

/* A second double error would raise none while the flag of the first is up. */
bool parameter_flash_take_error(void)
{
    if (!reads_store || (FLASH->eccr & FLASH_ECCR_ECCD) == 0) {
        return false;
    }
    FLASH->eccr |= FLASH_ECCR_ECCD; /* and ECCC, if it is up */
    damaged = true;
    __DSB(); /* the request is down before the handler ends */
    return true;
}

static bool read_store(void *to, uint32_t offset, size_t count)
{
    damaged = false;
    reads_store = true;
    __DSB();
    memcpy(to, (const void *)(uintptr_t)(STORE + offset), count);
    __DSB();
    const bool late = (FLASH->eccr & FLASH_ECCR_ECCD) != 0; /* by this the NMI has come */

    __ISB();
    reads_store = false;
    return !late && !damaged;
}

static bool holds(uint32_t offset, const uint32_t expected[2])
{
    uint32_t word[2];

    return read_store(word, offset, sizeof word) && word[0] == expected[0] &&
           word[1] == expected[1];
}

/* One double word: two writes, in order, then the flash programs them together. */
static bool program_word(uint32_t offset, const uint8_t *data)
{
    static const uint32_t erased[2] = {UINT32_MAX, UINT32_MAX};
    volatile uint32_t *place = (volatile uint32_t *)(uintptr_t)(STORE + offset);
    uint32_t word[2];

    if (!holds(offset, erased)) {
        return false;
    }
    memcpy(word, data, sizeof word);
    FLASH->cr = FLASH_CR_PG;
    place[0] = word[0];
    place[1] = word[1];
    return finished() && holds(offset, word);
}

bool parameter_flash_program(uint32_t offset, const void *data, size_t count)
{
    const uint8_t *bytes = data;
    bool good = true;

    if (!in_store(offset, count) || offset % PARAMETER_WORD_BYTES != 0 ||
        count % PARAMETER_WORD_BYTES != 0 || !unlock()) {
        return false;
    }
    for (size_t done = 0; good && done < count; done += PARAMETER_WORD_BYTES) {
        good = program_word(offset + done, bytes + done);
    }
    lock();
    return good;
}

bool parameter_flash_read(uint32_t offset, void *data, size_t count)
{
    return in_store(offset, count) && read_store(data, offset, count);
}
