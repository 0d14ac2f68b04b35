/* The number type of model/ and controller/: one source, two precisions.
 *
 * The controller flies float32 (the Cortex-M4F has no double unit, and the same
 * frames must give the same commands on every machine); studies of the return
 * map need double. Each source file is compiled once per precision, chosen by
 * defining REAL_IS_DOUBLE for the whole compilation. Public functions are
 * renamed with a suffix, so that both live in one program and a caller compiled
 * for the other precision fails to link instead of passing wrong structs.
 */
#ifndef MODEL_REAL_H
#define MODEL_REAL_H

#ifdef REAL_IS_DOUBLE
typedef double real;
#define REAL(literal) literal
#define REAL_SYMBOL(name) name##_f64
#define REAL_EPSILON 2.220446049250313e-16
#define REAL_LARGEST 1.7976931348623157e308
#else
typedef float real;
#define REAL(literal) literal##f
#define REAL_SYMBOL(name) name##_f32
#define REAL_EPSILON 1.1920929e-7f
#define REAL_LARGEST 3.40282347e38f
#endif

#define REAL_PI REAL(3.14159265358979323846)
#define REAL_HALF_PI REAL(1.57079632679489661923)

/* Square root, correctly rounded by IEEE 754 on every target; one instruction
 * where the unit has it (-fno-math-errno). x >= 0; a negative x gives NaN. */
static inline real real_sqrt(real x)
{
#ifdef REAL_IS_DOUBLE
    return __builtin_sqrt(x);
#else
    return __builtin_sqrtf(x);
#endif
}

static inline real real_abs(real x)
{
    return x < REAL(0.0) ? -x : x;
}

static inline real real_clamp(real x, real low, real high)
{
    return x < low ? low : (x > high ? high : x);
}

/* 1 when x is from low to high, 0 when it is outside or NaN. The analyser of `make prove` leaves NaN
 * out where x equals itself, and not by the other comparisons. */
#ifdef PROOF_BY_WP /* the other analyser takes its contract for wrong where x is not a number */
/*@ assigns \nothing;
    ensures wp_is_within: \result != 0 <==> \ge_float(x, low) && \le_float(x, high); */
#endif
static inline int real_is_within(real x, real low, real high)
{
    return x == x && x >= low && x <= high;
}

/* 1 for every finite x, 0 for infinities and NaN, without <math.h>. */
static inline int real_is_finite(real x)
{
    return x == x && x >= -REAL_LARGEST && x <= REAL_LARGEST;
}

#endif
