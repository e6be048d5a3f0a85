// The figures: one time for all that are over time, and the cursor in each.

const drawings = read("drawings");
for (const drawing of drawings) {
  for (const trace of drawing.data) {
    unpackAll(trace);
    if (trace.meta?.weight) trace.customdata = Float32Array.from(trace.y, (force) => force / trace.meta.weight);
  }
}
const plots = drawings.map((each) => ({ ...each, height: each.layout.height, node: document.getElementById(each.name) }));
const overTime = plots.filter((each) => each.over_time);
const times = read("times");
const whole = overTime.length ? overTime[0].layout.xaxis.range.slice() : [0, 1];
const config = { responsive: true, displayModeBar: false, displaylogo: false, doubleClick: false };
const PAPER = { width: 660, height: 900 };
let range = whole.slice();
let moving = false;

// Colours that follow the reader's light or dark.
function theme(layout) {
  const ink = colour("--ink"), grid = colour("--grid"), panel = colour("--panel");
  const patch = {
    "paper_bgcolor": "rgba(0,0,0,0)", "plot_bgcolor": "rgba(0,0,0,0)", "font.color": ink,
    "hoverlabel.bgcolor": panel, "hoverlabel.font.color": ink, "hoverlabel.bordercolor": colour("--line"),
  };
  for (const key of Object.keys(layout)) {
    if (/^[xy]axis\d*$/.test(key)) {
      Object.assign(patch, {
        [key + ".gridcolor"]: grid, [key + ".linecolor"]: grid, [key + ".zerolinecolor"]: colour("--soft"),
        [key + ".tickcolor"]: grid, [key + ".spikecolor"]: colour("--soft"),
      });
    }
  }
  return patch;
}

async function show(next, from) {
  const least = 1e-3;
  const middle = (next[0] + next[1]) / 2, half = Math.max((next[1] - next[0]) / 2, least / 2);
  range = [middle - half, middle + half];
  moving = true;
  try {
    await Promise.all(overTime.filter((each) => each.node !== from).map(
      (each) => Plotly.relayout(each.node, { "xaxis.range": range.slice() })));
  } finally {
    moving = false;
  }
  document.getElementById("shown").textContent =
    `${Math.max(range[0], 0).toFixed(2)} to ${Math.min(range[1], times.end).toFixed(2)} s`;
  placeCursors();
}
const zoom = (factor) => {
  const middle = (range[0] + range[1]) / 2, half = (range[1] - range[0]) / 2 * factor;
  show(factor > 1 && 2 * half >= whole[1] - whole[0] ? whole : [middle - half, middle + half]);
};
const move = (share) => {
  const step = (range[1] - range[0]) * share;
  show([range[0] + step, range[1] + step]);
};
// Show a span with some time beside it, and put the cursor where it begins.
function showSpan(from, to) {
  const beside = (times.typical[1] - times.typical[0]) / 2;
  cursor.set(from, "event");
  return show([from - beside, to + beside]);
}
const actions = {
  whole: () => show(whole), typical: () => show(times.typical), closer: () => zoom(0.5), wider: () => zoom(2),
  earlier: () => move(-0.25), later: () => move(0.25),
};
const keys = { "0": "whole", "t": "typical", "+": "closer", "=": "closer", "-": "wider", "ArrowLeft": "earlier", "ArrowRight": "later" };

// Lay a mark over a figure; it hides where its place is not known or not shown.
function overlay(node, kind, shade) {
  const mark = document.createElement("div");
  mark.className = `mark ${kind}`;
  if (shade) mark.style.background = shade;
  node.append(mark);
  return (x, y, height) => {
    mark.hidden = x === null;
    if (x === null) return;
    mark.style.transform = `translate(${x}px, ${y}px)`;
    if (height !== undefined) mark.style.height = `${height}px`;
  };
}
const pixel = (axis, value) => {
  const at = axis.d2p(value);
  return at >= -0.5 && at <= axis._length + 0.5 ? axis._offset + at : null;
};
const strides = times.strides.map(unpackAll);
// Share of a foot's stride that has passed at a time; null outside strides.
function phaseAt(foot, time) {
  const rows = strides[foot];
  if (!rows) return null;
  let low = 0, high = rows.length;
  while (low < high) { const middle = (low + high) >> 1; if (rows[middle][0] <= time) low = middle + 1; else high = middle; }
  const row = rows[low - 1];
  return row && time < row[1] ? (time - row[0]) / (row[1] - row[0]) : null;
}

const marks = [];
function placeCursors() {
  for (const place of marks) place(cursor.time);
}
function addCursors() {
  for (const { node } of overTime) {
    const put = overlay(node, "line");
    marks.push((time) => {
      const full = node._fullLayout, x = time === null ? null : pixel(full.xaxis, time);
      put(x, full._size.t, full._size.h);
    });
  }
  const named = (name) => plots.find((each) => each.name === name);
  const ground = named("ground"), base = ground?.data.find((trace) => trace.name === "base");
  if (base) {
    const put = overlay(ground.node, "dot");
    const known = Array.from(base.customdata, (time, row) => row).filter((row) => !Number.isNaN(base.customdata[row]));
    const time = known.map((row) => base.customdata[row]);
    marks.push((now) => {
      const row = now === null ? -1 : known[Math.max(lastUpTo(time, now), 0)];
      const { xaxis, yaxis } = ground.node._fullLayout;
      const x = row < 0 ? null : pixel(xaxis, base.x[row]), y = row < 0 ? null : pixel(yaxis, base.y[row]);
      put(y === null ? null : x, y);
    });
  }
  const cycle = named("cycle");
  for (const trace of cycle?.data ?? []) {
    const foot = trace.meta?.foot;
    if (foot === undefined) continue;
    const put = overlay(cycle.node, "dot", trace.line.color);
    marks.push((now) => {
      const phase = now === null ? null : phaseAt(foot, now);
      if (phase === null) { put(null); return; }
      const full = cycle.node._fullLayout, at = Math.round(phase * (trace.x.length - 1));
      const axis = (name) => full[`${name[0]}axis${name.slice(1)}`];
      put(pixel(axis(trace.xaxis), trace.x[at]), pixel(axis(trace.yaxis), trace.y[at]));
    });
  }
  cursor.listeners.push((time) => {
    placeCursors();
    document.getElementById("cursor").textContent = time === null ? "" : `at ${time.toFixed(3)} s`;
  });
}

function listen(plot) {
  plot.node.on("plotly_relayout", (change) => {
    if (moving) return;
    const next = change["xaxis.range"] || [change["xaxis.range[0]"], change["xaxis.range[1]"]];
    if (next[0] !== undefined) show(next.map(Number), plot.node);
  });
  plot.node.on("plotly_doubleclick", () => { show(whole); });
  const timeAt = (event) => {
    const axis = plot.node._fullLayout.xaxis;
    const across = event.clientX - plot.node.getBoundingClientRect().left - axis._offset;
    return across >= 0 && across <= axis._length ? Math.min(Math.max(axis.p2d(across), 0), times.end) : null;
  };
  plot.node.addEventListener("mousemove", (event) => {
    const time = timeAt(event);
    if (time !== null) cursor.set(time, "hover");
  });
  plot.node.addEventListener("click", (event) => {
    const time = timeAt(event);
    if (time !== null) cursor.set(time, "click");
  });
  plot.node.addEventListener("keydown", (event) => {
    const action = keys[event.key];
    if (action && !event.ctrlKey && !event.metaKey && !event.altKey) { event.preventDefault(); actions[action](); }
  });
}

const patched = (plot, more) => Plotly.relayout(plot.node, { ...theme(plot.layout), ...more });
function everywhere(more = () => ({})) {
  for (const redraw of onColours) redraw();
  return Promise.all(plots.map((plot) => patched(plot, more(plot))));
}

// On paper every figure is as wide as the paper, whatever the width of the window, no higher, and light.
function listenToPrinter() {
  let onPaper = false;
  const toPaper = () => {
    if (onPaper) return;
    onPaper = true;
    document.documentElement.classList.add("paper");
    for (const each of document.querySelectorAll("details")) each.open = true;
    for (const plot of plots) plot.node.style.maxHeight = `${PAPER.height}px`;
    everywhere((plot) => ({ width: PAPER.width, height: Math.min(plot.height, PAPER.height), autosize: false }));
    placeCursors();
  };
  const toScreen = () => {
    onPaper = false;
    document.documentElement.classList.remove("paper");
    for (const plot of plots) plot.node.style.maxHeight = "";
    everywhere((plot) => ({ width: null, height: plot.height, autosize: true })).then(placeCursors);
  };
  addEventListener("beforeprint", toPaper);
  addEventListener("afterprint", toScreen);
  matchMedia("print").addEventListener("change", (event) => (event.matches ? toPaper() : toScreen()));
}

async function drawFigures() {
  for (const plot of plots) {
    await Plotly.newPlot(plot.node, plot.data, plot.layout, config);
    await patched(plot);
    if (plot.over_time) listen(plot);
    plot.node.on("plotly_afterplot", placeCursors);
  }
  for (const button of document.querySelectorAll("button[data-do]")) {
    button.addEventListener("click", () => actions[button.dataset.do]());
  }
  for (const button of document.querySelectorAll("button[data-from]")) {
    button.addEventListener("click", () => {
      showSpan(Number(button.dataset.from), Number(button.dataset.to));
      (document.getElementById("replay") ?? overTime[0]?.node)?.scrollIntoView({ block: "center" });
    });
  }
  addCursors();
  await show(range);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => everywhere());
  listenToPrinter();
}
