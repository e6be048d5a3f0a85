"use strict";
(() => {
  const drawings = JSON.parse(document.getElementById("drawings").textContent);
  const plots = drawings.map((each) => ({ ...each, node: document.getElementById(each.name) }));
  const overTime = plots.filter((each) => each.over_time);
  const whole = overTime.length ? overTime[0].layout.xaxis.range.slice() : [0, 1];
  const { typical, end } = JSON.parse(document.getElementById("times").textContent);
  const config = { responsive: true, displayModeBar: false, displaylogo: false, doubleClick: false };
  let range = whole.slice();
  let moving = false;

  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

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
          [key + ".gridcolor"]: grid, [key + ".linecolor"]: grid, [key + ".zerolinecolor"]: grid,
          [key + ".tickcolor"]: grid, [key + ".spikecolor"]: colour("--soft"),
        });
      }
    }
    if (layout.polar) {
      patch["polar.angularaxis.gridcolor"] = grid;
      patch["polar.angularaxis.linecolor"] = grid;
    }
    return patch;
  }

  // One time for all figures over time.
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
      `${Math.max(range[0], 0).toFixed(2)} to ${Math.min(range[1], end).toFixed(2)} s`;
  }
  const zoom = (factor) => {
    const middle = (range[0] + range[1]) / 2, half = (range[1] - range[0]) / 2 * factor;
    show(factor > 1 && 2 * half >= whole[1] - whole[0] ? whole : [middle - half, middle + half]);
  };
  const move = (share) => {
    const step = (range[1] - range[0]) * share;
    show([range[0] + step, range[1] + step]);
  };
  const actions = {
    whole: () => show(whole), typical: () => show(typical), closer: () => zoom(0.5), wider: () => zoom(2),
    earlier: () => move(-0.25), later: () => move(0.25),
  };
  const keys = { "0": "whole", "t": "typical", "+": "closer", "=": "closer", "-": "wider", "ArrowLeft": "earlier", "ArrowRight": "later" };

  function listen(plot) {
    plot.node.on("plotly_relayout", (change) => {
      if (moving) return;
      const next = change["xaxis.range"] || [change["xaxis.range[0]"], change["xaxis.range[1]"]];
      if (next[0] !== undefined) show(next.map(Number), plot.node);
    });
    plot.node.on("plotly_doubleclick", () => { show(whole); });
    plot.node.addEventListener("keydown", (event) => {
      const action = keys[event.key];
      if (action && !event.ctrlKey && !event.metaKey && !event.altKey) { event.preventDefault(); actions[action](); }
    });
  }

  async function draw() {
    for (const plot of plots) {
      await Plotly.newPlot(plot.node, plot.data, plot.layout, config);
      await Plotly.relayout(plot.node, theme(plot.layout));
      if (plot.over_time) listen(plot);
    }
    for (const button of document.querySelectorAll("button[data-do]")) {
      button.addEventListener("click", () => actions[button.dataset.do]());
    }
    for (const button of document.querySelectorAll("button[data-from]")) {
      const from = Number(button.dataset.from), to = Number(button.dataset.to);
      button.addEventListener("click", () => {
        const beside = (typical[1] - typical[0]) / 2;
        show([from - beside, to + beside]);
        if (overTime.length) overTime[0].node.scrollIntoView({ block: "center" });
      });
    }
    await show(range);
    const again = () => plots.forEach((plot) => Plotly.relayout(plot.node, theme(plot.layout)));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);
    const paper = matchMedia("print");
    paper.addEventListener("change", () => { again(); plots.forEach((plot) => Plotly.Plots.resize(plot.node)); });
    document.documentElement.dataset.drawn = "yes";
  }
  draw();
})();
