/* The list of events with their reasons, the table of the AUVs, and the metrics of finished episodes. */
(function (STG) {
  "use strict";

  const { element, tableRow } = STG;
  const MOST_EVENTS = 400;
  const KINDS = {
    lost: ["✕", "Losses", "lost"], found: ["✓", "Found again", "stable"], detection: ["◎", "Detections", "search"],
    contact: ["●", "Contacts", "approach"], collision: ["≋", "Packet collisions", "approach"],
    grounding: ["▽", "Groundings", "lost"], join: ["+", "Joins", "stable"], leave: ["−", "Leaves", "lost"],
    late: ["!", "Late decisions", "approach"], episode: ["▸", "Episodes", "soft"],
    choice: ["→", "Choices of a target", "target"],
  };
  STG.KINDS = KINDS;

  /** The list of events. An open event shows its reasons. */
  class Events {
    constructor(app, root) {
      this.app = app;
      this.root = root;
      this.hidden = new Set(["collision", "choice"]);
      root.append(this.cards = element("div", "cards"), this.filters = element("div", "filters"), this.list = element("div"));
    }

    shown() { return this.app.story.events.filter((e) => !this.hidden.has(e.kind)); }

    drawCards() {
      const { recording: r, story } = this.app;
      this.cards.textContent = "";
      const card = (value, text) => {
        const made = element("div", "card");
        made.append(element("b", "", value), element("span", "", text));
        this.cards.append(made);
      };
      const losses = story.events.filter((e) => e.kind === "lost");
      card(STG.clock(r.end - r.start), "duration");
      if (r.agents > 0) card(String(r.agents), r.steps.count > 0 && r.targets > 0 ? "AUVs" : "nodes");
      if (r.targets > 0) card(String(losses.length), "losses of the target");
      const counts = r.counts(), all = counts.reduce((a, b) => a + b, 0);
      if (all > 0) card(`${(100 * counts[0] / all).toFixed(1)} %`, "packets delivered");
    }

    build() {
      const { story, transmissions } = this.app;
      this.drawCards();
      this.filters.textContent = "";
      for (const [kind, [mark, text]] of Object.entries(KINDS)) {
        const count = story.events.filter((e) => e.kind === kind).length;
        if (count === 0) continue;
        const button = element("button", this.hidden.has(kind) ? "" : "on", `${mark} ${text} ${count}`);
        button.addEventListener("click", () => {
          if (!this.hidden.delete(kind)) this.hidden.add(kind);
          this.build();
          this.app.track.draw();
        });
        this.filters.append(button);
      }
      this.list.textContent = "";
      const events = this.shown();
      this.rows = events.slice(0, MOST_EVENTS).map((event) => this.row(event));
      this.list.append(...this.rows);
      if (events.length > MOST_EVENTS) this.list.append(element("p", "hint", `… and ${events.length - MOST_EVENTS} more.`));
      if (events.length === 0) this.list.append(element("p", "hint", transmissions.list.length > 0 ? "No events; the tab Network shows the packets." : "No events."));
    }

    row(event) {
      const button = element("button", "event");
      const mark = element("span", "", KINDS[event.kind][0]);
      mark.style.color = this.app.colours[KINDS[event.kind][2]];
      button.append(element("time", "", STG.clock(event.t - this.app.recording.start)), mark, element("span", "", event.title));
      button.addEventListener("click", () => this.open(event, button));
      button.event = event;
      return button;
    }

    open(event, button) {
      this.root.querySelectorAll(".why").forEach((old) => old.remove());
      this.root.querySelectorAll(".event.now").forEach((old) => old.classList.remove("now"));
      this.app.select(event.auv, false);
      this.app.seek(event.t);
      if (!button) button = (this.rows || []).find((b) => b.event === event);
      if (!button) return;
      button.classList.add("now");
      button.scrollIntoView({ block: "nearest" });
      if (event.kind !== "lost" && event.kind !== "found") return;
      const { lines, missing } = this.app.story.explain(event), r = this.app.recording;
      const why = element("div", "why");
      lines.forEach((text) => why.append(element("p", "", text)));
      if (missing.length > 0) {
        const table = element("table");
        table.append(tableRow(["missing packet", "sent at", "why"], "th"));
        missing.slice(-12).forEach((p) => table.append(tableRow([`${r.name(p.source)} #${p.sequence}`, STG.clock(p.t - r.start), STG.FATES[p.fate]])));
        why.append(table);
      }
      button.after(why);
    }
  }

  /** The state of every AUV at the shown time, and the metrics of the episodes. */
  class Live {
    constructor(app, root) {
      this.app = app;
      this.root = root;
      this.heard = [];
      root.append(this.now = element("div", "scroll"), this.metrics = element("div", "scroll"));
    }

    draw() {
      const { recording: r, t, colours, selected } = this.app, row = r.row(t), steps = r.steps;
      const columns = [["AUV", (i) => r.name(i)]];
      const add = (title, has, value) => { if (has) columns.push([title, value]); };
      add("phase", steps.has("phase") && r.targets > 0, (i) => STG.PHASES[steps.at("phase", row, i)] || "–");
      add("target", r.targets > 1, (i) => String(r.targetOf(i, Math.max(row, 0))));
      add("distance", r.targets > 0, (i) => STG.number(steps.at("distance", row, i), "m"));
      add("estimate off", steps.has("estimate"), (i) => STG.number(r.estimateError(row, i)[0], "m"));
      add("stated", steps.has("covariance"), (i) => STG.number(r.estimateStd(row, i), "m"));
      add("age", steps.has("age"), (i) => STG.number(steps.at("age", row, i), "s"));
      add("depth", r.meta.open, (i) => STG.number(-steps.at("position", row, 3 * i + 2), "m"));
      const [heard, missed] = this.counts(t);
      add("heard", r.packets.count > 0, (i) => String(heard[i] || 0));
      add("missed", r.packets.count > 0, (i) => String(missed[i] || 0));
      add("energy", steps.has("energy") && Number.isFinite(steps.at("energy", Math.max(row, 0), 0)), (i) => STG.number(steps.at("energy", row, i), "J"));
      const table = element("table");
      table.append(tableRow(columns.map(([title]) => title), "th"));
      for (let i = 0; i < r.agents; ++i) {
        const line = tableRow(columns.map(([, value]) => value(i)));
        line.className = selected === i ? "pick chosen" : "pick";
        const dot = element("i", "dot");
        dot.style.background = colours.phases[steps.at("phase", row, i)] || colours.soft;
        line.firstChild.prepend(dot);
        line.addEventListener("click", () => this.app.select(selected === i ? -1 : i));
        table.append(line);
      }
      this.now.replaceChildren(element("h2", "", `At ${STG.clock(t - r.start)}`), table);
      if (this.summaries !== r.summaries) this.drawMetrics();
    }

    /** Returns the numbers of packets that each AUV has heard and missed since the start of the episode. */
    counts(t) {
      const { recording: r, transmissions } = this.app, heard = [], missed = [];
      const episode = r.episodeAt(t);
      for (const one of transmissions.between(episode ? episode.start : -Infinity, t + 1e-9)) {
        for (const packet of one.rows) {
          if (r.packets.at("arrival", packet) > t) continue;
          const i = r.packets.at("receiver", packet), to = r.packets.at("fate", packet) === 0 ? heard : missed;
          to[i] = (to[i] || 0) + 1;
        }
      }
      return [heard, missed];
    }

    drawMetrics() {
      const r = this.app.recording;
      this.summaries = r.summaries;
      this.metrics.textContent = "";
      if (r.summaries.length === 0) return;
      const names = Object.keys(r.summaries[0].metrics), table = element("table");
      table.append(tableRow(["metric", ...r.summaries.map((s) => `episode ${s.episode}`)], "th"));
      for (const name of names) {
        table.append(tableRow([name.replace(/_/g, " "), ...r.summaries.map((s) => {
          const value = s.metrics[name];
          return typeof value === "number" ? STG.number(value) : String(value ?? "–");
        })]));
      }
      this.metrics.append(element("h2", "", "Metrics of finished episodes"), table);
    }
  }

  STG.Events = Events;
  STG.Live = Live;
})(window.STG = window.STG || {});
