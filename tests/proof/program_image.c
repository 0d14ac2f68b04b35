/* The program's header and the check of its image, over a memory that reads as anything. */
#include "hal/storage/program_image.h"
#include "tests/proof/arbitrary.h"

static bool read(void *context, uint32_t address, uint8_t *out)
{
    (void)context;
    (void)address;
    any_bytes(out, PROGRAM_WORD_BYTES);
    return any_bool();
}

void proof_program_image(void)
{
    const struct program_memory memory = {.read = read, .page_bytes = any_u32};
    static struct program_scan scan;
    static struct program_header header;
    (void)program_check(&memory, any_u32, any_u32, any_u32, &header);
    for (;;) {
        program_scan_begin(&scan, &memory, any_u32, any_u32, any_u32);
        while (any_bool()) {
            program_scan_go_on(&scan, &memory, any_u32);
        }
    }
}
