/* page.js: draws a result of palpate, which stands in the page as JSON: of explain, characterize, calibrate, report or batch. */
"use strict";

/* ---- elements ---- */

/* element("p.about", "text", other, ...): null and false are left out, lists are taken apart. */
function element(kind, ...children) {
  const [name, ...classes] = kind.split("."), node = document.createElement(name);
  if (classes.length) node.className = classes.join(" ");
  node.append(...children.flat(Infinity).filter(c => c !== null && c !== undefined && c !== false));
  return node;
}

const paragraph = (...children) => element("p", ...children), about = (...children) => element("p.about", ...children);

/* heads: cells between bars; "~" in front of one makes its column text, aligned left. A row is a list of cells, each a text, an element
 * or a td of its own. */
function table(caption, heads, rows, name = "table") {
  if (!rows.length) return null;
  const columns = heads.split("|"), text = columns.map((h, i) => i === 0 || h.startsWith("~"));
  const head = columns.map((h, i) => element(text[i] ? "th.text" : "th", h.replace("~", "")));
  for (const th of head) th.scope = "col";
  const cell = (c, i) => c instanceof HTMLTableCellElement ? c : element(text[i] ? "td.text" : "td", c ?? "-");
  const body = rows.map(row => element(row.taken ? "tr.taken" : "tr", row.map(cell)));
  return element("div.scroll", element(name, caption && element("caption", caption), element("thead", element("tr", head)),
    element("tbody", body)));
}

const nothing = node => !node || (node.querySelector && !node.childNodes.length);
const tables = (...list) => list.flat().every(nothing) ? null : element("div.tables", list);

/* ---- numbers and names ---- */

const known = v => typeof v === "number" && isFinite(v);
const short = (v, n = 3) => known(v) ? String(Number(v.toPrecision(n))).replace("e+", "e") : "-";
const padded = (v, n) => known(v) ? v.toPrecision(n).replace("e+", "e") : "-";
const fixed = (v, n) => known(v) ? v.toFixed(n) : "-";
const base = path => String(path ?? "-").replace(/.*\//, "");
const list = v => Array.isArray(v) ? v : [];
const extent = values => values.reduce(([a, b], v) => known(v) ? [Math.min(a, v), Math.max(b, v)] : [a, b], [Infinity, -Infinity]);
const at_most_one = v => Math.max(0, Math.min(1, v));

/* In N to pN. */
function force(newtons) {
  const units = [["N", 1], ["mN", 1e-3], ["µN", 1e-6], ["nN", 1e-9], ["pN", 1e-12]];
  if (!known(newtons)) return "-";
  const [unit, size] = newtons === 0 ? units[1] : units.find(u => Math.abs(newtons) >= 0.9995 * u[1]) ?? units[4];
  return `${short(newtons / size)} ${unit}`;
}

/* With two digits of the uncertainty, half an interval. */
function digits(value, half) {
  if (!known(value)) return "-";
  if (!(half > 0)) return short(value, 5);
  const last = Math.floor(Math.log10(half)) - 1;
  if (-last <= 9 && Math.abs(value) < 1e15) return value.toFixed(Math.max(-last, 0));
  return value.toExponential(Math.min(Math.max(Math.floor(Math.log10(Math.abs(value))) - last, 0), 15));
}

/* "force_N_s" as name "force" and unit "N/s". */
function parameter(key) {
  const words = key.split("_"), unit = [];
  while (words.length > 1 && unit.length < 2 && ["mm", "um", "N", "s", "Hz", "kg", "rad",
    "K"].includes(words.at(-1))) unit.unshift(words.pop());
  return { name: words.join(" "), unit: unit.join("/") };
}

/* ---- figures: {name, title, panels: [{x_label, y_label, x_log, y_log, y_range, series: [{style, colour, title, x, y, low, high}]}]} ---- */

/* Okabe and Ito's palette, which colour-blind readers tell apart too; from 1000 on a place on the viridis scale, dark to light. */
const PALETTE = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000", "#8c6d31"];
const SHADES = [[68, 1, 84], [49, 104, 142], [31, 158, 137], [142, 201, 60]];
function colour(code) {
  if (code < 1000) return PALETTE[code % PALETTE.length];
  const at = 3 * Math.min((code - 1000) / 999, 0.9999), k = Math.floor(at);
  return `rgb(${SHADES[k].map((c, i) => Math.round(c + (at - k) * (SHADES[k + 1][i] - c)))})`;
}

const FONT = "12px 'DejaVu Sans', Arial, sans-serif";
const ruler = document.createElement("canvas").getContext("2d");
function text_width(text) {
  ruler.font = FONT;
  return ruler.measureText(text).width;
}

function shape(name, attributes, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children.flat(Infinity));
  return node;
}

function label(x, y, text, anchor = "start", more = {}) {
  return shape("text", { x, y, "text-anchor": anchor, fill: "#1c2329", ...more }, text);
}

/* Places of the marks of an axis and what they say. */
function ticks(low, high, log, room) {
  const decades = Math.log10(high / low);
  if (log && decades > 0.5) {
    const steps = decades > 3 ? [1] : decades > 1 ? [1, 2, 5] : [1, 2, 3, 5], every = Math.ceil(decades / Math.max(room, 2)), found = [];
    for (let k = Math.floor(Math.log10(low)); k <= Math.log10(high); k++)
      if (k % every === 0) for (const s of steps) found.push(s * 10 ** k);
    return found.filter(v => v >= low * 0.999 && v <= high * 1.001).map(v => ({ at: v, text: power_text(v) }));
  }
  const raw = (high - low) / Math.max(room, 2), unit = 10 ** Math.floor(Math.log10(raw)),
    step = [1, 2, 5, 10].map(s => s * unit).find(s => s >= 0.999 * raw);
  const found = [];
  for (let i = Math.ceil(low / step - 1e-6); i * step <= high + 1e-6 * step; i++)
    found.push({ at: i * step, text: short(Number((i * step).toPrecision(10)), 6) });
  return found;
}

function power_text(v) {
  const k = Math.round(Math.log10(v));
  if (v >= 0.00099 && v < 99999) return short(v, 2);
  return (Math.abs(v / 10 ** k - 1) < 1e-6 ? "10" : short(v / 10 ** Math.floor(Math.log10(v)), 1) + "·10") +
    String(Math.floor(Math.log10(v) + 1e-9)).replace(/./g, c => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻");
}

/* Lowest and highest of an axis; curves alone fill the width, and all have room above and below. */
function range_of(panel, axis) {
  const log = panel[axis + "_log"], keys = axis === "x" ? ["x"] : ["y", "low", "high"];
  if (axis === "y" && panel.y_range) return panel.y_range;
  let [low, high] = extent(panel.series.flatMap(s => keys.flatMap(k => list(s[k]))).filter(v => !log || v > 0));
  if (!(high >= low)) return log ? [0.1, 1] : [0, 1];
  const pad = axis === "y" || panel.series.some(s => ["points", "bars", "line_points"].includes(s.style)) ? 0.05 : 0;
  if (log) {
    const by = high > low ? (high / low) ** pad : 2;
    return [low / by, high * by];
  }
  const by = high > low ? pad * (high - low) : Math.abs(high) / 10 || 1;
  return [low - by, high + by];
}

/* The path of a series; X and Y put values on the paper. */
function path_of(s, X, Y) {
  const y = s.y ?? s.low, good = i => isFinite(X(s.x[i])) && isFinite(Y(y[i])) && y[i] !== null,
    xy = (i, v) => `${X(s.x[i]).toFixed(1)} ${Y(v).toFixed(1)}`;
  const index = s.x.map((_, i) => i).filter(good), line = values => index.map((i, k) => (k ? "L" : "M") + xy(i, values[i])).join("");
  const dots = r => index.map(i => `M${xy(i, y[i])}m${-r} 0a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`).join("");
  switch (s.style) {
  case "band": return line(s.low) + index.reverse().map(i => "L" + xy(i, s.high[i])).join("") + "Z";
  case "points": return dots(2.5);
  case "line_points": return line(y) + dots(2.5);
  case "bars": return dots(2.5) + index.filter(i => known(s.low[i]) &&
    known(s.high[i])).map(i => `M${xy(i, s.low[i])}L${xy(i, s.high[i])}`).join("");
  default: return line(y);
  }
}

const LOOKS = { line: { "stroke-width": 1.6 }, dashed: { "stroke-width": 1.6, "stroke-dasharray": "6 4" }, points: { "stroke-width": 1.2 },
  line_points: { "stroke-width": 1.6 }, bars: { "stroke-width": 1.3 }, pale: { "stroke-width": 1, "stroke-opacity": 0.4 } };

function curve(s, X, Y) {
  const tint = s.style === "band", look = tint ? { fill: colour(s.colour), "fill-opacity": 0.18 } :
    { fill: "none", stroke: colour(s.colour), ...LOOKS[s.style] };
  return shape("path", { class: "curve", d: path_of(s, X, Y), "stroke-linejoin": "round", ...look });
}

/* The names of the series in rows above the panel. */
function key_of(series, left, width, top) {
  const nodes = [];
  let x = left, y = top;
  for (const s of series.filter(s => s.title)) {
    const wide = 34 + text_width(s.title);
    if (x > left && x + wide > left + width) [x, y] = [left, y + 17];
    const sample = { ...s, x: [0, 1], y: [0, 0], low: s.style === "band" ? [-1, -1] : undefined,
      high: s.style === "band" ? [1, 1] : undefined };
    nodes.push(curve(s.style === "band" ? { ...sample, y: undefined } : s.style === "points" || s.style === "bars" ?
      { ...sample, style: "points", x: [0.5], y: [0] } : sample,
      v => x + 18 * v, v => y - 4 - 4 * v), label(x + 23, y, s.title));
    nodes.at(-2).setAttribute("class", "sample");
    x += wide + 10;
  }
  return { nodes, height: nodes.length ? y - top + 20 : 4 };
}

/* A panel from top on, so high; x marks and their name only below the last of those that share x. */
function panel_of(panel, range, width, left, top, high, last) {
  const key = key_of(panel.series, left, width - left - 6, top + 12), y0 = top + key.height + 4, y1 = top + high - (last ? 38 : 8),
    x1 = width - 12;
  const [xl, xh] = range, [yl, yh] = range_of(panel, "y"), scale = (log, l, h, a, b) => v => log ?
    a + (b - a) * Math.log(v / l) / Math.log(h / l) : a + (b - a) * (v - l) / (h - l);
  const X = scale(panel.x_log, xl, xh, left, x1), Y = scale(panel.y_log, yl, yh, y1, y0), nodes = [...key.nodes],
    grid = { stroke: "#e3e7ea" };
  let end = -Infinity;
  for (const t of ticks(xl, xh, panel.x_log, (x1 - left) / 75)) {
    const half = text_width(t.text) / 2, x = X(t.at);
    nodes.push(shape("line", { x1: x, x2: x, y1: y0, y2: y1, ...grid }));
    if (!last || x - half < end || x + half > width) continue;
    nodes.push(label(x, y1 + 16, t.text, "middle"));
    end = x + half + 6;
  }
  end = Infinity;
  for (const t of ticks(yl, yh, panel.y_log, (y1 - y0) / 38)) {
    const y = Y(t.at);
    nodes.push(shape("line", { x1: left, x2: x1, y1: y, y2: y, ...grid }));
    if (y + 14 > end) continue;
    nodes.push(label(left - 6, y + 4, t.text, "end"));
    end = y;
  }
  nodes.push(shape("path", { d: `M${left} ${y0}V${y1}H${x1}`, fill: "none", stroke: "#1c2329" }));
  /* an svg within an svg cuts off what is beyond it */
  nodes.push(shape("svg", { x: left, y: y0, width: Math.max(x1 - left, 1), height: Math.max(y1 - y0, 1),
    viewBox: `${left} ${y0} ${x1 - left} ${y1 - y0}` },
    panel.series.map(s => curve(s, X, Y))));
  const small = Math.min(12, 12 * (high - 4) / text_width(panel.y_label)), middle = top + high / 2;
  nodes.push(label(13, middle, panel.y_label, "middle", { transform: `rotate(-90 13 ${middle})`, "font-size": small.toFixed(1) }));
  if (last) nodes.push(label((left + x1) / 2, y1 + 33, panel.x_label, "middle"));
  return nodes;
}

function drawing(figure, width) {
  const panels = figure.panels, high = figure.low ? 190 : Math.min(Math.max(0.62 * width, 230), 360),
    heights = panels.length > 1 ? [0.72 * high, 0.5 * high] : [high];
  const ranges = panels.map(p => range_of(p, "x")), x = [Math.min(...ranges.map(r => r[0])), Math.max(...ranges.map(r => r[1]))];
  const marks = panels.flatMap((p, i) => ticks(...range_of(p, "y"), p.y_log, heights[i] / 38)),
    left = 34 + Math.max(...marks.map(t => text_width(t.text)));
  const keys = panels.map(p => key_of(p.series, left, width - left - 6, 0).height), nodes = [];
  let top = 0;
  panels.forEach((p, i) => {
    nodes.push(panel_of(p, x, width, left, top, heights[i] + keys[i], i === panels.length - 1));
    top += heights[i] + keys[i];
  });
  return shape("svg", { xmlns: "http://www.w3.org/2000/svg", viewBox: `0 0 ${width} ${top}`, role: "img", "aria-label": figure.title,
    style: `font: ${FONT}` },
    shape("title", {}, figure.title), shape("rect", { width, height: top, fill: "#fff" }), nodes);
}

function save(svg, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([new XMLSerializer().serializeToString(svg)], { type: "image/svg+xml" }));
  link.download = name + ".svg";
  link.click();
}

const drawn = [], placed = new Set();

/* A figure is drawn as wide as it stands, and again when that changes. */
function figure_of(spec, caption) {
  const button = element("button.save", "save SVG"), node = element("figure",
    element("figcaption", button, element("b", spec.title), caption ? ". " + caption : ""));
  let width = 0;
  const draw = () => {
    const now = Math.max(node.clientWidth - 16, 0) || 520;
    if (now === width) return;
    width = now;
    if (node.firstChild.tagName === "svg") node.firstChild.remove();
    node.prepend(drawing(spec, width));
  };
  node.dataset.name = spec.name;
  button.type = "button";
  button.onclick = () => save(node.firstChild, spec.name);
  drawn.push(draw);
  placed.add(spec);
  return node;
}

function draw_all() {
  for (const draw of drawn) draw();
}

const figures = (...nodes) => nodes.flat().every(nothing) ? null : element("div.figures", nodes.flat().filter(n => !nothing(n)));

/* ---- what is on the page ---- */

const R = JSON.parse(document.getElementById("result").textContent);
const kind_of = result => ["explain", "characterize", "calibrate", "report", "batch_result"].find(k => result.palpate && k in result.palpate);
const TITLES = { explain: "What the model misses", characterize: "The lumped model", calibrate: "The calibrated network",
  batch_result: "Jobs of a batch" };

/* A single result is a report of it alone. */
const page = kind_of(R) === "report" ? R : { title: TITLES[kind_of(R)] ?? "palpate", results: [{ file: "", result: R }],
  recordings: list(R.runs) };
const results = kind => list(page.results).map(r => r.result).filter(r => kind_of(r) === kind);
const recordings = list(page.recordings), models = list(page.models), simulations = list(page.simulations);
const known_figures = [...list(page.results).flatMap(r => list(r.result.figures)), ...list(page.figures)];

const CAPTIONS = {
  recordings_linear: "Force over time.",
  recordings_log: "The same over the logarithm of time, where each arm takes its decade.",
  recordings_first: "The first ten seconds.",
  recordings_static: "Force over depth in the slow press.",
  fit_linear: "The model (dark) over the raw samples (light).",
  fit_log: "The same over the logarithm of time.",
  fit_first: "The first ten seconds, with the ramp.",
  fit_depth: "Force against depth, loops included: the model (dark) over the raw samples (light).",
  residuals: "Model minus measured in units of the noise of a sample; means of short stretches.",
  fit_static: "The slow press: the model with its arms at work.",
  static_fit: "What was wanted and what the network gives.",
  relaxation_log: "The same over the logarithm of time.",
  simulated_linear: "Simulated (dark) over recorded (light); its 95 % band, if it was simulated with --band.",
  simulated_log: "The same over the logarithm of time.",
  simulated_static: "The slow press.",
};
const named = (...names) => names.flatMap(name => known_figures.filter(f => f.name === name).map(f => figure_of(f, CAPTIONS[name])));

const line = (title, colour, x, y, style = "line") => ({ style, colour, title, x, y });
const plot = (name, title, panels, caption) => figure_of({ name, title, panels: [panels].flat() }, caption);
const column = (rows, key) => rows.map(r => r[key]);

/* ---- explain ---- */

const effect_name = (r, id) => r.catalogue?.[id]?.name ?? id;
const phase_name = id => ({ early_dwell: "dwell, early", late_dwell: "dwell, late" })[id] ?? String(id).replace(/_/g, " ");
const some_effects = r => list(r.effects).length > 0;

function parameter_words(effect, key) {
  const [low, high] = effect.intervals?.[key] ?? [], half = (high - low) / 2;
  return { ...parameter(key), value: digits(effect.parameters[key], half), low: digits(low, half), high: digits(high, half) };
}

function effect_in_short(r, effect) {
  const numbers = Object.keys(effect.parameters ?? {}).map(key => {
    const w = parameter_words(effect, key);
    return `${w.name} ${w.value}${w.unit && " " + w.unit} (${w.low} to ${w.high})`;
  });
  return paragraph(`${effect_name(r, effect.id)}: ${r.catalogue?.[effect.id]?.means ?? ""} Here: ${numbers.join(", ")}.`);
}

/* Where no effect is named yet: which are the first to think of, and what to measure. */
function ranked(r) {
  const best = list(r.rejected).filter(c => c.score > 0).sort((a, b) => b.score - a.score).slice(0, 3);
  return [...best.map((c, i) => paragraph(`${i + 1}. ${effect_name(r, c.id)} (the natural logarithm of the likelihood grows by ${short(c.score)}): ${c.reason}.`)),
    paragraph(`Next: ${r.next_sentence}`)];
}

function verdict(r) {
  const [first, ...others] = list(r.sentences), box = element("div.verdict", element("b", first ?? r.verdict));
  box.classList.add(r.verdict);
  others.forEach((sentence, i) => box.append(paragraph(sentence), ...(i === 0 ? list(r.effects).map(e => effect_in_short(r, e)) : [])));
  if (r.verdict === "suspected" || r.verdict === "unexplained") box.append(...ranked(r));
  return box;
}

function effect_card(r, effect) {
  const alike = list(effect.class).slice(1).map(id => effect_name(r, id)).join(", ");
  const rows = Object.keys(effect.parameters ?? {}).map(key => {
    const w = parameter_words(effect, key);
    return [w.name, w.value, `${w.low} to ${w.high}`, w.unit, key];
  });
  return element("div.effect", element("h4", effect_name(r, effect.id)), paragraph(r.catalogue?.[effect.id]?.means ?? ""),
    table(null, "parameter|value|95 % interval|~unit|~in the model file", rows),
    known(effect.gap_closed) && paragraph(`It closes ${fixed(100 * at_most_one(effect.gap_closed), 0)} % of the squared gap above the noise level that is open without it.`),
    known(effect.evidence) && known(effect.evidence_standard_error) &&
      paragraph("With it the recordings are more likely: the natural logarithm of their likelihood, less a price for its parameters, grows by " +
      `${fixed(effect.evidence, 0)}. Over the experiments left out it grows with a standard error of ${fixed(effect.evidence_standard_error, 0)}.`),
    effect.recovers && paragraph("The specimen recovers between the runs of the session: each run begins as on a new one."),
    paragraph(`Would do as well: ${alike || "no other effect of the catalogue"}.`));
}

/* A cell with a bar for each share of the width that is known (orange as given, blue with the effects), and a dashed line. */
function bars(before, after, mark) {
  const cell = element("td.bars"), percent = v => (100 * v).toFixed(1) + "%";
  for (const [value, kind] of [[before, "i"], [after, "i.after"]])
    if (known(value)) cell.append(element(kind)), cell.lastChild.style.width = percent(value);
  if (known(mark)) cell.append(element("u")), cell.lastChild.style.left = percent(mark);
  return cell;
}

/* rows: label, before, after in N; null = none. */
function force_bars(r, caption, rows) {
  const level = r.gap?.noise_level_N, most = extent([level, ...rows.flatMap(b => b.slice(1))])[1], share = v => known(v) ? v / most : null;
  if (!rows.length) return null;
  return element("figure", table(null, `|~dashed: noise level ${force(level)}|~rms`, rows.map(([name, before, after]) =>
    [name, bars(share(before), share(after), share(level)), [before, after].filter(known).map(force).join(" → ")])),
  element("figcaption", caption));
}

function gap(r) {
  const g = r.gap ?? {}, parts = r.noise_level ?? {}, two = some_effects(r), one = list(r.profile?.experiments).length === 1;
  const rows = [["all experiments", g.before_N, two ? g.after_N : null],
    ["experiments left out", g.heldout_before_N, two ? g.heldout_after_N : null]];
  const caption = `The gap, rms: orange the model as given, refitted${two ? ", blue with the effects" : ""}.` +
    (one ? "" : " Below: experiments that the fit did not see.") +
    (two && known(g.closed) ? ` Of the gap above the noise level ${fixed(100 * at_most_one(g.closed), 0)} % is closed.` : "");
  const noise = [["white noise of a sample", force(parts.white_N)], ["correlated noise",
    `${force(parts.correlated_N)} over ${short(parts.correlation_s, 2)} s`],
    ...(one ? [] : [["gain from run to run", `${short(100 * parts.gain_scatter, 2)} %`],
      ["contact from run to run", `${short(parts.contact_scatter_mm, 2)} mm`],
      ["runs that go the same way", parts.replicates ? "there are some" : "none: repeat a run"]])];
  return [element("h3", "The gap before and after"),
    figures(force_bars(r, caption, one ? rows.slice(0, 1) : rows), element("div",
      table("What the noise level is made of", "part|~size", noise)))];
}

/* Shares of the gap by run and phase; at most so many runs, those with the largest. */
function disagreement(r) {
  const PHASES = ["air", "ramp", "corner", "early_dwell", "late_dwell", "unload", "recovery", "reload"], ROWS = 30;
  const shares = list(r.phase_shares), runs = list(r.profile?.experiments), two = some_effects(r), total = {}, by_phase = {};
  for (const s of shares) {
    total[s.experiment] = (total[s.experiment] ?? 0) + 100 * s.share;
    by_phase[s.phase] = (by_phase[s.phase] ?? 0) + 100 * s.share;
  }
  const largest = o => Object.keys(o).reduce((a, b) => o[b] > o[a] ? b : a),
    most = Math.max(1e-9, ...shares.flatMap(s => [100 * s.share, 100 * s.remaining || 0]));
  const part = (percent, rgb) => { /* the fainter the smaller */
    const strength = Math.sqrt(Math.min(1, percent / most)), b = element("b", fixed(percent, percent >= 9.95 ? 0 : 1));
    b.style.background = `rgba(${rgb},${strength.toFixed(2)})`;
    if (strength > 0.75) b.style.color = "#fff";
    return percent >= 0.05 && b;
  };
  const cell = (run, phase) => {
    const s = shares.find(s => s.experiment === run.experiment && s.phase === phase) ?? {};
    return element("td.share", part(100 * s.share, "213,94,0"), two && part(100 * s.remaining, "0,114,178"));
  };
  const order = [...runs].sort((a, b) => (total[b.experiment] ?? 0) - (total[a.experiment] ?? 0)).slice(0, ROWS);
  const rows = runs.filter(run => order.includes(run)).map(run => [base(run.experiment), ...PHASES.map(p => cell(run, p)),
    force(run.before_N) + (two ? ` → ${force(run.after_N)}` : "")]);
  const words = !shares.length ? "Nowhere is the gap above the noise level." :
    `Of all that is above the noise level ${fixed(by_phase[largest(by_phase)], 0)} % is in the phase “${phase_name(largest(by_phase))}” of the experiments, and ` +
    `${fixed(total[largest(total)], 0)} % in one experiment, ${base(largest(total))}. The largest single place is ${base(shares[0].experiment)}, ` +
    `“${phase_name(shares[0].phase)}”: ${fixed(100 * shares[0].share, 0)} %.`;
  const caption = "Share of the first gap in %, squared and above the noise level, by experiment and phase: orange as given" +
    (two && shares.some(s => known(s.remaining)) ? ", blue what remains of it with the effects" :
      "") + ". Empty: the experiment has no such phase, or nothing above " +
    "the noise level in it. A corner is the first 0.2 s after the motion changes; recovery is the time back at or above contact.";
  if (!runs.length) return [];
  const profile = (key, name, caption) => force_bars(r, caption, list(r.profile[key]).map(b =>
    [name(b.from, b.to), b.before_N, two ? b.after_N : null]));
  return [element("h3", "Where they disagree"), paragraph(words),
    element("figure", table(null, `experiment|${PHASES.map(p => "~" + phase_name(p)).join("|")}|whole run, rms`, rows),
      element("figcaption", caption)),
    figures(profile("depth_mm", (from, to) => known(from) ? `${short(from)} to ${short(to)} mm` : "in air",
      "Recorded minus model by depth, rms."),
      profile("speed_mm_s", speed_words, "The same by speed and direction of the plate."))];
}

function speed_words(from, to) {
  const [slow, fast] = [Math.abs(from), Math.abs(to)].sort((a, b) => a - b), way = from >= 0 && known(from) ? "in" : "out";
  if (from < 0 && to > 0) return "standing still";
  return known(from) && known(to) ? `${way}, ${short(slow)} to ${short(fast)} mm/s` :
    `${way}, above ${short(known(from) ? Math.abs(from) : Math.abs(to))} mm/s`;
}

function residuals(r) {
  const own = list(r.figures).filter(f => f.name === "explain_residuals");
  if (!own.length) return [];
  for (const f of own) f.low = true;
  return [element("h3", "Recorded minus model"), about("Orange as given, blue with the effects (lines: means, tint: lowest and highest), grey the noise level. " +
    "At most the twelve runs with the largest gap."), figures(own.map(f => figure_of(f)))];
}

/* ---- explain: how it was found ---- */

function search(r) {
  const SHOWN = 7, taken_of = s => s.taken ? [{ id: s.taken, score: s.score, explained_N: s.explained_N, taken: true }] : [];
  const steps = list(r.steps).map(s => ({ taken: s.taken, list: [...taken_of(s),
    ...[...list(s.rejected)].sort((a, b) => b.score - a.score || (a.id < b.id ? -1 : 1))] }));
  const best = Math.log(Math.max(100, ...steps.flatMap(s => s.list.map(c => c.score ?? 0)))),
    mark = at_most_one(Math.log(r.null_threshold) / best);
  const row = c => Object.assign([effect_name(r, c.id), bars(c.score > 1 ? at_most_one(Math.log(c.score) / best) : null, null, mark),
    fixed(c.score, Math.abs(c.score) < 9.95 ? 1 : 0), c.explained_N > 0 ? force(c.explained_N) : "-", c.taken ? "added" : c.reason],
      { taken: c.taken });
  const rows = list => table(null, "candidate|~score, on a logarithmic scale|score|would explain, rms|~what became of it", list.map(row));
  let given = "the model as given";
  const sections = steps.map((s, i) => {
    const first = s.list.slice(0, SHOWN).filter(c => c.score > 0 || c.taken), others = s.list.slice(first.length),
      title = `Step ${i + 1}: conditional on ${given}`;
    given += (i ? ", " : " with ") + effect_name(r, s.taken);
    return [element("h4", title), !s.taken && paragraph("No candidate was accepted: the search ends here."), rows(first),
      others.length > 0 && element("details", element("summary", `${first.length ? "The other" : "All"} ${others.length}`), rows(others))];
  });
  const kept = list(r.effects).map(e => e.id), back = steps.map(s => s.taken).filter(id => id && !kept.includes(id));
  const blind = list(r.not_identifiable).map(c => [effect_name(r, c.id), c.reason]);
  return [element("h3", "The candidates and their scores"), element("div.candidates",
    paragraph("Each effect of the catalogue was added to the model and refitted with " +
    "everything else over all experiments at once. The score is the natural logarithm of how many times more likely it makes the recordings, less a price for its " +
    "parameters; the dashed line is what the best of all candidates gains by chance" + (known(r.null_threshold) ?
      ` (${short(r.null_threshold, 2)})` : "") +
    ". The best one that also predicts experiments left out of the fit and changes the forces by enough is added, and the others are tried again with it in the model."),
  sections), back.map(id => list(r.rejected).filter(c => c.id === id).map(c =>
    paragraph(`Taken out again: ${effect_name(r, id)}. It ${c.reason}.`))),
  blind.length > 0 && paragraph("What an effect does is compared with all that a stiffness law, arms, and the runs' own contacts, zeros and gains could do in these runs. " +
    "Of which less than a twentieth is left, a law that is a little wrong would look the same: it is not named."),
  table("What these runs cannot show, whether it is there or not", "effect|~why, and what an experiment needs to show it", blind)];
}

function diagnostics(r) {
  const EVENTS = 30, d = r.residual_diagnostics ?? {}, g = r.gap ?? {}, two = some_effects(r), events = list(r.events),
    c = d.free_curves ?? {};
  const wave = (w, key, unit) => w?.[key] > 0 ? `Strongest wave of the residual: ${short(w[key], 4)} ${unit}, ${force(w.amplitude_N)}, ${short(w.prominence, 2)} times the usual power there.` :
    "No wave could be looked for.";
  const spectrum = (s, key, label, title, words) => {
    const mN = list => list.map(v => known(v) ? 1e3 * v : null);
    return list(s?.[key]).length > 1 && plot("spectrum_" + key, title,
      { x_label: label, y_label: "amplitude (mN)", x_log: true, y_log: true,
      series: [line(null, 1, s[key], mN(s.before_N)), ...(two ? [line(null, 0, s[key], mN(s.after_N))] : [])] }, words);
  };
  const free = [["the whole residual", g.after_N], ["above the noise level", g.unexplained_N], ["a curve of depth takes off", c.depth_N],
    ["a curve of time takes off", c.time_N], ["a curve of speed takes off", c.rate_N]].map(([name, v]) => two ? [name, null, v] :
      [name, v, null]);
  const order = list(r.phase_shares).map(s => [base(s.experiment), phase_name(s.phase), fixed(100 * s.share, 2), fixed(s.residual_lag1, 2),
    fixed(s.residual_runs_z, 1)]);
  return [element("h3", "Residual diagnostics"), figures(
    spectrum(r.spectrum?.time, "frequency_Hz", "frequency (Hz)", "Waves over time",
      "Amplitude against frequency. " + wave(d.line_in_time, "frequency_Hz", "Hz")),
    spectrum(r.spectrum?.depth, "period_mm", "period (mm)", "Waves over depth, while the plate moves",
      "Amplitude against period. " + wave(d.line_in_depth, "period_mm", "mm from crest to crest")),
    force_bars(r, "The most that an effect nobody has thought of could still explain, rms: free curves of depth, of time within a run, of the plate's speed.", free),
    events.length ? element("div", table("Events: they do not count against the model", "experiment|~what|from (s)|to (s)|size",
      events.slice(0, EVENTS).map(e => [base(e.experiment), e.kind, fixed(e.from_s, 3), fixed(e.to_s, 3), force(e.size_N)])),
    events.length > EVENTS && paragraph(`And ${events.length - EVENTS} more.`),
    about("spike: a lone sample far from its neighbours; release: the plate lets go of the specimen; slip: the residual steps and stays."))
      : element("div", paragraph("No events: no lone spikes, no plate letting go, no slips."))),
  order.length > 0 && element("details", element("summary", "From sample to sample: correlation and runs test, place by place"),
    paragraph("White noise has a correlation of 0 from sample to sample and a runs test within 2 standard deviations; correlated noise, a part of the noise level, has not."),
    table(null, "experiment|~phase|share of the first gap (%)|correlation|runs test (standard deviations)", order))];
}

/* The next runs, one after the other, as palpate acquire would make them. */
function next_path(runs) {
  const AIR = 2, x = [0], y = [-AIR], go = (depth, seconds) => { x.push(x.at(-1) + seconds); y.push(depth); };
  for (const run of runs) {
    const top = run.kind === "free" ? -AIR - run.depth_mm : run.depth_mm, way = Math.abs(top + AIR), rate = run.rate_mm_s;
    if (!(rate > 0)) return null;
    go(-AIR, 1);
    for (let c = 0; c < Math.max(run.cycles ?? 1, 1); c++) {
      if (c > 0) go(0, top / rate);
      go(top, (c ? top : way) / rate);
      go(top, Math.max(run.hold_s ?? 0, 0));
    }
    go(-AIR, way / rate);
    go(-AIR, Math.max(1, 0.02 * x.at(-1)));
  }
  return plot("next", "The next experiment: depth of the plate over time", { x_label: "time (s)", y_label: "depth (mm)",
    series: [line(null, 0, x, y), line("contact", 6, [0, x.at(-1)], [0, 0], "dashed")] },
      "The protocol file is written by --next, and run by palpate acquire --protocol.");
}

function next(r) {
  const n = r.next_experiment;
  return r.next_sentence ? [element("h3", "What to measure next"), paragraph(r.next_sentence), n?.runs.length ? figures(next_path(n.runs)) : null] : [];
}

function explained(r) {
  const cards = list(r.effects).map(e => effect_card(r, e));
  return [cards.length > 0 && [element("h3", "What is missing"), figures(cards)], gap(r), disagreement(r), residuals(r), search(r),
    diagnostics(r), next(r)];
}

/* ---- recordings ---- */

function findings(r) {
  const found = [r.missing > 0 && `${r.missing} samples missing (${short(100 * r.missing / (r.samples + r.missing), 2)} %)`,
    r.gaps > 0 && `${r.gaps} gap(s), up to ${short(r.longest_gap_s)} s`, r.spikes > 0 && `${r.spikes} spike(s)`,
      r.clipped > 0 && `${r.clipped} clipped samples`,
    r.hum_N > 0 && `hum ${short(1e3 * r.hum_N, 2)} mN at ${short(r.hum_Hz)} Hz`, r.uneven && "uneven sampling",
      r.fault && "ended by a fault"].filter(Boolean);
  return found.join("; ") || "none";
}

function measured() {
  const row = r => r.samples ? [base(r.file), { ramp: "ramp", ramp_hold: "ramp and hold" }[r.kind] ?? r.kind, short(r.deepest_mm, 4),
    short(r.ramp_s), short(r.duration_s, 4), r.samples,
    short(r.rate_Hz, 4), `${short(r.contact_mm)} ± ${short(1.96 * r.contact_sd_mm, 2)}`, r.contact_rule, fixed(1e3 * r.zero_N, 3),
      padded(1e3 * r.noise_N, 3), findings(r)] :
    [base(r.file), r.note ? "could not be used" : "no specimen", "", "", "", "", "", "", "", "", "", r.note ?? ""];
  return recordings.length > 0 && [table(null, "file|~protocol|depth (mm)|ramp (s)|length (s)|samples|rate (Hz)|contact (mm)|~found by|zero (mN)|noise (mN)|~findings", recordings.map(row)),
    about("Contact is the recorded depth at which the force begins, with its 95 % interval; zero is the recorded force in free air; noise is the standard deviation of a sample.")];
}

function curves() {
  const nodes = figures(named("recordings_linear", "recordings_log", "recordings_first", "recordings_static"));
  return nodes && [nodes, about("Light: raw samples, thinned to the lowest and highest of each stretch. Dark: filtered forward and backward, without a shift in time; " +
    "fits use the raw samples unless said otherwise.")];
}

/* ---- characterize ---- */

/* K(e) e of ascending coefficients of K. */
const polynomial = (coefficients, e) => coefficients.reduceRight((sum, c) => (sum + c) * e, 0);

/* The slow press of the first static run as it was filtered, and plain polynomials through it. */
function static_polynomials(r) {
  const first = list(r.static)[0], run = first && list(r.runs).find(x => x.file === first.file);
  const press = list(r.figures).find(f => f.name === "recordings_static")?.panels[0].series.find(s => s.style === "line");
  if (!press || !run) return null;
  const deepest = press.x.findIndex(x => x >= 0.9999 * Math.max(...press.x)),
    rows = press.x.map((x, i) => [x / run.height_mm, press.y[i]]).filter(([e], i) => e > 0 && i <= deepest);
  const e = rows.map(p => p[0]), measured = rows.map(p => p[1]), peak = Math.max(...measured),
    shown = list(first.polynomials).filter(p => p.degree <= 5);
  const every = Math.ceil(e.length / 60), thin = list => list.filter((_, i) => i % every === 0);
  return plot("static_polynomials", "Ramp without a dwell: polynomials F(e) of degree 2 to 5", [
    { x_label: "", y_label: "force (N)", series: [line("measured", 6, thin(e), thin(measured), "points"),
      ...shown.map((p, k) => line(`degree ${short(p.degree)}`, k, e, e.map(x => polynomial(p.coefficients_N, x))))] },
    { x_label: "strain e", y_label: "fit - measured (%)", series: shown.map((p, k) =>
      line(null, k, e, e.map((x, i) => 100 * (polynomial(p.coefficients_N, x) - measured[i]) / peak))) }],
        "As if the press were at rest; differences in % of the peak.");
}

function fits() {
  const of_one = r => tables(
    table("Residuals of the model", "recording|rms (mN)|rms over noise|largest (% of peak)|sum (N)", list(r.runs).map(x =>
      [base(x.file), padded(1e3 * x.rms_N, 4), padded(x.rms_noise, 3), fixed(x.largest_residual_percent, 2), padded(x.absolute_N, 5)])),
    table("Stiffness law: log odds of a spline of 31 knots over each, nats", "law|parameters|log odds|~", list(r.law_scores).map(l =>
      [l.kind, l.parameters, short(l.log_odds, 3), l.taken ? "taken" : ""])),
    table("Spread of the static presses", "strain|mean force (N)|sd (%)|lowest (N)|highest (N)", list(r.spread).map(s =>
      [fixed(s.strain, 3), padded(s.mean_N, 4), fixed(100 * s.sd_N / s.mean_N, 2), padded(s.low_N, 4), padded(s.high_N, 4)])),
    list(r.static).map(s => table(`Plain polynomials of ${base(s.file)}`,
      "degree of F(e)|norm of the residual (N)|~coefficients of e, e^2, ... (N)",
      list(s.polynomials).map(p => [p.degree, short(p.norm_N, 4), p.coefficients_N.map(c => short(c, 5)).join(", ")]))));
  const shown = figures(named("fit_linear", "fit_log", "fit_first", "fit_depth", "residuals", "fit_static"),
    results("characterize").map(static_polynomials));
  return [shown, ...results("characterize").map(of_one)];
}

const half_of = e => (e.high - e.low) / 2;

function estimates(caption, rows) {
  return table(caption, "parameter|value|95 % interval|~unit", list(rows).map(e => e.determined ?
    [e.name, digits(e.value, half_of(e)), `${digits(e.low, half_of(e))} to ${digits(e.high, half_of(e))}`, e.unit] :
    [e.name, "not identifiable", `${short(e.low, 1)} to ${short(e.high, 1)}`, e.unit]));
}

function correlated(r) {
  const names = column(list(r.estimates), "name"), pairs = list(r.correlation).flatMap((row, i) =>
    row.map((c, j) => j > i && Math.abs(c) > 0.95 && `${names[i]} and ${names[j]} (${fixed(c, 3)})`)).filter(Boolean);
  return pairs.length > 0 && about(`Correlated above 0.95, so that only their combination is known well: ${pairs.join(", ")}.`);
}

/* The hold of each depth alone: K_inf, and K and b of each arm. */
function per_depth(r) {
  const cell = (one, name) => {
    const e = list(one.estimates).find(e => e.name.split(" ")[0] === name);
    return !e ? "-" : e.determined ? `${digits(e.value, half_of(e))} ± ${digits(half_of(e), half_of(e))}` : "not identifiable";
  };
  const arms = [1, 2, 3, 4, 5].filter(j => list(r.per_depth).some(one => cell(one, `K_${j}`) !== "-"));
  return table("The hold of each depth alone", ["depth (mm)", "strain", "K_inf (N)", ...arms.flatMap(j => [`K_${j} (N)`, `b_${j} (N s)`]),
    "rms over noise"].join("|"),
    list(r.per_depth).map(one => [short(one.depth_mm, 4), fixed(one.strain, 4), cell(one, "K_inf"),
      ...arms.flatMap(j => [cell(one, `K_${j}`), cell(one, `b_${j}`)]),
      short(one.rms_noise)]));
}

function parameters() {
  /* the knots of a spline are in the figure of the law, with its band */
  const named = r => list(r.estimates).filter(e => r.law?.kind !== "spline" || !/^c\d/.test(e.name));
  return results("characterize").map(r => [tables(estimates("The model: one law, one set of arms", named(r)),
    estimates("Arms shared by all holds, K_inf of each", r.shared?.estimates),
      estimates("Moduli of the layer under the tip", r.moduli?.estimates)), correlated(r), per_depth(r)]);
}

/* ---- the stiffness law ---- */

function formula(law) {
  if (!law) return null;
  const c = list(law.coefficients_N);
  if (law.kind === "polynomial") {
    const powers = [[], [" e"]], term = (v, i) => [i ? (v < 0 ? " − " : " + ") : v < 0 ? "−" : "", short(Math.abs(v), 5),
      powers[i] ?? [" e", element("sup", String(i))]];
    return paragraph("K(e) = ", c.map(term), " N");
  }
  if (law.kind === "spline")
    return paragraph("A monotone cubic through (strain, N): ", list(law.strain).map((e, i) =>
      `(${short(e)}, ${short(list(law.stiffness_N)[i], 4)})`).join(" "));
  return paragraph(`${law.kind}: ${list(law.coefficients_Pa).map(v => short(v, 5)).join(", ")} Pa`);
}

const arms_table = (caption, arms) => table(caption, "arm|stiffness (N)|viscosity (N s)|time (s)|beta", list(arms).map((a, i) =>
  [i + 1, padded(a.stiffness_N, 4), padded(a.viscosity_Ns, 4), padded(a.viscosity_Ns / a.stiffness_N, 4),
    padded(a.beta ?? a.stiffness_per_strain ?? 0, 4)]));

function law_figure(r) {
  const band = list(r.band), points = list(r.comparison), e = column(band, "strain"),
    taken = list(r.law?.coefficients_N).length || 5;
  const plain = list(list(r.static)[0]?.polynomials).find(p => p.degree === taken);
  const series = [band.length && { style: "band", colour: 0, title: "95 % band", x: e, low: column(band, "stiffness_low_N"),
    high: column(band, "stiffness_high_N") },
    band.length && line(plain ? "joint law" : "law", 0, e, column(band, "stiffness_N")),
    band.length && plain && list(r.arms).length && line("static polynomial", 1, e.slice(1),
      e.slice(1).map(x => polynomial(plain.coefficients_N, x) / x), "dashed"),
    points.length && { style: "bars", colour: 6, title: "ramp and hold", x: column(points, "strain"), y: column(points, "ramp_hold_N"),
      low: column(points, "ramp_hold_low_N"),
      high: column(points, "ramp_hold_high_N") }].filter(Boolean);
  return series.length > 0 && plot("stiffness_law", "Stiffness law K(e), and K_inf of single depths with 95 % intervals",
    { x_label: "strain e", y_label: "stiffness K (N per unit strain)",
    series }, "F = K(e) e at rest. A static press that is not slow enough has the arms' force in it.");
}

function specimens(r) {
  const s = r.specimens, points = list(s?.stiffness), e = column(points, "strain"), forces = key => points.map(p => p[key] * p.strain);
  const row = p => [fixed(p.strain, 3), padded(p.stiffness_N, 4), `${padded(p.mean_low_N, 4)} to ${padded(p.mean_high_N, 4)}`,
    short(100 * p.between_sd_N / p.stiffness_N),
    short(100 * p.within_sd_N / p.stiffness_N), `${padded(p.specimen_low_N, 4)} to ${padded(p.specimen_high_N, 4)}`];
  const every = Math.floor(points.length / 5), band = (title, colour, which) =>
    ({ style: "band", colour, title, x: e, low: forces(which + "_low_N"), high: forces(which + "_high_N") });
  return s ? [points.length > 0 && plot("specimens", "Force at rest of the mean specimen, and of specimens not measured",
    { x_label: "strain e", y_label: "force (N)",
    series: [band("95 % of specimens", 1, "specimen"), band("95 % of the mean", 0, "mean"),
      line("mean specimen", 0, e, forces("stiffness_N"))] },
  "Where 95 % of the means lie that the data allow, and where 95 % of the specimens lie that were not measured."),
  element("div", table("Specimens, pooled in stress and strain", "specimen|height (mm)|radius (mm)|runs|stress by that of all",
    list(s.each).map(b =>
    [b.name, short(b.height_mm, 4), short(b.radius_mm, 4), b.runs, short(b.factor, 4)])),
  table("K_inf of the mean specimen; standard deviation between specimens and within one (what its runs leave open)",
    "strain|K_inf (N)|95 % of the mean (N)|between (%)|within (%)|95 % of specimens not measured (N)",
      points.filter((_, i) => i && i % every === 0).map(row)))] : [];
}

/* Storage and loss where runs oscillate: measured, of the model, and of the arms that the holds alone have. */
function spectrum_figure(r) {
  const points = list(r.spectrum), files = [...new Set(column(points, "file"))].slice(0, 6), first = points[0];
  if (!first) return null;
  const [low, high] = extent(column(points, "frequency_Hz")), f = Array.from({ length: 100 },
    (_, i) => low / 2 * (4 * high / low) ** (i / 99));
  const height = list(r.runs).find(x => x.file === first.file)?.height_mm;
  const of_arms = (arms, key, f) => list(arms).reduce((sum, a) => { /* N/m */
    const w = 2 * Math.PI * f * a.viscosity_Ns / a.stiffness_N;
    return sum + 1e3 * a.stiffness_N / height * (key === "storage" ? w * w : w) / (1 + w * w);
  }, 0);
  const panel = key => {
    const at = p => p[`model_${key}_N_m`] - of_arms(r.arms, key, p.frequency_Hz); /* what is not of the arms */
    const model = (title, arms, p, colour, style) => line(key === "storage" ? title : null, colour, f,
      f.map(v => at(p) + of_arms(arms, key, v)), style);
    return { x_label: key === "storage" ? "" : "frequency (Hz)", y_label: key === "storage" ? "storage K' (N/m)" : "loss K\" (N/m)",
      x_log: true,
      series: [...files.flatMap((file, k) => {
        const own = points.filter(p => p.file === file), column_of = what => column(own, `${key}${what}_N_m`);
        return [model(k ? null : "model", r.arms, own[0], k, "line"), { style: "bars", colour: k,
          title: key === "storage" ? base(file) : null, x: column(own, "frequency_Hz"),
          y: column_of(""), low: column_of("_low"), high: column_of("_high") }];
      }), ...(list(r.shared?.arms).length ? [model("arms of the holds alone", r.shared.arms, first, 6, "dashed")] : [])] };
  };
  return plot("spectrum", "Storage and loss stiffness", [panel("storage"), panel("loss")],
    "Measured with 95 % intervals, and the model's.");
}

function law() {
  const lumped = models.filter(m => m.model.kind === "lumped"), fitted = results("characterize");
  const heads = lumped.length ? lumped.map(m => [element("h3", base(m.file)), formula(m.model.stiffness), arms_table(null, m.model.arms)]) :
    fitted.map(r => [formula(r.law), arms_table(null, r.arms)]);
  const drawn = fitted.map(r => [law_figure(r), element("div", table("K_inf: ramp and hold, static press as if at rest, model",
    "strain|ramp and hold (N)|static polynomial (N)|model (N)", list(r.comparison).map(g =>
      [fixed(g.strain, 4), padded(g.ramp_hold_N, 4), padded(g.static_plain_N, 4), padded(g.joint_N, 4)]))),
  spectrum_figure(r), ...specimens(r)]);
  if (!fitted.length && lumped.length)
    drawn.push(plot("stiffness_law", "Stiffness law K(e)", { x_label: "strain e", y_label: "stiffness K (N per unit strain)",
      series: lumped.map((m, k) => line(base(m.file), k, m.strain, m.stiffness_N)) }, "F = K(e) e at rest."));
  return [...heads, figures(drawn.flat())];
}

/* ---- the network ---- */

function convergence(stage, name, title) {
  const rows = list(stage?.iterations), n = rows.map((_, i) => i + 1), phases = rows.some(i => "phase" in i),
    relative = rows.some(i => "relative_rms_percent" in i);
  const positive = key => rows.map(i => i[key] > 0 ? i[key] : null);
  return rows.length > 0 && plot(name, title, { x_label: phases ? "iteration" : "evaluation of the curve", y_log: true,
    y_label: phases ? "error (%)" : relative ? "rms error (% of the peak)" : "residual, 2-norm (N)",
    series: phases ? [["peak force", "peak"], ["steady time", "steady_time"], ["steady force", "steady_force"]].map(([what, key], k) =>
      line(what, k, n, positive(key + "_error_percent"), "line_points")) :
        [line(null, 0, n, positive(relative ? "relative_rms_percent" : "residual"), "line_points")] });
}

function network() {
  const about_model = m => [element("h3", base(m.file)), paragraph(m.model.mesh?.kind === "lattice" ?
    `A lattice of ${m.model.mesh.nodes.join(" × ")} nodes, ${m.model.mesh.size_mm.map(v => short(v, 4)).join(" × ")} mm. Element law:` :
    `The mesh of ${base(m.model.mesh?.path)}. Element law:`), formula(m.model.stiffness)];
  const found = results("calibrate"), given = models.filter(m => m.model.kind === "network");
  return [given.map(about_model), found.map(r => r.method && paragraph(`Method ${r.method}, `,
    r.converged === false ? element("b", "not converged") : "converged", ".")),
    tables(found.map(r => table("Network against its target, ramp and hold", "depth (mm)|peak (N)|largest error (% of the peak)",
      list(r.depths).map(d => [short(d.depth_mm, 4), padded(d.peak_N, 4), fixed(d.max_error_percent, 3)]))),
        (given.length ? given.map(m => m.model) : found).map(m => arms_table("Arms of an element", m.arms))),
    figures(named("static_fit", "stiffness", "relaxation_linear", "relaxation_log"), found.map(r => {
      const both = r.static && r.relaxation, relaxed = r.stage !== "static";
      return [convergence(both ? r.static : relaxed ? null : r, "static_convergence", "How the static stage converged"),
        convergence(both ? r.relaxation : relaxed ? r : null, "relaxation_convergence", "How the relaxation stage converged")];
    }).flat())];
}

/* ---- a batch ---- */

/* A file's name as an address in this folder. */
const address = name => "./" + encodeURIComponent(name);

function link(name, text) {
  const node = element("a", text);
  node.href = address(name);
  return node;
}

function batch_cards(jobs) {
  const count = test => jobs.filter(test).length, card = (name, text) => element("div.card", element("span", name), element("b", text));
  return element("div.cards", card("Jobs", jobs.length), card("Succeeded", count(j => j.status === 0)),
    card("Failed", count(j => j.status > 0)), card("Not done", count(j => j.status === null)),
    card("Their time together", `${short(jobs.reduce((sum, j) => sum + (j.seconds ?? 0), 0))} s`));
}

function batch() {
  const ROWS = 1000, COLUMNS = 40, jobs = list(R.jobs), failed = jobs.filter(j => j.status > 0), columns = list(R.columns).slice(0, COLUMNS);
  if (kind_of(R) !== "batch_result") return null;
  const value = v => typeof v === "number" ? short(v, 5) : v === null || v === undefined ? "-" : String(v);
  const text = columns.map(c => jobs.some(j => typeof j.values?.[c] === "string"));
  const files = j => element("span", link(j.name + ".out", "out"), " ", link(j.name + ".err", "err"));
  const cut = jobs.length > ROWS || list(R.columns).length > COLUMNS;
  return [batch_cards(jobs), table("Jobs that failed", "job|status|~last line of its messages|~files", failed.slice(0, ROWS).map(j =>
    [j.name, j.status, j.words, files(j)])),
  table("All jobs", ["job", "status", "time (s)", "~files", ...columns.map((c, i) => (text[i] ? "~" : "") + c.replaceAll("|", "/"))].join("|"),
    jobs.slice(0, ROWS).map(j => [j.name, j.status, short(j.seconds), files(j), ...columns.map(c => value(j.values?.[c]))])),
  about(cut && "This page leaves out some rows or columns. ", "The table is also in ", link("table.csv", "table.csv"), ".")];
}

/* ---- the report ---- */

function simulation() {
  return [table(null, "simulation|~of the model|~recording|peak (N)|rms error (mN)|largest error (% of the peak)", simulations.map(s =>
    [base(s.simulation), base(s.model), base(s.recording), padded(s.peak_N, 4), padded(1e3 * s.rms_N, 3),
      padded(s.largest_error_percent, 3)])),
  figures(named("simulated_linear", "simulated_log", "simulated_static"))];
}

function cards() {
  const add = (name, text) => text ? element("div.card", element("span", name), element("b", text)) : null;
  const body = recordings.find(r => r.height_mm > 0) ?? models[0]?.model.specimen ?? {},
    radius = Math.max(0, ...recordings.map(r => r.radius_mm ?? 0), body.radius_mm ?? 0);
  const used = recordings.filter(r => r.samples), ramps = used.filter(r => r.kind === "ramp").length,
    top = Math.max(...used.map(r => r.deepest_mm / r.height_mm));
  const fitted = results("characterize")[0], times = list(fitted?.arms).map(a => `${short(a.tau_s)} s`),
    [low, high] = extent(column(list(fitted?.runs), "rms_noise"));
  const lumped = models.find(m => m.model.kind === "lumped"), law = lumped ? lumped.stiffness_N : column(list(fitted?.band), "stiffness_N"),
    missing = results("explain")[0];
  const worst = rows => Math.max(0, ...rows.filter(known)), calibrated = worst(column(results("calibrate").flatMap(r => list(r.depths)),
    "max_error_percent"));
  const simulated = worst(column(simulations, "largest_error_percent"));
  return element("div.cards", add("Specimen", body.height_mm > 0 && `${short(body.height_mm, 4)} mm high${radius > 0 ? `, ${short(2 * radius, 4)} mm across` : ""}`),
    add("Recordings", recordings.length && `${recordings.length}${ramps ? `, ${ramps} of them static` : ""}`),
      add("Deepest", used.length && `${short(100 * top)} % strain`),
    add("Stiffness K at strain 0 and at the deepest", law.length && `${short(law[0])} N and ${short(law.at(-1))} N`),
    add(times.length === 1 ? "1 arm, relaxation time" : "Arms, relaxation times", fitted && (times.join(", ") || "none")),
    add("Residual, times the noise of a sample", high > 0 && (low < high ? `${short(low)} to ${short(high)}` : short(low))),
    add("Static against ramp and hold, before and after the joint fit",
      fitted && known(fitted.gap_before_percent) && known(fitted.gap_after_percent) &&
      [fitted.gap_before_percent, fitted.gap_after_percent].map(v => `${v < 0 ? "−" : "+"}${fixed(Math.abs(v), 2)} %`).join(" and ")),
    add("Missing in the lumped model", missing && (list(missing.effects).map(e => effect_name(missing, e.id)).join(", ") ||
      (missing.verdict === "unexplained" ? "something that no effect accounts for" : "nothing"))),
    add("Network against its target, largest error", calibrated > 0 && `${short(calibrated, 2)} % of the peak`),
    add("Simulation against recording, largest error", simulated > 0 && `${short(simulated, 2)} % of the peak`));
}

function warnings() {
  const said = list(page.results).flatMap(r => list(r.result.warnings));
  return said.length > 0 && element("div.warn", element("b", "Warnings"), element("ul", said.map(w => element("li", w))),
    paragraph("c0, c1, c2 are the coefficients of a polynomial stiffness law K(e) = c0 + c1 e + c2 e", element("sup", "2"),
      " of the strain e; K_1, b_1 and tau_1 the spring, " +
      "the dashpot and the relaxation time of the first arm; K_inf [1] the stiffness at the depth of the first hold."));
}

function provenance() {
  return [paragraph(`This page: palpate ${R.palpate?.version ?? ""}. It needs no network and no other file.`),
    list(page.results).map(r => r.result.command && paragraph(r.file ? base(r.file) + ": " : "", element("code", r.result.command))),
    table(null, "file|~what|size (bytes)|CRC-32|~modified (UTC)|~note",
      list(page.files).map(f => [base(f.file), f.kind, f.bytes, f.crc32, f.modified, f.note]))];
}

const sections = [["jobs", TITLES.batch_result, batch], ["measured", "What was measured", measured], ["curves", "Recorded curves", curves], ["fits", "Fits and residuals", fits],
  ["parameters", "Parameters", parameters], ["law", "Stiffness law and arms", law],
  ["explain", TITLES.explain, () => results("explain").map(explained)], ["calibration", "Network calibration", network],
  ["simulation", "Simulation against recordings", simulation], ["others", "Other figures",
    () => figures(known_figures.filter(f => !placed.has(f)).map(f => figure_of(f)))],
  ["provenance", "Provenance", provenance]];

function show() {
  const main = document.getElementById("page"), made = [], nav = element("nav");
  document.title = page.title;
  for (const [id, title, make] of sections) {
    const nodes = [make()].flat(Infinity).filter(n => n && !nothing(n));
    if (!nodes.length) continue;
    const heading = element("h2", title), link = element("a", title);
    heading.id = id;
    heading.hidden = title === page.title;
    link.href = "#" + id;
    nav.append(link);
    made.push(heading, ...nodes);
  }
  main.replaceChildren(...[element("h1", page.title), kind_of(R) === "report" &&
    about("From the press of an indenter to a tissue model that a simulator can run."),
    ...results("explain").map(verdict), !["explain", "batch_result"].includes(kind_of(R)) && cards(), nav.childNodes.length > 2 && nav, warnings(),
      ...made].filter(Boolean));
  draw_all();
  let timer = 0;
  addEventListener("resize", () => { clearTimeout(timer); timer = setTimeout(draw_all, 100); });
  document.addEventListener("toggle", draw_all, true);
}

show();
