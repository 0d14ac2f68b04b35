/* afo-study: studies of the return map; see sim_host/study/study_main.h. */
#include "firmware/version.h"
#include "sim_host/study/study_main.h"

int main(int argc, char **argv)
{
    return study_main(argc, argv, version_text());
}
