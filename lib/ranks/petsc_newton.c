/* petsc_newton.c: one equilibrium by PETSc's Newton method with a line search on the residual, as
 * network_newton for one process; linear systems by conjugate gradients with algebraic multigrid. */
#include "petsc_internal.h"

#include <math.h>

static const double AT_FOLD = 10.0;   /* as in network_newton.c */
static const double PREDICTED = 1e-6; /* relative tolerance of linear solutions outside SNES */

/* ---- what PETSc asks ----------------------------------------------------------------------------- */

/* Evaluates at x. False: an element has collapsed. */
static PetscErrorCode evaluate_at(part *p, Vec x, bool *sound) {
    palp_network *net = p->net;
    const PetscScalar *at;
    PASS(part_fetch(p, x));
    PASS(VecGetArrayRead(p->local, &at));
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            net->next.x[i] = at[i];
    PASS(VecRestoreArrayRead(p->local, &at));
    *sound = network_evaluate(net);
    if (*sound)
        p->residual = network_residual(net, &p->scale);
    return 0;
}

/* to = factor times the part's unknowns from[n_free]; 0 at fixed axes. */
static PetscErrorCode give_unknowns(part *p, const double *from, double factor, Vec to) {
    PetscScalar *at;
    PetscInt first;
    PASS(VecGetOwnershipRange(to, &first, NULL));
    PASS(VecGetArray(to, &at));
    for (size_t i = 0; i < 3 * p->n_nodes; i++)
        if (p->own[i / 3])
            at[3 * p->number[i / 3] + (PetscInt)(i % 3) - first] =
                p->net->dof[i] < 0 ? 0.0 : factor * from[p->net->dof[i]];
    return VecRestoreArray(to, &at);
}

/* A collapsed element makes the residual infinite, so that the line search shortens the step. */
static PetscErrorCode residual_at(SNES snes, Vec x, Vec f, void *user) {
    part *p = user;
    bool sound;
    (void)snes;
    PASS(evaluate_at(p, x, &sound));
    return sound ? give_unknowns(p, p->net->rhs, -1.0, f) : VecSet(f, PETSC_INFINITY);
}

static PetscErrorCode tangent_at(SNES snes, Vec x, Mat tangent, Mat same, void *user) {
    part *p = user;
    bool sound;
    (void)snes, (void)tangent, (void)same;
    PASS(evaluate_at(p, x, &sound));
    return part_assemble(p);
}

static PetscErrorCode judge(SNES snes, PetscInt iteration, PetscReal x, PetscReal step, PetscReal f,
                            SNESConvergedReason *reason, void *user) {
    const part *p = user;
    (void)snes, (void)iteration, (void)x, (void)step;
    *reason = !isfinite(f)    ? SNES_DIVERGED_FNORM_NAN
              : f <= p->scale ? SNES_CONVERGED_FNORM_ABS
                              : SNES_CONVERGED_ITERATING;
    return 0;
}

/* ---- making -------------------------------------------------------------------------------------- */

static palp_status set_up_multigrid(KSP ksp) {
    PC pc;
    TRY(KSPSetType(ksp, KSPCG));
    TRY(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
    TRY(KSPSetTolerances(ksp, PREDICTED, 1e-50, 1e5, 1000));
    TRY(KSPGetPC(ksp, &pc));
    TRY(PCSetType(pc, PCGAMG));
    TRY(PCGAMGSetReuseInterpolation(pc, PETSC_TRUE));
    return PALP_OK;
}

static palp_status make_solver(part *p) {
    SNESLineSearch search;
    KSP ksp;
    TRY(SNESCreate(p->comm, &p->snes));
    TRY(SNESSetType(p->snes, SNESNEWTONLS));
    TRY(SNESSetFunction(p->snes, p->f, residual_at, p));
    TRY(SNESSetJacobian(p->snes, p->tangent, p->tangent, tangent_at, p));
    TRY(SNESSetConvergenceTest(p->snes, judge, p, NULL));
    TRY(SNESSetTolerances(p->snes, 0.0, 0.0, 0.0, p->net->settings.max_iterations, 10000));
    TRY(SNESGetLineSearch(p->snes, &search));
    TRY(SNESLineSearchSetType(search, SNESLINESEARCHBT));
    TRY(SNESGetKSP(p->snes, &ksp));
    palp_status status = set_up_multigrid(ksp);
    TRY(SNESSetFromOptions(p->snes));
    return status;
}

static palp_status prepare(part *p, palp_network *net) {
    p->net = net;
    if (p->snes)
        return PALP_OK;
    palp_status status = part_agree(p->comm, part_make_tangent(p), NULL);
    return status ? status : make_solver(p);
}

/* ---- the age of the multigrid -------------------------------------------------------------------- */

/* A multigrid of an earlier tangent is kept until a solution takes this many times the iterations of the
 * first. Setting it up costs about twenty iterations. This changes the work, not the solution. */
enum { WORN = 2 };

static palp_status begin_solution(part *p, KSP ksp) {
    TRY(SNESSetLagPreconditioner(p->snes, p->fresh > 0 ? -1 : -2));
    TRY(KSPSetReusePreconditioner(ksp, p->fresh > 0 ? PETSC_TRUE : PETSC_FALSE));
    return PALP_OK;
}

static palp_status end_solution(part *p, KSP ksp) {
    KSPConvergedReason reason;
    PetscInt iterations;
    TRY(KSPGetIterationNumber(ksp, &iterations));
    TRY(KSPGetConvergedReason(ksp, &reason));
    if (p->fresh == 0)
        p->fresh = iterations + 1;
    else if (reason < 0 || iterations > WORN * p->fresh)
        p->fresh = 0;
    return PALP_OK;
}

/* ---- the network's calls ------------------------------------------------------------------------- */

/* SNES from the positions in x. If a tangent is not positive definite, conjugate gradients stop and FGMRES
 * takes over. */
static palp_status solve_from(part *p, SNESConvergedReason *reason, palp_step_info *info) {
    KSPConvergedReason linear;
    PetscInt iterations;
    KSP ksp;
    TRY(SNESGetKSP(p->snes, &ksp));
    TRY(KSPSetType(ksp, KSPCG));
    for (int i = 0; i < 2; i++) {
        palp_status status = begin_solution(p, ksp);
        if (status)
            return status;
        TRY(SNESSolve(p->snes, NULL, p->x));
        status = end_solution(p, ksp);
        if (status)
            return status;
        TRY(SNESGetConvergedReason(p->snes, reason));
        TRY(SNESGetIterationNumber(p->snes, &iterations));
        info->iterations += (int)iterations;
        TRY(KSPGetConvergedReason(ksp, &linear));
        if (*reason != SNES_DIVERGED_LINEAR_SOLVE)
            break;
        p->indefinite = p->indefinite || linear == KSP_DIVERGED_INDEFINITE_MAT;
        TRY(KSPSetType(ksp, KSPFGMRES));
        p->fresh = 0;
    }
    return PALP_OK;
}

/* A tangent during the iteration was not positive definite. Conjugate gradients then test that of the
 * solution. */
static palp_status assess_solution(part *p, palp_step_info *info) {
    KSPConvergedReason reason;
    KSP ksp;
    TRY(SNESGetKSP(p->snes, &ksp));
    TRY(KSPSetType(ksp, KSPCG));
    TRY(part_assemble(p));
    TRY(KSPSetOperators(ksp, p->tangent, p->tangent));
    p->fresh = 0;
    palp_status status = begin_solution(p, ksp);
    if (status)
        return status;
    TRY(VecCopy(p->x, p->f));
    TRY(KSPSolve(ksp, p->f, p->sum));
    TRY(KSPGetConvergedReason(ksp, &reason));
    info->negative_pivots = reason == KSP_DIVERGED_INDEFINITE_MAT ? 1 : -1;
    return PALP_OK;
}

palp_status part_newton(network_ranks *ranks, palp_network *net, palp_step_info *info) {
    part *p = (part *)ranks;
    SNESConvergedReason reason;
    bool sound = true;
    palp_status status = prepare(p, net);
    if (status)
        return status;
    p->indefinite = false;
    PetscScalar *at;
    PetscInt first;
    TRY(VecGetOwnershipRange(p->x, &first, NULL));
    TRY(VecGetArray(p->x, &at));
    for (size_t i = 0; i < 3 * p->n_nodes; i++)
        if (p->own[i / 3])
            at[3 * p->number[i / 3] + (PetscInt)(i % 3) - first] = net->next.x[i];
    TRY(VecRestoreArray(p->x, &at));
    status = solve_from(p, &reason, info);
    if (status)
        return status;
    TRY(evaluate_at(p, p->x, &sound));
    info->negative_pivots = -1;
    if (!sound)
        return PALP_ERR_COLLAPSED;
    info->residual = p->scale > 0.0 ? net->settings.tolerance * p->residual / p->scale : 0.0;
    if (reason > 0 || (reason == SNES_DIVERGED_LINE_SEARCH && p->residual <= AT_FOLD * p->scale))
        return p->indefinite ? assess_solution(p, info) : PALP_OK;
    return p->indefinite ? PALP_ERR_BUCKLED : PALP_ERR_NOT_CONVERGED;
}

palp_status part_factor(network_ranks *ranks, palp_network *net) {
    part *p = (part *)ranks;
    KSP ksp;
    palp_status status = prepare(p, net);
    if (status)
        return status;
    TRY(part_assemble(p));
    TRY(SNESGetKSP(p->snes, &ksp));
    TRY(KSPSetOperators(ksp, p->tangent, p->tangent));
    return PALP_OK;
}

static palp_status solve_linear(part *p, double *x) {
    const PetscScalar *at;
    KSP ksp;
    TRY(SNESGetKSP(p->snes, &ksp));
    TRY(KSPSetTolerances(ksp, PREDICTED, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
    TRY(give_unknowns(p, x, 1.0, p->f));
    palp_status status = begin_solution(p, ksp);
    if (status)
        return status;
    TRY(KSPSolve(ksp, p->f, p->x));
    TRY(part_fetch(p, p->x));
    TRY(VecGetArrayRead(p->local, &at));
    for (size_t i = 0; i < 3 * p->n_nodes; i++)
        if (p->net->dof[i] >= 0)
            x[p->net->dof[i]] = at[i];
    TRY(VecRestoreArrayRead(p->local, &at));
    return end_solution(p, ksp);
}

void part_solve(network_ranks *ranks, palp_network *net, double *x) {
    (void)net;
    if (solve_linear((part *)ranks, x))
        MPI_Abort(((part *)ranks)->comm, 1);
}
