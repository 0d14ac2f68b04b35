/* What the analyser is told of the compiler's own functions; included ahead of every source.
 *
 * The square root may be any float: no proof relies on its value. A trap is an assertion that
 * failed: a proof must show that none is reached.
 */
#ifndef TESTS_PROOF_COMPILER_H
#define TESTS_PROOF_COMPILER_H

/*@ assigns \result \from x; */
extern float __builtin_sqrtf(float x);
/*@ requires never_reached: \false;
    assigns \nothing;
    ensures \false; */
extern void __builtin_trap(void);

#endif
