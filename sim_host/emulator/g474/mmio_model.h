/* Where register accesses go: to models of peripherals, each at its addresses. They come
 * from the drivers' host build in a test, and from the image in the emulated chip. An
 * access to any other address is a misuse. */
#ifndef SIM_HOST_EMULATOR_G474_MMIO_MODEL_H
#define SIM_HOST_EMULATOR_G474_MMIO_MODEL_H

#include <stdbool.h>
#include <stdint.h>

typedef uint32_t (*mmio_model_read)(void *context, uint32_t offset);
typedef void (*mmio_model_write)(void *context, uint32_t offset, uint32_t value);

/* Forgets all models. */
void mmio_model_reset(void);

/* Puts a model at `bytes` addresses from `base`. */
void mmio_model_map(uint32_t base, uint32_t bytes, mmio_model_read read, mmio_model_write write,
                    void *context);

/* Plain memory: reads back what was written. `words` stays the caller's. */
void mmio_model_map_memory(uint32_t base, uint32_t bytes, uint32_t *words);

/* Calls `function` in mmio_sleep from now on; NULL after a reset: sleeping fails the test. */
void mmio_model_on_sleep(void (*function)(void));

/* Nesting of mmio_model_lock; a test ends with 0. */
int mmio_model_locked(void);

/* Writes to this register are lost from now on, as one into a block whose clock has not come
 * yet is; 0, as after a reset: none is. */
void mmio_model_lose(uint32_t address);
/* Whether they are. */
bool mmio_model_loses(uint32_t address);

/* One access of a word. */
uint32_t mmio_model_load(uint32_t address);
void mmio_model_store(uint32_t address, uint32_t value);

/* What stands for the interrupt mask and for waiting on the host. */
uint32_t mmio_model_lock(void);
void mmio_model_unlock(uint32_t state);
void mmio_model_sleep(void);

#endif
