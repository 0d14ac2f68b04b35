#include "firmware/version.h"

#if !defined(AFO_VERSION) || !defined(AFO_BUILD_ID)
#error "the build passes AFO_VERSION and AFO_BUILD_ID to this file"
#endif

const char *version_text(void)
{
    return AFO_VERSION;
}

uint32_t version_build_id(void)
{
    return AFO_BUILD_ID;
}
