#include "sim_host/study/person/cma_es.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { STREAM = 72 };

void cma_es_init(struct cma_es *search, int count, const double *start, double sigma, uint64_t seed)
{
    memset(search, 0, sizeof *search);
    search->count = count;
    search->lambda = 4 + (int)(3.0 * log((double)count));
    search->sigma = sigma;
    search->best_value = (double)INFINITY;
    rng_init(&search->rng, seed, STREAM);
    for (int i = 0; i < count; i++) {
        search->mean[i] = search->best[i] = start[i];
        search->matrix[i][i] = 1.0;
    }
}

void cma_es_ask(struct cma_es *search)
{
    for (int k = 0; k < search->lambda; k++) {
        for (int i = 0; i < search->count; i++) {
            search->z[k][i] = rng_normal(&search->rng);
        }
    }
}

/* M z */
static void turned(const struct cma_es *search, const double *z, double *result)
{
    for (int i = 0; i < search->count; i++) {
        result[i] = 0.0;
        for (int j = 0; j < search->count; j++) {
            result[i] += search->matrix[i][j] * z[j];
        }
    }
}

void cma_es_try(const struct cma_es *search, int k, double *x)
{
    double step[CMA_MOST];
    turned(search, search->z[k], step);
    for (int i = 0; i < search->count; i++) {
        x[i] = search->mean[i] + search->sigma * step[i];
    }
}

static bool is_better(double value, double than)
{
    return value < than || (isnan(than) && !isnan(value));
}

/* The tries from the best to the worst; equals stay in their order. */
static void sort(const struct cma_es *search, const double *value, int *order)
{
    for (int k = 0; k < search->lambda; k++) {
        int at = k;
        while (at > 0 && is_better(value[k], value[order[at - 1]])) {
            order[at] = order[at - 1];
            at--;
        }
        order[at] = k;
    }
}

/* Weights of the best half, and the speeds of learning; of count and lambda alone. */
struct strategy {
    int parents;
    double weight[CMA_LAMBDA_MOST], parents_effective, path_rate, rank_one, rank_parents, damping;
};

static void strategy_of(const struct cma_es *search, struct strategy *s)
{
    const double n = (double)search->count, half = 0.5 * (search->lambda + 1);
    double sum = 0.0, squares = 0.0;
    s->parents = search->lambda / 2;
    for (int i = 0; i < s->parents; i++) {
        s->weight[i] = log(half) - log1p(i);
        sum += s->weight[i];
    }
    for (int i = 0; i < s->parents; i++) {
        s->weight[i] /= sum;
        squares += s->weight[i] * s->weight[i];
    }
    const double mu = 1.0 / squares;
    s->parents_effective = mu;
    s->path_rate = (mu + 2.0) / (n + mu + 5.0);
    s->rank_one = 2.0 / ((n + 1.3) * (n + 1.3) + mu);
    s->rank_parents =
        fmin(1.0 - s->rank_one, 2.0 * (mu - 2.0 + 1.0 / mu) / ((n + 2.0) * (n + 2.0) + mu));
    s->damping = 1.0 + s->path_rate + 2.0 * fmax(0.0, sqrt((mu - 1.0) / (n + 1.0)) - 1.0);
}

/* M = M (1 + c_1 / 2 (s s^T - 1) + c_mu / 2 (sum w z z^T - 1)) */
static void adapt(struct cma_es *search, const struct strategy *s, const int *order)
{
    const int n = search->count;
    double by_path[CMA_MOST], by_parent[CMA_LAMBDA_MOST][CMA_MOST];
    turned(search, search->path, by_path);
    for (int k = 0; k < s->parents; k++) {
        turned(search, search->z[order[k]], by_parent[k]);
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            double *m = &search->matrix[i][j];
            *m *= 1.0 - 0.5 * (s->rank_one + s->rank_parents);
            *m += 0.5 * s->rank_one * by_path[i] * search->path[j];
            for (int k = 0; k < s->parents; k++) {
                *m +=
                    0.5 * s->rank_parents * s->weight[k] * by_parent[k][i] * search->z[order[k]][j];
            }
        }
    }
}

void cma_es_tell(struct cma_es *search, const double *value)
{
    const double n = (double)search->count;
    const double length = sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)); /* E|N| */
    double mean_z[CMA_MOST] = {0.0}, step[CMA_MOST], squares = 0.0;
    int order[CMA_LAMBDA_MOST] = {0};
    struct strategy s;
    strategy_of(search, &s);
    sort(search, value, order);
    if (value[order[0]] < search->best_value) {
        search->best_value = value[order[0]];
        cma_es_try(search, order[0], search->best);
    }
    for (int i = 0; i < search->count; i++) {
        for (int k = 0; k < s.parents; k++) {
            mean_z[i] += s.weight[k] * search->z[order[k]][i];
        }
        search->path[i] = (1.0 - s.path_rate) * search->path[i] +
                          sqrt(s.path_rate * (2.0 - s.path_rate) * s.parents_effective) * mean_z[i];
        squares += search->path[i] * search->path[i];
    }
    turned(search, mean_z, step);
    for (int i = 0; i < search->count; i++) {
        search->mean[i] += search->sigma * step[i];
    }
    adapt(search, &s, order);
    search->sigma *= exp(s.path_rate / s.damping * (sqrt(squares) / length - 1.0));
    search->generations++;
}
