/* memset and memcpy for this processor: newlib's take three times as long, and clearing the
 * observer's 4 KB, or copying them into a snapshot, falls into a tick. memmove because newlib's takes
 * 256 bytes of flash for the few short moves there are. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

void *memset(void *start, int value, size_t length);
void *memcpy(void *restrict target, const void *restrict source, size_t length);
void *memmove(void *target, const void *source, size_t length);

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

/* Copies eight words at a time; `blocks` > 0. */
static void copy_blocks(uint32_t *to, const uint32_t *from, uint32_t blocks)
{
    __asm volatile("1: ldmia %[from]!, {r3, r4, r5, r6, r8, r9, r10, r12}\n"
                   "stmia %[to]!, {r3, r4, r5, r6, r8, r9, r10, r12}\n"
                   "subs %[blocks], %[blocks], #1\n"
                   "bne 1b\n"
                   : [to] "+r"(to), [from] "+r"(from), [blocks] "+r"(blocks)
                   :
                   : "r3", "r4", "r5", "r6", "r8", "r9", "r10", "r12", "cc", "memory");
}

void *memcpy(void *restrict target, const void *restrict source, size_t length)
{
    volatile uint8_t *to = target; /* volatile as above */
    const uint8_t *from = source;

    if (length >= 32 && (((uintptr_t)to | (uintptr_t)from) & 3u) == 0u) {
        const size_t most = length / 32 * 32;
        copy_blocks((uint32_t *)(uintptr_t)to, (const uint32_t *)(uintptr_t)from,
                    (uint32_t)(length / 32));
        to += most;
        from += most;
        length -= most;
    }
    for (; length >= 4; length -= 4, to += 4, from += 4) { /* the processor bears words anywhere */
        uint32_t word;
        __asm volatile("ldr %[word], [%[from]]" : [word] "=r"(word) : [from] "r"(from) : "memory");
        __asm volatile("str %[word], [%[to]]" : : [word] "r"(word), [to] "r"(to) : "memory");
    }
    for (; length > 0; length--) {
        *to++ = *from++;
    }
    return target;
}

/* Moves of whole words at word addresses go word by word; nothing here moves more than a
 * few dozen bytes. */
void *memmove(void *target, const void *source, size_t length)
{
    const size_t unit =
        (((uintptr_t)target | (uintptr_t)source | length) & 3u) == 0u ? sizeof(uint32_t) : 1u;
    const bool forward = (uintptr_t)target <= (uintptr_t)source;

    for (size_t done = 0; done < length; done += unit) {
        const size_t at = forward ? done : length - unit - done;
        volatile uint8_t *to = (uint8_t *)target + at; /* volatile as above */
        const uint8_t *from = (const uint8_t *)source + at;
        if (unit == 1u) {
            *to = *from;
        } else {
            *(volatile uint32_t *)(uintptr_t)to = *(const uint32_t *)(uintptr_t)from;
        }
    }
    return target;
}
