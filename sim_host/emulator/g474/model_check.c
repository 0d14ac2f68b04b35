#include "sim_host/emulator/g474/model_check.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

static model_misuse_handler handler;
static void *handler_context;

void model_on_misuse(model_misuse_handler function, void *context)
{
    handler = function;
    handler_context = context;
}

void model_misuse(const char *format, ...)
{
    char description[160];
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(description, sizeof description, format, arguments);
    va_end(arguments);
    if (handler != NULL) {
        handler(handler_context, description);
        return;
    }
    fprintf(stderr, "misuse of a peripheral: %s\n", description);
    abort();
}
