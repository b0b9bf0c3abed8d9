/* network_load.h: what acts on the nodes of a network from outside: gravity, held nodes, tools. Internal.
 * A step: begin, then evaluate and assemble (by network_evaluate, network_assemble) as often as it takes, then
 * finish. All but free need net->load. */
#ifndef NETWORK_LOAD_H
#define NETWORK_LOAD_H

#include <palpate/network.h>

typedef struct network_load network_load;

void network_load_free(network_load *load); /* NULL is fine */

/* A step from now starts: tools and hands go where they were told to, contacts are looked for at now.x. */
void network_load_begin(palp_network *net);

/* Has a tool or a hand come or moved since the last committed state? */
bool network_load_moved(const palp_network *net);

/* Tools and hands go a share (0..1) of their way from the last committed state; contacts are looked for at next.x. */
void network_load_place(palp_network *net, double share);

/* A guess next.x that lets go of a tool which touched in the committed state: the nodes there go with it, along its push.
 * A tool that withdraws all of a sudden would otherwise have lost the tissue for some ticks. */
void network_load_follow(palp_network *net);

/* If the solution moved a contact's point so far that it is not the nearest to the tool any more: looks for contacts
 * again at next.x and says true; it is to be evaluated and solved again. */
bool network_load_refresh(palp_network *net);

/* Forces on the nodes at next.x and their derivatives; a part of network_evaluate. */
void network_load_evaluate(palp_network *net);

/* [3 n_nodes] of the last evaluation, N. */
const double *network_load_force(const network_load *load);

/* Sum of squares of the forces, stiffness times place, that rounding of places makes uncertain, N^2. */
double network_load_size(const network_load *load);

/* Adds the derivative, -d force / d x, to the assembled tangent in the solver's values. Couplings of nodes that
 * no element joins are left out. */
void network_load_assemble(palp_network *net);

/* Block of the derivative that couples two nodes, row-major. */
typedef struct load_coupling {
    int32_t row, column;
    double block[9];
} load_coupling;

/* The same in pieces: adds it to each node's own block[6 n_nodes] (lower triangle by rows), and gives the blocks
 * between a contact's nodes, each once; those of contacts for which max has no room are lumped on the own ones.
 * Returns how many there are. */
size_t network_load_blocks(const palp_network *net, double *block, size_t max, load_coupling *coupling);

/* out += (-d force / d x) u, both [3 n_nodes]. */
void network_load_times(const palp_network *net, const double *u, double *out);

/* Adds d force / d depth on the unknowns, by the motion of driven nodes: column[n_free]. */
void network_load_drive(const palp_network *net, double *column);

/* u (-d force / d x) u */
double network_load_curvature(const palp_network *net, const double *u);

/* Adds the potential of the last evaluation, J. False where there is none: friction. */
bool network_load_energy(const palp_network *net, double *energy);

/* After finish, where a residual[3 n_nodes] is left in next.x: forces on tools and hands become what the tissue pushes
 * them back with, not what the stiff springs between would press it with; off by less. */
void network_load_settle(palp_network *net, const double *residual);

/* Stiffness that the tissue's own elements give the nodes that are touched or held, summed over nodes and axes, N/m. */
double network_load_own_stiffness(const palp_network *net);

/* The committed state was restored: tools are set as they were. */
void network_load_recall(palp_network *net);

/* The step is solved at next.x: what lasts into next.load. */
void network_load_finish(palp_network *net);

#endif
