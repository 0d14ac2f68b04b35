/* The last four flash pages of the STM32G474's second bank as an nv_store of two banks.
 *
 * The program runs from the first bank, which stays readable while the second is
 * erased or written: interrupts go on; the caller waits. Meanwhile the data cache is off, for
 * that reading may corrupt it (flash_store.c). That needs the option bit DBANK, as
 * delivered; without it the store refuses to erase and write.
 *
 * A word that a power failure tore can fail the error correction when it is read:
 * the processor then takes a non-maskable interrupt. Its handler must ask
 * flash_store_survives_nmi first.
 */
#ifndef HAL_PORT_STM32G474_FLASH_STORE_H
#define HAL_PORT_STM32G474_FLASH_STORE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/storage/nv_store.h"
#include "hal/storage/program_slots.h"

/* The first bank: the starter, then the program. The second: the stage for the next program, the
 * page of its mark, and at the end the settings. */
#define FLASH_STARTER_BYTES 0x2000u
#define FLASH_PROGRAM_BYTES 0x20000u

enum {
    FLASH_STORE_FIRST_PAGE = 124, /* of bank 2: 0x0807E000 and 0x0807F000 */
    FLASH_STORE_PAGES = 2,        /* of one bank of the store */
    /* A page takes 24.47 ms to erase at most: Zephyr, drivers/flash/flash_stm32.c (its releases of 2020,
     * for the STM32G4), and dts/arm/st/g4/stm32g4.dtsi, max-erase-time 25; both wait twice as long.
     * For a word's 84 us no public source was at hand, and no bound rests on it. 2 million polls of
     * at least 4 cycles at 170 MHz are 47 ms: nearly twice a page's time. */
    FLASH_STORE_POLLS = 2000000
};

struct flash_store {
    volatile bool reading; /* an error now is the store's own */
    volatile bool corrupt; /* set by the handler */
    uint32_t failures;     /* erases and writes that failed; saturates */
};

/* Prepares the store; touches nothing. */
void flash_store_init(struct flash_store *store);

/* The store as the parameter store sees it. Every read costs about 50
 * instructions; erase blocks 49 ms, write 0.1 ms. */
struct nv_store flash_store_interface(struct flash_store *store);

/* A word or a page anywhere in flash, by its address: for programs. The caller keeps away from what
 * it runs on; the core waits where both are in one bank. Results and times as of nv_store.h;
 * NV_OUT_OF_RANGE also where the address does not begin a word or a page. */
enum nv_result flash_store_read_at(struct flash_store *store, uint32_t address, uint8_t *out);
enum nv_result flash_store_erase_at(struct flash_store *store, uint32_t address);
enum nv_result flash_store_write_at(struct flash_store *store, uint32_t address,
                                    const uint8_t *word);

/* The option bytes in force (FLASH_OPTR). O(1). */
uint32_t flash_store_option_bytes(void);

/* True when the error correction mended a word since the last call (RM0440, ECCR.ECCC). Loop; O(1). */
bool flash_store_take_corrected(void);

/* The program's slot and the stage for its successor. */
struct program_slots flash_store_programs(struct flash_store *store);

/* From the NMI handler: true when the interrupt was a read of the store that the
 * error correction gave up on; then the cause is cleared and the handler may
 * return. O(1). */
bool flash_store_survives_nmi(struct flash_store *store);

#endif
