/* Small dense linear algebra: what orbits and branches of a three-state map need. */
#ifndef SIM_HOST_GAIT_LINEAR_H
#define SIM_HOST_GAIT_LINEAR_H

#define LINEAR_MAX 4

struct eigenvalue {
    double re, im;
};

/* Solves A x = b, n <= LINEAR_MAX, by elimination with row exchange; A and b are not changed.
 * Returns 0 when A is singular to rounding or not finite (x is then undefined), else 1. */
int linear_solve(int n, const double A[LINEAR_MAX][LINEAR_MAX], const double *b, double *x);

/* The determinant of a 3 x 3 matrix with `shift` added to its diagonal. */
double linear_determinant3(const double A[3][3], double shift);

/* The three eigenvalues of a real matrix, largest magnitude first, of a complex pair the one with im > 0
 * first. One real eigenvalue is split off by an orthogonal transformation, so that zeros (simple or
 * double) come out to rounding and not to its root. */
void linear_eigenvalues3(const double A[3][3], struct eigenvalue values[3]);

/* The unit vector of A's real eigenvalue nearest to `value` (inverse iteration); its largest entry is > 0. */
void linear_eigenvector3(const double A[3][3], double value, double vector[3]);

/* product = A B. */
void linear_multiply3(const double A[3][3], const double B[3][3], double product[3][3]);

double linear_magnitude(struct eigenvalue value);

#endif
