/* rig_make.h: the surroundings of the tests of the virtual indenter: the program itself as its firmware, in a
 * folder of its own. To be included first, after _GNU_SOURCE. */
#ifndef RIG_MAKE_H
#define RIG_MAKE_H

#include "shared/cli.h"
#include "app.h"
#include "rig/rig_internal.h"
#include "rig/rig_options.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>
#include <palpate/wire.h>

enum { RECORDS = 400, DUTY = 3000 };
static const char NAME[] = "test";
static char folder[PATH_MAX]; /* of this run of the tests */

static inline const char *in_folder(const char *file) {
    static char path[2 * PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    return path;
}

/* ---- the firmware: keeps what it is fed in a file, and does what FAKE says ---- */

static inline bool is(const char *what) {
    return strcmp(getenv("FAKE"), what) == 0;
}

static inline int fake(char **argv) {
    int in = open(argv[1], O_RDONLY), out = open(argv[2], O_WRONLY);
    int kept = open(getenv("FAKE_RECORDS"), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    plant_out next = {.boot = 1, .version = (uint16_t)(is("version") ? 9 : PLANT_LINK_VERSION)};
    FILE *own = fopen(getenv("FAKE_PID"), "w");
    fprintf(own, "%d\n", (int)getpid());
    fclose(own);
    next.tx_count = 1; /* the first byte of all, as of a firmware that has started */
    for (uint32_t n = 0; !is("mute"); n++) {
        uint8_t record[PLANT_LINK_IN], answer[PLANT_LINK_OUT];
        plant_in now;
        if (is("dies") && n == 5) {
            dprintf(2, "on fire\nit is broken\n");
            return 3;
        }
        plant_link_put_out(&next, answer);
        if (write(out, answer, sizeof answer) < 0 ||
            read(in, record, sizeof record) != (ssize_t)sizeof record ||
            write(kept, record, sizeof record) < 0) {
            return 1;
        }
        plant_link_get_in(record, &now);
        next.boot = (now.events & PLANT_EVENT_HANG) != 0;
        next.duty = DUTY;
        next.motor = !next.boot;
        next.cost = n;
        next.tx_count = now.rx_count; /* sends back what comes, changed, so that the test sees it was here */
        for (int i = 0; i < PLANT_LINK_RX; i++) {
            next.tx[i] = (uint8_t)(now.rx[i] + 1);
        }
        if (now.events & PLANT_EVENT_QUIT) {
            next.tx_count = 0;
            plant_link_put_out(&next, answer);
            return write(out, answer, sizeof answer) < 0;
        }
    }
    pause();
    return 0;
}

/* ---- around a run ---- */

static inline int only_name(const struct dirent *entry) {
    return strncmp(entry->d_name, "palpate.", 8) == 0;
}

static inline void no_folder_is_left(void) {
    struct dirent **list;
    assert_int_equal(scandir(folder, &list, only_name, NULL), 0);
    free(list);
}

static inline void remove_folders(void) {
    struct dirent **list;
    int n = scandir(folder, &list, only_name, NULL);
    for (int i = 0; i < n; i++) {
        static const char *const files[] = {"/in", "/out", ""};
        for (size_t k = 0; k < 3; k++) {
            char path[2 * PATH_MAX + 8];
            snprintf(path, sizeof path, "%s%s", in_folder(list[i]->d_name), files[k]);
            remove(path);
        }
        free(list[i]);
    }
    free(list);
}

static inline rig_settings start_with(const char *what) {
    rig_settings s = rig_settings_default();
    setenv("FAKE", what, 1);
    s.firmware = RIG_HOST;
    s.until_s = 0.05;
    s.plant.actuator.start_m = 0.0115;
    return s;
}

static inline size_t read_records(plant_in *in) {
    uint8_t record[PLANT_LINK_IN];
    FILE *file = fopen(getenv("FAKE_RECORDS"), "r");
    size_t n = 0;
    while (file && n < RECORDS && fread(record, sizeof record, 1, file) == 1) {
        plant_link_get_in(record, &in[n++]);
    }
    if (file) {
        fclose(file);
    }
    return n;
}

static const volatile int go;

/* Runs it, stderr going to a file; that must have text in it if text is not NULL. */
static inline int run(const rig_settings *s, rig_figures *figures, const char *text) {
    char said[1024] = "";
    int kept = dup(2), to = open(in_folder("err"), O_RDWR | O_CREAT | O_TRUNC, 0600);
    dup2(to, 2);
    int code = rig_run(NAME, s, &go, NULL, NULL, figures);
    dup2(kept, 2);
    assert_true(pread(to, said, sizeof said - 1, 0) >= 0);
    close(kept);
    close(to);
    if (text && (!strstr(said, text) || strchr(said, '\n') != said + strlen(said) - 1)) {
        fail_msg("\"%s\" is not one line with \"%s\"", said, text);
    }
    no_folder_is_left();
    return code;
}

/* ---- the program ---- */

/* The firmware that rig_find finds is this program, by a link to it. */
static inline void set_up(void) {
    const char *scratch = getenv("SCRATCH");
    char own[PATH_MAX] = "", base[PATH_MAX];
    snprintf(base, sizeof base, "%s/palpate-test.XXXXXX", scratch && strlen(scratch) < 50 ? scratch : "/tmp");
    if (!mkdtemp(base) || readlink("/proc/self/exe", own, sizeof own - 1) <= 0) {
        exit(1);
    }
    strcpy(folder, base);
    if (symlink(own, in_folder("indenter_host")) != 0) {
        exit(1);
    }
    setenv("TMPDIR", folder, 1);
    setenv("PALPATE_FIRMWARE", folder, 1);
    setenv("FAKE_RECORDS", in_folder("records"), 1);
    setenv("FAKE_PID", in_folder("pid"), 1);
}

static inline void clean_up(void) {
    static const char *const files[] = {"indenter_host", "records", "pid", "err", "log.csv", "script"};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        remove(in_folder(files[i]));
    }
    rmdir(folder);
}

/* As the firmware, or the tests. */
static inline int rig_main(int argc, char **argv, int (*tests)(void)) {
    if (argc == 4 && strcmp(argv[1], "in") == 0) {
        return fake(argv);
    }
    set_up();
    int failed = tests();
    clean_up();
    return failed;
}

#endif
