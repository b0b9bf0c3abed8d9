/* sim.h: what libpalpate-sim has: networks, the tools that touch and cut them, and their real-time steps; it
 * has palpate/reduce.h too. Stable. */
#ifndef PALPATE_SIM_H
#define PALPATE_SIM_H

#include <palpate/closed_form.h>
#include <palpate/cut.h>
#include <palpate/effect.h>
#include <palpate/file.h>
#include <palpate/law.h>
#include <palpate/material.h>
#include <palpate/mesh.h>
#include <palpate/model.h>
#include <palpate/network.h>
#include <palpate/path.h>
#include <palpate/random.h>
#include <palpate/realtime.h>
#include <palpate/region.h>
#include <palpate/solver.h>
#include <palpate/status.h>
#include <palpate/tie.h>
#include <palpate/tool.h>
#include <palpate/version.h>
#include <palpate/visual.h>
#include <palpate/vtu.h>

#endif
