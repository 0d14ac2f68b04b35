/* The drivers' register accesses on the host: they meet the models. */
#include "hal/port_cortex_m/mmio.h"
#include "sim_host/emulator/g474/mmio_model.h"

uint32_t mmio_read(uint32_t address)
{
    return mmio_model_load(address);
}

void mmio_write(uint32_t address, uint32_t value)
{
    mmio_model_store(address, value);
}

uint32_t mmio_lock(void)
{
    return mmio_model_lock();
}

void mmio_unlock(uint32_t state)
{
    mmio_model_unlock(state);
}

void mmio_sleep(void)
{
    mmio_model_sleep();
}

void mmio_barrier(void)
{
}
