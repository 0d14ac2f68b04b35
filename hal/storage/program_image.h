/* What stands at the beginning of a program in flash, and how one is known to be whole.
 *
 * The header follows the vector table, at PROGRAM_HEADER_OFFSET of the image. scripts/seal-image
 * fills in length, version and CRC when the image is linked. A program whose header or CRC is not
 * right does not run: its writing was cut short, or its memory has changed.
 *
 * The CRC finds accidents. It is no signature: whoever can send an image can make one that passes.
 */
#ifndef HAL_STORAGE_PROGRAM_IMAGE_H
#define HAL_STORAGE_PROGRAM_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

enum {
    PROGRAM_MAGIC = 0x474D4941, /* "AIMG" in memory order */
    PROGRAM_HEADER_OFFSET = 0x200,
    PROGRAM_WORD_BYTES = 8,
    /* Boards by number; the values appear in images and never change meaning. */
    PROGRAM_HARDWARE_NUCLEO_G474RE = 0x0001
};

struct program_header {
    uint32_t magic;
    uint32_t hardware; /* the board that it is for */
    uint32_t version;  /* major << 16 | minor << 8 | patch: a greater number is newer */
    uint32_t build_id;
    uint32_t length; /* of the image in bytes, a multiple of PROGRAM_WORD_BYTES */
    uint32_t reserved[2];
    uint32_t crc; /* CRC-32 of the image without these four bytes */
};

enum program_verdict {
    PROGRAM_GOOD = 0,
    PROGRAM_NO_HEADER = -1,      /* erased, or something else */
    PROGRAM_BAD_LENGTH = -2,     /* none, more than there is room for, or in the middle of a word */
    PROGRAM_OTHER_HARDWARE = -3, /* for another board */
    PROGRAM_TORN = -4            /* the CRC is another, or the memory's error correction gave up */
};

/* Memory that holds programs; addresses are the chip's. */
struct program_memory {
    /* Reads the 8 bytes at `address`; false when the error correction gave up. */
    bool (*read)(void *context, uint32_t address, uint8_t *out);
    /* Erases the page that begins at `address`; false when refused. */
    bool (*erase)(void *context, uint32_t address);
    /* Writes 8 erased bytes once; false when refused. */
    bool (*write)(void *context, uint32_t address, const uint8_t *word);
    void *context;
    uint32_t page_bytes;
};

/* A look through an image, a part at a time. */
struct program_scan {
    uint32_t base, at;
    uint32_t crc;
    struct program_header header;
    enum program_verdict verdict;
    bool done;
};

/* Begins: reads the header at `base` and judges it. `room` is what there is, in bytes. With a bad
 * header the scan is done at once. Below 1,000 instructions. */
void program_scan_begin(struct program_scan *scan, const struct program_memory *memory,
                        uint32_t base, uint32_t room, uint32_t hardware);

/* Goes on by `words` words of 8 bytes; then `done` says whether it is through, and `verdict` what
 * it found. About 130 instructions a word. */
void program_scan_go_on(struct program_scan *scan, const struct program_memory *memory,
                        uint32_t words);

/* All of it at once: 16 instructions a byte. *header is what was read, also when it is bad. */
enum program_verdict program_check(const struct program_memory *memory, uint32_t base,
                                   uint32_t room, uint32_t hardware, struct program_header *header);

#endif
