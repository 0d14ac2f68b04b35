/* Time against error of the stride by SUNDIALS CVODE with its root finding, Adams and BDF.
 * Usage: afo-bench-cvode REFERENCE.csv [SECONDS]. Built without SUNDIALS it says so and stops. */
#define REAL_IS_DOUBLE 1 /* the equations in double */
#include <stdlib.h>

#include "sim_host/batch/benchmark_phases.h"

#ifdef HAVE_PEER

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#define TIME_LIMIT_S 20.0
#define MAX_STEPS 200000

struct cvode {
    SUNContext sun;
    void *memory[2]; /* for four states, for two */
    N_Vector y[2];
    SUNMatrix matrix[2];
    SUNLinearSolver linear[2];
    SUNNonlinearSolver nonlinear[2];
    struct walker walker;
    struct double_support support;
    enum benchmark_phase phase;
};

static int rates_of(realtype t, N_Vector y, N_Vector dy, void *user)
{
    const struct cvode *cvode = user;
    (void)t;
    if (cvode->phase == PHASE_PUSH_OFF) {
        double_support_rates(&cvode->support, N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
    } else {
        single_support_rates(&cvode->walker, N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
    }
    return 0;
}

static int root_of(realtype t, N_Vector y, realtype *value, void *user)
{
    const struct cvode *cvode = user;
    (void)t;
    *value = benchmark_event(cvode->phase, &cvode->support, N_VGetArrayPointer(y));
    return 0;
}

static int run_phase(void *solver, enum benchmark_phase phase, double tolerance, double *state)
{
    struct cvode *cvode = solver;
    const int which = phase == PHASE_PUSH_OFF;
    void *memory = cvode->memory[which];
    double *y = N_VGetArrayPointer(cvode->y[which]);
    const int count = which ? 2 : 4;
    realtype t = 0.0;
    cvode->phase = phase;
    for (int i = 0; i < count; i++) {
        y[i] = state[i];
    }
    if (CVodeReInit(memory, 0.0, cvode->y[which]) != CV_SUCCESS ||
        CVodeSStolerances(memory, tolerance, tolerance) != CV_SUCCESS ||
        CVode(memory, TIME_LIMIT_S, cvode->y[which], &t, CV_NORMAL) != CV_ROOT_RETURN) {
        return 0;
    }
    for (int i = 0; i < count; i++) {
        state[i] = y[i];
    }
    return 1;
}

static int cvode_open(struct cvode *cvode, int method)
{
    int falling = -1;
    if (SUNContext_Create(NULL, &cvode->sun) != 0) {
        return 0;
    }
    for (int i = 0; i < 2; i++) {
        const sunindextype count = i == 0 ? 4 : 2;
        cvode->y[i] = N_VNew_Serial(count, cvode->sun);
        cvode->memory[i] = CVodeCreate(method, cvode->sun);
        N_VConst(0.0, cvode->y[i]);
        if (cvode->memory[i] == NULL ||
            CVodeInit(cvode->memory[i], rates_of, 0.0, cvode->y[i]) != CV_SUCCESS ||
            CVodeSStolerances(cvode->memory[i], 1e-6, 1e-6) != CV_SUCCESS) {
            return 0;
        }
        if (method == CV_ADAMS) {
            cvode->nonlinear[i] = SUNNonlinSol_FixedPoint(cvode->y[i], 0, cvode->sun);
            CVodeSetNonlinearSolver(cvode->memory[i], cvode->nonlinear[i]);
        } else {
            cvode->matrix[i] = SUNDenseMatrix(count, count, cvode->sun);
            cvode->linear[i] = SUNLinSol_Dense(cvode->y[i], cvode->matrix[i], cvode->sun);
            CVodeSetLinearSolver(cvode->memory[i], cvode->linear[i], cvode->matrix[i]);
        }
        CVodeSetUserData(cvode->memory[i], cvode);
        CVodeSetMaxNumSteps(cvode->memory[i], MAX_STEPS);
        CVodeRootInit(cvode->memory[i], 1, root_of);
        CVodeSetRootDirection(cvode->memory[i], &falling);
        CVodeSetNoInactiveRootWarn(cvode->memory[i]);
    }
    return 1;
}

static void cvode_close(struct cvode *cvode)
{
    for (int i = 0; i < 2; i++) {
        CVodeFree(&cvode->memory[i]);
        SUNNonlinSolFree(cvode->nonlinear[i]);
        SUNLinSolFree(cvode->linear[i]);
        SUNMatDestroy(cvode->matrix[i]);
        N_VDestroy(cvode->y[i]);
    }
    SUNContext_Free(&cvode->sun);
}

static void measure(const char *name, int method, const struct benchmark_rows *rows)
{
    static struct cvode cvode;
    cvode = (struct cvode){0};
    if (cvode_open(&cvode, method)) {
        struct benchmark_solver solver = {run_phase, &cvode, &cvode.walker, &cvode.support};
        double tolerance = 1e-5;
        for (int rung = 0; rung < 20; rung++) {
            benchmark_measure(name, rows, benchmark_solve, &solver, tolerance, 1);
            tolerance /= 3.1622776601683795;
        }
    }
    cvode_close(&cvode);
}

int main(int argc, char **argv)
{
    static struct benchmark_rows rows;
    if (!benchmark_open(&rows, argc, argv)) {
        return EXIT_FAILURE;
    }
    measure("CVODE Adams", CV_ADAMS, &rows);
    measure("CVODE BDF", CV_BDF, &rows);
    return EXIT_SUCCESS;
}

#else

int main(void)
{
    fputs("built without SUNDIALS: install libsundials-dev and build again\n", stderr);
    return EXIT_FAILURE;
}

#endif
