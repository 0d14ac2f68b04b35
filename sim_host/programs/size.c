/* afo size: the work is the study's. */
#include "sim_host/programs/commands.h"
#include "sim_host/study/size/size_main.h"

int afo_size(int argc, char **argv)
{
    return size_main(argc, argv);
}
