/* Sine, cosine and inverse cosine with the same bits on every machine.
 *
 * libm's results differ between newlib, glibc and CPU types in the last bit;
 * a walk that is period-doubling or chaotic turns that bit into another gait.
 * These use only + - * / and sqrt, which IEEE 754 rounds the same everywhere.
 *
 * Range: sine and cosine for |x| <= 1e4 rad (beyond: still finite, less exact);
 * a non-finite x gives NaN. acos clamps its argument to [-1, 1].
 * Error: at most 1.5 units in the last place on |x| <= 2*pi.
 * Callable from anywhere; constant cost (tens of instructions), no branches
 * that depend on more than the quadrant.
 */
#ifndef MODEL_TRIG_H
#define MODEL_TRIG_H

#include "model/real.h"

float trig_sin_f32(float x_rad);
float trig_cos_f32(float x_rad);
float trig_acos_f32(float x);
double trig_sin_f64(double x_rad);
double trig_cos_f64(double x_rad);
double trig_acos_f64(double x);

/* Both at once, for the price of little more than one. */
void trig_sincos_f32(float x_rad, float *sin_x, float *cos_x);
void trig_sincos_f64(double x_rad, double *sin_x, double *cos_x);

#define real_sin REAL_SYMBOL(trig_sin)
#define real_cos REAL_SYMBOL(trig_cos)
#define real_acos REAL_SYMBOL(trig_acos)
#define real_sincos REAL_SYMBOL(trig_sincos)

#endif
