/* rig_process.c: the firmware as a child process, under QEMU or by itself: found, started, listened to,
 * ended. */
#define _GNU_SOURCE
#include "shared/cli.h"
#include "rig_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { PARTING_MS = 1000, ARGUMENTS = 32, FOLDER_MOST = 80 };
static const char QEMU[] = "qemu-system-arm", QEMU_IMAGE[] = "rig.elf", HOST_IMAGE[] = "indenter_host";

/* folder/file, or folder/inner/file; false if it is not there. */
static bool look_in(const char *folder, const char *inner, const char *file, char path[RIG_PATH]) {
    int n = snprintf(path, RIG_PATH, "%s/%s%s", folder, inner, file);
    return n > 0 && n < RIG_PATH && access(path, R_OK) == 0;
}

/* The folder of this program, without the slash. */
static bool own_folder(char folder[RIG_PATH]) {
    ssize_t n = readlink("/proc/self/exe", folder, RIG_PATH - 1);
    folder[n > 0 ? n : 0] = '\0';
    char *slash = strrchr(folder, '/');
    if (slash)
        *slash = '\0';
    return slash != NULL;
}

bool rig_find_image(const char *file, char path[RIG_PATH]) {
    char folder[RIG_PATH];
    const char *given = getenv("PALPATE_FIRMWARE");
    if (given && *given)
        return look_in(given, "", file, path);
    return own_folder(folder) &&
           (look_in(folder, "firmware/", file, path) || look_in(folder, "../lib/palpate/", file, path));
}

/* The first line of qemu-system-arm --version up to its bracket: "QEMU 7.2.22". */
static bool find_qemu(char version[RIG_NOTE]) {
    char line[RIG_NOTE] = "";
    FILE *answer = popen("exec qemu-system-arm --version 2>/dev/null", "r");
    bool there = answer && fgets(line, sizeof line, answer);
    there = answer && pclose(answer) == 0 && there;
    const char *number = strstr(line, "version ");
    number = number ? number + strlen("version ") : "";
    snprintf(version, RIG_NOTE, "QEMU %.*s", (int)strcspn(number, " (\n"), number);
    return there;
}

bool rig_find(rig_settings *settings, char note[RIG_NOTE]) {
    char version[RIG_NOTE], found[RIG_PATH];
    bool qemu = settings->firmware != RIG_HOST && find_qemu(version);
    if (settings->firmware == RIG_QEMU && !qemu) {
        snprintf(note, RIG_NOTE, "%s is not installed; apt-get install qemu-system-arm, or --firmware host",
                 QEMU);
        return false;
    }
    if (qemu && rig_find_image(QEMU_IMAGE, found)) {
        settings->firmware = RIG_QEMU;
        snprintf(note, RIG_NOTE, "the STM32F405 image under %.64s", version);
    } else if (settings->firmware != RIG_QEMU && rig_find_image(HOST_IMAGE, found)) {
        settings->firmware = RIG_HOST;
        snprintf(note, RIG_NOTE, "the host process");
    } else {
        snprintf(note, RIG_NOTE,
                 "there is no %s%s%s; make firmware firmware-host, or name its folder in PALPATE_FIRMWARE",
                 qemu ? QEMU_IMAGE : "", qemu && settings->firmware == RIG_AUTO ? " or " : "",
                 settings->firmware == RIG_QEMU ? "" : HOST_IMAGE);
        return false;
    }
    return realpath(found, settings->image) != NULL;
}

/* Makes a folder for the FIFOs. */
static bool make_folder(char folder[RIG_PATH]) {
    const char *base = getenv("TMPDIR");
    if (!base || *base != '/' || strlen(base) > FOLDER_MOST ||
        strchr(base, ',')) { /* QEMU splits its arguments at commas */
        base = "/tmp";
    }
    snprintf(folder, RIG_PATH, "%s/palpate.XXXXXX", base);
    bool made = mkdtemp(folder) != NULL;
    folder[made ? strlen(folder) : 0] = '\0';
    return made;
}

/* QEMU's two threads wait for each other all the time, which is faster on one processor than on two. */
static void stay_on_one_processor(void) {
    cpu_set_t here;
    int cpu = sched_getcpu();
    if (cpu >= 0) {
        CPU_ZERO(&here);
        CPU_SET((size_t)cpu, &here);
        sched_setaffinity(0, sizeof here, &here);
    }
}

/* Becomes the firmware. It runs in the folder with the FIFOs, so that their names need no quoting. */
static void become(const rig_settings *s, const rig_process *p, pid_t parent) {
    /* clang-format off */
    const char *const under_qemu[] = {
        QEMU, "-M", "netduinoplus2", "-kernel", s->image, "-display", "none", "-monitor", "none",
        "-icount", "shift=3,sleep=off", "-semihosting-config",
        "enable=on,target=native,arg=in,arg=out,arg=store", "-serial", "none", NULL};
    const char *const as_process[] = {s->image, "in", "out", "store", NULL};
    /* clang-format on */
    const char *const *wanted = s->firmware == RIG_QEMU ? under_qemu : as_process;
    char *list[ARGUMENTS] = {NULL};
    for (size_t i = 0; wanted[i]; i++)
        list[i] = strdup(wanted[i]);
    if (s->firmware == RIG_QEMU)
        stay_on_one_processor();
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == parent && setpgid(0, 0) == 0 && chdir(p->folder) == 0)
        execvp(list[0], list);
    fprintf(stderr, "%s: %s\n", list[0] ? list[0] : "firmware", strerror(errno));
    _exit(127);
}

/* Both ends stay open here, so that neither opening them waits nor a restart of the firmware closes them. */
static int open_fifo(const char *folder, const char *name) {
    char path[RIG_PATH + 8];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return mkfifo(path, 0600) == 0 ? open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1;
}

/* The flash: a file in the folder, which is removed with it, or one elsewhere. */
static bool link_store(const char *folder, const char *store) {
    char path[RIG_PATH + 8], here[RIG_PATH], whole[2 * RIG_PATH + 2];
    if (!store)
        return true;
    snprintf(path, sizeof path, "%s/store", folder);
    if (*store != '/' && !getcwd(here, sizeof here))
        return false;
    snprintf(whole, sizeof whole, "%s%s%s", *store == '/' ? "" : here, *store == '/' ? "" : "/", store);
    return symlink(whole, path) == 0;
}

static int start_failed(const char *name, const char *what) {
    return cli_failure(name, "cannot start the firmware: %s: %s", what, strerror(errno));
}

int rig_process_start(const char *name, const rig_settings *settings, rig_process *p) {
    int text[2] = {-1, -1};
    *p = (rig_process){.to = -1, .from = -1, .text = -1};
    if (!make_folder(p->folder))
        return start_failed(name, "a temporary folder");
    p->to = open_fifo(p->folder, "in");
    p->from = open_fifo(p->folder, "out");
    if (p->to < 0 || p->from < 0 || pipe2(text, O_CLOEXEC | O_NONBLOCK) != 0)
        return start_failed(name, p->folder);
    p->text = text[0];
    if (!link_store(p->folder, settings->store))
        return start_failed(name, settings->store);
    pid_t parent = getpid();
    p->pid = fork();
    if (p->pid == 0) {
        int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
        fcntl(text[1], F_SETFL, 0);
        if (dup2(nothing, 0) >= 0 && dup2(text[1], 1) >= 0 && dup2(text[1], 2) >= 0)
            become(settings, p, parent);
        _exit(127);
    }
    close(text[1]);
    return p->pid > 0 ? CLI_OK : start_failed(name, "fork");
}

static void take_line(rig_process *p) {
    p->line[p->n] = '\0';
    if (p->n > 0)
        strcpy(p->last, p->line);
    p->n = 0;
}

bool rig_process_listen(rig_process *p) {
    char text[1024];
    ssize_t n;
    while ((n = read(p->text, text, sizeof text)) > 0) {
        for (ssize_t i = 0; i < n; i++) {
            if (text[i] == '\n')
                take_line(p);
            else if (p->n + 1 < sizeof p->line)
                p->line[p->n++] = text[i];
        }
    }
    if (n == 0)
        take_line(p);
    return n < 0 && (errno == EAGAIN || errno == EINTR);
}

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void close_one(int fd) {
    if (fd >= 0)
        close(fd);
}

/* With its FIFOs closed it ends by itself. It has ended when its output is at the end. */
static void part(rig_process *p) {
    double until_s = now_s() + 1e-3 * PARTING_MS;
    struct pollfd one = {.fd = p->text, .events = POLLIN};
    while (rig_process_listen(p) && now_s() < until_s)
        poll(&one, 1, 10);
    kill(p->pid, SIGKILL);
    while (waitpid(p->pid, NULL, 0) < 0 && errno == EINTR) {
    }
}

static void remove_in(const char *folder, const char *name) {
    char path[RIG_PATH + 8];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    unlink(path);
}

void rig_process_end(rig_process *p) {
    close_one(p->to);
    close_one(p->from);
    if (p->pid > 0)
        part(p);
    close_one(p->text);
    if (p->folder[0]) {
        remove_in(p->folder, "in");
        remove_in(p->folder, "out");
        remove_in(p->folder, "store");
        rmdir(p->folder);
    }
}
