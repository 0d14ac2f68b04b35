/* afo study: a study each, of the return map, of the laws, of what the controller knows. */
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/program.h"
#include "sim_host/programs/commands.h"
#include "sim_host/study/dose/dose_study.h"
#include "sim_host/study/laws/laws_main.h"
#include "sim_host/study/observer/commands.h"
#include "sim_host/study/paper/command.h"
#include "sim_host/study/person/commands.h"
#include "sim_host/study/plot.h"
#include "sim_host/study/size/latch_study.h"

static const struct program_command table[] = {
    {"fixed-point", command_fixed_point, "a periodic gait, its eigenvalues and measures"},
    {"continue", command_continue, "follow a gait in a parameter, with folds and period doublings"},
    {"doublings", command_doublings, "the cascade of period doublings (Tables 1 and 2)"},
    {"bifurcation", command_bifurcation, "long runs over r0: periods, chaos, loss of walking"},
    {"basin", command_basin, "where from the walker finds its gait"},
    {"gain", command_gain, "eigenvalues under the step law, and the best gain"},
    {"noise", command_noise, "Monte Carlo: the step law told speeds with errors"},
    {"map", command_map, "iterate the return map from a state"},
    {"atlas", afo_study_atlas,
     "basin as a volume, plane of push-off and stiffness, point by point"},
    {"laws", laws_main, "the laws that choose the push-off, beside each other"},
    {"latch", latch_main, "what each law bears of a latch that opens late"},
    {"dose", dose_main, "what a push-off does to a person who walks by reflexes"},
    {"observe", command_observe, "how well the controller knows the gait, and what it costs"},
    {"observer-gains", command_observer_gains, "the model observer's gains, as C"},
    {"tune-person", tune_person_main, "gains for a person who walks by reflexes, by CMA-ES"},
    {"validate-person", validate_person_main, "such a person's gait against that of people"},
    {"table", afo_study_table, "the gait curve of a walker as the controller's table, as C"},
    {"page", afo_study_page, "the paper's tables and figures for any walker, on one page"},
};

int afo_study(int argc, char **argv)
{
    static const struct program_commands commands = {
        "study",
        "Studies of the ankle-actuated compass gait, the return map from apex to apex, and of the "
        "laws\nand the observer that walk with it.",
        table, sizeof table / sizeof table[0]};
    const int status = plot_finish(program_dispatch(&commands, argc, argv));
    return program_output_done() == 0 ? status : EXIT_USAGE;
}
