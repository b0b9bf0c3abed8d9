/* palpate.h: the whole library. version.h says what "Stable" and "May change" mean in the headers. */
#ifndef PALPATE_H
#define PALPATE_H

#include <palpate/calibrate.h>
#include <palpate/characterize.h>
#include <palpate/closed_form.h>
#include <palpate/cut.h>
#include <palpate/effect.h>
#include <palpate/experiment.h>
#include <palpate/explain.h>
#include <palpate/file.h>
#include <palpate/forward.h>
#include <palpate/free_term.h>
#include <palpate/indentation.h>
#include <palpate/law.h>
#include <palpate/material.h>
#include <palpate/mesh.h>
#include <palpate/model.h>
#include <palpate/moduli.h>
#include <palpate/network.h>
#include <palpate/palpation.h>
#include <palpate/path.h>
#include <palpate/random.h>
#include <palpate/ranks.h>
#include <palpate/realtime.h>
#include <palpate/recording.h>
#include <palpate/reduce.h>
#include <palpate/region.h>
#include <palpate/segments.h>
#include <palpate/solid.h>
#include <palpate/solver.h>
#include <palpate/specimen.h>
#include <palpate/spectrum.h>
#include <palpate/status.h>
#include <palpate/thesis.h>
#include <palpate/version.h>
#include <palpate/tie.h>
#include <palpate/tool.h>
#include <palpate/visual.h>
#include <palpate/vtu.h>
#include <palpate/wire.h>

#endif
