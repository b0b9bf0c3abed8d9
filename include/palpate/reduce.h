/* reduce.h: reduced models of networks that are too large for a tick: few coordinates (POD) and few elements
 * (ECSW). May change. */
#ifndef PALPATE_REDUCE_H
#define PALPATE_REDUCE_H

#include <palpate/model.h>
#include <palpate/network.h>
#include <palpate/realtime.h>
#include <palpate/tool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct palp_snapshots palp_snapshots; /* states of the full network on one path;
                                                 palp_snapshots_free */
typedef struct palp_reduced palp_reduced;     /* opaque; palp_reduced_free */

/* Motion of the plate and the tools, sample by sample: the network is stepped from each to the next, the
 * first from rest at time 0. All the caller's. */
typedef struct palp_tool_path {
    size_t n;              /* samples */
    const double *time_s;  /* [n], >= 0, increasing */
    const double *depth_m; /* [n], or NULL = 0 */
    size_t n_tools;
    const palp_tool *tools; /* [n n_tools], those of a sample together */
} palp_tool_path;

typedef struct palp_reduce_settings {
    size_t modes;             /* most coordinates; 80 */
    double tolerance;         /* of the shapes: share of the energy norm that may be left out; 1e-3 */
    size_t elements;          /* most elements kept; at least the network's own number = all; 1200 */
    double element_tolerance; /* of the sampled forces on the snapshot paths, relative; 3e-3 */
    size_t static_modes; /* number of the modes that are responses to unit loads at places that tools touched;
                            0 */
} palp_reduce_settings;

PALP_API palp_reduce_settings palp_reduce_settings_default(void);

/* Runs the network (reset first) along a path and keeps its states; with its realtime where that is not NULL,
 * which is much faster for large networks. Tools need palp_network_enable_tools. The caller owns *snapshots.
 * ERR_ARGUMENT: times that do not increase, a number that is not finite, another network's realtime; else the
 * statuses of palp_network_step, with the time in error. observer (may be NULL): non-zero = ERR_STOPPED. */
PALP_API palp_status palp_snapshots_record(palp_network *network, palp_realtime *realtime,
                                           const palp_tool_path *path, palp_network_observer observer,
                                           void *user, palp_snapshots **snapshots, palp_error *error);
PALP_API void palp_snapshots_free(palp_snapshots *snapshots); /* NULL is fine */

/* Error of a reduced model on one path: length of the difference of the plate's and all tools' forces
 * together. */
typedef struct palp_reduce_error {
    double worst_N, rms_N; /* largest over the samples; root of the mean square */
    double peak_N;         /* largest force of the full network */
} palp_reduce_error;

/* Makes a reduced model from snapshots: shapes by proper orthogonal decomposition (POD) in the norm of the
 * stiffness at rest (Sirovich 1987), elements and their weights by energy-conserving sampling and weighting
 * (ECSW; Farhat, Avery, Chapman, Cortial 2014), its non-negative least squares by Lawson and Hanson 1974. The
 * network (reset) must be the one of the snapshots. With n_held_out > 0 the error is then measured on paths
 * held out, into error_held_out[n_held_out] (may be NULL). The bound in the model's summary follows from it.
 * The caller owns *reduced. ERR_UNSUPPORTED: mass, PALP_SEDEF2008, springs with a load history, a volume
 * modulus or Poisson's ratio, ties, tissue that touches itself; ERR_SINGULAR: a network that is a mechanism
 * at rest. */
PALP_API palp_status palp_reduced_create(palp_network *network, size_t n_paths,
                                         palp_snapshots *const *snapshots, size_t n_held_out,
                                         palp_snapshots *const *held_out,
                                         const palp_reduce_settings *settings, palp_reduced **reduced,
                                         palp_reduce_error *error_held_out, palp_error *error);
PALP_API void palp_reduced_free(palp_reduced *reduced); /* NULL is fine */

/* Runs the reduced model (reset first) along the path of the snapshots and compares the forces. */
PALP_API palp_status palp_reduced_compare(palp_reduced *reduced, const palp_snapshots *snapshots,
                                          palp_reduce_error *result);

/* What a reduced model is. */
typedef struct palp_reduced_summary {
    size_t modes, elements;            /* kept */
    size_t unknowns, network_elements; /* of the network */
    size_t snapshot_paths, held_out_paths;
    double element_residual;             /* relative, of the sampled forces on the snapshot paths */
    double held_out_worst, held_out_rms; /* relative to each path's peak force; the worst path */
    double snapshot_worst;               /* the same of the snapshot paths; 0 without held-out paths */
    double held_out_peak_N;              /* the least of the held-out paths' peak forces */
    double bound;    /* of the force error, relative to a path's peak force: the larger of the two
                        times 1 + 2 / held_out_paths; INFINITY without held-out paths */
    double height_m; /* along the plate's motion; 0 where there is no plate */
} palp_reduced_summary;

PALP_API palp_reduced_summary palp_reduced_describe(const palp_reduced *reduced);

/* How a step went. */
typedef struct palp_reduced_info {
    int iterations;
    bool converged;       /* false: the best state reached within the iterations */
    double residual;      /* relative */
    double force_N;       /* reaction conjugate to depth */
    double force_error_N; /* bound times the largest force since the reset, or held_out_peak_N if that is
                             larger; grows with outside */
    double outside;       /* 0: within the snapshots; else by how much of its range a coordinate exceeds it */
    size_t contacts;      /* nodes in touch */
    double beyond;        /* as of palp_step_info, of the elements that are kept */
} palp_reduced_info;

/* One step to depth_m with n_tools tools in these poses after dt_s seconds (INFINITY = relaxed), committed.
 * force[n_tools] (may be NULL): of the tissue on each tool. info may be NULL. Allocates nothing; the same
 * input gives the same bits. A tool is put at its new place at once, not followed in parts: move it by less
 * than half an edge of the surface and a quarter of its radius. On failure the state stays as it was.
 * ERR_ARGUMENT, ERR_COLLAPSED, ERR_NOT_CONVERGED. */
PALP_API palp_status palp_reduced_step(palp_reduced *reduced, double depth_m, size_t n_tools,
                                       const palp_tool *tools, double dt_s, palp_tool_force *force,
                                       palp_reduced_info *info);

/* When a step is converged: |residual| <= tolerance |element forces|; 1e-6 and 20 iterations unless set. */
PALP_API palp_status palp_reduced_set_limits(palp_reduced *reduced, double tolerance, int max_iterations);
PALP_API void palp_reduced_reset(palp_reduced *reduced); /* undeformed, no history, time 0 */

/* Positions of nodes in the last committed state into x_m[3 n]; nodes NULL = the first n. */
PALP_API palp_status palp_reduced_positions(const palp_reduced *reduced, size_t n, const int32_t *nodes,
                                            double *x_m);
PALP_API size_t palp_reduced_node_count(const palp_reduced *reduced);

/* Triangles of the surface, as palp_mesh_triangles. */
PALP_API size_t palp_reduced_triangle_count(const palp_reduced *reduced);
PALP_API const int32_t *palp_reduced_triangles(const palp_reduced *reduced);

/* Writes path, JSON, and beside it the arrays, little-endian, as path's name with .bin for .json; both under
 * temporary names first. model is what the network was built from. */
PALP_API palp_status palp_reduced_write(const palp_reduced *reduced, const palp_model *model,
                                        const char *path, palp_error *error);

/* Reads them back. model (may be NULL) and mesh are as of palp_model_read. ERR_INPUT: "file:line: ...",
 * another size or checksum. */
PALP_API palp_status palp_reduced_read(const char *path, palp_model *model, palp_mesh_source *mesh,
                                       palp_reduced **reduced, palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
