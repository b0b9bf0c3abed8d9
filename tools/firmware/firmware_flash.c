/* firmware_flash.c: the board's image, written through the chip's own boot loader by the programs that speak
 * with it; never one for another kind of board. */
#define _POSIX_C_SOURCE 200809L
#include "firmware_flash.h"

#include "identity.h"
#include "rig/rig.h"
#include "shared/temporary.h"

#include <errno.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { FLASH = 0x08000000, FLASH_MOST = 65536, RAM = 0x20000000, RAM_MOST = 0x20000, VECTORS = 8, KIND = 17 };

/* The first bytes of an image, or of what is in a board. */
typedef struct beginning {
    size_t n;
    long size; /* of the whole file */
    unsigned char byte[IDENTITY_WITHIN];
} beginning;

static bool read_beginning(const char *path, beginning *b) {
    FILE *f = fopen(path, "rb");
    *b = (beginning){.n = 0};
    if (!f)
        return false;
    b->n = fread(b->byte, 1, sizeof b->byte, f);
    b->size = fseek(f, 0, SEEK_END) == 0 ? ftell(f) : 0;
    fclose(f);
    return true;
}

/* The kind of board that it names, of plain letters; empty where it names none. */
static void find_kind(const beginning *b, char kind[KIND]) {
    const size_t mark = sizeof IDENTITY_MARK - 1;
    size_t i = 0;
    while (i + mark + KIND <= b->n && memcmp(b->byte + i, IDENTITY_MARK, mark) != 0)
        i++;
    kind[0] = '\0';
    if (i + mark + KIND <= b->n)
        snprintf(kind, KIND, "%.*s", KIND - 1, (const char *)b->byte + i + mark);
    kind[strspn(kind, "abcdefghijklmnopqrstuvwxyz0123456789_")] = '\0';
}

static uint32_t word(const unsigned char *byte) {
    return byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
}

/* It begins with the end of its stack and with where it starts, an odd address: other files hardly do. */
static bool begins_as_image(const beginning *b) {
    const uint32_t stack = word(b->byte), start = word(b->byte + 4);
    return b->n >= VECTORS && b->size <= FLASH_MOST && stack > RAM && stack <= RAM + RAM_MOST &&
           start % 2 == 1 && start > FLASH && start < FLASH + (uint32_t)b->size;
}

static int check_image(const char *name, const char *path, const char *board) {
    beginning b;
    char kind[KIND];
    if (!read_beginning(path, &b))
        return cli_failure(name, "%s: %s", path, strerror(errno));
    find_kind(&b, kind);
    if (!begins_as_image(&b) || !kind[0])
        return cli_failure(name, "%s is no image for an indenter's board; make firmware builds them", path);
    if (strcmp(kind, board) != 0)
        return cli_failure(
            name,
            "%s is for the board %s, and this board is %s: nothing was written; if its parts were "
            "changed, name its kind with --board",
            path, kind, board);
    return CLI_OK;
}

/* The one that came with this program for that kind of board. */
static int find_image(const char *name, const char *board, char path[RIG_PATH]) {
    char file[KIND + 8];
    snprintf(file, sizeof file, "%s.bin", strcmp(board, "stm32f405") == 0 ? "indenter" : board);
    if (!rig_find_image(file, path))
        return cli_failure(
            name, "there is no %s for the board %s: make firmware builds it, or name one with --image", file,
            board);
    return CLI_OK;
}

/* Its exit code; its output goes to standard error. -1: it did not start, errno says why. */
static int run(const char **argv) {
    posix_spawn_file_actions_t files;
    pid_t child;
    int status = 0;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
    errno = posix_spawnp(&child, argv[0], &files, NULL, (char *const *)argv, environ);
    posix_spawn_file_actions_destroy(&files);
    if (errno)
        return -1;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static int run_tool(const char *name, const char **argv, bool usb) {
    const char *hint = usb ? "is the board at USB, and was it reset with BOOT0 high?"
                           : "was the board reset with BOOT0 high, and is the port right and free?";
    const int code = run(argv);
    if (code < 0 && errno == ENOENT)
        return cli_failure(name, "there is no %s: install it (on Debian: sudo apt install %s)", argv[0],
                           argv[0]);
    if (code < 0)
        return cli_failure(name, "%s: %s", argv[0], strerror(errno));
    if (code > 0)
        return cli_failure(name, "%s failed (exit code %d): %s", argv[0], code, hint);
    return CLI_OK;
}

static int read_board(const char *name, const char *port, bool usb, const char *path) {
    const char *over_serial[] = {"stm32flash",      "-b", "115200", "-r", path, "-S",
                                 "0x08000000:1024", port, NULL};
    const char *over_usb[] = {"dfu-util",        "-a", "0",  "-d", "0483:df11", "-s",
                              "0x08000000:1024", "-U", path, NULL};
    return run_tool(name, usb ? over_usb : over_serial, usb);
}

/* Which kind of board it is, by the firmware that is in it. */
static int ask_board(const char *name, const char *port, bool usb, char kind[KIND]) {
    char folder[CLI_PATH_MAX], path[sizeof folder + 8];
    beginning b;
    int code = temporary_folder_make(name, folder);
    if (code)
        return code;
    snprintf(path, sizeof path, "%s/board", folder);
    code = read_board(name, port, usb, path);
    bool read = read_beginning(path, &b);
    temporary_folder_remove(folder);
    find_kind(&b, kind);
    if (code == CLI_OK && (!read || !kind[0]))
        return cli_failure(name,
                           "the board has no firmware of palpate yet: say which board it is with --board");
    return code;
}

static int write_board(const char *name, const char *port, bool usb, const char *path) {
    const char *over_serial[] = {"stm32flash", "-b", "115200", "-w", path, "-v", port, NULL};
    const char *over_usb[] = {"dfu-util",         "-a", "0",  "-d", "0483:df11", "-s",
                              "0x08000000:leave", "-D", path, NULL};
    const int code = run_tool(name, usb ? over_usb : over_serial, usb);
    if (code == CLI_OK)
        cli_note(name, "%s is written and verified; %s", path,
                 usb ? "the board starts it" : "BOOT0 low and a reset start it");
    return code;
}

int firmware_flash(const char *name, const char *port, const char *board, const char *image) {
    char path[RIG_PATH], kind[KIND];
    const bool usb = strcmp(port, "dfu") == 0;
    const char *colon = strchr(port, ':');
    int code = CLI_OK;
    if (!usb && colon && strncmp(port, "/dev/", 5) != 0)
        return cli_usage_error(name, "flash wants a serial port such as /dev/ttyUSB0, or dfu, not \"%s\"",
                               port);
    if (board)
        snprintf(kind, sizeof kind, "%s", board);
    else
        code = ask_board(name, port, usb, kind);
    if (image)
        snprintf(path, sizeof path, "%s", image);
    else
        code = code ? code : find_image(name, kind, path);
    code = code ? code : check_image(name, path, kind);
    return code ? code : write_board(name, port, usb, path);
}
