/*
 * The last four pages of the flash. The chip has one bank: while a page is erased (up to 40 ms) or
 * a word programmed (0.1 ms) the core stalls at its next fetch from flash. Both are refused while
 * the bridge is on.
 */
#include "hal/cortex_m/parameter_flash.h"

#include <string.h>

#include "hal/stm32g071/bridge.h"
#include "hal/stm32g071/watchdog.h"

enum {
    STORE_BYTES = PARAMETER_PAGES * FLASH_PAGE_BYTES,
    FIRST_PAGE = FLASH_BANK_BYTES / FLASH_PAGE_BYTES - PARAMETER_PAGES
};

#define STORE (FLASH_BANK_1 + FLASH_BANK_BYTES - (uint32_t)STORE_BYTES)
/* Unlocks FLASH->cr after FLASH_KEY1. */
#define KEY2 0xcdef89abu
#define ERRORS                                                                                     \
    (FLASH_SR_OPERR | FLASH_SR_PROGERR | FLASH_SR_WRPERR | FLASH_SR_PGAERR | FLASH_SR_SIZERR |     \
     FLASH_SR_PGSERR)

static bool in_store(uint32_t offset, size_t count)
{
    return offset <= STORE_BYTES && count <= STORE_BYTES - offset;
}

static bool finished(void)
{
    while ((FLASH->sr & (FLASH_SR_BSY1 | FLASH_SR_CFGBSY)) != 0) {
    }
    const bool good = (FLASH->sr & ERRORS) == 0;
    FLASH->sr = ERRORS | FLASH_SR_EOP;
    return good;
}

static bool unlock(void)
{
    if (!bridge_hold_open()) {
        return false;
    }
    if ((FLASH->cr & FLASH_CR_LOCK) != 0) {
        FLASH->keyr = FLASH_KEY1;
        FLASH->keyr = KEY2;
    }
    (void)finished(); /* forgets old errors */
    return true;
}

static void lock(void)
{
    FLASH->cr = FLASH_CR_LOCK;
    bridge_release();
}

bool parameter_flash_erase(uint32_t page)
{
    if (page >= PARAMETER_PAGES || !unlock()) {
        return false;
    }
    watchdog_feed(); /* nobody else can while the core stalls */
    FLASH->cr = FLASH_CR_PER | FLASH_CR_PNB(FIRST_PAGE + page);
    FLASH->cr |= FLASH_CR_STRT;
    const bool good = finished();
    lock();
    return good;
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
        volatile uint32_t *place = (volatile uint32_t *)(uintptr_t)(STORE + offset + done);
        uint32_t word[2];

        memcpy(word, bytes + done, sizeof word);
        if (place[0] != UINT32_MAX || place[1] != UINT32_MAX) {
            good = false;
            break;
        }
        FLASH->cr = FLASH_CR_PG;
        place[0] = word[0];
        place[1] = word[1];
        good = finished() && place[0] == word[0] && place[1] == word[1];
    }
    lock();
    return good;
}

bool parameter_flash_read(uint32_t offset, void *data, size_t count)
{
    if (!in_store(offset, count)) {
        return false;
    }
    memcpy(data, (const void *)(uintptr_t)(STORE + offset), count);
    return true;
}
