#include "sim_host/emulator/g474/flash_model.h"

#include <string.h>

#include "sim_host/emulator/g474/mmio_model.h"
#include "sim_host/emulator/g474/model_check.h"

/* Offsets and bits, RM0440 section "FLASH registers". */
enum { ACR = 0x00, KEYR = 0x08, OPTKEYR = 0x0C, SR = 0x10, CR = 0x14, ECCR = 0x18, OPTR = 0x20 };
enum {
    SR_PROGERR = 1 << 3,
    SR_PGAERR = 1 << 5,
    SR_SIZERR = 1 << 6,
    SR_PGSERR = 1 << 7,
    SR_BSY = 1 << 16,
    CR_PG = 1 << 0,
    CR_PER = 1 << 1,
    CR_BKER = 1 << 11,
    CR_STRT = 1 << 16,
    CR_OPTSTRT = 1 << 17,
    CR_OBL_LAUNCH = 1 << 27,
    CR_OPTLOCK = 1 << 30,
    ACR_DCEN = 1 << 10,
    ACR_DCRST = 1 << 12
};
#define CR_LOCK 0x80000000u
#define ECCR_ECCD 0x80000000u
#define ECCR_ECCC 0x40000000u
#define SR_ERRORS 0xC3FAu

static bool power_fails(struct flash_model *model)
{
    if (model->on_operation != NULL) {
        model->on_operation(model->operation_context);
    }
    if (model->operations++ == model->power_fails_at) {
        model->power_off = true;
    }
    return model->power_off;
}

/* Errata sheet ES0430 of the STM32G471 to G484, "Data cache might be corrupted during flash
 * memory read-while-write operation": its workaround is to have the cache off meanwhile. */
static void begin(struct flash_model *model, uint32_t time_ns, uint32_t page)
{
    model->worked_on = page / MODEL_BANK_PAGES;
    model->elapsed_ms += 1e-6 * time_ns;
    MODEL_CHECK((model->acr & ACR_DCEN) == 0, "an operation began with the data cache on");
    model->busy = model->busy_time;
}

static void tell_change(const struct flash_model *model, uint32_t page, uint32_t index,
                        uint32_t words)
{
    if (model->changed != NULL) {
        model->changed(model->changed_context, (page * MODEL_PAGE_WORDS + index) * 8, words * 8);
    }
}

static void erase(struct flash_model *model)
{
    const uint32_t bank = (model->cr & CR_BKER) != 0 ? 1 : 0;
    const uint32_t page = ((model->cr >> 3) & 0x7F) + bank * MODEL_BANK_PAGES;

    if (page < model->first_page) {
        model->foreign_erases++;
        return;
    }
    const bool fails = power_fails(model);
    for (int i = 0; i < MODEL_PAGE_WORDS; i++) {
        if (fails && i % 3 == 0) {
            model->state[page][i] = WORD_TORN; /* not yet what the erase makes of it */
            continue;
        }
        model->word[page][i] = UINT64_MAX;
        model->state[page][i] = WORD_ERASED;
    }
    tell_change(model, page, 0, MODEL_PAGE_WORDS);
    begin(model, MODEL_ERASE_NS, page);
}

/* RM0440, "Modifying user options". */
static void write_options(struct flash_model *model, uint32_t value)
{
    if ((model->cr & CR_OPTLOCK) != 0) {
        return;
    }
    if ((value & CR_OPTSTRT) != 0) {
        model->optr_stored = power_fails(model) ? MODEL_OPTIONS_TORN : model->optr_written;
        model->elapsed_ms += 1e-6 * MODEL_ERASE_NS;
    }
    model->options_wanted = model->options_wanted || (value & CR_OBL_LAUNCH) != 0;
}

static void write_cr(struct flash_model *model, uint32_t value)
{
    if (model->power_off || (model->cr & CR_LOCK) != 0) {
        return;
    }
    MODEL_CHECK((model->sr & SR_BSY) == 0 && model->busy == 0, "CR written while busy");
    write_options(model, value);
    model->cr = (value & ~(uint32_t)(CR_STRT | CR_OPTSTRT | CR_OBL_LAUNCH | CR_OPTLOCK)) |
                ((model->cr | value) & (uint32_t)CR_OPTLOCK); /* only keys open it */
    if ((value & CR_STRT) != 0) {
        if ((value & CR_PER) == 0 || (value & CR_PG) != 0 || (model->sr & SR_ERRORS) != 0) {
            model->sr |= SR_PGSERR;
        } else {
            erase(model);
        }
    }
}

static void write_key(struct flash_model *model, uint32_t value)
{
    static const uint32_t keys[2] = {0x45670123u, 0xCDEF89ABu};

    if (model->keys < 0 || (model->cr & CR_LOCK) == 0 || value != keys[model->keys]) {
        model->keys = -1; /* until the next reset */
        return;
    }
    if (++model->keys == 2) {
        model->cr &= ~CR_LOCK;
        model->keys = 0;
    }
}

static void write_option_key(struct flash_model *model, uint32_t value)
{
    static const uint32_t keys[2] = {0x08192A3Bu, 0x4C5D6E7Fu};

    if (model->option_keys < 0 || model->option_keys == 2 || (model->cr & CR_LOCK) != 0 ||
        value != keys[model->option_keys]) {
        model->option_keys = -1;
        return;
    }
    if (++model->option_keys == 2) {
        model->cr &= ~(uint32_t)CR_OPTLOCK;
    }
}

static void write_acr(struct flash_model *model, uint32_t value)
{
    MODEL_CHECK((value & ACR_DCEN) == 0 || model->busy == 0 || (model->acr & ACR_DCEN) != 0,
                "the data cache was switched on during an operation");
    if ((value & ACR_DCRST) != 0) {
        MODEL_CHECK((model->acr & ACR_DCEN) == 0 && (value & ACR_DCEN) == 0,
                    "the data cache was reset while on");
        memset(model->in_cache, 0, sizeof model->in_cache);
    }
    model->acr = value;
}

static uint32_t register_read(void *context, uint32_t offset)
{
    struct flash_model *model = context;

    switch (offset) {
    case ACR:
        return model->acr;
    case SR:
        if (model->busy > 0) {
            if (model->busy != UINT32_MAX) {
                model->busy--;
            }
            return model->sr | SR_BSY;
        }
        return model->sr;
    case CR:
        return model->cr;
    case ECCR:
        return model->eccr;
    case OPTR:
        return model->optr;
    default:
        model_misuse("flash register %#x read", offset);
        return 0;
    }
}

static void register_write(void *context, uint32_t offset, uint32_t value)
{
    struct flash_model *model = context;

    switch (offset) {
    case ACR:
        write_acr(model, value);
        break;
    case KEYR:
        write_key(model, value);
        break;
    case OPTKEYR:
        write_option_key(model, value);
        break;
    case OPTR:
        MODEL_CHECK((model->cr & CR_OPTLOCK) == 0, "option bytes were written while locked");
        model->optr_written = value;
        break;
    case SR:
        model->sr &= ~value;
        break;
    case CR:
        if ((value & CR_LOCK) != 0) {
            model->cr |= CR_LOCK | CR_OPTLOCK;
            model->option_keys = 0;
        } else {
            write_cr(model, value);
        }
        break;
    case ECCR:
        model->eccr &= ~(value & (ECCR_ECCD | ECCR_ECCC));
        break;
    default:
        model_misuse("flash register %#x written", offset);
    }
}

void flash_model_failed(struct flash_model *model)
{
    model->eccr |= ECCR_ECCD;
    if (model->nmi != NULL) {
        model->nmi(model->nmi_context);
    }
}

void flash_model_corrected(struct flash_model *model)
{
    model->eccr |= ECCR_ECCC;
}

void flash_model_load_options(struct flash_model *model)
{
    model->optr = model->optr_written = model->optr_stored;
    model->options_wanted = false;
}

static uint32_t memory_read(void *context, uint32_t offset)
{
    struct flash_model *model = context;
    uint32_t page = offset / 2048, index = offset % 2048 / 8;
    uint64_t value = model->word[page][index];

    if ((model->acr & ACR_DCEN) != 0 && model->in_cache[page][index]) {
        value = model->cached[page][index];
    } else if (model->state[page][index] == WORD_TORN && model->torn_raises_nmi) {
        value ^= 0x11;
        flash_model_failed(model);
    } else if (model->state[page][index] == WORD_WEAK) {
        flash_model_corrected(model);
    }
    if ((model->acr & ACR_DCEN) != 0) {
        model->cached[page][index] = value;
        model->in_cache[page][index] = true;
    }
    return (uint32_t)(value >> (8 * (offset & 4)));
}

static void program(struct flash_model *model, uint32_t page, uint32_t index, uint64_t value)
{
    if (model->state[page][index] != WORD_ERASED) {
        model->sr |= SR_PROGERR;
        return;
    }
    if (power_fails(model)) {
        /* Some of the bits that go to 0 are there. */
        model->word[page][index] = value | 0xA5C3000000F00F81u;
        model->state[page][index] = WORD_TORN;
    } else {
        model->word[page][index] = value;
        model->state[page][index] = WORD_WRITTEN;
    }
    begin(model, MODEL_PROGRAM_NS, page);
}

void flash_model_store(struct flash_model *model, uint32_t offset, uint32_t value)
{
    if (model->power_off) {
        return;
    }
    if ((model->cr & (CR_LOCK | CR_PG)) != CR_PG || (model->sr & SR_ERRORS) != 0) {
        model->sr |= SR_PGSERR;
        return;
    }
    if (!model->half_written) {
        if ((offset & 4) != 0) {
            model->sr |= SR_PGAERR;
            return;
        }
        model->half_written = true;
        model->half_address = offset;
        model->half_value = value;
        return;
    }
    model->half_written = false;
    if (offset != model->half_address + 4) {
        model->sr |= SR_PGAERR;
        return;
    }
    program(model, offset / 2048, offset % 2048 / 8, ((uint64_t)value << 32) | model->half_value);
    tell_change(model, offset / 2048, offset % 2048 / 8, 1);
}

static void memory_write(void *context, uint32_t offset, uint32_t value)
{
    flash_model_store(context, offset, value);
}

void flash_model_power_up(struct flash_model *model)
{
    model->acr = 0x00040601; /* both caches on */
    model->cr = 0xC0000000;  /* locked */
    model->sr = 0;
    model->eccr = 0;
    model->keys = model->option_keys = 0;
    model->optr_written = model->optr;
    model->busy = 0;
    model->half_written = false;
    model->power_off = false;
    model->power_fails_at = UINT32_MAX;
    memset(model->in_cache, 0, sizeof model->in_cache);
}

void flash_model_init(struct flash_model *model)
{
    memset(model, 0, sizeof *model);
    memset(model->word, 0xFF, sizeof model->word);
    model->optr_stored = MODEL_OPTIONS_DELIVERED;
    flash_model_load_options(model);
    model->busy_time = 20;
    model->torn_raises_nmi = true;
    model->first_page = MODEL_STORE_PAGE;
    flash_model_power_up(model);
    mmio_model_map(0x40022000, 0x78, register_read, register_write, model);
    mmio_model_map(0x08000000, MODEL_PAGES * 2048, memory_read, memory_write, model);
}
