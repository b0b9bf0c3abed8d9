/* cmd_batch.c: palpate batch: any command over many inputs. */
#define _GNU_SOURCE /* sched_getaffinity */
#include "batch.h"
#include "shared/commands.h"

#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { JOBS_MAX = 1024, TASKS_MAX = 100000, FAILED_SHOWN = 10 };

/* Those that this process may run on. */
static size_t processors(void) {
    cpu_set_t set;
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    int n = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : (int)online;
    return n < 1 ? 1 : n > JOBS_MAX ? JOBS_MAX : (size_t)n;
}

static bool read_count(const char *text, size_t most, size_t *value) {
    char *end = NULL;
    unsigned long n = text && *text >= '0' && *text <= '9' ? strtoul(text, &end, 10) : 0;
    *value = n;
    return end && !*end && n <= most;
}

/* The number of this process and how many there are, as mpirun or srun tell them. */
static bool find_rank(size_t *rank, size_t *ranks) {
    static const char *const names[][2] = {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
                                           {"PMI_RANK", "PMI_SIZE"},
                                           {"SLURM_PROCID", "SLURM_NTASKS"}};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (read_count(getenv(names[i][0]), TASKS_MAX, rank) &&
            read_count(getenv(names[i][1]), TASKS_MAX, ranks) && *rank < *ranks)
            return true;
    return false;
}

static int read_task(batch_options *o) {
    char first[32] = "";
    const char *slash = o->under_mpi ? NULL : strchr(o->task_text, '/');
    o->is_task = true;
    if (o->under_mpi)
        return find_rank(&o->task, &o->tasks)
                   ? CLI_OK
                   : cli_usage_error(BATCH_NAME, "--mpi needs mpirun or srun, which number the tasks");
    if (slash && (size_t)(slash - o->task_text) < sizeof first)
        memcpy(first, o->task_text, (size_t)(slash - o->task_text));
    return slash && read_count(first, TASKS_MAX, &o->task) && read_count(slash + 1, TASKS_MAX, &o->tasks) &&
                   o->task < o->tasks
               ? CLI_OK
               : cli_usage_error(BATCH_NAME, "--task must be I/N with I from 0 to N - 1, not \"%s\"",
                                 o->task_text);
}

static int check(batch_options *o, size_t n_words) {
    if (!o->template && n_words != 1)
        return cli_usage_error(BATCH_NAME, "name one manifest; see palpate batch --help");
    if (o->template && n_words == 0)
        return cli_usage_error(BATCH_NAME, "name the inputs of --template; see palpate batch --help");
    if (!o->out)
        return cli_usage_error(BATCH_NAME, "name a folder for the results by --out");
    const bool task = o->task_text || o->under_mpi;
    if (task && (o->collect || o->slurm || (o->task_text && o->under_mpi)))
        return cli_usage_error(BATCH_NAME, "--task, --mpi, --collect and --slurm exclude each other");
    if (o->slurm && (o->template || o->collect))
        return cli_usage_error(BATCH_NAME, "--slurm needs a manifest and excludes --collect");
    int code = task ? read_task(o) : CLI_OK;
    o->jobs = o->jobs ? o->jobs : o->under_mpi ? 1 : processors();
    return code;
}

static int parse(int argc, char **argv, batch_options *o, const char **words, size_t *n_words) {
    const cli_option options[] = {
        cli_heading("Jobs"),
        cli_text("template", "COMMAND", &o->template,
                 "a command between quotes, for each file that is named after it;\n"
                 "{input}, {name} and {index} are replaced, blanks part its words, a\n"
                 "word with *, ? or [ becomes the files that match it"),
        cli_count("jobs", "N", 1, JOBS_MAX, &o->jobs, "processes at once (default: the processors)"),
        cli_flag("retry-failed", &o->retry_failed, "repeat jobs that ended with another status than 0"),
        cli_heading("Output"),
        cli_out_folder("out", "DIR", &o->out, "table.csv index.html slurm.sh",
                       "folder of NAME.out, NAME.err, table.csv, index.html and journal"),
        cli_heading("Many machines"),
        cli_text("task", "I/N", &o->task_text, "only each N-th job from job I on, I from 0 to N - 1"),
        cli_flag("mpi", &o->under_mpi, "the same, with I and N as mpirun or srun number this process"),
        cli_flag("collect", &o->collect, "only collect what tasks did"),
        cli_count("slurm", "N", 1, TASKS_MAX, &o->slurm,
                  "only write DIR/slurm.sh, which submits N tasks and collects"),
    };
    const cli_command command = {
        BATCH_NAME,
        "MANIFEST.json --out DIR | --template COMMAND FILES ... --out DIR",
        "Runs any command of palpate over many inputs, several at a time. The same command resumes a\n"
        "batch that was interrupted: jobs that ended with the same arguments are not repeated. The JSON\n"
        "that the jobs print becomes one table.",
        "  palpate batch batch.json --out results\n"
        "  palpate batch --template 'characterize {input} --json' runs/*.csv --out results\n",
        options,
        sizeof options / sizeof options[0]};
    int code = cli_parse(&command, argc, argv, words, (size_t)argc, n_words);
    return code ? code : check(o, *n_words);
}

/* ---- a command on the command line ---- */

static char **split(char *text, size_t *n) {
    char **words = calloc(strlen(text) / 2 + 2, sizeof *words), *rest = NULL;
    *n = 0;
    for (char *word = strtok_r(text, " \t", &rest); words && word; word = strtok_r(NULL, " \t", &rest))
        words[(*n)++] = word;
    return words;
}

static int fill(batch_plan *plan, const batch_template *from, size_t n, const char *const *inputs) {
    if (!from->words || from->n_words == 0 || !plan->by_name || !plan->folder)
        return from->words && from->n_words == 0 ? cli_usage_error(BATCH_NAME, "--template has no command")
                                                 : cli_failure(BATCH_NAME, "out of memory");
    for (size_t i = 0; i < n; i++) {
        const char *fault = batch_plan_fill(plan, from, inputs[i]);
        if (fault)
            return cli_failure(BATCH_NAME, "%s: the job's name %s", inputs[i], fault);
    }
    const batch_job *twice = batch_plan_sort(plan);
    return twice ? cli_failure(BATCH_NAME, "%s: the name \"%s\" is that of an earlier job",
                               inputs[twice->number], twice->name)
                 : CLI_OK;
}

static int plan_of_template(const batch_options *o, size_t n, const char *const *inputs, batch_plan *plan) {
    char *text = strdup(o->template);
    batch_template from = {0, NULL, "{name}"};
    from.words = text ? split(text, &from.n_words) : NULL;
    plan->folder = strdup(".");
    plan->by_name = malloc(n * sizeof *plan->by_name);
    int code = fill(plan, &from, n, inputs);
    free(from.words);
    free(text);
    return code;
}

/* ---- results ---- */

typedef struct tally {
    size_t mine, good, failed, open;
    bool not_converged_only;
} tally;

static tally count(const batch_options *o, const batch_plan *plan) {
    tally t = {.not_converged_only = true};
    for (size_t i = 0; i < plan->n; i++) {
        const batch_job *job = &plan->job[i];
        bool mine = batch_is_mine(o, job), failed = job->ended && job->status;
        t.mine += mine;
        t.good += mine && job->ended && !job->status;
        t.failed += mine && failed;
        t.open += mine && !job->ended;
        t.not_converged_only = t.not_converged_only && (!mine || !failed || job->status == CLI_NOT_CONVERGED);
    }
    return t;
}

static void say_failed(const batch_options *o, const batch_plan *plan, size_t failed) {
    char words[256];
    size_t shown = 0;
    for (size_t i = 0; i < plan->n && shown < FAILED_SHOWN; i++) {
        const batch_job *job = &plan->job[i];
        if (!batch_is_mine(o, job) || !job->ended || !job->status)
            continue;
        batch_last_words(o->out, job, words);
        if (job->status > 128)
            cli_note(BATCH_NAME, "%s: ended by signal %d", job->name, job->status - 128);
        else
            cli_note(BATCH_NAME, "%s: exit status %d%s%s", job->name, job->status, *words ? ": " : "", words);
        shown++;
    }
    if (failed > shown)
        cli_note(BATCH_NAME, "and %zu more; see the column status of %s/table.csv", failed - shown, o->out);
}

static int conclude(const batch_options *o, const batch_plan *plan) {
    tally t = count(o, plan);
    say_failed(o, plan, t.failed);
    cli_say(stdout, "%zu jobs: %zu succeeded, %zu failed, %zu not done", t.mine, t.good, t.failed, t.open);
    if (t.good == t.mine || (o->under_mpi && t.open == 0))
        return CLI_OK;
    return t.open == 0 && t.not_converged_only ? CLI_NOT_CONVERGED : CLI_FAILURE;
}

static int save_results(const batch_options *o, const batch_plan *plan) {
    batch_table table;
    int code = batch_table_make(o->out, plan, &table);
    code = code ? code : batch_table_save(o->out, plan, &table);
    code = code ? code : batch_page_save(o->out, plan, &table);
    batch_table_free(&table);
    return code;
}

/* ---- the whole ---- */

static int work(const batch_options *o, batch_plan *plan) {
    int stopped = 0, code = cli_folder(BATCH_NAME, o->out);
    if (code == CLI_OK && o->slurm)
        return batch_slurm_save(o);
    code = code ? code : batch_lock(o);
    if (code == CLI_OK && !o->is_task)
        code = batch_journal_merge(o->out);
    code = code ? code : batch_journal_load(o->out, plan);
    if (code == CLI_OK && !o->collect)
        code = batch_run(o, plan, &stopped);
    if (stopped) {
        tally t = count(o, plan);
        cli_note(BATCH_NAME, "stopped with %zu of %zu jobs done; the same command goes on with the others",
                 t.mine - t.open, t.mine);
        raise(stopped);
        return CLI_FAILURE;
    }
    if (code == CLI_OK && !o->is_task)
        code = save_results(o, plan);
    return code ? code : conclude(o, plan);
}

int cmd_batch(int argc, char **argv) {
    batch_options o = {.tasks = 1};
    batch_plan plan = {0};
    size_t n_words = 0;
    const char **words = calloc((size_t)argc, sizeof *words);
    int code = words ? parse(argc, argv, &o, words, &n_words) : cli_failure(BATCH_NAME, "out of memory");
    o.manifest = words && !o.template ? words[0] : NULL;
    if (code == CLI_OK)
        code =
            o.template ? plan_of_template(&o, n_words, words, &plan) : batch_manifest_read(o.manifest, &plan);
    code = code ? code : work(&o, &plan);
    batch_plan_free(&plan);
    free(words);
    return code == CLI_HELP ? CLI_OK : code;
}
