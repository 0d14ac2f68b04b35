/* A march test of RAM: finds cells that are stuck, that do not change, or that change with another.
 *
 * March C- (van de Goor, "Using March Tests to Test SRAMs", IEEE Design and Test of Computers 10(1),
 * 1993), a test of variable memory in the sense of IEC 60730-1, annex H, class B: up write 0; up read
 * 0 write 1; up read 1 write 0; down read 0 write 1; down read 1 write 0; up read 0. Words stand for
 * cells; it runs with two patterns, so that neighbours within a word differ once.
 */
#ifndef HAL_RAM_MARCH_H
#define HAL_RAM_MARCH_H

#include <stdbool.h>
#include <stdint.h>

/* How a word is reached; on the target these vanish into loads and stores. */
struct ram_march_access {
    uint32_t (*read)(uint32_t address);
    void (*write)(uint32_t address, uint32_t value);
};

/* Reads `expected` and writes `next` at every word. Returns the address of the first that is not as
 * expected, 0 when all are. */
static inline uint32_t ram_march_element(const struct ram_march_access *access, uint32_t begin,
                                         uint32_t words, bool down, uint32_t expected,
                                         uint32_t next)
{
    for (uint32_t i = 0; i < words; i++) {
        const uint32_t address = begin + 4U * (down ? words - 1U - i : i);
        if (access->read(address) != expected) {
            return address;
        }
        access->write(address, next);
    }
    return 0;
}

/* Tests `words` words from `begin` (not 0), and leaves them 0. Returns the address of the first that
 * failed, 0 when none did. Nothing else may use them meanwhile. 22 accesses a word. Start-up only. */
static inline uint32_t ram_march(const struct ram_march_access *access, uint32_t begin,
                                 uint32_t words)
{
    static const uint32_t patterns[] = {0x55555555U, 0x00000000U};
    uint32_t failed = 0;

    for (uint32_t i = 0; i < 2U && failed == 0U; i++) {
        const uint32_t zero = patterns[i], one = ~patterns[i];
        for (uint32_t word = 0; word < words; word++) {
            access->write(begin + 4U * word, zero);
        }
        for (uint32_t element = 0; element < 4U && failed == 0U; element++) {
            const bool rises = element % 2U == 0U;
            failed = ram_march_element(access, begin, words, element >= 2U, rises ? zero : one,
                                       rises ? one : zero);
        }
        failed = failed == 0U ? ram_march_element(access, begin, words, false, zero, zero) : failed;
    }
    return failed;
}

#endif
