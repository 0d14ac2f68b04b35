/* afo: everything that runs on this machine, a sub-command each. */
#include "sim_host/cli/program.h"
#include "sim_host/programs/commands.h"

static const struct program_command table[] = {
    {"sim", afo_sim, "a walk, or a recording, in closed loop on an in-process bus"},
    {"compare", afo_compare, "the same walk by several laws: one table, one picture"},
    {"study", afo_study, "the paper's tables and figures, the laws, the observer, and more"},
    {"faults", afo_faults, "inject faults into steady walks and judge what came of them"},
    {"soak", afo_soak, "walk for days of simulated time and watch what must not change"},
    {"replay", afo_replay, "a log through the control task, its frames compared bit by bit"},
    {"view", afo_view, "a walk in a browser: see, tune, mark, keep and compare"},
    {"report", afo_report, "a trial of afo view as one HTML file, two compared, or exported"},
    {"import", afo_import,
     "a gait laboratory's file (C3D, OpenSim, CSV) as a recording; a CAN log of other tools"},
    {"export", afo_export, "a table as Parquet, as an OpenSim motion, or as a moving picture"},
    {"walker", afo_walker, "the simulated walker and its four nodes on a CAN interface"},
    {"host", afo_host, "the control task on a CAN interface"},
    {"ctl", afo_ctl, "read and write the objects of a node by name; walk, stop, reset, zero, save"},
    {"commission", afo_commission,
     "set a device up step by step; a device file and a page to sign"},
    {"blackbox", afo_blackbox, "fetch the controller's black box over CAN, as a log"},
    {"update", afo_update, "a new program for the controller, over CAN"},
    {"settings", afo_settings,
     "a person's and a device's settings as the board keeps them in flash"},
    {"size", afo_size, "what a device's motor bears over cadence, and what limits it"},
    {"device", afo_device, "device files: check, show, convert"},
    {"eds", afo_eds, "data sheets of all nodes (EDS) and the DBC of the bus"},
    {"pil", afo_pil, "walk with the flashed object code on an emulated processor"},
    {"g474", afo_g474, "walk with the very image that is flashed, in an emulated STM32G474"},
    {"slcan", afo_slcan, "the same over slcan on the emulated board's UART"},
};

int main(int argc, char **argv)
{
    static const struct program_commands commands = {
        "command", "The ankle-foot orthosis: controller, simulated walker, studies and tools.",
        table, sizeof table / sizeof table[0]};
    program_check_output_at_exit();
    return program_dispatch(&commands, argc, argv);
}
