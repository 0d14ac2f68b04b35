/* memset for this processor: newlib's takes three times as long, and clearing the
 * observer's 4 KB falls into a tick. */
#include <stddef.h>
#include <stdint.h>

void *memset(void *start, int value, size_t length);

/* Stores eight words at a time; `blocks` > 0. Returns where it stopped. */
static uint32_t *fill_blocks(uint32_t *at, uint32_t word, uint32_t blocks)
{
    __asm volatile("mov r3, %[word]\n"
                   "mov r4, %[word]\n"
                   "mov r5, %[word]\n"
                   "mov r6, %[word]\n"
                   "1: stmia %[at]!, {r3, r4, r5, r6}\n"
                   "stmia %[at]!, {r3, r4, r5, r6}\n"
                   "subs %[blocks], %[blocks], #1\n"
                   "bne 1b\n"
                   : [at] "+r"(at), [blocks] "+r"(blocks)
                   : [word] "r"(word)
                   : "r3", "r4", "r5", "r6", "cc", "memory");
    return at;
}

void *memset(void *start, int value, size_t length)
{
    volatile uint8_t *byte = start; /* volatile: the compiler must not make it a memset */
    const uint32_t pattern = (uint32_t)(uint8_t)value * 0x01010101u;

    while (length > 0 && ((uintptr_t)byte & 3u) != 0u) {
        *byte++ = (uint8_t)value;
        length--;
    }
    if (length >= 32) {
        byte = (volatile uint8_t *)fill_blocks((uint32_t *)(uintptr_t)byte, pattern, length / 32);
        length %= 32;
    }
    for (; length >= 4; length -= 4, byte += 4) {
        *(volatile uint32_t *)(uintptr_t)byte = pattern;
    }
    for (; length > 0; length--) {
        *byte++ = (uint8_t)value;
    }
    return start;
}
