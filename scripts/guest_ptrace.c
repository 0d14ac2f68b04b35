/* Preloaded into a User-Mode-Linux kernel by scripts/vcan-guest, on a processor whose
 * extended state is larger than that kernel's buffer for it.
 *
 * Linux 6.1's User-Mode-Linux keeps 2,696 bytes of a process's extended state (XSAVE).
 * Where the processor has the matrix unit AMX the state has 11,008: the host gives the
 * first part when asked for less, but takes back the whole only (EFAULT), and the guest
 * ends as it starts its first process. Here the part that the guest keeps is laid over
 * what the process has. No process of the guest can have used the matrix unit: it needs
 * leave of its kernel, which knows of none.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <elf.h>
#include <stdarg.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

/* More than any processor's state; the host gives what there is. */
enum { STATE_BYTES = 65536 };

typedef long ptrace_call(enum __ptrace_request request, ...);

long ptrace(enum __ptrace_request request, ...)
{
    static ptrace_call *real;
    static unsigned char state[STATE_BYTES]; /* that kernel has one thread */
    va_list arguments;

    va_start(arguments, request);
    const pid_t pid = va_arg(arguments, pid_t);
    void *const addr = va_arg(arguments, void *);
    void *const data = va_arg(arguments, void *);
    va_end(arguments);
    if (real == NULL) {
        *(void **)&real = dlsym(RTLD_NEXT, "ptrace");
    }
    if (request != PTRACE_SETREGSET || addr != (void *)NT_X86_XSTATE) {
        return real(request, pid, addr, data);
    }
    const struct iovec *const part = data;
    struct iovec whole = {state, sizeof state};
    if (real(PTRACE_GETREGSET, pid, addr, &whole) < 0) {
        return -1;
    }
    if (part->iov_len > whole.iov_len) {
        return real(request, pid, addr, data);
    }
    memcpy(state, part->iov_base, part->iov_len);
    return real(request, pid, addr, &whole);
}
