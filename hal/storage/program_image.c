#include "hal/storage/program_image.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/storage/crc.h"

enum {
    HEADER_WORDS = sizeof(struct program_header) / PROGRAM_WORD_BYTES,
    CRC_OFFSET = PROGRAM_HEADER_OFFSET + offsetof(struct program_header, crc),
    CRC_WORD = CRC_OFFSET - 4, /* the word whose second half the CRC is */
    LEAST_BYTES = PROGRAM_HEADER_OFFSET + sizeof(struct program_header)
};
static_assert(sizeof(struct program_header) == 32 && CRC_WORD % PROGRAM_WORD_BYTES == 0,
              "the CRC is the second half of a word");

static bool read_header(struct program_scan *scan, const struct program_memory *memory)
{
    uint8_t bytes[sizeof(struct program_header)];
    struct program_header *header = &scan->header;

    for (uint32_t i = 0; i < HEADER_WORDS; i++) {
        if (!memory->read(memory->context,
                          scan->base + PROGRAM_HEADER_OFFSET + i * PROGRAM_WORD_BYTES,
                          bytes + i * PROGRAM_WORD_BYTES)) {
            return false;
        }
    }
    header->magic = bytes_get_u32(bytes);
    header->hardware = bytes_get_u32(bytes + 4);
    header->version = bytes_get_u32(bytes + 8);
    header->build_id = bytes_get_u32(bytes + 12);
    header->length = bytes_get_u32(bytes + 16);
    header->crc = bytes_get_u32(bytes + offsetof(struct program_header, crc));
    return true;
}

static enum program_verdict judge_header(const struct program_header *header, uint32_t room,
                                         uint32_t hardware)
{
    if (header->magic != (uint32_t)PROGRAM_MAGIC) {
        return PROGRAM_NO_HEADER;
    }
    if (header->length < LEAST_BYTES || header->length > room ||
        header->length % PROGRAM_WORD_BYTES != 0U) {
        return PROGRAM_BAD_LENGTH;
    }
    return header->hardware == hardware ? PROGRAM_GOOD : PROGRAM_OTHER_HARDWARE;
}

void program_scan_begin(struct program_scan *scan, const struct program_memory *memory,
                        uint32_t base, uint32_t room, uint32_t hardware)
{
    memset(scan, 0, sizeof *scan);
    scan->base = base;
    scan->crc = CRC32_INIT;
    scan->verdict =
        read_header(scan, memory) ? judge_header(&scan->header, room, hardware) : PROGRAM_TORN;
    scan->done = scan->verdict != PROGRAM_GOOD;
}

void program_scan_go_on(struct program_scan *scan, const struct program_memory *memory,
                        uint32_t words)
{
    uint8_t word[PROGRAM_WORD_BYTES];

    for (uint32_t i = 0; i < words && !scan->done; i++) {
        if (!memory->read(memory->context, scan->base + scan->at, word)) {
            scan->verdict = PROGRAM_TORN;
            scan->done = true;
            return;
        }
        scan->crc = crc32_update(scan->crc, word,
                                 scan->at == (uint32_t)CRC_WORD ? sizeof word / 2 : sizeof word);
        scan->at += PROGRAM_WORD_BYTES;
        if (scan->at >= scan->header.length) {
            scan->verdict = scan->crc == scan->header.crc ? PROGRAM_GOOD : PROGRAM_TORN;
            scan->done = true;
        }
    }
}

enum program_verdict program_check(const struct program_memory *memory, uint32_t base,
                                   uint32_t room, uint32_t hardware, struct program_header *header)
{
    struct program_scan scan;

    program_scan_begin(&scan, memory, base, room, hardware);
    program_scan_go_on(&scan, memory, room / PROGRAM_WORD_BYTES);
    *header = scan.header;
    return scan.verdict;
}
