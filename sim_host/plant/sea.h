/* One series elastic actuator with its drive and its latch.
 *
 * motor -> screw -> spring -> latch -> ankle. The motor's position is given in metres of spring:
 * with the ankle at r = 0 and the motor at x the spring pushes k x. The latch holds the spring's output:
 *   CLOSED    output held; the motor may compress, the ankle may extend freely,
 *             no force reaches it
 *   RELEASED  the spring pushes the ankle, k (x - r), as long as x > r
 *   SLACK     it has pushed to its end (lift-off); the foot follows the motor;
 *             closes again when the output is back at reclose_m or below
 * An armed latch is released by its own node, release_latency_s after the cause
 * chosen by release_on. The drive runs its position loop at its own fast rate
 * and reacts to a dead link by itself (SEA_UNLOAD).
 *
 * Time inside: sea_drive_period() computes one period of the drive's loop. In it the motor moves with
 * constant acceleration. So the walker can integrate against motor position(tau) at any step size.
 *
 * No heap, no globals, no I/O. Callable from anywhere that may use double. Every function is O(1)
 * unless it says otherwise. struct sea is plain data: a copy is a snapshot.
 */
#ifndef SIM_HOST_PLANT_SEA_H
#define SIM_HOST_PLANT_SEA_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/plant/sea_built.h"
#include "sim_host/random/rng.h"

enum sea_latch { SEA_LATCH_CLOSED = 0, SEA_LATCH_RELEASED = 1, SEA_LATCH_SLACK = 2 };

enum sea_mode {
    SEA_TORQUE_OFF = 0, /* motor without current: a loaded spring drives it back */
    SEA_POSITION = 1,   /* follows target_position_m (cyclic synchronous position) */
    SEA_UNLOAD = 2      /* the drive's own reaction: back to 0 at unload_rate_m_s */
};

enum sea_release {
    SEA_RELEASE_CONTACT_OR_EXTENSION = 0, /* whichever comes first */
    SEA_RELEASE_CONTACT = 1,              /* contact input of the other foot */
    SEA_RELEASE_EXTENSION = 2,            /* own ankle beyond extension_trigger_m */
    SEA_RELEASE_COMMAND = 3               /* as soon as armed: timed by the controller */
};

/* A latch that is broken, from the moment on at which it is set. */
enum sea_latch_fault {
    SEA_LATCH_WHOLE = 0,
    SEA_LATCH_OPENS = 1,      /* opens by itself, now, and works on */
    SEA_LATCH_STUCK_OPEN = 2, /* does not close any more */
    SEA_LATCH_STUCK_SHUT = 3  /* does not open any more */
};

/* Everything a SEA can be. sea_preset() fills all of it, idealised: a motor that is a mass with a force,
 * a linear spring, a latch that holds everything. sea_params_as_built() makes it an actuator of parts
 * (sea_config.h); then motor, drive and spring are the config's, and the fields marked (i) say nothing. */
struct sea_params {
    bool as_built;
    struct sea_config built; /* as_built */
    double spring_N_per_m;
    bool ideal_motor;            /* true: position = clamped target at once, force unlimited */
    bool ideal_foot;             /* true: after lift-off the foot is at r = 0 and latched at once */
    double drive_period_s;       /* of the position loop, divides 1 ms */
    double motor_mass_kg;        /* (i) rotor and screw, reflected to metres of spring */
    double viscous_N_per_m_s;    /* (i) */
    double coulomb_N;            /* (i) also holds the motor at rest */
    double loop_bandwidth_rad_s; /* (i) position loop */
    double loop_damping;         /* (i) */
    double loop_integral_rad_s;  /* (i) corner of the integral part */
    double force_limit_N;        /* motor force, both directions (current limit) */
    double speed_limit_m_s;
    double acceleration_limit_m_s2;        /* of the drive's reference */
    double stroke_min_m, stroke_max_m;     /* commanded positions are clamped to these */
    double end_stop_min_m, end_stop_max_m; /* hard, without rebound */
    double unload_rate_m_s;
    double counts_per_m;  /* drive position counts per metre of spring, > 0 */
    double zero_offset_m; /* reported position = true position + this */
    enum sea_release release_on;
    double release_latency_s;   /* 0 .. 50 ms */
    double release_jitter_s;    /* 0 .. 50 ms, added: uniform in [0, this) */
    double extension_trigger_m; /* > 0 */
    double reclose_m;           /* >= 0 */
    double reclose_s;           /* from home until it holds again, 0 .. 0.5 s */
    double holding_N;           /* more the latch does not hold */
    double wear_per_release;    /* share of holding_N that each release takes */
    double slip_m_s;            /* overloaded its output creeps so fast; 0: it opens */
    double rated_force_N;       /* 1000 per mille of object 0x6077 */
    double thermal_rise_K;      /* winding above ambient at rated force for ever */
    double thermal_time_s;
    double ambient_degC;
    double dc_link_V;   /* no load */
    double dc_link_ohm; /* source resistance */
    double force_per_current_N_A;
};

struct sea_command {
    enum sea_mode mode;
    double target_position_m; /* in reported coordinates; ignored unless SEA_POSITION */
    bool latch_armed;
};

/* What a node can report at a SYNC, and what the tests look at. */
struct sea_output {
    double position_m;          /* true motor position */
    double reported_position_m; /* quantised to counts, with the zero offset */
    int32_t position_counts;    /* the same, as the drive reports it */
    double speed_m_s;
    double motor_force_N;
    double torque_per_mille; /* motor force / rated force * 1000 */
    double spring_force_N;   /* in the spring, whoever holds it, >= 0 */
    double ankle_force_N;    /* the part that reaches the ankle, >= 0 */
    enum sea_latch latch;
    bool armed;
    bool release_pending; /* cause seen, latency running */
    bool target_clamped;  /* target outside the stroke limits */
    bool force_limited;   /* motor force (as built: current or voltage) at its limit, last period */
    bool at_end_stop;
    bool latch_slipping; /* overloaded, and creeping */
    double current_A;    /* as built: of the motor */
    bool unloaded;       /* spring force below 1 % of spring * stroke_max */
    double temperature_degC;
    double dc_link_V;
};

struct sea {
    struct sea_params params;
    struct sea_command command;
    /* motor, at the start of the current drive period */
    double position_m, speed_m_s, acceleration_m_s2;
    double motor_force_N, spring_force_N, friction_N;
    /* drive; in true coordinates */
    double reference_m, reference_speed_m_s, reference_acceleration_m_s2;
    double target_from_m, target_to_m; /* interpolated over one tick */
    double since_command_s;
    double integral_N;
    double measured_m, measured_speed_m_s;
    double temperature_degC;
    bool force_limited, at_end_stop, target_clamped;
    struct sea_built built; /* as_built */
    /* latch */
    enum sea_latch latch;
    enum sea_latch_fault latch_fault;
    double output_m; /* where a closed latch holds the spring's output; creeps when overloaded */
    double home_s;   /* how long everything has been where it can close */
    bool slipping;
    bool lets_go; /* by itself: overloaded, or broken */
    bool release_pending;
    double release_time_s; /* walker's time */
    struct rng rng;
    /* energy since init */
    double motor_work_J; /* by the motor on screw and spring */
    double motor_positive_work_J;
    double friction_loss_J;
    uint64_t releases;  /* counters */
    uint64_t overloads; /* times the latch did not hold the spring */
};

enum sea_preset_kind { SEA_IDEAL = 0, SEA_REAL = 1 };

/* The subject a preset is scaled to. */
struct sea_subject {
    double total_mass_kg; /* M + 2 m */
    double leg_length_m;
    double gravity_m_s2;
    double spring_N_per_m;
};

/* Fills every field of *params.
 * SEA_IDEAL: the motor is at its target from the SYNC on. Only the stroke (0 .. 0.5 l) limits it. The
 *   foot is back at once. The release has no latency.
 * SEA_REAL: reflected motor mass 4 (M + 2m), 60 Hz loop at 10 kHz, damping 1,
 *   Coulomb friction 1 % of k stroke and viscous friction, force limit 2.5 k stroke,
 *   speed limit 0.6 sqrt(g l), stroke 0 .. 0.35 l, end stops 0.005 l outside, 16-bit
 *   motor encoder on a 5 mm screw, release on contact or extension after 0.1 ms,
 *   foot follows the motor back. Numbers and reasons: sea_presets.c. */
void sea_preset(enum sea_preset_kind kind, const struct sea_subject *subject,
                struct sea_params *params);

/* Params of an actuator as it is built. The config has passed sea_config_check(). The rest of the world
 * sees its limits in the same fields as a preset's: stroke, speed, the force at the peak current, counts
 * per metre, the latch's times. */
void sea_params_as_built(const struct sea_config *config, struct sea_params *params);

/* "ideal" or "real" -> kind; false for any other name. */
bool sea_preset_from_name(const char *name, enum sea_preset_kind *kind);

/* NULL if every field is in range, else the name of the first that is not. */
const char *sea_params_check(const struct sea_params *params);

/* At rest at 0, unloaded, latch closed, torque off. Params are copied. */
void sea_init(struct sea *sea, const struct sea_params *params, uint64_t seed);

/* A command takes effect; call at SYNC, once per tick at most. A non-finite
 * target leaves the old one and sets target_clamped. now_s is the walker's time
 * (SEA_RELEASE_COMMAND starts its latency here). Disarming before the latency
 * has run cancels the release. */
void sea_set_command(struct sea *sea, const struct sea_command *command, double now_s);

/* Ends the drive's last period and begins the next: runs the loop once and fixes the motor's
 * acceleration. ankle_m is the ankle's extension now, where an unlatched spring's output is. */
void sea_drive_period(struct sea *sea, double ankle_m);

/* Motor position and speed tau_s after the start of the current period,
 * 0 <= tau_s <= drive_period_s. */
double sea_position_at_m(const struct sea *sea, double tau_s);
double sea_speed_at_m_s(const struct sea *sea, double tau_s);

/* Moves the motor to the end of the current period (energy is accounted here). */
void sea_finish_period(struct sea *sea);

/* The causes of a release, at the walker's time now_s: the other foot touched
 * the ground, or the own ankle passed extension_trigger_m. If armed, chosen as a
 * cause and closed, release_time_s is set. */
void sea_other_foot_contact(struct sea *sea, double now_s);
void sea_ankle_extends(struct sea *sea, double now_s);

/* The latch opens now; the spring has reached its motor; the foot is back. sea_lift_off() acts only
 * in RELEASED. sea_reclose(), once every period of the drive, acts only in SLACK, with motor and foot both
 * at or below reclose_m for reclose_s. Both return whether the latch moved; a broken one may not. */
bool sea_release_now(struct sea *sea);
void sea_lift_off(struct sea *sea);
bool sea_reclose(struct sea *sea, double foot_m);

/* Breaks or mends the latch, now. */
void sea_set_latch_fault(struct sea *sea, enum sea_latch_fault fault);

/* Whether an overloaded or broken latch lets go of its spring by itself now: the walk then releases it. */
bool sea_lets_go(const struct sea *sea);

/* Whether an armed, closed latch waits for a cause or for its latency to pass. */
bool sea_may_release(const struct sea *sea);

/* Force that the ankle at ankle_m feels now (0 while closed; below 0 only of a two-way spring). */
double sea_ankle_force_N(const struct sea *sea, double ankle_m);

/* The straight line through the force of an open latch's spring near ankle_m: force = stiffness
 * (motor - play_m - ankle). */
void sea_spring_at(const struct sea *sea, double ankle_m, double *stiffness_N_per_m,
                   double *play_m);

/* Energy in the spring now, J. */
double sea_spring_energy_now_J(const struct sea *sea, double ankle_m);

/* Reported counts -> metres in reported coordinates, and back (saturating). */
double sea_counts_to_m(const struct sea_params *params, int32_t counts);
int32_t sea_m_to_counts(const struct sea_params *params, double position_m);

void sea_read(const struct sea *sea, double ankle_m, struct sea_output *output);

#endif
