#include "sim_host/reflex/multibody.h"

#include <math.h>

#include "model/trig.h"

enum { HIP_AXES = 2 };
static const double NEAR_RAD = 0.02;

/* Of one segment: the vectors from joint to joint that lead to its centre of mass, turned to where they are. */
struct chain {
    int count;
    struct vector2 r[LEG_PARTS];
};

/* Of every segment. */
struct chains {
    struct chain trunk;
    struct chain part[SIDE_COUNT][LEG_PARTS]; /* up to the centre of mass of each */
};

/* A vector of the segment with this coordinate. */
static struct vector2 turned(struct vector2 vector, const struct multibody_pose *pose,
                             int coordinate)
{
    const double sine = pose->sine[coordinate], cosine = pose->cosine[coordinate];
    return (struct vector2){cosine * vector.x - sine * vector.y,
                            sine * vector.x + cosine * vector.y};
}

static void point_shafts(const struct segments *segments, struct multibody_pose *pose)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int i = 0; i < PART_FOOT; i++) {
            pose->shaft_m[side][i] = turned((struct vector2){0.0, -segments->part[i].length_m},
                                            pose, multibody_leg((enum side)side) + i);
        }
    }
}

void multibody_pose(const struct segments *segments, const struct multibody_state *state,
                    struct multibody_pose *pose)
{
    for (int i = MULTIBODY_TRUNK; i < MULTIBODY_DOF; i++) {
        trig_sincos_f64(state->q[i], &pose->sine[i], &pose->cosine[i]);
    }
    point_shafts(segments, pose);
}

void multibody_pose_near(const struct segments *segments, const struct multibody_state *state,
                         const struct multibody_state *close,
                         const struct multibody_pose *close_pose, struct multibody_pose *pose)
{
    for (int i = MULTIBODY_TRUNK; i < MULTIBODY_DOF; i++) {
        const double d = state->q[i] - close->q[i], dd = d * d;
        if (!(d < NEAR_RAD && d > -NEAR_RAD)) {
            trig_sincos_f64(state->q[i], &pose->sine[i], &pose->cosine[i]);
            continue;
        }
        const double sine = d * (1.0 - dd / 6.0 * (1.0 - dd / 20.0)); /* the next: d^7 / 5040 */
        const double less = dd / 2.0 * (1.0 - dd / 12.0 * (1.0 - dd / 30.0)); /* 1 - cos d */
        const double sine0 = close_pose->sine[i], cosine0 = close_pose->cosine[i];
        pose->sine[i] = sine0 + (cosine0 * sine - sine0 * less);
        pose->cosine[i] = cosine0 - (sine0 * sine + cosine0 * less);
    }
    point_shafts(segments, pose);
}

static void chain_leg(const struct segments *segments, const struct multibody_pose *pose,
                      enum side side, struct chain part[LEG_PARTS])
{
    for (int i = 0; i < LEG_PARTS; i++) {
        part[i].count = i + 1;
        for (int j = 0; j < i; j++) {
            part[i].r[j] = pose->shaft_m[side][j];
        }
        part[i].r[i] = turned(segments->part[i].centre_m, pose, multibody_leg(side) + i);
    }
}

static void chain_all(const struct segments *segments, const struct multibody_pose *pose,
                      struct chains *chains)
{
    chains->trunk =
        (struct chain){.count = 1, .r = {turned(segments->trunk.centre_m, pose, MULTIBODY_TRUNK)}};
    for (int side = 0; side < SIDE_COUNT; side++) {
        chain_leg(segments, pose, (enum side)side, chains->part[side]);
    }
}

/* A limb's share of the equations: D of its own angles, B of them with the hip's x and y. */
struct limb {
    int count;
    double d[LEG_PARTS][LEG_PARTS], b[LEG_PARTS][HIP_AXES], force[LEG_PARTS];
};

/* What the hip's x and y have in all. */
struct trunk_sum {
    double mass_kg, coupling[HIP_AXES][HIP_AXES], force[HIP_AXES];
};

static void add_segment(const struct segment *segment, const struct chain *chain,
                        const double *rate, double gravity_m_s2, struct limb *limb,
                        struct trunk_sum *sum)
{
    /* The acceleration that it has without any alpha: gravity's and towards the joints. */
    struct vector2 free = {0.0, -gravity_m_s2};
    for (int j = 0; j < chain->count; j++) {
        free.x += rate[j] * rate[j] * chain->r[j].x;
        free.y += rate[j] * rate[j] * chain->r[j].y;
    }
    const double mass = segment->mass_kg;
    for (int j = 0; j < chain->count; j++) {
        const struct vector2 perp = {-chain->r[j].y, chain->r[j].x};
        limb->b[j][0] += mass * perp.x;
        limb->b[j][1] += mass * perp.y;
        limb->force[j] += mass * (perp.x * free.x + perp.y * free.y);
        for (int k = 0; k <= j; k++) {
            limb->d[j][k] += mass * (chain->r[j].x * chain->r[k].x + chain->r[j].y * chain->r[k].y);
        }
    }
    limb->d[chain->count - 1][chain->count - 1] += segment->inertia_kgm2;
    sum->mass_kg += mass;
    sum->force[0] += mass * free.x;
    sum->force[1] += mass * free.y;
}

/* D = L L^T in place of D's lower triangle. */
static void factor(struct limb *limb)
{
    for (int i = 0; i < limb->count; i++) {
        for (int j = 0; j <= i; j++) {
            double rest = limb->d[i][j];
            for (int k = 0; k < j; k++) {
                rest -= limb->d[i][k] * limb->d[j][k];
            }
            limb->d[i][j] = i == j ? sqrt(rest) : rest / limb->d[j][j];
        }
    }
}

/* x = L^-1 x, for a column of `stride`. */
static void forward(const struct limb *limb, double *x, int stride)
{
    for (int i = 0; i < limb->count; i++) {
        for (int k = 0; k < i; k++) {
            x[i * stride] -= limb->d[i][k] * x[k * stride];
        }
        x[i * stride] /= limb->d[i][i];
    }
}

/* The limb out of the hip's equations: (A - B^T D^-1 B) hip'' = f - B^T D^-1 f_limb. */
static void eliminate(struct limb *limb, struct trunk_sum *sum)
{
    factor(limb);
    forward(limb, limb->force, 1);
    for (int axis = 0; axis < HIP_AXES; axis++) {
        forward(limb, &limb->b[0][axis], HIP_AXES);
    }
    for (int i = 0; i < limb->count; i++) {
        for (int row = 0; row < HIP_AXES; row++) {
            sum->force[row] -= limb->b[i][row] * limb->force[i];
            for (int column = 0; column < HIP_AXES; column++) {
                sum->coupling[row][column] -= limb->b[i][row] * limb->b[i][column];
            }
        }
    }
}

static void solve_limb(const struct limb *limb, const double hip[HIP_AXES], double *acceleration)
{
    for (int i = limb->count - 1; i >= 0; i--) {
        double rest = limb->force[i] - limb->b[i][0] * hip[0] - limb->b[i][1] * hip[1];
        for (int k = i + 1; k < limb->count; k++) {
            rest -= limb->d[k][i] * acceleration[k];
        }
        acceleration[i] = rest / limb->d[i][i];
    }
}

void multibody_accelerations(const struct segments *segments, const struct multibody_state *state,
                             const struct multibody_pose *pose, const double force[MULTIBODY_DOF],
                             double acceleration[MULTIBODY_DOF])
{
    struct chains chains;
    chain_all(segments, pose, &chains);
    struct limb trunk = {.count = 1, .force = {force[MULTIBODY_TRUNK]}};
    struct limb leg[SIDE_COUNT];
    struct trunk_sum sum = {.force = {force[MULTIBODY_X], force[MULTIBODY_Y]}};
    add_segment(&segments->trunk, &chains.trunk, state->dq + MULTIBODY_TRUNK,
                segments->gravity_m_s2, &trunk, &sum);
    eliminate(&trunk, &sum);
    for (int side = 0; side < SIDE_COUNT; side++) {
        const int first = multibody_leg((enum side)side);
        leg[side] = (struct limb){.count = LEG_PARTS};
        for (int i = 0; i < LEG_PARTS; i++) {
            leg[side].force[i] = force[first + i];
        }
        for (int i = 0; i < LEG_PARTS; i++) {
            add_segment(&segments->part[i], &chains.part[side][i], state->dq + first,
                        segments->gravity_m_s2, &leg[side], &sum);
        }
        eliminate(&leg[side], &sum);
    }
    const double xx = sum.mass_kg + sum.coupling[0][0], yy = sum.mass_kg + sum.coupling[1][1];
    const double xy = sum.coupling[0][1], determinant = xx * yy - xy * xy;
    const double hip[HIP_AXES] = {(yy * sum.force[0] - xy * sum.force[1]) / determinant,
                                  (xx * sum.force[1] - xy * sum.force[0]) / determinant};
    acceleration[MULTIBODY_X] = hip[0];
    acceleration[MULTIBODY_Y] = hip[1];
    solve_limb(&trunk, hip, acceleration + MULTIBODY_TRUNK);
    solve_limb(&leg[SIDE_LEFT], hip, acceleration + MULTIBODY_LEFT);
    solve_limb(&leg[SIDE_RIGHT], hip, acceleration + MULTIBODY_RIGHT);
}

/* Position and velocity of where a chain ends. */
static void follow(const struct multibody_state *state, const struct chain *chain,
                   const double *rate, struct vector2 *position_m, struct vector2 *velocity_m_s)
{
    *position_m = (struct vector2){state->q[MULTIBODY_X], state->q[MULTIBODY_Y]};
    *velocity_m_s = (struct vector2){state->dq[MULTIBODY_X], state->dq[MULTIBODY_Y]};
    for (int j = 0; j < chain->count; j++) {
        position_m->x += chain->r[j].x;
        position_m->y += chain->r[j].y;
        velocity_m_s->x -= rate[j] * chain->r[j].y;
        velocity_m_s->y += rate[j] * chain->r[j].x;
    }
}

/* The vectors from the hip to a point of a foot. */
static void foot_chain(const struct multibody_pose *pose, enum side side, struct vector2 at_m,
                       struct vector2 r[LEG_PARTS])
{
    for (int i = 0; i < PART_FOOT; i++) {
        r[i] = pose->shaft_m[side][i];
    }
    r[PART_FOOT] = turned(at_m, pose, multibody_leg(side) + PART_FOOT);
}

void multibody_foot_point(const struct multibody_state *state, const struct multibody_pose *pose,
                          enum side side, struct vector2 at_m, struct vector2 *position_m,
                          struct vector2 *velocity_m_s)
{
    struct chain chain = {.count = LEG_PARTS};
    foot_chain(pose, side, at_m, chain.r);
    follow(state, &chain, state->dq + multibody_leg(side), position_m, velocity_m_s);
}

void multibody_add_force(const struct multibody_pose *pose, enum side side, struct vector2 at_m,
                         struct vector2 force_N, double force[MULTIBODY_DOF])
{
    struct vector2 r[LEG_PARTS];
    double *leg = force + multibody_leg(side);
    foot_chain(pose, side, at_m, r);
    force[MULTIBODY_X] += force_N.x;
    force[MULTIBODY_Y] += force_N.y;
    for (int i = 0; i < LEG_PARTS; i++) {
        leg[i] += r[i].x * force_N.y - r[i].y * force_N.x;
    }
}

/* What is summed over the segments. */
struct body_sum {
    double mass_kg, energy_J;
    struct vector2 moment, momentum;
};

static void sum_segment(const struct segments *segments, const struct multibody_state *state,
                        const struct segment *segment, const struct chain *chain,
                        const double *rate, struct body_sum *sum)
{
    struct vector2 at, speed;
    follow(state, chain, rate, &at, &speed);
    const double mass = segment->mass_kg, own_rate = rate[chain->count - 1];
    sum->mass_kg += mass;
    sum->energy_J += 0.5 * mass * (speed.x * speed.x + speed.y * speed.y) +
                     0.5 * segment->inertia_kgm2 * own_rate * own_rate +
                     mass * segments->gravity_m_s2 * at.y;
    sum->moment.x += mass * at.x;
    sum->moment.y += mass * at.y;
    sum->momentum.x += mass * speed.x;
    sum->momentum.y += mass * speed.y;
}

static struct body_sum sum_of(const struct segments *segments, const struct multibody_state *state)
{
    struct body_sum sum = {0};
    struct multibody_pose pose;
    struct chains chains;
    multibody_pose(segments, state, &pose);
    chain_all(segments, &pose, &chains);
    sum_segment(segments, state, &segments->trunk, &chains.trunk, state->dq + MULTIBODY_TRUNK,
                &sum);
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int i = 0; i < LEG_PARTS; i++) {
            sum_segment(segments, state, &segments->part[i], &chains.part[side][i],
                        state->dq + multibody_leg((enum side)side), &sum);
        }
    }
    return sum;
}

double multibody_energy_J(const struct segments *segments, const struct multibody_state *state)
{
    return sum_of(segments, state).energy_J;
}

void multibody_centre(const struct segments *segments, const struct multibody_state *state,
                      struct vector2 *position_m, struct vector2 *velocity_m_s)
{
    const struct body_sum sum = sum_of(segments, state);
    *position_m = (struct vector2){sum.moment.x / sum.mass_kg, sum.moment.y / sum.mass_kg};
    *velocity_m_s = (struct vector2){sum.momentum.x / sum.mass_kg, sum.momentum.y / sum.mass_kg};
}
