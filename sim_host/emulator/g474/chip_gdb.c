#include "sim_host/emulator/g474/chip_gdb.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/emulator/g474/chip_gdb_target.h"

enum { BYTES_MAX = (GDB_PACKET_MAX - 8) / 2 };

static void answer(struct chip_gdb *gdb, const char *text)
{
    gdb_link_send(&gdb->link, text);
}

/* `address,count` in hexadecimal; what follows in *rest. */
static bool parse_range(const char *text, uint32_t *address, uint32_t *count, const char **rest)
{
    char *end;

    *address = (uint32_t)strtoul(text, &end, 16);
    if (*end != ',') {
        return false;
    }
    *count = (uint32_t)strtoul(end + 1, &end, 16);
    *rest = end;
    return true;
}

static void read_memory(struct chip_gdb *gdb, const char *text)
{
    uint32_t address, count;
    const char *rest;

    gdb->answer[0] = '\0';
    if (!parse_range(text, &address, &count, &rest) || count > (uint32_t)BYTES_MAX) {
        answer(gdb, "E01");
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        uint8_t byte;
        if (!chip_gdb_read_byte(gdb->chip, address + i, &byte)) {
            break; /* what there is */
        }
        snprintf(gdb->answer + 2 * i, 3, "%02x", byte);
    }
    answer(gdb, gdb->answer[0] != '\0' || count == 0 ? gdb->answer : "E0e");
}

static void write_memory(struct chip_gdb *gdb, const char *text)
{
    uint32_t address, count;
    const char *rest;
    bool good = parse_range(text, &address, &count, &rest) && *rest == ':' &&
                strlen(rest + 1) == 2 * (size_t)count && count <= (uint32_t)BYTES_MAX;

    good = good && chip_gdb_write(gdb->chip, address, count, rest + 1);
    answer(gdb, good ? "OK" : "E0e");
}

static void read_all_registers(struct chip_gdb *gdb)
{
    char *at = gdb->answer;

    for (unsigned i = 0; i < (unsigned)CHIP_GDB_REGISTERS; i++) {
        at += chip_gdb_register_text(gdb->chip, i, at);
    }
    answer(gdb, gdb->answer);
}

static void read_register(struct chip_gdb *gdb, const char *text)
{
    char *end;
    const unsigned long number = strtoul(text, &end, 16);

    if (end == text || number >= (unsigned long)CHIP_GDB_REGISTERS) {
        answer(gdb, "E01");
        return;
    }
    (void)chip_gdb_register_text(gdb->chip, (unsigned)number, gdb->answer);
    answer(gdb, gdb->answer);
}

static void write_registers(struct chip_gdb *gdb, const char *text)
{
    for (unsigned i = 0; i < (unsigned)CHIP_GDB_REGISTERS && *text != '\0'; i++) {
        text = chip_gdb_set_register(gdb->chip, i, text);
        if (text == NULL) {
            answer(gdb, "E01");
            return;
        }
    }
    answer(gdb, "OK");
}

static void write_register(struct chip_gdb *gdb, const char *text)
{
    char *end;
    const unsigned long number = strtoul(text, &end, 16);
    const bool good = end != text && number < (unsigned long)CHIP_GDB_REGISTERS && *end == '=' &&
                      chip_gdb_set_register(gdb->chip, (unsigned)number, end + 1) != NULL;

    answer(gdb, good ? "OK" : "E01");
}

/* Z0 and Z1: breakpoints in memory and in hardware are the same here. */
static void set_breakpoint(struct chip_gdb *gdb, const char *text, bool on)
{
    uint32_t address, kind;
    const char *rest;

    if ((text[0] != '0' && text[0] != '1') || text[1] != ',') {
        answer(gdb, ""); /* watchpoints: not offered */
    } else if (!parse_range(text + 2, &address, &kind, &rest)) {
        answer(gdb, "E01");
    } else {
        answer(gdb, core_break(&gdb->chip->core, address, on) == 0 ? "OK" : "E0e");
    }
}

static void tell_features(struct chip_gdb *gdb, const char *text)
{
    uint32_t offset, count;
    const char *rest;
    const char *xml = chip_gdb_description();

    if (strncmp(text, "target.xml:", 11) != 0 || !parse_range(text + 11, &offset, &count, &rest)) {
        answer(gdb, "E00");
        return;
    }
    const size_t length = strlen(xml);
    const size_t left = offset < length ? length - offset : 0;
    const size_t room = count < GDB_PACKET_MAX - 2 ? count : GDB_PACKET_MAX - 2;
    const bool is_last = left <= room;
    const size_t part = is_last ? left : room;
    gdb->answer[0] = is_last ? 'l' : 'm';
    memcpy(gdb->answer + 1, xml + (left > 0 ? offset : 0), part);
    gdb->answer[1 + part] = '\0';
    answer(gdb, gdb->answer);
}

static void answer_query(struct chip_gdb *gdb, const char *packet)
{
    if (strncmp(packet, "qSupported", 10) == 0) {
        answer(gdb, "PacketSize=fff;qXfer:features:read+;QStartNoAckMode+");
    } else if (strncmp(packet, "qXfer:features:read:", 20) == 0) {
        tell_features(gdb, packet + 20);
    } else if (strcmp(packet, "QStartNoAckMode") == 0) {
        answer(gdb, "OK");
        gdb->link.no_acks = true;
    } else if (strcmp(packet, "qAttached") == 0) {
        answer(gdb, "1");
    } else if (strcmp(packet, "qC") == 0) {
        answer(gdb, "QC1");
    } else if (strcmp(packet, "qfThreadInfo") == 0) {
        answer(gdb, "m1");
    } else if (strcmp(packet, "qsThreadInfo") == 0) {
        answer(gdb, "l");
    } else {
        answer(gdb, "");
    }
}

static void leave(struct chip_gdb *gdb)
{
    gdb->attached = false;
    gdb->chip->debug = NULL;
    gdb->chip->debug_step = gdb->chip->debug_halted = false;
    core_break_none(&gdb->chip->core);
    gdb_link_drop(&gdb->link);
}

/* `c', `s', with or without an address. */
static void go_on(struct chip_gdb *gdb, const char *packet)
{
    struct chip *chip = gdb->chip;

    if (packet[1] != '\0') {
        chip->pc = (uint32_t)strtoul(packet + 1, NULL, 16) & ~1u;
    }
    chip->debug_step = packet[0] == 's';
    chip->debug_halted = false;
    core_pass_break(&chip->core, chip->pc);
}

static void obey(struct chip_gdb *gdb, const char *packet)
{
    switch (packet[0]) {
    case '?':
        answer(gdb, "S05");
        break;
    case 'g':
        read_all_registers(gdb);
        break;
    case 'G':
        write_registers(gdb, packet + 1);
        break;
    case 'p':
        read_register(gdb, packet + 1);
        break;
    case 'P':
        write_register(gdb, packet + 1);
        break;
    case 'm':
        read_memory(gdb, packet + 1);
        break;
    case 'M':
        write_memory(gdb, packet + 1);
        break;
    case 'Z':
    case 'z':
        set_breakpoint(gdb, packet + 1, packet[0] == 'Z');
        break;
    case 'c':
    case 's':
        go_on(gdb, packet);
        break;
    case 'D':
        answer(gdb, "OK");
        leave(gdb);
        break;
    case 'k':
        leave(gdb);
        break;
    case 'H':
    case 'T':
        answer(gdb, "OK"); /* there is one thread */
        break;
    case 'q':
    case 'Q':
        answer_query(gdb, packet);
        break;
    default:
        answer(gdb, "");
        break;
    }
}

/* Between two runs of the core. */
static void look(void *context)
{
    struct chip_gdb *gdb = context;
    struct chip *chip = gdb->chip;
    static char packet[GDB_PACKET_MAX];

    if (!chip->debug_halted && !gdb_link_interrupts(&gdb->link)) {
        return;
    }
    chip->debug_halted = true;
    chip->debug_step = false;
    answer(gdb, "S05");
    while (gdb->attached && chip->debug_halted) {
        if (gdb_link_receive(&gdb->link, packet) < 0) {
            leave(gdb);
            return;
        }
        obey(gdb, packet);
    }
}

/* The first stop is asked for (`?'), the others are told. */
static void halt_at_start(struct chip_gdb *gdb)
{
    static char packet[GDB_PACKET_MAX];

    gdb->chip->debug_halted = true;
    while (gdb->attached && gdb->chip->debug_halted) {
        if (gdb_link_receive(&gdb->link, packet) < 0) {
            leave(gdb);
            return;
        }
        obey(gdb, packet);
    }
}

int chip_gdb_open(struct chip_gdb *gdb, struct chip *chip, unsigned port)
{
    const int own = gdb_link_listen(&gdb->link, port);

    gdb->chip = chip;
    if (own < 0) {
        return -1;
    }
    fprintf(stderr, "gdb: target remote 127.0.0.1:%d\n", own);
    if (gdb_link_accept(&gdb->link) != 0) {
        return -1;
    }
    gdb->attached = true;
    chip->debug = look;
    chip->debug_context = gdb;
    halt_at_start(gdb);
    return 0;
}

void chip_gdb_close(struct chip_gdb *gdb)
{
    if (gdb->attached) {
        answer(gdb, "W00");
        leave(gdb);
    }
    if (gdb->chip != NULL) {
        gdb_link_close(&gdb->link);
    }
}
