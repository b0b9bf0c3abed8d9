"use strict";
/* page.js: what palpate panel's page does. The server has all state; a page that is loaded anew asks for it. */
const token = new URLSearchParams(location.search).get("token");
const $ = id => document.getElementById(id);

/* ---- asking the server ---- */

async function ask(method, path, body, signal) {
  const answer = await fetch(path, { method, body, signal, headers: { "X-Palpate-Token": token }, cache: "no-store" });
  const text = await answer.text();
  let value = {};
  try { value = JSON.parse(text); } catch { value = { error: text }; }
  if (!answer.ok) throw new Error(value.error || "the panel refused it");
  return value;
}

/* An order by hand; what is wrong with it is shown. */
async function order(path, body) {
  try { return await ask("POST", path, body); } catch (e) { note(e.message, true); return null; }
}

async function emergency() {
  series = null;
  $("emergency").classList.add("pressed");
  let got = null; /* a server that is crowded may close this connection unread: ask again */
  for (let tries = 0; tries < 20 && !got; tries++) got = await order("/emergency");
  if (!got) note("The panel has not answered to the emergency stop: press the indenter's switch.", true);
  else if (!got.stopped) note("The indenter has not answered to the emergency stop: press its switch.", true);
}

function note(text, bad) {
  const line = document.createElement("li"), time = document.createElement("time");
  time.textContent = new Date().toLocaleTimeString();
  line.append(time, text);
  line.className = bad ? "bad" : "";
  $("notes").prepend(line);
  while ($("notes").children.length > 100) $("notes").lastChild.remove();
}

/* ---- plots ---- */

const nice = (low, high, n) => { /* places of ticks */
  const step0 = (high - low) / n, power = 10 ** Math.floor(Math.log10(step0));
  const step = [1, 2, 5, 10].find(k => k * power >= step0) * power, ticks = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) ticks.push(k * step);
  return { ticks, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
};

class Plot {
  constructor(canvas, x, y) {
    Object.assign(this, { canvas, xName: x, yName: y, lines: [], zoom: null, drag: null });
    new ResizeObserver(() => this.draw()).observe(canvas);
    canvas.addEventListener("pointerdown", e => { this.drag = [e.offsetX, e.offsetX]; canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener("pointermove", e => { if (this.drag) { this.drag[1] = e.offsetX; this.draw(); } });
    canvas.addEventListener("pointerup", () => this.release());
    canvas.addEventListener("dblclick", () => { this.zoom = null; this.draw(); });
    canvas.addEventListener("wheel", e => { e.preventDefault(); this.scale(this.at(e.offsetX), e.deltaY > 0 ? 1.25 : 0.8); }, { passive: false });
  }
  at(px) { return this.x0 + (px - this.left) / this.width * (this.x1 - this.x0); }
  scale(x, by) { this.zoom = [x + (this.x0 - x) * by, x + (this.x1 - x) * by]; this.draw(); }
  release() {
    const [a, b] = (this.drag || [0, 0]).map(p => this.at(p)).sort((p, q) => p - q), far = this.drag && Math.abs(this.drag[1] - this.drag[0]) > 8;
    this.drag = null;
    if (far) this.zoom = [a, b];
    this.draw();
  }
  /* lines: of {x, y, color, from (index)} */
  show(lines) { this.lines = lines; this.draw(); }
  ranges() {
    let x0 = Infinity, x1 = -Infinity, y0 = 0, y1 = 0;
    for (const l of this.lines) for (let i = l.from || 0; i < l.x.length; i++) if (l.x[i] !== null) {
      if (l.x[i] < x0) x0 = l.x[i];
      if (l.x[i] > x1) x1 = l.x[i];
    }
    if (!(x1 > x0)) { x0 = isFinite(x0) ? x0 - 0.5 : 0; x1 = x0 + 1; }
    if (this.zoom) [x0, x1] = this.zoom;
    for (const l of this.lines) for (let i = l.from || 0; i < l.x.length; i++)
      if (l.x[i] !== null && l.y[i] !== null && l.x[i] >= x0 && l.x[i] <= x1) { y0 = Math.min(y0, l.y[i]); y1 = Math.max(y1, l.y[i]); }
    const room = 0.06 * (y1 - y0) || 0.05;
    Object.assign(this, { x0, x1, y0: y0 - room, y1: y1 + room });
  }
  draw() {
    const c = this.canvas, ratio = devicePixelRatio || 1, w = c.clientWidth, h = c.clientHeight, g = c.getContext("2d");
    if (!w || !h) return;
    if (c.width !== Math.round(w * ratio) || c.height !== Math.round(h * ratio)) { c.width = Math.round(w * ratio); c.height = Math.round(h * ratio); }
    this.ranges();
    Object.assign(this, { left: 56, top: 8, width: w - 70, height: h - 48 });
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, w, h);
    g.font = "12px system-ui, sans-serif";
    this.axes(g, w, h);
    g.save();
    g.beginPath(); g.rect(this.left, this.top, this.width, this.height); g.clip();
    for (const l of this.lines) this.line(g, l);
    if (this.drag) { g.fillStyle = "#0060a022"; g.fillRect(Math.min(...this.drag), this.top, Math.abs(this.drag[1] - this.drag[0]), this.height); }
    g.restore();
  }
  px(x) { return this.left + (x - this.x0) / (this.x1 - this.x0) * this.width; }
  py(y) { return this.top + (this.y1 - y) / (this.y1 - this.y0) * this.height; }
  axes(g, w, h) {
    const x = nice(this.x0, this.x1, Math.max(2, this.width / 90)), y = nice(this.y0, this.y1, Math.max(2, this.height / 40));
    g.strokeStyle = "#e3e8ec"; g.fillStyle = "#5a6772"; g.lineWidth = 1;
    g.textAlign = "center";
    for (const t of x.ticks) { g.beginPath(); g.moveTo(this.px(t), this.top); g.lineTo(this.px(t), this.top + this.height); g.stroke(); g.fillText(t.toFixed(x.digits), this.px(t), h - 24); }
    g.textAlign = "right";
    for (const t of y.ticks) { g.beginPath(); g.moveTo(this.left, this.py(t)); g.lineTo(this.left + this.width, this.py(t)); g.stroke(); g.fillText(t.toFixed(y.digits), this.left - 6, this.py(t) + 4); }
    g.strokeStyle = "#aab4bc"; g.strokeRect(this.left, this.top, this.width, this.height);
    g.textAlign = "center"; g.fillText(this.xName, this.left + this.width / 2, h - 6);
    g.save(); g.translate(13, this.top + this.height / 2); g.rotate(-Math.PI / 2); g.fillText(this.yName, 0, 0); g.restore();
  }
  /* Where many points share a column of the screen, their extremes: no peak is lost. */
  line(g, l) {
    let column = null, low = 0, high = 0, last = 0, broken = true;
    const flush = () => { if (column !== null && high - low > 1) { g.moveTo(column, low); g.lineTo(column, high); g.moveTo(column, last); } };
    g.strokeStyle = l.color; g.lineWidth = l.width || 1.6; g.lineJoin = "round"; g.setLineDash(l.dash || []); g.beginPath();
    for (let i = l.from || 0; i < l.x.length; i++) {
      if (l.x[i] === null || l.y[i] === null) { broken = true; continue; }
      const x = this.px(l.x[i]), y = this.py(l.y[i]);
      if (l.thin && !broken && Math.round(x) === column) { low = Math.min(low, y); high = Math.max(high, y); last = y; continue; }
      if (l.thin) flush();
      if (broken) g.moveTo(x, y); else g.lineTo(x, y);
      broken = false; column = Math.round(x); low = high = last = y;
    }
    if (l.thin) flush();
    g.stroke(); g.setLineDash([]);
  }
}

const overTime = new Plot($("over_time"), "time (s)", "force (N)");
const overDepth = new Plot($("over_depth"), "depth (mm)", "force (N)");
const picture = new Plot($("picture"), "time (s)", "depth (mm)");

/* ---- what comes live ---- */

const data = { time_s: [], place_mm: [], depth_mm: [], force_N: [], error_mm: [], run: [] };
let nextPoint = 0, nextNote = 0, now = null, heard = 0, knownRuns = "";

function take(points) {
  if (points.next < nextPoint) for (const k in data) data[k].length = 0; /* another server */
  for (const k in data) for (const v of points[k]) data[k].push(v);
  nextPoint = points.next;
  if (data.time_s.length > 150000) for (const k in data) data[k].splice(0, 50000);
}

const shown = (x, digits) => x === null || x === undefined || !isFinite(x) ? "-" : x.toFixed(digits).replace(/^-(0\.?0*)$/, "$1");
const clock = s => s < 100 ? shown(s, 1) + " s" : Math.floor(s / 60) + " min " + String(Math.floor(s % 60)).padStart(2, "0") + " s";
const moves = { homing: 1, approach: 1, run: 1, retract: 1, jog: 1 };
const words = { boot: "starting", idle: "motor off", homing: "homing", ready: "ready", approach: "searching", run: "running", retract: "withdrawing", jog: "moving", fault: "stopped by a fault", gone: "disconnected" };

/* The panel is silent: nothing is known, and no order can be given but the emergency stop. */
function showLost() {
  $("lost").hidden = false;
  $("fault").hidden = true;
  $("state").textContent = "not known";
  $("state").className = $("state").dataset.state = $("doing").textContent = "";
  for (const b of document.querySelectorAll("[data-do], [data-jog], [data-job], #stop, #start, #until")) b.disabled = true;
  document.body.classList.add("stale");
}

function showState(s) {
  $("state").textContent = words[s.state] || s.state;
  $("state").className = s.state === "fault" || s.state === "gone" ? "fault" : moves[s.state] ? "moves" : s.state === "ready" ? "ready" : "";
  $("state").dataset.state = s.state;
  $("doing").textContent = s.stopping ? "stopping" : s.doing;
  $("fault").hidden = s.state !== "fault" && !s.gone;
  $("fault_text").textContent = s.gone ? "The indenter is disconnected." : "Stopped: " + s.fault_text + ".";
  $("advice").textContent = s.gone ? "See to its cable and supply, then start palpate panel again. What was recorded is kept." : s.advice;
  $("winding").textContent = shown(s.winding_C, 1);
  $("case").textContent = shown(s.case_C, 1);
  $("ready_hint").textContent = !s.homed ? "The plate's position is not known yet: home it." : s.contact_known ?
    `Contact ${shown(s.contact_mm, 2)} mm below home, ${shown(s.stiffness_N_m, 0)} N/m. Limits ${shown(s.limit_N, 1)} N, ${shown(s.limit_C, 0)} °C.${s.calibration ? ` Calibration ${s.calibration}.` : ''}` :
    "Contact is not known yet. A run finds it first.";
  const r = s.run;
  $("run_name").textContent = r ? `Run ${r.number} of ${r.of}: ${r.name}` : "Run";
  $("run_time").textContent = r ? clock(r.elapsed_s) : "-";
  $("run_note").textContent = r ? `of ${clock(r.length_s)}` + (r.lost ? `, ${r.lost} samples lost` : "") : s.runs ? `${s.runs} recorded` : "";
  $("progress").value = r ? Math.min(1, r.elapsed_s / r.length_s) : 0;
  for (const b of document.querySelectorAll("[data-do], [data-jog]")) b.disabled = s.busy || s.gone || (s.state === "fault") !== (b.dataset.do === "clear");
  for (const b of document.querySelectorAll("[data-jog], [data-do=hold], [data-do=contact]")) b.disabled = b.disabled || !s.homed;
  $("stop").disabled = !s.busy;
  $("start").disabled = s.busy || s.gone || s.state === "fault" || !planGood;
  document.body.classList.toggle("stale", s.gone);
}

function showNumbers() {
  const i = data.time_s.length - 1, known = now.contact_known && i >= 0;
  $("force").textContent = i < 0 ? "-" : shown(data.force_N[i], 3);
  $("depth_name").textContent = known ? "Depth from contact" : "Below home";
  $("depth").textContent = i < 0 ? "-" : shown(known ? data.depth_mm[i] : data.place_mm[i], 3);
  $("error").textContent = i < 0 ? "-" : shown(1000 * data.error_mm[i], 1);
}

/* The index from which points are shown, by what was chosen. */
function firstShown() {
  const n = data.time_s.length, span = $("span").value;
  if (span === "all" || n === 0) return 0;
  if (span !== "run") { let i = n - 1; while (i > 0 && data.time_s[n - 1] - data.time_s[i] < Number(span)) i--; return i; }
  let i = n - 1;
  while (i > 0 && !data.run[i]) i--;
  if (!data.run[i]) return Math.max(0, n - 3000); /* no run yet */
  const run = data.run[i];
  while (i > 0 && data.run[i - 1] === run) i--;
  return i;
}

function drawLive() {
  const from = firstShown(), n = data.time_s.length, zero = n ? data.time_s[from] : 0;
  const ofRun = $("span").value === "run" && data.run[from];
  let end = n;
  if (ofRun) while (end > from && data.run[end - 1] !== data.run[from]) end--;
  const t = [], d = [], f = [];
  for (let i = from; i < end; i++) {
    t.push(data.time_s[i] - zero);
    d.push(data.depth_mm[i] === null ? data.place_mm[i] : data.depth_mm[i]);
    f.push(data.force_N[i]);
  }
  overDepth.xName = now && now.contact_known ? "depth from contact (mm)" : "place below home (mm)";
  const more = k => chosen.map(c => ({ x: c[k], y: c.force_N, color: c.color, thin: k === "time_s" }));
  overTime.show([...more("time_s"), { x: t, y: f, color: "#0060a0", thin: true }]);
  overDepth.show([...more("depth_mm"), { x: d, y: f, color: "#0060a0" }]);
}

let chosen = []; /* recordings drawn beside it */

const askLive = signal => ask("GET", `/live?point=${nextPoint}&note=${nextNote}`, undefined, signal);

async function poll() {
  try {
    const got = await askLive(AbortSignal.timeout(10000));
    heard = Date.now();
    now = got.state;
    take(got.points);
    nextNote = got.notes.next;
    for (const n of got.notes.list) note(n.text, n.bad);
    $("lost").hidden = true;
    showState(now);
    showNumbers();
    drawLive();
    showJob(got.job);
    const known = now.runs + " " + got.job.done + " " + got.job.running;
    if (known !== knownRuns) { knownRuns = known; listRuns(); }
  } catch (e) {
    if (Date.now() - heard > 3000) showLost();
    if (!(e instanceof TypeError) && e.name !== "TimeoutError") console.error(e);
  }
  setTimeout(poll, 100);
}

/* ---- the runs that are in the folder ---- */

const colors = ["#d55e00", "#00795a", "#9a4fb0", "#c08a00", "#56b4e9", "#8c564b"], marked = new Map(); /* name: its curve */
let runs = [];

function cell(row, text, kind) {
  const td = row.insertCell();
  if (text instanceof Node) td.append(text); else td.textContent = text;
  td.className = kind || "";
}

function fitText(fit) {
  if (!fit || !fit.stiffness) return "";
  const c = fit.stiffness.coefficients_N, k = c ? `K(0) ${c[0].toPrecision(3)} N` : fit.stiffness.kind;
  return k + (fit.arms || []).map(a => `; arm ${a.stiffness_N.toPrecision(3)} N, ${(a.viscosity_Ns / a.stiffness_N).toPrecision(3)} s`).join("");
}

function endText(run) {
  if (run.fault === null) return "whole";
  return run.fault === "interrupted" ? (now && now.run && now.run.name + ".csv" === run.name ? "going on" : "interrupted") : run.fault;
}

async function mark(name, on) {
  if (!on) marked.delete(name);
  else marked.set(name, await ask("GET", "/curve?run=" + encodeURIComponent(name)).catch(e => { note(e.message, true); return null; }));
  chosen = [...marked.values()].filter(c => c).map((c, i) => Object.assign(c, { color: colors[i % colors.length] }));
  showRuns();
}

function showRuns() {
  const table = document.createElement("table"), head = table.createTHead().insertRow();
  for (const name of ["Run", "Kind", "Depth (mm)", "Peak (N)", "Error rms (µm)", "Lost", "Ended", "Fit alone"]) {
    const th = document.createElement("th");
    th.textContent = name; th.className = name === "Fit alone" || name === "Kind" || name === "Ended" ? "t" : "";
    head.append(th);
  }
  const body = table.createTBody();
  for (const r of runs) {
    const row = body.insertRow(), label = document.createElement("label"), box = document.createElement("input"), curve = marked.get(r.name);
    box.type = "checkbox"; box.checked = marked.has(r.name); box.onchange = () => mark(r.name, box.checked);
    label.append(box, " ", r.name.replace(/\.csv$/, ""));
    if (curve) label.style.color = curve.color;
    cell(row, label);
    cell(row, (r.kind || "").replace("_", " and "), "t");
    cell(row, shown(r.depth_mm, 2)); cell(row, shown(r.peak_N, 3));
    cell(row, r.error_rms_mm === null ? "-" : shown(1000 * r.error_rms_mm, 1));
    cell(row, r.lost_samples === null ? "-" : String(r.lost_samples), r.lost_samples ? "bad" : "");
    cell(row, endText(r), r.fault === null || endText(r) === "going on" ? "t" : "t bad"); cell(row, fitText(r.fit), "t");
  }
  $("runs").replaceChildren(runs.length ? table : "None yet.");
}

async function listRuns() {
  try { runs = (await ask("GET", "/runs")).runs; } catch { return; }
  for (const name of [...marked.keys()]) if (!runs.some(r => r.name === name)) marked.delete(name);
  showRuns();
  showFound();
}

const made = name => `/made?name=${name}&token=${token}`;

/* What explain has found at last, and the experiment that it asks for. */
async function showFound() {
  let e = null;
  try { e = await ask("GET", "/made?name=explain.json"); } catch { /* not yet */ }
  $("found").hidden = !e;
  if (!e) return;
  const effects = e.effects.map(x => x.id).join(", "), link = document.createElement("a");
  link.textContent = "the whole story"; link.href = made("explain.html"); link.target = "_blank"; link.rel = "noreferrer";
  const parts = [`Explain: ${e.verdict}${effects ? ": " + effects : ""}.`, link], next = e.next_experiment;
  if (next && next.runs.length) parts.push(` Next: ${next.runs.map(x => `${x.kind.replace("_", " and ")} to ${shown(x.depth_mm, 2)} mm`).join(", ")}.`,
    button("Load the next experiment", async () => loadProtocol(JSON.stringify(await ask("GET", "/made?name=next.json"), null, 2))));
  $("found").replaceChildren(...parts);
}

/* ---- explain, measure, explain again ---- */

let series = null; /* the one under way; what ends it sets this to null */

/* The server's answer once it shows this, or null where the series was ended before. */
async function whenLive(mine, shows) {
  while (series === mine) {
    const live = await askLive();
    if (shows(live)) return live;
    await new Promise(r => setTimeout(r, 200));
  }
  return null;
}

async function explainChosen(mine, left) {
  const before = (await askLive()).job.done;
  if (series !== mine) return null;
  await ask("POST", "/job?what=explain&next_s=" + left, [...marked.keys()].join(","));
  const live = await whenLive(mine, l => l.job.done > before);
  return live && live.job.good ? ask("GET", "/made?name=explain.json") : null;
}

/* False where it did not go to its end. Nothing moves once the series has ended. */
async function measureNext(mine) {
  const old = new Set(runs.map(r => r.name)), protocol = JSON.stringify(await ask("GET", "/made?name=next.json"));
  if (series !== mine) return false;
  await ask("POST", "/start", protocol);
  const live = await whenLive(mine, l => !l.state.busy);
  await listRuns();
  const fresh = runs.filter(r => !old.has(r.name));
  for (const r of fresh) await mark(r.name, true);
  return live !== null && live.state.state !== "fault" && !live.state.gone && fresh.length > 0 && fresh.every(r => r.fault === null);
}

async function measureUntilExplained(mine) {
  for (let left = 60 * Number($("budget").value); ;) {
    if (!(left > 0)) return "The time for measuring must be a number above 0.";
    const found = await explainChosen(mine, left), next = found && found.next_experiment;
    if (!found) return "The series has ended before an explanation.";
    if (found.verdict !== "ambiguous") return `The series has ended: ${found.verdict}.`;
    if (!next || !next.runs.length || next.time_s > left) return "Several causes are left: no further experiment fits the time.";
    left -= next.time_s;
    if (!await measureNext(mine)) return "The series has ended: an experiment was not recorded whole.";
  }
}

async function toggleSeries() {
  if (series) { series = null; order("/stop"); order("/job?what=cancel"); return; }
  const mine = series = {}, words = $("until").textContent;
  $("until").textContent = "End the series";
  try { note(await measureUntilExplained(mine), false); } catch (e) { note(e.message, true); }
  if (series === mine) series = null;
  $("until").textContent = words;
}

let jobShown = "";
function showJob(job) {
  const names = { fit: "fitting", explain: "explaining, which may take minutes", report: "writing the report" };
  for (const b of document.querySelectorAll("[data-job]")) b.disabled = job.running || !marked.size;
  $("until").disabled = !series && (job.running || !marked.size || now.busy || now.gone || now.state === "fault");
  $("cancel").hidden = !job.running;
  $("job").textContent = job.running ? names[job.what] + " ..." : marked.size ? "" : "Choose runs: they are drawn, and can be fitted.";
  if (jobShown.startsWith("true") && !job.running && job.good && job.what === "report") {
    const a = document.createElement("a");
    a.href = made("report.html"); a.target = "_blank"; a.rel = "noreferrer"; a.textContent = "The report is written: open it";
    note("", false);
    $("notes").firstChild.append(a);
  }
  jobShown = job.running + " " + job.done;
}

/* ---- the stimulus: a form that makes a protocol file ---- */

const F = { /* key: [label, default shown] */
  depth_mm: ["Depth (mm)", ""], rate_mm_s: ["Speed (mm/s)", ""], ramp_s: ["Ramp (s)", "1"], hold_s: ["Hold (s)", ""], cycles: ["Cycles", ""],
  amplitude_mm: ["Amplitude (mm)", "depth / 10"], frequency_Hz: ["Frequency (Hz)", ""], frequency_end_Hz: ["up to (Hz)", "10"], duration_s: ["Duration (s)", ""],
  force_N: ["Force (N)", ""], pre_mm: ["Pre-indentation (mm)", "0"], pre_s: ["held for (s)", "5"],
  deepest_mm: ["No deeper than (mm)", ""],
};
const kinds = { /* [label, fields with the value they begin with, or its default as a shade] */
  ramp_hold: ["Ramp and hold", { depth_mm: "3", ramp_s: ":1", hold_s: "20", pre_mm: ":0", pre_s: ":5" }],
  static: ["Static press", { depth_mm: "3", rate_mm_s: ":0.1", pre_mm: ":0", pre_s: ":5" }],
  cyclic: ["Cycles", { depth_mm: "3", rate_mm_s: ":1", cycles: ":3", pre_mm: ":0", pre_s: ":5" }],
  sine: ["Sine", { depth_mm: "3", rate_mm_s: ":1", hold_s: ":10", amplitude_mm: ":depth / 10", frequency_Hz: ":1", cycles: ":10" }],
  sweep: ["Sweep", { depth_mm: "3", rate_mm_s: ":1", hold_s: ":10", amplitude_mm: ":depth / 10", frequency_Hz: ":0.1", frequency_end_Hz: ":10", duration_s: ":60" }],
  creep: ["Creep (a force held)", { force_N: "0.5", ramp_s: "1", duration_s: "60", deepest_mm: ":the specimen's height", pre_mm: ":0", pre_s: ":5" }],
  segments: ["Segments", {}],
  free: ["In the air", { depth_mm: ":0", ramp_s: ":1", hold_s: ":10" }],
  file: ["The protocol file below", {}],
};
const common = { name: ["Name of the file", "by kind and depth"], repeats: ["Times", "1"], rest_s: ["Rest between (s)", "as long as a press"], air_mm: ["Begin above (mm)", "1"], air_s: ["Air before (s)", "1"], after_s: ["Air after (s)", "1"] };
const segmentKinds = { /* what names it: the other figures */
  move_to_mm: ["go to (mm)", { rate_mm_s: "at (mm/s)" }], hold_s: ["hold (s)", {}], cycle_to_mm: ["cycle to (mm)", { rate_mm_s: "at (mm/s)", cycles: "times" }],
  sine_mm: ["sine of (mm)", { frequency_Hz: "Hz", cycles: "periods" }], sweep_mm: ["sweep of (mm)", { frequency_Hz: "from Hz", frequency_end_Hz: "to Hz", duration_s: "in s" }],
  force_N: ["force of (N)", { ramp_s: "reached in (s)", duration_s: "held (s)", deepest_mm: "no deeper (mm)" }],
};
let segments = [{ move_to_mm: "1", rate_mm_s: "5" }, { hold_s: "15" }, { move_to_mm: "2", rate_mm_s: "5" }, { hold_s: "15" }];
let planGood = false, planning = null, timer = 0;

const number = text => text.trim() !== "" && isFinite(Number(text)) ? Number(text) : text.trim(); /* what is none, the parser tells */
const field = key => $("f_" + key) ? $("f_" + key).value.trim() : "";

function input(key, label, value, shade) {
  const l = document.createElement("label"), i = document.createElement("input");
  l.append(label, i);
  i.id = "f_" + key; i.value = value; i.placeholder = shade; i.inputMode = key === "name" ? "text" : "decimal";
  i.addEventListener("input", changed);
  return l;
}

function showFields() {
  const kind = $("kind").value, old = Object.fromEntries([...$("fields").querySelectorAll("input")].map(i => [i.id, i.value]));
  $("fields").replaceChildren(...Object.entries(kinds[kind][1]).map(([key, v]) => {
    const shade = v.startsWith(":"), kept = old["f_" + key];
    const label = key === "depth_mm" && (kind === "ramp_hold" || kind === "static") ? "Depths (mm), e.g. 2, 4" : key === "depth_mm" && kind === "sine" ? "About a depth of (mm)" : F[key][0];
    return input(key, label, kept !== undefined && kept !== "" ? kept : shade ? "" : v, shade ? v.slice(1) : "");
  }));
  $("segments").hidden = kind !== "segments";
  showSegments();
}

function showSegments() {
  $("segments").replaceChildren(...segments.map((s, i) => {
    const row = document.createElement("div"), pick = document.createElement("select"), kind = Object.keys(segmentKinds).find(k => k in s);
    row.className = "segment";
    for (const k in segmentKinds) pick.add(new Option(segmentKinds[k][0], k, false, k === kind));
    pick.onchange = () => { segments[i] = { [pick.value]: "1" }; showSegments(); changed(); };
    row.append(pick);
    for (const k of [kind, ...Object.keys(segmentKinds[kind][1])]) {
      const x = document.createElement("input");
      x.value = s[k] === undefined ? "" : s[k]; x.placeholder = k === kind ? "" : segmentKinds[kind][1][k]; x.title = x.placeholder; x.inputMode = "decimal";
      x.oninput = () => { s[k] = x.value; changed(); };
      row.append(x);
    }
    row.append(button("+", () => { segments.splice(i + 1, 0, { hold_s: "1" }); showSegments(); changed(); }, "a segment after this one"),
      button("−", () => { if (segments.length > 1) segments.splice(i, 1); showSegments(); changed(); }, "leave this one out"));
    return row;
  }));
}

function button(text, act, title) {
  const b = document.createElement("button");
  b.textContent = text; b.title = title || ""; b.onclick = act;
  return b;
}

const given = keys => Object.fromEntries(keys.filter(k => field(k) !== "").map(k => [k, number(field(k))]));

/* A run of a kind from a pre-indentation on is a list of segments. */
function preIndented(kind, run) {
  const pre = number(field("pre_mm")), list = [{ move_to_mm: pre, rate_mm_s: 1 }, { hold_s: field("pre_s") === "" ? 5 : number(field("pre_s")) }];
  const ramp_s = run.ramp_s === undefined ? 1 : run.ramp_s;
  if (kind === "ramp_hold") list.push({ move_to_mm: run.depth_mm, rate_mm_s: Math.abs(run.depth_mm - pre) / ramp_s }, { hold_s: run.hold_s === undefined ? 200 : run.hold_s });
  else if (kind === "static") list.push({ move_to_mm: run.depth_mm, rate_mm_s: run.rate_mm_s === undefined ? 0.1 : run.rate_mm_s });
  else if (kind === "cyclic") list.push({ cycle_to_mm: run.depth_mm, rate_mm_s: run.rate_mm_s === undefined ? 1 : run.rate_mm_s, cycles: run.cycles === undefined ? 3 : run.cycles });
  else list.push({ ...run, ramp_s });
  return { kind: "segments", name: `${kind}_from_${pre}mm`, segments: list };
}

function oneRun(kind, depth) {
  const keys = Object.keys(kinds[kind][1]).filter(k => !k.startsWith("pre_") && k !== "depth_mm"), figures = given(keys);
  if (depth !== "") figures.depth_mm = number(depth);
  if (kinds[kind][1].pre_mm && Number(field("pre_mm")) > 0) return preIndented(kind, figures);
  if (kind === "creep") return { kind: "segments", name: `creep_${figures.force_N}N`, segments: [figures] };
  if (kind === "segments") return { kind, segments: segments.map(s => Object.fromEntries(Object.entries(s).filter(e => e[1] !== "").map(([k, v]) => [k, number(String(v))]))) };
  return { kind, ...figures };
}

function makeProtocol() {
  const kind = $("kind").value, depths = field("depth_mm") === "" ? [""] : field("depth_mm").split(/[,;\s]+/).filter(d => d !== "");
  const shared = given(["air_mm", "air_s", "after_s", "rest_s"]), times = Math.min(100, Math.max(1, Math.round(Number(field("repeats")) || 1)));
  const order = $("f_random").checked ? { order: "random" } : {}, first = $("f_first").checked ? { repeat_first: true } : {}, runs = [];
  for (let k = 0; k < times; k++) for (const d of depths) {
    const run = oneRun(kind, d);
    if (field("name") !== "") run.name = field("name");
    runs.push(run);
  }
  return { palpate: { protocol: 1 }, ...order, ...first, ...shared, runs };
}

const pretty = p => JSON.stringify(p, null, 2).replace(/\{\n\s+([^{}[\]]{0,100}?)\n\s*\}/g, (all, inside) => "{" + inside.replace(/\n\s+/g, " ") + "}");

function changed() {
  if ($("kind").value !== "file") $("protocol").value = pretty(makeProtocol());
  try { localStorage.setItem("palpate_form", JSON.stringify({ kind: $("kind").value, text: $("protocol").value, segments,
    fields: Object.fromEntries([...document.querySelectorAll(".fields input")].map(i => [i.id, i.type === "checkbox" ? i.checked : i.value])) })); } catch { /* not kept, then */ }
  planGood = false;
  $("start").disabled = true;
  clearTimeout(timer);
  timer = setTimeout(plan, 250);
}

/* The program says what the runs would be, or what is wrong: the same that would run them. */
async function plan() {
  if (planning) planning.abort();
  planning = new AbortController();
  try {
    const got = await ask("POST", "/plan", $("protocol").value, planning.signal), one = got.runs.length === 1;
    let at = 0;
    const x = [], y = [], fx = [], fy = [];
    let deepest = 0, strongest = 0;
    for (const r of got.runs) { for (const p of r.path) deepest = Math.max(deepest, p[1]); for (const p of r.force) strongest = Math.max(strongest, Math.abs(p[1])); }
    for (const r of got.runs) {
      at += r.rest_s;
      for (const p of r.path) { x.push(at + p[0]); y.push(p[1]); }
      for (const p of r.force) { fx.push(at + p[0]); fy.push(strongest ? p[1] / strongest * Math.max(deepest, 1) : 0); }
      x.push(null); y.push(null); fx.push(null); fy.push(null);
      at += r.length_s;
    }
    picture.zoom = null;
    picture.yName = strongest ? "depth (mm), force" : "depth (mm)";
    picture.show([{ x, y, color: "#0060a0" }, { x: fx, y: fy, color: "#c0271a", dash: [5, 3] }]);
    $("plan").textContent = `${one ? "1 run" : got.runs.length + " runs"}, ${clock(got.length_s)}` + (one ? `: ${got.runs[0].name}` : "") + (strongest ? `; red: force, up to ${strongest} N` : "");
    $("plan").className = "hint";
    planGood = true;
  } catch (e) {
    if (e.name === "AbortError") return;
    $("plan").textContent = e.message;
    $("plan").className = "hint bad";
    planGood = false;
    picture.show([]);
  }
  if (now && $("lost").hidden) showState(now);
}

function loadProtocol(text) {
  $("kind").value = "file";
  showFields();
  $("protocol").value = text;
  $("protocol").closest("details").open = true;
  changed();
}

function makeForm() {
  for (const k in kinds) $("kind").add(new Option(kinds[k][0], k));
  for (const k in common) $("common").append(input(k, common[k][0], "", common[k][1]));
  for (const [id, text] of [["f_random", " random order"], ["f_first", " the first again at the end"]]) {
    const l = document.createElement("label"), b = document.createElement("input");
    b.type = "checkbox"; b.id = id; b.onchange = changed;
    l.append(b, text);
    $("common").append(l);
  }
  let kept = null;
  try { kept = JSON.parse(localStorage.getItem("palpate_form")); } catch { /* none */ }
  if (kept && kept.kind in kinds) {
    segments = kept.segments;
    $("kind").value = kept.kind;
    showFields();
    for (const id in kept.fields) if ($(id)) { if ($(id).type === "checkbox") $(id).checked = kept.fields[id]; else $(id).value = kept.fields[id]; }
    $("protocol").value = kept.text;
  } else showFields();
  $("kind").onchange = () => { showFields(); changed(); };
  $("protocol").oninput = () => { $("kind").value = "file"; showFields(); changed(); };
  $("open").onchange = async e => { if (e.target.files[0]) loadProtocol(await e.target.files[0].text()); e.target.value = ""; };
  $("save").onclick = () => {
    const a = document.createElement("a");
    a.href = "data:application/json," + encodeURIComponent($("protocol").value); a.download = "protocol.json"; a.click();
  };
  changed();
}

/* ---- begin ---- */

$("emergency").onclick = emergency;
document.addEventListener("keydown", e => { if (e.key === "Escape") { e.preventDefault(); emergency(); } }, true);
$("stop").onclick = () => { series = null; order("/stop"); };
$("until").onclick = toggleSeries;
$("start").onclick = () => { $("start").disabled = true; $("span").value = "run"; overTime.zoom = overDepth.zoom = null; order("/start", $("protocol").value); };
for (const b of document.querySelectorAll("[data-do]")) b.onclick = () => { b.disabled = true; order("/do?what=" + b.dataset.do); };
for (const b of document.querySelectorAll("[data-jog]")) b.onclick = () => order(`/jog?by_mm=${b.dataset.jog}&rate_mm_s=${encodeURIComponent($("jog_rate").value)}`);
$("choose").onclick = async () => { const all = marked.size < runs.length; for (const r of runs) if (marked.has(r.name) !== all) await mark(r.name, all); };
$("cancel").onclick = () => { series = null; order("/job?what=cancel"); };
for (const b of document.querySelectorAll("[data-job]")) b.onclick = () => order("/job?what=" + b.dataset.job, [...marked.keys()].join(","));
$("span").onchange = () => { overTime.zoom = overDepth.zoom = null; };
makeForm();
poll();
