/* semihosting.c: system calls by the instruction that a debugger or QEMU intercepts. */
#include "semihosting.h"

enum {
    SYS_OPEN = 1,
    SYS_WRITE0 = 4,
    SYS_WRITE = 5,
    SYS_READ = 6,
    SYS_SEEK = 10,
    SYS_GET_CMDLINE = 0x15,
    SYS_EXIT = 0x18
};
enum {
    OPEN_READ = 1,
    OPEN_UPDATE = 3,
    OPEN_WRITE = 5,
    OPEN_NEW = 7,
    COMMAND_LINE = 512,
    EXIT_GOOD = 0x20026,
    EXIT_BAD = 0x20023
};

/* Handles. */
static struct {
    uint32_t in;
    uint32_t out;
    uint32_t store;
    bool keeps; /* there is a store */
} fifo;

static int32_t call(uint32_t operation, uintptr_t argument) {
    register uint32_t r0 __asm("r0") = operation;
    register uintptr_t r1 __asm("r1") = argument;
    __asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return (int32_t)r0;
}

static int32_t call3(uint32_t operation, uintptr_t a, uintptr_t b, uintptr_t c) {
    const uintptr_t block[3] = {a, b, c};
    return call(operation, (uintptr_t)block);
}

/* Ends the word at its first space. Returns where the next word begins, or the end. */
static char *cut_word(char *word) {
    while (*word != ' ' && *word != '\0')
        word++;
    if (*word == ' ')
        *word++ = '\0';
    return word;
}

static bool open_file(const char *path, uint32_t mode, uint32_t *handle) {
    uint32_t n = 0;
    while (path[n] != '\0')
        n++;
    *handle = (uint32_t)call3(SYS_OPEN, (uintptr_t)path, mode, n);
    return n > 0 && *handle != UINT32_MAX;
}

static void give_up(const char *why) {
    call(SYS_WRITE0, (uintptr_t)why);
    semihosting_exit(false);
}

void semihosting_open(void) {
    static char line[COMMAND_LINE];
    uintptr_t block[2] = {(uintptr_t)line, COMMAND_LINE};
    if (call(SYS_GET_CMDLINE, (uintptr_t)block) == 0) {
        char *second = cut_word(line);
        char *third = cut_word(second);
        cut_word(third);
        fifo.keeps = open_file(third, OPEN_UPDATE, &fifo.store) || open_file(third, OPEN_NEW, &fifo.store);
        if (open_file(line, OPEN_READ, &fifo.in) && open_file(second, OPEN_WRITE, &fifo.out))
            return;
    }
    give_up("rig.elf: cannot open the two FIFOs that -semihosting-config arg=...,arg=... should name\n");
}

/* SYS_READ and SYS_WRITE return how much is left to do. */
void semihosting_read(uint8_t *byte, uint32_t n) {
    while (n > 0) {
        const uint32_t left = (uint32_t)call3(SYS_READ, fifo.in, (uintptr_t)byte, n);
        if (left >= n)
            give_up("rig.elf: the plant has gone\n");
        byte += n - left;
        n = left;
    }
}

void semihosting_write(const uint8_t *byte, uint32_t n) {
    if (call3(SYS_WRITE, fifo.out, (uintptr_t)byte, n) != 0)
        give_up("rig.elf: the plant has gone\n");
}

static bool seek_word(uint32_t at) {
    const uintptr_t block[2] = {fifo.store, at * sizeof(uint32_t)};
    return fifo.keeps && call(SYS_SEEK, (uintptr_t)block) == 0;
}

/* SYS_READ stops at the end of the file. */
void semihosting_recall(uint32_t *word, uint32_t n) {
    if (seek_word(0))
        (void)call3(SYS_READ, fifo.store, (uintptr_t)word, n * sizeof *word);
}

void semihosting_keep(uint32_t at, const uint32_t *word, uint32_t n) {
    if (fifo.keeps &&
        (!seek_word(at) || call3(SYS_WRITE, fifo.store, (uintptr_t)word, n * sizeof *word) != 0))
        give_up("rig.elf: the file of the parameters cannot be written\n");
}

void semihosting_exit(bool good) {
    call(SYS_EXIT, good ? EXIT_GOOD : EXIT_BAD);
}
