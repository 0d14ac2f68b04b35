#include "sim_host/emulator/emulator.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *const file_names[] = {"pil-in", "pil-out", "uart", "nv.bin", "qemu.log"};

static void in_directory(const struct emulator *emulator, const char *name, char *path)
{
    snprintf(path, EMULATOR_PATH_MAX + 16, "%s/%s", emulator->directory, name);
}

static int write_file(const char *path, const uint8_t *bytes, size_t length)
{
    FILE *file = fopen(path, "wb");
    int result = -1;

    if (file == NULL) {
        return -1;
    }
    result = fwrite(bytes, 1, length, file) == length ? 0 : -1;
    return fclose(file) == 0 ? result : -1;
}

static int make_pipes(struct emulator *emulator)
{
    char path[EMULATOR_PATH_MAX + 16];

    /* Open for both directions: neither side waits for the other to open. */
    in_directory(emulator, "pil-in", path);
    if (mkfifo(path, 0600) != 0 || (emulator->to_image = open(path, O_RDWR | O_CLOEXEC)) < 0) {
        return -1;
    }
    in_directory(emulator, "pil-out", path);
    if (mkfifo(path, 0600) != 0 || (emulator->from_image = open(path, O_RDWR | O_CLOEXEC)) < 0) {
        return -1;
    }
    return 0;
}

/* A listening socket that QEMU connects its UART to; in `uart` until it has. */
static int make_socket(struct emulator *emulator)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    char path[EMULATOR_PATH_MAX + 16];

    in_directory(emulator, "uart", path);
    const size_t length = strlen(path);
    if (length >= sizeof address.sun_path) {
        errno = ENAMETOOLONG;
        return -1;
    }
    memcpy(address.sun_path, path, length + 1);
    emulator->uart = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    return emulator->uart >= 0 &&
                   bind(emulator->uart, (const struct sockaddr *)&address, sizeof address) == 0 &&
                   listen(emulator->uart, 1) == 0
               ? 0
               : -1;
}

static int accept_uart(struct emulator *emulator)
{
    struct pollfd ready = {.fd = emulator->uart, .events = POLLIN};
    const int listening = emulator->uart;

    if (poll(&ready, 1, EMULATOR_TIMEOUT_MS) != 1) {
        return -1;
    }
    emulator->uart = accept4(listening, NULL, NULL, SOCK_CLOEXEC);
    close(listening);
    return emulator->uart >= 0 ? 0 : -1;
}

static int make_directory(struct emulator *emulator, enum emulator_link link, const uint8_t *nv,
                          size_t nv_bytes)
{
    const char *base = getenv("TMPDIR");
    char path[EMULATOR_PATH_MAX + 16];

    snprintf(emulator->directory, sizeof emulator->directory, "%s/afo-pil-XXXXXX",
             base != NULL && strlen(base) < 200 ? base : "/tmp");
    if (mkdtemp(emulator->directory) == NULL) {
        emulator->directory[0] = '\0';
        return -1;
    }
    in_directory(emulator, "nv.bin", path);
    if (write_file(path, nv, nv_bytes) != 0) {
        return -1;
    }
    return link == EMULATOR_UART ? make_socket(emulator) : make_pipes(emulator);
}

_Noreturn static void run_qemu(const struct emulator *emulator, enum emulator_link link,
                               const char *image)
{
    char log[EMULATOR_PATH_MAX + 16];
    int null = open("/dev/null", O_RDONLY), out;

    in_directory(emulator, "qemu.log", log);
    out = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    prctl(PR_SET_PDEATHSIG, SIGKILL); /* never outlive the program */
    if (null < 0 || out < 0 || dup2(null, 0) < 0 || dup2(out, 1) < 0 || dup2(out, 2) < 0 ||
        chdir(emulator->directory) != 0) {
        _exit(126);
    }
    const bool uart = link == EMULATOR_UART;
    execlp("qemu-system-arm", "qemu-system-arm", "-machine", "mps2-an386", "-icount", "shift=0",
           "-display", "none", "-monitor", "none", "-chardev",
           uart ? "socket,id=line,path=uart" : "null,id=line", "-serial", "chardev:line",
           "-semihosting-config", "enable=on,target=native", "-kernel", image, "-device",
           "loader,file=nv.bin,addr=0x21000000,force-raw=on", (char *)NULL);
    fprintf(stderr, "qemu-system-arm: %s\n", strerror(errno));
    _exit(127);
}

int emulator_start(struct emulator *emulator, enum emulator_link link, const char *image,
                   const uint8_t *nv, size_t nv_bytes, char *message, size_t message_size)
{
    char absolute[4096];

    *emulator = (struct emulator){.to_image = -1, .from_image = -1, .uart = -1};
    if (realpath(image, absolute) == NULL) {
        snprintf(message, message_size, "%s: %s (make firmware builds it)", image, strerror(errno));
        return -1;
    }
    signal(SIGPIPE, SIG_IGN);
    if (make_directory(emulator, link, nv, nv_bytes) != 0) {
        snprintf(message, message_size, "no place for the emulator's pipes: %s", strerror(errno));
        emulator_stop(emulator);
        return -1;
    }
    emulator->process = fork();
    if (emulator->process == 0) {
        run_qemu(emulator, link, absolute);
    }
    if (emulator->process < 0) {
        emulator->process = 0;
        snprintf(message, message_size, "the emulator does not start: %s", strerror(errno));
        emulator_stop(emulator);
        return -1;
    }
    if (link == EMULATOR_UART && accept_uart(emulator) != 0) {
        snprintf(message, message_size, "the emulator does not connect its UART");
        emulator_stop(emulator);
        return -1;
    }
    return 0;
}

static bool has_died(struct emulator *emulator)
{
    if (emulator->process != 0 && waitpid(emulator->process, NULL, WNOHANG) == emulator->process) {
        emulator->process = 0;
    }
    return emulator->process == 0;
}

int emulator_read(struct emulator *emulator, struct pil_record *record)
{
    size_t used = 0;
    int waited_ms = 0;

    while (used < sizeof *record) {
        struct pollfd ready = {.fd = emulator->from_image, .events = POLLIN};
        const int result = poll(&ready, 1, 500);
        if (result > 0) {
            const ssize_t got =
                read(emulator->from_image, (char *)record + used, sizeof *record - used);
            if (got <= 0) {
                return -1;
            }
            used += (size_t)got;
        } else if (result == 0) {
            waited_ms += 500;
            if (waited_ms >= EMULATOR_TIMEOUT_MS || has_died(emulator)) {
                return -1;
            }
        } else if (errno != EINTR) {
            return -1;
        }
    }
    return record->magic == (uint32_t)PIL_MAGIC && record->count <= PIL_FRAMES ? 0 : -1;
}

int emulator_write(struct emulator *emulator, const struct pil_record *record)
{
    /* A record is shorter than PIPE_BUF: it is written as a whole. */
    return write(emulator->to_image, record, sizeof *record) == (ssize_t)sizeof *record ? 0 : -1;
}

int emulator_uart_read(struct emulator *emulator)
{
    uint8_t byte;
    ssize_t got = recv(emulator->uart, &byte, 1, MSG_DONTWAIT);

    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
        struct pollfd ready = {.fd = emulator->uart, .events = POLLIN};
        (void)kill(emulator->process, SIGCONT);
        const int result = poll(&ready, 1, EMULATOR_TIMEOUT_MS);
        (void)kill(emulator->process, SIGSTOP);
        got = result == 1 ? recv(emulator->uart, &byte, 1, MSG_DONTWAIT) : -1;
    }
    return got == 1 ? byte : -1;
}

int emulator_uart_write(struct emulator *emulator, const char *bytes, size_t length)
{
    return send(emulator->uart, bytes, length, MSG_NOSIGNAL) == (ssize_t)length ? 0 : -1;
}

void emulator_stop(struct emulator *emulator)
{
    char path[EMULATOR_PATH_MAX + 16];

    if (emulator->process != 0) {
        kill(emulator->process, SIGKILL);
        waitpid(emulator->process, NULL, 0);
        emulator->process = 0;
    }
    if (emulator->to_image >= 0) {
        close(emulator->to_image);
    }
    if (emulator->from_image >= 0) {
        close(emulator->from_image);
    }
    if (emulator->uart >= 0) {
        close(emulator->uart);
    }
    emulator->to_image = emulator->from_image = emulator->uart = -1;
    if (emulator->directory[0] == '\0') {
        return;
    }
    for (size_t i = 0; i < sizeof file_names / sizeof file_names[0]; i++) {
        in_directory(emulator, file_names[i], path);
        (void)unlink(path);
    }
    (void)rmdir(emulator->directory);
    emulator->directory[0] = '\0';
}
