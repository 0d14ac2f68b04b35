#include "sim_host/emulator/g474/mmio_model.h"

#include <stddef.h>

#include "sim_host/emulator/g474/model_check.h"

struct region {
    uint32_t base;
    uint32_t bytes;
    mmio_model_read read;
    mmio_model_write write;
    void *context;
};

enum { REGION_MAX = 24 };

static struct region regions[REGION_MAX];
static int region_count;
static int locked;
static void (*on_sleep)(void);
static uint32_t lost_address;

void mmio_model_reset(void)
{
    region_count = 0;
    locked = 0;
    on_sleep = NULL;
    lost_address = 0;
}

void mmio_model_lose(uint32_t address)
{
    lost_address = address;
}

bool mmio_model_loses(uint32_t address)
{
    return address == lost_address;
}

void mmio_model_map(uint32_t base, uint32_t bytes, mmio_model_read read, mmio_model_write write,
                    void *context)
{
    if (region_count == REGION_MAX) {
        model_misuse("no room for a model at %#x", base);
        return;
    }
    regions[region_count++] = (struct region){base, bytes, read, write, context};
}

static uint32_t memory_read(void *context, uint32_t offset)
{
    return ((uint32_t *)context)[offset / 4];
}

static void memory_write(void *context, uint32_t offset, uint32_t value)
{
    ((uint32_t *)context)[offset / 4] = value;
}

void mmio_model_map_memory(uint32_t base, uint32_t bytes, uint32_t *words)
{
    mmio_model_map(base, bytes, memory_read, memory_write, words);
}

int mmio_model_locked(void)
{
    return locked;
}

static const struct region *find(uint32_t address)
{
    MODEL_CHECK(address % 4 == 0, "access to %#x is not aligned", address);
    for (int i = 0; i < region_count; i++) {
        if (address - regions[i].base < regions[i].bytes) {
            return &regions[i];
        }
    }
    model_misuse("nothing is at address %#x", address);
    return NULL;
}

uint32_t mmio_model_load(uint32_t address)
{
    const struct region *region = find(address);
    return region != NULL ? region->read(region->context, address - region->base) : 0;
}

void mmio_model_store(uint32_t address, uint32_t value)
{
    const struct region *region = find(address);
    if (region != NULL && (lost_address == 0 || address != lost_address)) {
        region->write(region->context, address - region->base, value);
    }
}

uint32_t mmio_model_lock(void)
{
    return (uint32_t)locked++;
}

void mmio_model_unlock(uint32_t state)
{
    locked = (int)state;
}

void mmio_model_on_sleep(void (*function)(void))
{
    on_sleep = function;
}

void mmio_model_sleep(void)
{
    if (on_sleep == NULL) {
        model_misuse("nothing would end this sleep");
        return;
    }
    on_sleep();
}
