/* HAL_ASSERT: a caller's error, which no return code can mend.
 *
 * A broken contract traps where it is noticed: on the target that is a fault, whose
 * handler keeps the address in the crash record and leaves the drives to their own
 * unloading; on a host the process ends with SIGILL or SIGTRAP and a debugger shows the line.
 * No text, no library, no state. What the world does wrong (frames, sensors,
 * parameters from outside) gets a return code instead, never this.
 *
 * A build may define HAL_ASSERT(condition) itself, for all files alike.
 */
#ifndef HAL_CONTRACT_H
#define HAL_CONTRACT_H

#ifndef HAL_ASSERT
#define HAL_ASSERT(condition) \
    do {                      \
        if (!(condition)) {   \
            __builtin_trap(); \
        }                     \
    } while (0)
#endif

#endif
