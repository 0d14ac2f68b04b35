#include "sim_host/gait/linear.h"

#include "model/real.h"

int linear_solve(int n, const double A[LINEAR_MAX][LINEAR_MAX], const double *b, double *x)
{
    double a[LINEAR_MAX][LINEAR_MAX + 1] = {{0.0}};
    double size = 0.0;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            a[i][j] = A[i][j];
            size = real_abs(A[i][j]) > size ? real_abs(A[i][j]) : size;
        }
        a[i][n] = b[i];
    }
    for (int c = 0; c < n; c++) {
        int p = c;
        for (int i = c + 1; i < n; i++) {
            p = real_abs(a[i][c]) > real_abs(a[p][c]) ? i : p;
        }
        if (!(real_abs(a[p][c]) > 1e-15 * size)) {
            return 0;
        }
        for (int k = c; k <= n; k++) {
            const double t = a[c][k];
            a[c][k] = a[p][k];
            a[p][k] = t;
        }
        for (int i = c + 1; i < n; i++) {
            const double q = a[i][c] / a[c][c];
            for (int k = c; k <= n; k++) {
                a[i][k] -= q * a[c][k];
            }
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        double sum = a[i][n];
        for (int j = i + 1; j < n; j++) {
            sum -= a[i][j] * x[j];
        }
        x[i] = sum / a[i][i];
        if (!real_is_finite(x[i])) {
            return 0;
        }
    }
    return 1;
}

double linear_determinant3(const double A[3][3], double shift)
{
    const double a = A[0][0] + shift, b = A[1][1] + shift, c = A[2][2] + shift;
    return a * (b * c - A[1][2] * A[2][1]) - A[0][1] * (A[1][0] * c - A[1][2] * A[2][0]) +
           A[0][2] * (A[1][0] * A[2][1] - b * A[2][0]);
}

void linear_multiply3(const double A[3][3], const double B[3][3], double product[3][3])
{
    double c[3][3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            c[i][j] = A[i][0] * B[0][j] + A[i][1] * B[1][j] + A[i][2] * B[2][j];
        }
    }
    for (int i = 0; i < 9; i++) {
        product[i / 3][i % 3] = c[i / 3][i % 3];
    }
}

double linear_magnitude(struct eigenvalue value)
{
    return real_sqrt(value.re * value.re + value.im * value.im);
}

/* The real root of t^3 - trace t^2 + minors t - det that lies furthest out. */
static double outer_real_root(const double A[3][3])
{
    const double trace = A[0][0] + A[1][1] + A[2][2];
    const double minors = A[0][0] * A[1][1] - A[0][1] * A[1][0] + A[0][0] * A[2][2] -
                          A[0][2] * A[2][0] + A[1][1] * A[2][2] - A[1][2] * A[2][1];
    const double det = linear_determinant3(A, 0.0);
    const double bound = 1.0 + real_abs(trace) + real_abs(minors) + real_abs(det);
    double best = 0.0;
    int found = 0;
    /* From beyond either end Newton falls monotonically on the outermost root of that side. */
    for (int side = -1; side <= 1; side += 2) {
        double t = side * bound;
        for (int i = 0; i < 200; i++) {
            const double value = ((t - trace) * t + minors) * t - det;
            const double slope = (3.0 * t - 2.0 * trace) * t + minors;
            const double next = slope != 0.0 ? t - value / slope : t;
            if (!(real_abs(next - t) > 1e-16 * real_abs(t))) {
                break;
            }
            t = next;
        }
        const double value = ((t - trace) * t + minors) * t - det;
        if (real_abs(value) <= 1e-9 * (1.0 + real_abs(t * t * t)) &&
            (!found || real_abs(t) > real_abs(best))) {
            best = t;
            found = 1;
        }
    }
    return best;
}

static void normalise(double v[3])
{
    int largest = 0;
    for (int i = 1; i < 3; i++) {
        largest = real_abs(v[i]) > real_abs(v[largest]) ? i : largest;
    }
    const double s = v[largest];
    double size = 0.0;
    for (int i = 0; i < 3; i++) {
        v[i] /= s;
        size += v[i] * v[i];
    }
    for (int i = 0; i < 3; i++) {
        v[i] /= real_sqrt(size);
    }
}

void linear_eigenvector3(const double A[3][3], double value, double vector[3])
{
    double size = 1e-300;
    for (int i = 0; i < 9; i++) {
        size = real_abs(A[i / 3][i % 3]) > size ? real_abs(A[i / 3][i % 3]) : size;
    }
    vector[0] = 0.6;
    vector[1] = 0.48;
    vector[2] = 0.64;
    for (int i = 0; i < 4; i++) {
        double a[LINEAR_MAX][LINEAR_MAX] = {{0.0}}, x[3] = {vector[0], vector[1], vector[2]};
        for (int k = 0; k < 9; k++) {
            a[k / 3][k % 3] = A[k / 3][k % 3];
        }
        double shift = value;
        for (int attempt = 1;;
             attempt++) { /* off the eigenvalue by as little as keeps it regular */
            for (int k = 0; k < 3; k++) {
                a[k][k] = A[k][k] - shift;
            }
            if (linear_solve(3, (const double(*)[LINEAR_MAX])a, vector, x) || attempt > 8) {
                break;
            }
            shift = value + size * 1e-15 * (double)(1 << (2 * attempt));
        }
        for (int k = 0; k < 3; k++) {
            vector[k] = x[k];
        }
        normalise(vector);
    }
}

/* B = Q A Q with the reflection Q that takes v to the first axis. */
static void reflect(const double A[3][3], const double v[3], double B[3][3])
{
    double u[3] = {v[0], v[1], v[2]}, size = 0.0, Q[3][3];
    u[0] += u[0] < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < 3; i++) {
        size += u[i] * u[i];
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            Q[i][j] = (i == j ? 1.0 : 0.0) - 2.0 * u[i] * u[j] / size;
        }
    }
    linear_multiply3((const double(*)[3])Q, A, B);
    linear_multiply3((const double(*)[3])B, (const double(*)[3])Q, B);
}

void linear_eigenvalues3(const double A[3][3], struct eigenvalue values[3])
{
    double v[3], B[3][3];
    linear_eigenvector3(A, outer_real_root(A), v);
    reflect(A, v, B);
    const double half = 0.5 * (B[1][1] + B[2][2]), gap = 0.5 * (B[1][1] - B[2][2]);
    const double square = gap * gap + B[1][2] * B[2][1];
    values[0] = (struct eigenvalue){B[0][0], 0.0};
    if (square < 0.0) {
        values[1] = (struct eigenvalue){half, real_sqrt(-square)};
        values[2] = (struct eigenvalue){half, -real_sqrt(-square)};
    } else {
        const double det = B[1][1] * B[2][2] - B[1][2] * B[2][1];
        const double outer = half + (half < 0.0 ? -real_sqrt(square) : real_sqrt(square));
        values[1] = (struct eigenvalue){outer, 0.0};
        values[2] = (struct eigenvalue){outer != 0.0 ? det / outer : 0.0, 0.0};
    }
    for (int i = 0; i < 2; i++) { /* sort by magnitude, stably, so a pair keeps its order */
        for (int k = 0; k < 2; k++) {
            if (linear_magnitude(values[k]) < linear_magnitude(values[k + 1])) {
                const struct eigenvalue t = values[k];
                values[k] = values[k + 1];
                values[k + 1] = t;
            }
        }
    }
}
