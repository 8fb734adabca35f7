/* Plots with a common time cursor (uPlot). Every plot is a list of lines over the shown steps. The line of the
 * chosen AUV is thick, the others are thin. A click sets the time. */
(function (STG) {
  "use strict";

  const MOST_POINTS = 1500, HEIGHT = 150, LEAST_LOG = 0.01, MANY = 9, LEAST_WIDTH = 400, GAP = 20;

  /** Returns the rows of the plotted steps: all of them, or every n-th one. */
  function plottedRows(recording) {
    const count = recording.steps.count, stride = Math.max(1, Math.ceil(count / MOST_POINTS));
    const rows = [];
    for (let row = 0; row < count; row += stride) rows.push(row);
    if (count > 0 && rows[rows.length - 1] !== count - 1) rows.push(count - 1);
    return rows;
  }
  const orNull = (x) => (Number.isFinite(x) ? x : null);

  /** Returns all plots for which the recording has numbers. */
  function plotsOf(app) {
    const { recording: r, selected } = app, rows = plottedRows(r), plots = [];
    const t = rows.map((row) => r.steps.at("t", row));
    const perAuv = (value) => [...Array(r.agents)].map((_, i) => ({
      label: r.name(i), auv: i, values: rows.map((row) => orNull(value(row, i))),
    }));
    const add = (title, unit, lines, more = {}) => {
      if (rows.length > 1 && lines.some((l) => l.values.some((v) => v !== null && v !== 0))) plots.push({ title, unit, t, lines, ...more });
    };
    const steps = r.steps;
    if (r.targets > 0) {
      add("Distance to the target", "m", perAuv((row, i) => steps.at("distance", row, i)), { band: r.meta.band_m });
      if (steps.has("estimate")) {
        const lines = perAuv((row, i) => r.estimateError(row, i)[0]);
        if (selected >= 0 && steps.has("covariance")) {
          lines.push({ label: "stated deviation", dashed: true, values: rows.map((row) => orNull(r.estimateStd(row, selected))) });
        }
        add("Error of the estimate of the target", "m", lines);
        if (steps.has("covariance")) {
          add("NEES of the estimate (consistent: 3)", "", perAuv((row, i) => r.estimateError(row, i)[1]), { log: true, level: 3 });
        }
      }
    }
    if (steps.has("age")) add("Age of the newest observation in the estimate", "s", perAuv((row, i) => steps.at("age", row, i)));
    if (steps.has("neighbour_age")) add("Age of information about other AUVs", "s", perAuv((row, i) => steps.at("neighbour_age", row, i)));
    const fates = packetsOverTime(app, t);
    if (fates) plots.push(fates);
    if (steps.has("energy")) add("Energy of the modem", "J", perAuv((row, i) => steps.at("energy", row, i)));
    if (steps.has("terms") && r.terms.length > 0) {
      const width = r.terms.length;
      add(selected >= 0 ? `Reward terms of ${r.name(selected)}` : "Reward terms, mean of the AUVs", "", r.terms.map((label, k) => ({
        label, values: rows.map((row) => {
          if (selected >= 0) return orNull(steps.at("terms", row, selected * width + k));
          let sum = 0;
          for (let i = 0; i < r.agents; ++i) sum += steps.at("terms", row, i * width + k);
          return orNull(sum / r.agents);
        }),
      })), { own: true });
    }
    for (const c of r.curves) plots.push(curvePlot(c));
    return plots;
  }

  /** Returns the plot of packets by fate and time; the fates are stacked. */
  function packetsOverTime(app, t) {
    const { recording: r, selected } = app;
    if (r.packets.count === 0) return null;
    const [start, end] = r.range(), bins = 80, width = (end - start) / bins || 1;
    const rows = STG.FATES.map(() => new Array(bins + 1).fill(0));
    for (let row = 0; row < r.packets.count; ++row) {
      if (selected >= 0 && r.packets.at("receiver", row) !== selected) continue;
      const when = r.packets.at("transmit", row);
      const bin = Math.floor(((Number.isFinite(when) ? when : r.packets.at("offered", row)) - start) / width);
      if (bin >= 0 && bin <= bins) ++rows[r.packets.at("fate", row)][bin];
    }
    const used = STG.FATES.map((_, k) => k).filter((k) => rows[k].some((n) => n > 0));
    return {
      title: selected >= 0 ? `Packets to ${r.name(selected)} by fate` : "Packets by fate", unit: "", own: true, steps: true,
      t: [...Array(bins + 1)].map((_, k) => start + k * width),
      lines: used.map((k) => ({ label: STG.FATES[k], values: rows[k], colour: app.colours.fates[k] })),
    };
  }

  function curvePlot(c) {
    const x = c.data.find((one) => one.name === c.x);
    return {
      title: c.title, unit: c.unit || "", own: true, free: true, xLabel: c.x, t: Array.from(x.data),
      lines: c.data.filter((one) => one !== x).map((one) => ({ label: one.name, values: Array.from(one.data, orNull) })),
    };
  }

  /** Returns the range of an axis. If a line is almost level, the range is wider, so that ticks have different numbers. */
  function rangeOf(u, low, high) {
    if (low === null || (low === 0 && high === 0)) return [0, 1];
    const least = 1e-3 * Math.max(Math.abs(low), Math.abs(high)), lack = Math.max(0, least - (high - low)) / 2;
    return uPlot.rangeNum(low - lack, high + lack, 0.1, true);
  }

  /** Returns ticks for a time that is counted from a start. The start need not be a round number. */
  function ticksFrom(start, low, high, every) {
    const ticks = [];
    for (let k = Math.ceil((low - start) / every - 1e-6); start + k * every <= high + 1e-6 * every; ++k) ticks.push(start + k * every);
    return ticks;
  }

  class Plots {
    constructor(app, element) {
      this.app = app;
      this.element = element;
      this.charts = [];
    }

    /** Makes all plots again, after a change of recording, chosen AUV, theme or width. */
    build() {
      this.charts.forEach((c) => c.destroy());
      this.element.textContent = "";
      this.charts = [];
      const plots = plotsOf(this.app);
      if (plots.some((plot) => plot.lines.some((l) => l.auv !== undefined))) this.element.append(this.who());
      // A page without a scene has room for several plots in a row.
      const all = this.element.clientWidth - 24, beside = this.app.hasScene ? 1 : Math.max(1, Math.floor(all / LEAST_WIDTH));
      const width = Math.max(240, (all - GAP * (beside - 1)) / beside);
      for (const plot of plots) {
        const box = document.createElement("div");
        box.className = "plot";
        const heading = document.createElement("h2");
        const value = document.createElement("span");
        heading.append(plot.title + (plot.unit ? ` [${plot.unit}]` : ""), value);
        box.append(heading);
        if (plot.own && plot.lines.length > 1) box.append(this.keysOf(plot));
        this.element.append(box);
        const chart = this.chart(plot, width, box);
        chart.plotOf = plot;
        chart.readout = value;
        this.charts.push(chart);
      }
      if (plots.length === 0) {
        const hint = document.createElement("p");
        hint.className = "hint";
        hint.textContent = "This recording has nothing to plot yet.";
        this.element.append(hint);
      }
      this.builtAt = this.app.recording.version;
      this.now();
    }

    /** Returns the legend with the colours of the AUVs. If there are many AUVs, only the chosen one has a colour. */
    who() {
      const { recording: r, colours, selected } = this.app, line = STG.element("div", "who");
      for (let i = 0; i < r.agents; ++i) {
        const button = STG.element("button", i === selected ? "on" : ""), mark = STG.element("i");
        mark.style.background = r.agents > MANY && i !== selected ? colours.soft : colours.lines[i % colours.lines.length];
        button.append(mark, r.agents > MANY ? r.name(i).replace(/^auv_/, "") : r.name(i));
        button.onclick = () => this.app.select(i === this.app.selected ? -1 : i);
        line.append(button);
      }
      return line;
    }

    /** Returns the legend of a plot that has no lines of AUVs. */
    keysOf(plot) {
      const { colours } = this.app, line = STG.element("div", "keys-of");
      plot.lines.forEach((l, k) => {
        const key = STG.element("span", "keyed"), mark = STG.element("i");
        mark.style.background = l.colour || colours.lines[k % colours.lines.length];
        key.append(mark, l.key = document.createTextNode(l.label));
        line.append(key);
      });
      return line;
    }

    chart(plot, width, box) {
      const { colours, selected, recording: r } = this.app;
      const many = r.agents > MANY && !plot.own;
      const axis = { stroke: colours.soft, grid: { stroke: colours.line, width: 1 }, ticks: { stroke: colours.line, width: 1, size: 4 }, font: "11px system-ui, sans-serif" };
      const series = plot.lines.map((l, k) => {
        const chosen = l.auv === selected || l.auv === undefined;
        const base = l.colour || (many && !(chosen && l.auv !== undefined) ? colours.soft : colours.lines[(l.auv === undefined ? k : l.auv) % colours.lines.length]);
        return {
          label: l.label, stroke: base, width: chosen && selected >= 0 && l.auv !== undefined ? 2.2 : 1.2,
          alpha: selected >= 0 && !chosen ? 0.28 : many ? 0.55 : 1, points: { show: false }, spanGaps: Boolean(plot.free),
          dash: l.dashed ? [4, 3] : k >= 8 && plot.own ? [6, 3] : undefined,
          paths: plot.steps ? uPlot.paths.stepped({ align: 1 }) : undefined,
        };
      });
      const options = {
        width, height: HEIGHT, padding: [6, plot.free ? 26 : 14, 0, 0], legend: { show: false },
        scales: { x: { time: false }, y: plot.log ? { distr: 3 } : { range: rangeOf } },
        cursor: { sync: plot.free ? undefined : { key: "stg" }, drag: { x: true, y: false }, points: { show: false } },
        axes: [{ ...axis, size: 26, splits: plot.free ? undefined : (u, k, low, high, every) => ticksFrom(r.start, low, high, every), values: plot.free ? undefined : (u, ticks) => ticks.map((x) => STG.number(x - r.start)) },
          { ...axis, size: 56, values: (u, ticks) => ticks.map((x) => (x === null ? "" : x === 0 ? "0" : STG.number(x))) }],
        series: [{}, ...series],
        hooks: {
          drawClear: [(u) => this.background(u, plot)],
          setScale: [(u) => this.playhead(u)],
          setCursor: [(u) => this.read(u, plot)],
        },
      };
      const data = [plot.t, ...plot.lines.map((l) => (plot.log ? l.values.map((v) => (v > 0 ? Math.max(v, LEAST_LOG) : null)) : l.values))];
      const chart = new uPlot(options, data, box);
      if (!plot.free) {
        chart.head = chart.over.appendChild(document.createElement("div"));
        chart.head.className = "playhead";
      }
      chart.over.addEventListener("click", () => {
        if (!plot.free && chart.cursor.left >= 0) this.app.seek(chart.posToVal(chart.cursor.left, "x"));
      });
      return chart;
    }

    background(u, plot) {
      const { left, width } = u.bbox, ctx = u.ctx;
      if (plot.band && plot.band[1] > 0) {
        const a = u.valToPos(plot.band[1], "y", true), b = u.valToPos(plot.band[0], "y", true);
        ctx.fillStyle = this.app.colours.bandFill;
        ctx.fillRect(left, a, width, Math.max(1.5, b - a));
      }
      if (plot.level) {
        ctx.fillStyle = this.app.colours.stable;
        ctx.fillRect(left, u.valToPos(plot.level, "y", true), width, 1.5);
      }
    }

    /** Places the line of the shown time. It lies over the chart, so the chart need not be drawn again. */
    playhead(u) {
      if (!u.head) return;
      const x = u.valToPos(this.app.t, "x");
      u.head.hidden = !(x >= 0 && x <= u.bbox.width / devicePixelRatio);  // reading the size of the element would force a layout
      if (!u.head.hidden) u.head.style.transform = `translateX(${x.toFixed(1)}px)`;
    }

    /** Shows the values at the cursor, or at the shown time. */
    read(u, plot) {
      if (!u.readout) return;
      let at = u.cursor.idx;
      if (at === null || at === undefined) {
        at = plot.free ? -1 : Math.max(0, STG.lastUpTo(plot.t, plot.t.length, this.app.t));
      }
      if (plot.own && plot.lines.length > 1) {
        for (const l of plot.lines) {
          const v = l.values[at], text = v === null || v === undefined ? l.label : `${l.label} ${STG.number(v)}`;
          if (l.key.data !== text) l.key.data = text;
        }
        return;
      }
      const values = plot.lines.map((l) => [l, l.values[at]]).filter(([, v]) => v !== null && v !== undefined);
      const { selected } = this.app;
      const shown = values.filter(([l]) => selected < 0 || l.auv === selected || l.auv === undefined);
      if (plot.own) { u.readout.textContent = values.map(([, v]) => STG.number(v)).join(""); return; }
      u.readout.textContent = shown.length > 2
        ? `${STG.number(Math.min(...shown.map(([, v]) => v)))} … ${STG.number(Math.max(...shown.map(([, v]) => v)))}`
        : shown.map(([l, v]) => `${l.label} ${STG.number(v)}`).join("   ");
    }

    /** Moves the line of the shown time in all plots. */
    now() {
      this.charts.forEach((c) => {
        this.playhead(c);
        this.read(c, c.plotOf);
      });
    }
  }

  STG.Plots = Plots;
})(window.STG = window.STG || {});
