#include "tests/support/in_vcan.h"

#include <net/if.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define WITH_ADDRESS_SANITIZER 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define WITH_ADDRESS_SANITIZER 1
#endif

bool in_vcan_is_possible(void)
{
#ifdef WITH_ADDRESS_SANITIZER
    return if_nametoindex("vcan0") != 0;
#else
    return true;
#endif
}

void in_vcan_or_restart(char *const *argv)
{
    static char script[] = "scripts/vcan-guest";
    static char option[] = "--timeout";
    static char seconds[] = "300"; /* built without optimisation, on a busy machine */
    static char end[] = "--";
    if (if_nametoindex("vcan0") != 0) {
        return;
    }
    if (getenv("AFO_IN_VCAN") != NULL) {
        fprintf(stderr, "no vcan0 even under scripts/vcan-guest\n");
        exit(EXIT_FAILURE);
    }
    setenv("AFO_IN_VCAN", "1", 1);
    char *const arguments[] = {script, option, seconds, end, argv[0], NULL};
    execv(script, arguments);
    perror("cannot run scripts/vcan-guest (run tests from the top of the tree)");
    exit(EXIT_FAILURE);
}
