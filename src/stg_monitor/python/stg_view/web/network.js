/* The network: a matrix of the links, a time line of the transmissions, and the receivers of one transmission. It
 * only needs packets, no vehicles. */
(function (STG) {
  "use strict";

  const ROW = 18, LEFT = 74;

  const element = (tag, className, text) => {
    const made = document.createElement(tag);
    if (className) made.className = className;
    if (text !== undefined) made.textContent = text;
    return made;
  };
  STG.element = element;

  /** Sets the size of a canvas so that it is sharp on every screen. Returns its context, in CSS pixels. */
  STG.sharp = (canvas, width, height) => {
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.height = `${height}px`;
    const ctx = canvas.getContext("2d");
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, width, height);
    return ctx;
  };

  class Network {
    constructor(app, root) {
      this.app = app;
      this.root = root;
      this.tip = document.body.appendChild(element("div", "tip"));
      this.tip.hidden = true;
      root.append(
        this.cards = element("div", "cards"),
        element("h2", "", "Transmissions over time"),
        this.lineHint = element("p", "hint"),
        this.line = element("canvas", "wide"),
        this.detail = element("div"),
        element("h2", "", "Links between the nodes"),
        element("p", "hint", "Rows are senders, columns are receivers. A cell is full if all packets of the link arrive."),
        this.matrix = element("canvas", "wide"),
        element("h2", "", "Fates of all packets"),
        this.fates = element("div"));
      this.line.addEventListener("click", (e) => this.choose(e));
      this.line.addEventListener("mousemove", (e) => this.hoverLine(e));
      this.matrix.addEventListener("mousemove", (e) => this.hoverMatrix(e));
      for (const canvas of [this.line, this.matrix]) canvas.addEventListener("mouseleave", () => { this.tip.hidden = true; });
    }

    get nodes() { return Math.max(this.app.recording.agents, 0); }

    draw() {
      const r = this.app.recording;
      if (this.drawnVersion !== r.version || this.theme !== this.app.colours.name) {
        this.drawnVersion = r.version;
        this.theme = this.app.colours.name;
        this.drawCards();
        this.drawFates();
        this.drawMatrix();
      }
      this.drawLine();
    }

    drawCards() {
      const { recording: r, transmissions } = this.app, counts = r.counts();
      const all = counts.reduce((a, b) => a + b, 0);
      const sent = r.totals && r.totals.transmissions !== undefined ? r.totals.transmissions : transmissions.list.filter((one) => one.left).length;
      this.cards.textContent = "";
      const card = (value, text) => {
        const made = element("div", "card");
        made.append(element("b", "", value), element("span", "", text));
        this.cards.append(made);
      };
      card(String(sent), "transmissions");
      card(String(all), "packets by receiver");
      card(String(counts[0]), "delivered");
      card(all > 0 ? `${(100 * (all - counts[0]) / all).toFixed(1)} %` : "–", "lost");
    }

    drawFates() {
      const counts = this.app.recording.counts(), all = counts.reduce((a, b) => a + b, 0);
      const table = element("table");
      table.id = "fates";
      table.append(row(["fate", "packets", "share"], "th"));
      counts.forEach((count, fate) => {
        if (count === 0 && fate > 0) return;
        const line = row([STG.FATES[fate], String(count), all > 0 ? `${(100 * count / all).toFixed(1)} %` : "–"]);
        line.dataset.fate = fate;
        const dot = element("i", "dot");
        dot.style.background = this.app.colours.fates[fate];
        line.firstChild.prepend(dot);
        table.append(line);
      });
      this.fates.textContent = "";
      this.fates.append(table);
    }

    drawMatrix() {
      const { recording: r, colours } = this.app, n = this.nodes;
      const width = Math.max(200, this.root.clientWidth - 24), cell = Math.min(34, (width - LEFT) / Math.max(1, n));
      const ctx = STG.sharp(this.matrix, width, 22 + cell * n);
      this.cell = cell;
      ctx.font = "11px system-ui, sans-serif";
      ctx.textBaseline = "middle";
      for (let i = 0; i < n; ++i) {
        ctx.fillStyle = colours.soft;
        if (cell > 9) ctx.fillText(r.name(i).slice(0, 11), 4, 22 + cell * (i + 0.5), LEFT - 8);
        ctx.textAlign = "center";
        if (cell > 15) ctx.fillText(String(i), LEFT + cell * (i + 0.5), 12);
        ctx.textAlign = "left";
        for (let j = 0; j < n; ++j) {
          const link = r.link(i, j), all = link ? link.reduce((a, b) => a + b, 0) : 0;
          const x = LEFT + cell * j, y = 22 + cell * i, gap = cell > 8 ? 1 : 0.3;
          ctx.fillStyle = colours.line;
          ctx.globalAlpha = i === j ? 0.25 : 0.7;
          ctx.fillRect(x, y, cell - gap, cell - gap);
          ctx.globalAlpha = 1;
          if (all === 0) continue;
          // The cell is filled from below, so that the share is a height and not only a colour.
          const share = link[0] / all;
          ctx.fillStyle = colours.heard;
          ctx.fillRect(x, y + (cell - gap) * (1 - share), cell - gap, (cell - gap) * share);
          ctx.fillStyle = colours.lost;
          ctx.globalAlpha = 0.8;
          ctx.fillRect(x, y, cell - gap, (cell - gap) * (1 - share));
          ctx.globalAlpha = 1;
        }
      }
    }

    window() {
      const { recording: r, t } = this.app, [start, end] = r.range();
      const packets = this.app.transmissions.list;
      const mean = packets.length > 1 ? (end - start) / packets.length : 1;
      const span = Math.min(end - start || 1, Math.max(mean * 60, 10 * (r.meta.decision_s || 0.1)));
      const from = Math.max(start, Math.min(t - span * 0.7, end - span));
      return [from, from + span];
    }

    drawLine() {
      const { recording: r, transmissions, colours, t } = this.app, n = this.nodes;
      const width = Math.max(200, this.root.clientWidth - 24), ctx = STG.sharp(this.line, width, ROW * n + 22);
      const [from, to] = this.window(), x = (time) => LEFT + (width - LEFT - 6) * (time - from) / (to - from);
      this.x = { from, to, width };
      this.lineHint.textContent = `${STG.clock(from - r.start)} to ${STG.clock(to - r.start)}. A bar is a transmission; its filled part is the share of receivers that heard it. ` +
        "Marks in other rows are receivers that missed it. Click a bar for details.";
      ctx.font = "11px system-ui, sans-serif";
      ctx.textBaseline = "middle";
      for (let i = 0; i < n; ++i) {
        ctx.fillStyle = colours.soft;
        ctx.fillText(r.name(i).slice(0, 11), 4, ROW * (i + 0.5), LEFT - 8);
        ctx.fillStyle = colours.line;
        ctx.fillRect(LEFT, ROW * (i + 1) - 1, width - LEFT, 1);
      }
      for (const one of transmissions.between(from - 10, to)) {
        if (one.end < from || !one.left) continue;
        const a = Math.max(LEFT, x(one.begin)), b = Math.max(a + 3, x(one.end)), share = one.heard / one.rows.length;
        const y = ROW * one.source + 3, h = ROW - 7;
        ctx.fillStyle = colours.lost;
        ctx.fillRect(a, y, b - a, h);
        ctx.fillStyle = colours.heard;
        ctx.fillRect(a, y + h * (1 - share), b - a, h * share);
        if (one === this.chosen) { ctx.strokeStyle = colours.accent; ctx.lineWidth = 2; ctx.strokeRect(a - 1, y - 1, b - a + 2, h + 2); }
        for (const packet of one.rows) {
          const fate = r.packets.at("fate", packet);
          if (fate === 0) continue;
          const at = x(r.packets.at("arrival", packet)), yy = ROW * (r.packets.at("receiver", packet) + 0.5);
          if (!(at > LEFT)) continue;
          ctx.fillStyle = colours.fates[fate];
          ctx.fillRect(at - 1, yy - 4, 2, 8);
        }
      }
      ctx.fillStyle = colours.accent;
      if (x(t) >= LEFT) ctx.fillRect(x(t) - 1, 0, 2, ROW * n);
      ctx.fillStyle = colours.soft;
      const ticks = Math.max(2, Math.floor((width - LEFT) / 90));
      for (let k = 0; k <= ticks; ++k) {
        const time = from + (to - from) * k / ticks;
        ctx.textAlign = k === ticks ? "right" : "left";
        ctx.fillText(`${STG.number(time - r.start)} s`, x(time), ROW * n + 12);
      }
      ctx.textAlign = "left";
    }

    hit(e) {
      const box = this.line.getBoundingClientRect(), { from, to, width } = this.x;
      const time = from + (e.clientX - box.left - LEFT) / (width - LEFT - 6) * (to - from);
      const source = Math.floor((e.clientY - box.top) / ROW), slack = (to - from) / width * 6;
      return this.app.transmissions.between(from - 10, to)
        .find((one) => one.source === source && one.begin - slack <= time && time <= one.end + slack);
    }

    choose(e) {
      this.chosen = this.hit(e);
      this.detail.textContent = "";
      if (this.chosen) {
        const r = this.app.recording, one = this.chosen;
        const box = element("div", "why");
        box.append(element("p", "", `${r.name(one.source)}, packet ${one.sequence}, ${one.bytes} bytes, sent at ${STG.clock(one.begin - r.start)}: heard by ${one.heard} of ${one.rows.length}.`));
        const table = element("table");
        table.append(row(["receiver", "fate", "distance", "SINR", "loss probability"], "th"));
        for (const packet of one.rows) {
          const at = (name) => r.packets.at(name, packet);
          table.append(row([r.name(at("receiver")), STG.FATES[at("fate")], STG.number(at("distance"), "m"),
            at("sinr") ? STG.number(at("sinr"), "dB") : "–", STG.number(at("probability"))]));
        }
        box.append(table);
        this.detail.append(box);
        this.app.seek(one.begin);
      } else {
        this.drawLine();
      }
    }

    hoverLine(e) {
      const one = this.hit(e), r = this.app.recording;
      this.show(e, one && `${r.name(one.source)}, packet ${one.sequence}: heard by ${one.heard} of ${one.rows.length}`);
    }

    hoverMatrix(e) {
      const box = this.matrix.getBoundingClientRect(), r = this.app.recording;
      const j = Math.floor((e.clientX - box.left - LEFT) / this.cell), i = Math.floor((e.clientY - box.top - 22) / this.cell);
      const link = i >= 0 && j >= 0 && i < this.nodes && j < this.nodes ? r.link(i, j) : null;
      this.show(e, link && `${r.name(i)} → ${r.name(j)}\n` + link.map((count, fate) => [count, fate]).filter(([count]) => count > 0)
        .map(([count, fate]) => `${count} ${STG.FATES[fate]}`).join("\n"));
    }

    show(e, text) {
      this.tip.hidden = !text;
      if (!text) return;
      this.tip.textContent = text;
      this.tip.style.left = `${Math.min(e.clientX + 14, window.innerWidth - 220)}px`;
      this.tip.style.top = `${e.clientY + 12}px`;
    }
  }

  function row(cells, tag = "td") {
    const line = element("tr");
    line.append(...cells.map((text) => element(tag, "", text)));
    return line;
  }
  STG.tableRow = row;
  STG.Network = Network;
})(window.STG = window.STG || {});
