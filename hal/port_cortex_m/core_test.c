#include "hal/port_cortex_m/core_test.h"

/* A block of instructions ends between writing and comparing: in an emulator a fault can come there. */
#define NEXT_BLOCK "b 1f\n1:\n"

/* DDI 0403, A5.3.2: both patterns are immediate operands. */
#define EACH_HOLDS(pattern)                                                         \
    ".irp reg, r0,r1,r2,r3,r4,r5,r6,r7,r8,r9,r10,r11,r12,lr\n"                      \
    "mov.w \\reg, #" pattern "\n"                                                   \
    ".endr\n" NEXT_BLOCK ".irp reg, r0,r1,r2,r3,r4,r5,r6,r7,r8,r9,r10,r11,r12,lr\n" \
    "cmp.w \\reg, #" pattern "\n"                                                   \
    "bne 9f\n"                                                                      \
    ".endr\n"

/* The upper bits of a word to the flags or to the mask, and back. */
#define SPECIAL_HOLDS(written, read, value, mask)                   \
    "mov.w r0, #" value "\nmsr " written ", r0\nmrs r1, " read "\n" \
    "and.w r1, r1, #" mask "\ncmp.w r1, #" value "\nbne 9f\n"

__attribute__((naked)) uint32_t core_test_registers(void)
{
    __asm volatile("push {r4-r11, lr}\n" EACH_HOLDS("0x55555555") EACH_HOLDS("0xAAAAAAAA")
                       SPECIAL_HOLDS("apsr_nzcvq", "apsr", "0x50000000", "0xF8000000")
                           SPECIAL_HOLDS("apsr_nzcvq", "apsr", "0xA8000000", "0xF8000000")
                               SPECIAL_HOLDS("basepri", "basepri", "0x50", "0xF0") SPECIAL_HOLDS(
                                   "basepri", "basepri", "0xA0", "0xF0") "movs r0, #0\n"
                                                                         "8: movs r1, #0\n"
                                                                         "msr basepri, r1\n"
                                                                         "pop {r4-r11, pc}\n"
                                                                         "9: movs r0, #1\n"
                                                                         "b 8b\n");
}

#define FLOATS_HOLD(pattern, numbers)            \
    "mov.w r0, #" pattern "\n"                   \
    ".irp n, " numbers "\n"                      \
    "vmov s\\n, r0\n"                            \
    ".endr\n" NEXT_BLOCK ".irp n, " numbers "\n" \
    "vmov r1, s\\n\n"                            \
    "cmp.w r1, #" pattern "\n"                   \
    "bne 9f\n"                                   \
    ".endr\n"
#define LOW "0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15"
#define HIGH "16,17,18,19,20,21,22,23,24,25,26,27,28,29,30,31"

__attribute__((naked)) uint32_t core_test_low_floats(void)
{
    __asm volatile(FLOATS_HOLD("0x55555555", LOW) FLOATS_HOLD("0xAAAAAAAA", LOW) "movs r0, #0\n"
                                                                                 "bx lr\n"
                                                                                 "9: movs r0, #1\n"
                                                                                 "bx lr\n");
}

__attribute__((naked)) uint32_t core_test_high_floats(void)
{
    __asm volatile("vpush {s16-s31}\n" FLOATS_HOLD("0x55555555", HIGH)
                       FLOATS_HOLD("0xAAAAAAAA", HIGH) "movs r0, #0\n"
                                                       "8: vpop {s16-s31}\n"
                                                       "bx lr\n"
                                                       "9: movs r0, #1\n"
                                                       "b 8b\n");
}

#define WRITE(value)                                 \
    "str " value ", [r0]\nstr " value ", [r0, #4]\n" \
    "str " value ", [r0, #8]\nstr " value ", [r0, #12]\n"
#define READ_WRITE_AT(offset, expected, next)                   \
    "ldr r3, [r0, #" offset "]\ncmp r3, " expected "\nbne 9f\n" \
    "str " next ", [r0, #" offset "]\n"
#define UP(expected, next)             \
    READ_WRITE_AT("0", expected, next) \
    READ_WRITE_AT("4", expected, next) \
    READ_WRITE_AT("8", expected, next) READ_WRITE_AT("12", expected, next)
#define DOWN(expected, next)            \
    READ_WRITE_AT("12", expected, next) \
    READ_WRITE_AT("8", expected, next)  \
    READ_WRITE_AT("4", expected, next) READ_WRITE_AT("0", expected, next)
#define MARCH \
    WRITE("r1") UP("r1", "r2") UP("r2", "r1") DOWN("r1", "r2") DOWN("r2", "r1") UP("r1", "r1")

__attribute__((naked)) uint32_t core_test_ram(uint32_t *at)
{
    (void)at;
    __asm volatile("push {r4-r7, lr}\n"
                   "ldm r0, {r4-r7}\n"
                   "mov.w r12, #1\n"
                   "mov.w r1, #0x55555555\n"
                   "mvn r2, r1\n" MARCH "mov.w r1, #0\n"
                   "mvn r2, r1\n" MARCH "mov.w r12, #0\n"
                   "9: stm r0, {r4-r7}\n"
                   "mov r0, r12\n"
                   "pop {r4-r7, pc}\n");
}
