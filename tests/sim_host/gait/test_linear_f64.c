/* Eigenvalues of matrices built from known ones, S diag S^-1. */
#include <math.h>

#include "sim_host/gait/linear.h"
#include "tests/model/walkers.h"

/* A = S D S^-1 with D given as a block matrix. */
static void build(unsigned long long *seed, const double D[3][3], double A[3][3])
{
    double S[3][3], inverse[3][3], det;
    do {
        for (int i = 0; i < 9; i++) {
            S[i / 3][i % 3] = draw(seed, -1.0, 1.0);
        }
        det = linear_determinant3((const double(*)[3])S, 0.0);
    } while (fabs(det) < 0.3);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            inverse[i][j] = (S[a][c] * S[b][d] - S[a][d] * S[b][c]) / det;
        }
    }
    linear_multiply3((const double(*)[3])S, D, A);
    linear_multiply3((const double(*)[3])A, (const double(*)[3])inverse, A);
}

START_TEST(real_eigenvalues)
{
    unsigned long long seed = 11;
    for (int i = 0; i < 2000; i++) {
        const double a = draw(&seed, -3, 3), b = draw(&seed, -1, 1) * fabs(a);
        const double D[3][3] = {{a, 0, 0}, {0, b, 0}, {0, 0, 0}};
        double A[3][3];
        struct eigenvalue v[3];
        build(&seed, D, A);
        linear_eigenvalues3((const double(*)[3])A, v);
        if (fabs(a - b) < 0.05) { /* close ones are ill conditioned */
            continue;
        }
        assert_close(v[0].re, a, 1e-12, 0.0);
        assert_close(v[1].re, b, 1e-12, 0.0);
        assert_close(v[2].re, 0.0, 1e-12, 0.0);
        ck_assert(v[0].im == 0.0 && v[1].im == 0.0 && v[2].im == 0.0);
    }
}
END_TEST

START_TEST(complex_pairs)
{
    unsigned long long seed = 12;
    for (int i = 0; i < 2000; i++) {
        const double a = draw(&seed, -1, 1), b = draw(&seed, 0.1, 1), c = draw(&seed, -2, 2);
        const double D[3][3] = {{a, b, 0}, {-b, a, 0}, {0, 0, c}};
        double A[3][3];
        struct eigenvalue v[3];
        build(&seed, D, A);
        linear_eigenvalues3((const double(*)[3])A, v);
        const int pair = fabs(c) > hypot(a, b) ? 1 : 0;
        assert_close(v[pair].re, a, 2e-11, 0.0);
        assert_close(v[pair].im, b, 2e-11, 0.0);
        assert_close(v[pair + 1].im, -b, 2e-11, 0.0);
        assert_close(v[pair ? 0 : 2].re, c, 2e-11, 0.0);
    }
}
END_TEST

START_TEST(two_zeros_come_out_as_zeros)
{
    unsigned long long seed = 13;
    for (int i = 0; i < 2000; i++) {
        double A[3][3], p[3], q[3], dot = 0.0;
        struct eigenvalue v[3];
        for (int k = 0; k < 3; k++) {
            p[k] = draw(&seed, -1, 1);
            q[k] = draw(&seed, -1, 1);
            dot += p[k] * q[k];
        }
        for (int k = 0; k < 9; k++) {
            A[k / 3][k % 3] = p[k / 3] * q[k % 3];
        }
        if (fabs(dot) < 0.05) {
            continue;
        }
        linear_eigenvalues3((const double(*)[3])A, v);
        assert_close(v[0].re, dot, 1e-14, 1e-13);
        ck_assert(linear_magnitude(v[1]) < 1e-13 && linear_magnitude(v[2]) < 1e-13);
    }
}
END_TEST

START_TEST(eigenvectors)
{
    const double A[3][3] = {{2, 1, 0}, {0, -1, 3}, {0, 0, 0.5}};
    const double values[3] = {2, -1, 0.5};
    for (int k = 0; k < 3; k++) {
        double v[3];
        linear_eigenvector3(A, values[k], v);
        for (int i = 0; i < 3; i++) {
            const double moved = A[i][0] * v[0] + A[i][1] * v[1] + A[i][2] * v[2];
            assert_close(moved, values[k] * v[i], 1e-14, 0.0);
        }
    }
}
END_TEST

START_TEST(singular_systems_are_told)
{
    const double singular[4][4] = {{1, 2, 0, 0}, {2, 4, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    const double good[4][4] = {{0, 2, 0, 0}, {2, 4, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    const double b[4] = {2, 8, 3, 4};
    double x[4];
    ck_assert(!linear_solve(4, singular, b, x));
    ck_assert(linear_solve(4, good, b, x));
    ck_assert(x[0] == 2.0 && x[1] == 1.0 && x[2] == 3.0 && x[3] == 4.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("linear");
    TCase *tests = tcase_create("linear");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, real_eigenvalues);
    tcase_add_test(tests, complex_pairs);
    tcase_add_test(tests, two_zeros_come_out_as_zeros);
    tcase_add_test(tests, eigenvectors);
    tcase_add_test(tests, singular_systems_are_told);
    return run_suite(suite);
}
