/* A small CMA-ES: looks for the least value of a function of many numbers that has no derivative.
 *
 * The variant of Beyer & Sendhoff (2017), IEEE Trans. Evol. Comput. 21(5), 746-759, "Simplify your covariance matrix
 * adaptation evolution strategy": it adapts M with C = M M^T itself, and so needs neither C nor its eigenvectors.
 * Constants are those of Hansen (2016), arXiv:1604.00772, Table 1. A generation:
 *     z_k normal,  x_k = mean + sigma M z_k,  sorted by value; w_i the weights of the best half, mu_w = 1 / sum w_i^2
 *     s = (1 - c_s) s + sqrt(c_s (2 - c_s) mu_w) sum w_i z_i
 *     M = M + M [c_1 / 2 (s s^T - 1) + c_mu / 2 (sum w_i z_i z_i^T - 1)]
 *     sigma = sigma exp(c_s / d (|s| / E|N| - 1)),   mean = mean + sigma M sum w_i z_i (of before)
 *
 * Its own and not pycma: `afo` needs no Python, and the state is some numbers, which a file holds whole.
 * The state is plain data without pointers: written to a file and read again, the search goes on with the same bits.
 */
#ifndef SIM_HOST_STUDY_PERSON_CMA_ES_H
#define SIM_HOST_STUDY_PERSON_CMA_ES_H

#include "sim_host/random/rng.h"

enum { CMA_MOST = 32, CMA_LAMBDA_MOST = 32 };

struct cma_es {
    int count, lambda;     /* numbers looked for; tries a generation */
    int generations;       /* done */
    double sigma;          /* the size of the steps */
    double mean[CMA_MOST]; /* where it searches */
    double path[CMA_MOST]; /* s */
    double matrix[CMA_MOST][CMA_MOST];
    double z[CMA_LAMBDA_MOST][CMA_MOST]; /* of the generation asked for */
    double best[CMA_MOST], best_value;   /* so far; INFINITY before the first generation */
    struct rng rng;
};

/* count: 1 .. CMA_MOST. The number of tries is 4 + 3 ln(count). Scale the numbers so that sigma suits each. */
void cma_es_init(struct cma_es *search, int count, const double *start, double sigma,
                 uint64_t seed);

/* Draws a generation. */
void cma_es_ask(struct cma_es *search);

/* Try k of it, 0 .. lambda - 1. */
void cma_es_try(const struct cma_es *search, int k, double *x);

/* Takes the values of all tries (lower is better; NaN counts as the worst), and goes on. */
void cma_es_tell(struct cma_es *search, const double *value);

#endif
