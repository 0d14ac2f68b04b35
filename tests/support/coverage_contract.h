/* Included by force where coverage is measured: a broken contract traps before the counters
 * of its process are written, so they are written first. */
#ifndef TESTS_SUPPORT_COVERAGE_CONTRACT_H
#define TESTS_SUPPORT_COVERAGE_CONTRACT_H

void __gcov_dump(void);

#define HAL_ASSERT(condition) \
    do {                      \
        if (!(condition)) {   \
            __gcov_dump();    \
            __builtin_trap(); \
        }                     \
    } while (0)

#endif
