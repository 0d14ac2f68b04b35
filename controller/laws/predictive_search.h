/* The push-off by looking ahead: a bounded search over r0 with the return map on board.
 *
 * From the estimated apex one stride is predicted for each candidate r0 (float return map, large
 * integration steps), and its end is judged by gait_branch_distance(): what it costs to be caught by
 * some steady gait, and to travel from that gait to the wanted one. The stride up to heel strike is the
 * same for all candidates and computed once.
 *
 * Spread over the ticks after the apex: one call of predictive_search_work() does one unit (the stride to
 * heel strike, or one candidate), at most PREDICTIVE_UNITS units a step. There is an answer from the
 * start, the caller's; it is replaced as better ones are found. Everything that bounds the work is
 * counted in integration steps, so its cost does not depend on the machine, nor do its bits. Candidates
 * that the motor cannot reach before the predicted heel strike are left out.
 *
 * Where apexes have lately come out with other energies than foretold, the ground is uneven, and the next
 * foothold may take as much again: the law then wants no apex slower than bears that, up to terrain_speed_rad_s, even
 * where less is asked for, and comes back within tens of steps of even ground.
 *
 * What the walker does beyond the model (a slope, a wrong mass) is learned as the mean difference of
 * measured and predicted apex and added to predictions. When they disagree too often nevertheless,
 * the law steps back (PREDICTIVE_UNRELIABLE) and eq. (16) alone walks until predictions, still made
 * for the push-offs that happen, come true again.
 */
#ifndef CONTROLLER_LAWS_PREDICTIVE_SEARCH_H
#define CONTROLLER_LAWS_PREDICTIVE_SEARCH_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/laws/gait_branch.h"

#define predictive_search_init REAL_SYMBOL(predictive_search_init)
#define predictive_search_begin REAL_SYMBOL(predictive_search_begin)
#define predictive_search_work REAL_SYMBOL(predictive_search_work)
#define predictive_search_finish REAL_SYMBOL(predictive_search_finish)
#define predictive_search_is_reliable REAL_SYMBOL(predictive_search_is_reliable)

enum {
    PREDICTIVE_COARSE = 16, /* candidates over the whole range, closer together where r0 is small */
    PREDICTIVE_ROUNDS =
        4, /* of refinement: both sides of the best, then the vertex of the parabola */
    PREDICTIVE_UNITS = 2 + PREDICTIVE_COARSE + 3 * PREDICTIVE_ROUNDS, /* bound of units a step */
    PREDICTIVE_UNRELIABLE = 12
};

enum predictive_stage {
    PREDICTIVE_IDLE = 0,   /* the answer is final */
    PREDICTIVE_STRIKE = 1, /* next unit: the stride up to heel strike */
    PREDICTIVE_FIRST = 2,  /* next: the caller's answer as the first candidate */
    PREDICTIVE_SPREAD = 3, /* next: candidates over the range */
    PREDICTIVE_REFINE = 4  /* next: candidates beside the best */
};

/* What the search may use; r0 in metres of spring. */
struct predictive_request {
    struct apex apex;         /* as estimated */
    real target_speed_rad_s;  /* forward apex speed wanted */
    real terrain_speed_rad_s; /* and on uneven ground at most this, if it is more */
    real r0_first_m;          /* the answer to begin with; stands if nothing better is found */
    real r0_low_m, r0_high_m; /* where candidates may lie */
    /* The motor, which stands at r0_from_m, must be at r0 before heel strike. It can start when the range
     * has been searched. */
    real r0_from_m, motor_speed_m_s, motor_acceleration_m_s2;
    real report_delay_s, tick_s; /* age of the apex at the first unit of work; time a unit takes */
};

struct predictive_search {
    struct walker walker;
    enum predictive_stage stage;
    struct predictive_request request;
    struct gait_branch_point target; /* the gait at the (clamped) target speed */
    real target_speed_rad_s;
    struct stride_result strike; /* apex to heel strike */
    real r0_m;                   /* the best so far */
    real best_cost;              /* NEGATIVE while no candidate has survived */
    real grid_m;                 /* present width of the refinement */
    real middle_m;               /* about which this round refines */
    real cost_at[3];       /* below, at and above the middle; NEGATIVE = none survives there */
    int16_t index;         /* of the next candidate in its stage */
    bool answered;         /* r0_m came from the search */
    struct apex predicted; /* next apex, without bias; valid if has_prediction */
    bool has_prediction;   /* predicted belongs to the push-off that was given last */
    real bias[3];          /* measured minus predicted apex, filtered */
    real last_error;       /* of the foretold stance rate, rad/s */
    real roughness;        /* v^2 l / g that the ground has lately called for; 0 = even */
    uint8_t
        misprediction_count;   /* counts up by 3 on a wrong prediction, down by 1 on a right one */
    uint32_t steps, fallbacks; /* answers given, and of these by the caller's first answer */
};

/* Prepares the law for a walker. Returns 0, or -1 when the walker's parameters are out of range. */
int predictive_search_init(struct predictive_search *search, const struct walker_params *params);

/* A new apex: compares it with the last prediction and sets up the search. */
void predictive_search_begin(struct predictive_search *search, const struct gait_branch *branch,
                             const struct predictive_request *request);

/* One unit of work; nothing when the answer is final. Returns true when search->r0_m is worth following: once
 * the range has been searched, at each improvement after that, and when it has become final
 * (search->stage == PREDICTIVE_IDLE). Cost bound: 21 RK4 steps of single support or 11 of double and
 * 19 of single support, one landing each, and one gait_branch_distance(). */
bool predictive_search_work(struct predictive_search *search, const struct gait_branch *branch);

/* Time is up: the answer that stands becomes final. If it came from a candidate, its prediction stands, too. */
void predictive_search_finish(struct predictive_search *search);

/* False while predictions and measured apexes disagree too often. */
bool predictive_search_is_reliable(const struct predictive_search *search);

#endif
