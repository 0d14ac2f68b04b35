/* What the models of peripherals do about a program that misuses them: what the real
 * peripheral would leave undefined, or what the reference manual forbids. */
#ifndef SIM_HOST_EMULATOR_G474_MODEL_CHECK_H
#define SIM_HOST_EMULATOR_G474_MODEL_CHECK_H

/* Takes the description of a misuse, without a newline. May return. */
typedef void (*model_misuse_handler)(void *context, const char *description);

/* Who is told from now on. NULL, as at the start: the description goes to standard error
 * and the program is aborted, which is what a test wants. */
void model_on_misuse(model_misuse_handler handler, void *context);

/* Tells of a misuse; a printf format. Returns when the handler does: the caller goes on
 * as the hardware plausibly would. */
void model_misuse(const char *format, ...) __attribute__((format(printf, 1, 2)));

#define MODEL_CHECK(condition, ...)    \
    do {                               \
        if (!(condition)) {            \
            model_misuse(__VA_ARGS__); \
        }                              \
    } while (0)

#endif
