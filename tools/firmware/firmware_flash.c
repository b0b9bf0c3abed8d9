/* firmware_flash.c: the board's image, written through the chip's own boot loader by the programs that speak
 * with it. */
#define _POSIX_C_SOURCE 200809L
#include "firmware_flash.h"

#include "rig/rig.h"
#include "shared/cli.h"

#include <errno.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { FLASH = 0x08000000, FLASH_MOST = 65536, RAM = 0x20000000, RAM_MOST = 0x20000, VECTORS = 8 };

static const char IMAGE[] = "indenter.bin";

/* ---- the image ---- */

static uint32_t word(const unsigned char *byte) {
    return byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
}

/* It begins with where its stack ends and where it starts, an odd address: what anything else hardly does. */
static bool begins_as_image(const unsigned char first[VECTORS], long size) {
    const uint32_t stack = word(first), start = word(first + 4);
    return stack > RAM && stack <= RAM + RAM_MOST && start % 2 == 1 && start > FLASH &&
           start < FLASH + (uint32_t)size;
}

static int check_image(const char *name, const char *path) {
    unsigned char first[VECTORS];
    FILE *f = fopen(path, "rb");
    if (!f)
        return cli_failure(name, "%s: %s", path, strerror(errno));
    bool good = fread(first, 1, sizeof first, f) == sizeof first && fseek(f, 0, SEEK_END) == 0;
    const long size = good ? ftell(f) : 0;
    fclose(f);
    if (!good || size > FLASH_MOST || !begins_as_image(first, size))
        return cli_failure(name, "%s is no image for the indenter's board; make firmware builds %s", path,
                           IMAGE);
    return CLI_OK;
}

static int find_image(const char *name, const char *given, char path[RIG_PATH]) {
    if (given)
        snprintf(path, RIG_PATH, "%s", given);
    else if (!rig_find_image(IMAGE, path))
        return cli_failure(name, "there is no %s: make firmware builds it, or name one with --image", IMAGE);
    return check_image(name, path);
}

/* ---- the program ---- */

/* Its exit code; what it says goes to standard error. -1: it is not installed, or something else, in errno.
 */
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

static int run_tool(const char *name, const char **argv, const char *hint) {
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

int firmware_flash(const char *name, const char *port, const char *image) {
    char path[RIG_PATH];
    const bool usb = strcmp(port, "dfu") == 0;
    const char *over_serial[] = {"stm32flash", "-b", "115200", "-w", path, "-v", port, NULL};
    const char *over_usb[] = {"dfu-util",         "-a", "0",  "-d", "0483:df11", "-s",
                              "0x08000000:leave", "-D", path, NULL};
    const char *colon = strchr(port, ':');
    if (!usb && colon && strncmp(port, "/dev/", 5) != 0)
        return cli_usage_error(name, "flash wants a serial port such as /dev/ttyUSB0, or dfu, not \"%s\"",
                               port);
    int code = find_image(name, image, path);
    code = code  ? code
           : usb ? run_tool(name, over_usb, "is the board at USB, and was it reset with BOOT0 high?")
                 : run_tool(name, over_serial,
                            "was the board reset with BOOT0 high, and is the port right and free?");
    if (code == CLI_OK)
        fprintf(stderr, "palpate %s: %s is written and verified; %s\n", name, path,
                usb ? "the board starts it" : "BOOT0 low and a reset start it");
    return code;
}
